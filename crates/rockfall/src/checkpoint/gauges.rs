//! The gauges in a checkpoint: their number, then the name of each, what it measures, and what was in front of its plane at the
//! start.

use glam::DVec3;

use super::words::{Damage, Head, Words};
use crate::scene::{Front, Gauge, Gauged, Scene};

pub(super) fn put(head: &mut Head, scene: &Scene, fronts: &[Front]) {
    head.u32(scene.gauges().len() as u32);
    for (index, Gauge { name, of }) in scene.gauges().iter().enumerate() {
        head.text(name);
        match of {
            Gauged::Wall(wall) => {
                head.u32(0);
                head.text(wall);
            }
            Gauged::Plane { point, normal } => {
                head.u32(1);
                point.to_array().into_iter().chain(normal.to_array()).for_each(|number| head.f64(number));
            }
        }
        let Front { count, mass } = fronts.get(index).copied().unwrap_or_default();
        head.u64(count.cast_unsigned());
        head.f64(mass);
    }
}

pub(super) fn read(words: &mut Words, scene: &mut Scene) -> Result<Vec<Front>, Damage> {
    let mut fronts = Vec::new();
    for _ in 0..words.u32()? {
        let name = words.text()?;
        let of = match words.u32()? {
            0 => Gauged::Wall(words.text()?),
            1 => {
                let mut vector = || -> Result<DVec3, Damage> { Ok(DVec3::new(words.f64()?, words.f64()?, words.f64()?)) };
                Gauged::Plane { point: vector()?, normal: vector()? }
            }
            kind => return Err(Damage::new(format!("it has a gauge of kind {kind}, expected 0 or 1"))),
        };
        // The walls follow.
        scene.put_gauge(Gauge { name, of })?;
        let front = Front { count: words.u64()?.cast_signed(), mass: words.f64()? };
        if !front.mass.is_finite() {
            return Err(Damage::new("the mass in front of a gauge is not finite"));
        }
        fronts.push(front);
    }
    Ok(fronts)
}
