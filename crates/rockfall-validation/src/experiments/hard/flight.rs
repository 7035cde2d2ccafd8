//! Bodies that nothing touches: free fall, and a body that flips.

use rockfall::glam::{DVec3, Vec3, Vec3Swizzles as _};
use rockfall::{Integrator, Shape, Sphere};

use super::{FRAME, GRAVITY, add, bodies, frames, ground};
use crate::chart::{Axis, Chart, Mark};
use crate::measure::on_cpu;
use crate::{Effort, Outcome, Result};

/// Free fall for a second.
pub(super) fn fall(outcome: &mut Outcome) -> Result<()> {
    let mut scene = ground(0.0, 0.5, 0.0)?;
    scene.add_sphere(Sphere::new([0.0, 10.0, 0.0], 0.5))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    frames(&mut simulation, 1.0)?;
    let height = simulation.spheres()?[0].position.y;
    outcome.check("1: ball that falls from 10 m: height after 1 s, m", 10.0 - 0.5 * GRAVITY, height.into(), 1e-4);
    Ok(())
}

/// Moments of inertia, and the spin at the start.
const MOMENTS: DVec3 = DVec3::new(1.0, 2.0, 3.0);
const SPIN: DVec3 = DVec3::new(0.01, 1.0, 0.0);

/// The cosine of the angle between the middle axis and the angular momentum, from Euler's equations, at the ends of all frames.
fn euler(count: u32) -> Vec<(f64, f64)> {
    const PARTS: u32 = 20;
    let dt = f64::from(FRAME) / f64::from(PARTS);
    let rate = |w: DVec3| {
        let turning = (MOMENTS.yzx() - MOMENTS.zxy()) / MOMENTS;
        turning * w.yzx() * w.zxy()
    };
    let (mut w, mut cosines) = (SPIN, Vec::new());
    for frame in 0..=count {
        cosines.push((f64::from(frame) * f64::from(FRAME), MOMENTS.y * w.y / (MOMENTS * w).length()));
        for _ in 0..PARTS {
            let k1 = rate(w);
            let k2 = rate(w + 0.5 * dt * k1);
            let k3 = rate(w + 0.5 * dt * k2);
            let k4 = rate(w + dt * k3);
            w += dt / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        }
    }
    cosines
}

/// The times at which a sampled signal changes its sign.
fn crossings(samples: &[(f64, f64)]) -> Vec<f64> {
    let pairs = samples.windows(2).filter(|pair| pair[0].1 * pair[1].1 <= 0.0);
    pairs.map(|pair| pair[0].0 + (pair[1].0 - pair[0].0) * pair[0].1 / (pair[0].1 - pair[1].1)).collect()
}

/// A body that spins about its middle axis flips.
pub(super) fn flips(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    let count = effort.pick(1800, 7200);
    let mut scene = ground(0.0, 0.5, 0.0)?;
    scene.settings.gravity = 0.0;
    let [x, y, z] = MOMENTS.as_vec3().to_array();
    let shape = Shape::new().sphere([0.0; 3], 0.5).mass_properties(1.0, [0.0; 3], [x, y, z, 0.0, 0.0, 0.0]);
    add(&mut scene, shape, |place| place.at([0.0, 5.0, 0.0]).spin(SPIN.as_vec3()))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let start = simulation.energy()?;
    let momentum = bodies(&mut simulation)?[0].angular_momentum.as_dvec3();
    let (mut cosines, mut turned) = (vec![(0.0, 1.0)], 0.0_f64);
    for frame in 1..=count {
        simulation.run(1, FRAME)?;
        let body = &bodies(&mut simulation)?[0];
        let now = body.angular_momentum.as_dvec3();
        let axis = (body.orientation * Vec3::Y).as_dvec3();
        cosines.push((f64::from(frame) * f64::from(FRAME), axis.dot(now) / now.length()));
        turned = turned.max(now.distance(momentum));
    }
    let exact = euler(count);
    let energy = simulation.energy()?.kinetic / start.kinetic - 1.0;
    let [wanted, found] = [&exact, &cosines].map(|samples| crossings(samples)[0]);
    outcome.check("29: body with the moments 1, 2, 3: time of the first flip, s", wanted, found, 0.005);
    let seconds = f64::from(count) * f64::from(FRAME);
    outcome.check(format!("29: relative energy change in {seconds:.0} s"), 0.0, energy, 5e-5);
    outcome.check(format!("29: angular momentum change in {seconds:.0} s, kg m²/s"), 0.0, turned, 1e-6);
    let until = |samples: Vec<(f64, f64)>, step| samples.into_iter().take(3600).step_by(step).collect();
    let cosine = Axis::linear("cosine of the middle axis with L");
    outcome.charts.push(
        Chart::new("hard-flips", "A body flips about its middle axis", Axis::linear("time, s"), cosine)
            .add(0, Mark::Line, "Euler's equations", until(exact, 6))
            .add(0, Mark::Points, "measured", until(cosines, 30)),
    );
    Ok(())
}
