//! Kernels with one plausible mistake each. The comparisons with the twin reject every one of them.

use std::sync::Arc;

use super::super::scene::{DT, Scene};
use super::device::{apart, open, stage};
use super::{device, device_round};
use crate::rigid::frame::{Frame, bodies_alone};
use crate::rigid::gpu::world::GpuWorld;
use crate::rigid::gpu::{Part, RigidGpu};
use crate::rigid::world::RigidWorld;

/// The right text of a kernel, and a wrong one.
const MISTAKES: &[[&str; 2]] = &[
    ["0.5 * share * h * h * acceleration.xyz", "0.5 * share * h * acceleration.xyz"],
    ["vec4f(place + h * motion.velocity, 0.0)", "vec4f(place, 0.0)"],
    ["bodies[at + 2u].xyz + frame.h * constants", "bodies[at + 2u].xyz + 0.9 * frame.h * constants"],
    ["press.kept = 1.0 - rule.soft.z;", "press.kept = 1.0;"],
    ["const PUSH_OUT: f32 = 3.0;", "const PUSH_OUT: f32 = 0.001;"],
    ["return rule.biased | (gap <= 0.0) | (normal > 0.0);", "return rule.biased | (gap <= 0.0);"],
    ["let inverse = 1.0 / (inverse_masses(sides) + coupling(along, along));", "let inverse = 1.0 / inverse_masses(sides);"],
    ["next *= bound / size;", "next = vec2f(0.0);"],
    ["let k_both = coupling(one, two);", "let k_both = 0.0;"],
    ["1.0 / (0.5 * (k_one + k_two) + sqrt", "1.0 / ((k_one + k_two) + sqrt"],
    ["grip.two)) + axes.belt;", "grip.two));"],
    ["let scale = (1.0 + bounce / sum) * (work / loss);", "let scale = (1.0 + 0.5 * bounce / sum) * (work / loss);"],
    ["after.velocity = velocity - time * frame.gravity;", "after.velocity = velocity;"],
    ["moment_b += cross(at.xyz - sight.apart, impulse);", "moment_b += cross(at.xyz, impulse);"],
    ["0.5 * (place_a + place_b), dot(place_b - place_a, normal)", "place_a, dot(place_b - place_a, normal)"],
    ["let scale = frame.soft[0].w;", "let scale = 0.5 * frame.soft[0].w;"],
    ["let grown = shape.radius + bodies", "let grown = -shape.radius + bodies"],
    ["if !is_covered(block, side, own, probe, skin)", "if is_covered(block, side, own, probe, skin)"],
    ["max(found.least - row.w + u * rest, 0.0)", "0.0"],
];

/// Scenes in which a mistake may show, at the first frame that is compared, and the number of these frames. Bodies pass each other in one
/// of several frames.
fn scenes() -> Vec<(&'static str, Scene, usize)> {
    let flat = device::scenes().into_iter().filter(|scene| ["pile", "corner", "elastic corner"].contains(&scene.0));
    let round = ["tiles", "rolling", "ground", "passing"];
    let round = device_round::scenes().into_iter().filter(move |scene| round.contains(&scene.0));
    flat.chain(round)
        .map(|(name, mut scene, seconds)| {
            scene.run(seconds);
            (name, scene, if name == "passing" { 12 } else { 1 })
        })
        .collect()
}

/// What a comparison finds wrong in some frames, if anything.
fn rejected(gpu: &Arc<RigidGpu>, scene: &Scene, frames: usize) -> Option<String> {
    let mut world = scene.world.clone();
    (0..frames).find_map(|_| {
        let found = rejected_here(gpu, &world);
        crate::rigid::frame::advance(&mut world, DT, 4);
        found
    })
}

/// The same in a frame and the next one.
fn rejected_here(gpu: &Arc<RigidGpu>, start: &RigidWorld) -> Option<String> {
    const PARTS: [Part; 7] = [Part::Impacts, Part::Kick, Part::Spare, Part::Biased, Part::Drift, Part::Refresh, Part::Relax];
    let mut frame = Frame::open(start, DT, 4);
    for substep in 0..4 {
        for part in PARTS {
            let (kind, apart) = stage(gpu, &mut frame, part);
            // Wider than the bounds of `stages_agree` and `round_stages_agree`.
            if apart >= 1e-3 {
                return Some(format!("{part:?} of substep {substep}: {kind} differs by {apart:.1e}"));
            }
        }
    }
    let (mut world, mut twin) = (start.clone(), start.clone());
    let mut on_device = GpuWorld::new(gpu, &world, &bodies_alone(&world)).expect("it fits");
    for _ in 0..2 {
        on_device.advance(DT, 4, true).expect("a frame");
        crate::rigid::frame::advance(&mut twin, DT, 4);
    }
    on_device.download(&mut world).expect("states");
    let [place, speed] = apart(&twin, &world);
    // As in `worlds_agree`, for two frames.
    (place >= 2e-4 || speed >= 2e-2).then(|| format!("frames differ by {place:.1e} and {speed:.1e}"))
}

#[test]
fn mistakes_in_kernels_are_rejected() {
    let (gpu, scenes) = (open(), scenes());
    for (name, scene, frames) in &scenes {
        assert_eq!(rejected(&gpu, scene, *frames), None, "{name}, without a mistake");
    }
    let mut accepted = Vec::new();
    for mistake in MISTAKES {
        let broken = gpu.with_mistake(*mistake);
        let found = scenes.iter().find_map(|(name, scene, frames)| Some((name, rejected(&broken, scene, *frames)?)));
        match found {
            Some((name, what)) => eprintln!("{}: {name}, {what}", mistake[1]),
            None => accepted.push(mistake[1]),
        }
    }
    assert!(accepted.is_empty(), "{accepted:#?}");
}
