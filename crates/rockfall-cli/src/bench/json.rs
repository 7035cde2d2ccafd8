//! Results as JSON, for programs.

use rockfall::Profile;
use serde_json::{Map, Value, json};

use crate::bench::Arguments;
use crate::bench::measure::Measured;
use crate::bench::phases::PHASES;
use crate::options;

/// All results as one JSON object.
pub(crate) fn object(arguments: &Arguments, sizes: &[Measured]) -> String {
    let (device, driver, backend) = sizes.first().map_or((String::new(), String::new(), String::new()), |size| {
        let info = &size.backend;
        (info.device.clone(), info.driver.clone(), info.kind.to_string())
    });
    let best_copy = sizes.iter().filter_map(|size| size.copy_bandwidth).reduce(f64::max);
    let object = json!({
        "version": env!("CARGO_PKG_VERSION"),
        // Commit that the program was built from, with "-dirty" if the sources had changed since; null outside a repository.
        "commit": option_env!("ROCKFALL_COMMIT"),
        "scene": arguments.scene.to_string(),
        "backend": backend,
        "device": device,
        "driver": driver,
        "integrator": sizes.first().map(|size| size.integrator.to_string()),
        "broad_phase": arguments.engine.broad_phase.to_string(),
        "without": arguments.engine.without.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "dt": options::as_written(arguments.dt()),
        "steps": arguments.steps,
        "warmup": arguments.warmup(),
        "runs": arguments.runs,
        "seed": arguments.seed,
        "copy_bytes_per_second": best_copy,
        "sizes": sizes.iter().map(size).collect::<Vec<_>>(),
    });
    format!("{object}\n")
}

/// The measurements of one size.
pub(crate) fn size(size: &Measured) -> Value {
    let per_sphere = |bytes: f64| bytes / size.counts.spheres as f64;
    let buffers: Map<String, Value> = size.buffers.iter().map(|buffer| (buffer.name.to_owned(), buffer.bytes.into())).collect();
    json!({
        "bodies": size.bodies,
        "broad_phase": size.broad_phase.to_string(),
        "objects": options::counts_json(&size.counts),
        "seconds": size.seconds.json(),
        "steps_per_second": size.steps_per_second().json(),
        "sphere_steps_per_second": size.sphere_steps_per_second().json(),
        "memory_bytes": size.memory(),
        "memory_bytes_per_sphere": per_sphere(size.memory() as f64),
        "buffers": buffers,
        "least_bytes_per_sphere_step": size.least_bytes_per_step().map(per_sphere),
        "bandwidth_used": size.bandwidth_used(),
        "contacts": size.report.contacts,
        "collisions": size.report.total_collisions,
        "replays": size.report.replays,
        "list_builds": size.report.list_builds,
        "steps_with_warmup": size.report.steps,
        "profile": size.profile.as_ref().map(|profile| profile_of(size, profile)),
    })
}

fn profile_of(size: &Measured, profile: &Profile) -> Value {
    let phases: Map<String, Value> =
        PHASES.into_iter().map(|(phase, _, key)| (key.to_owned(), size.phase_seconds(phase).into())).collect();
    let key = |phase| PHASES.iter().find(|known| known.0 == phase).map(|known| known.2);
    let stages: Vec<Value> = profile
        .stages
        .iter()
        .map(|stage| {
            json!({
                "name": stage.name,
                "phase": key(stage.phase),
                "runs": stage.runs,
                "seconds": stage.seconds,
                "least_bytes": stage.least_bytes,
            })
        })
        .collect();
    json!({
        "clock": profile.clock.name(),
        "steps": profile.steps,
        "seconds": profile.seconds,
        "rejected_seconds": profile.rejected_seconds,
        "phase_seconds_per_step": phases,
        "stages": stages,
    })
}
