//! Warnings about inlets that cannot keep their rate.

use crate::report::short_number;
use crate::scene::{Inlet, Rate, Scene};

/// Largest share of the space behind an inlet that spheres at random places fill.
const SOLID: f64 = 0.3;

impl Scene {
    /// Warnings about inlets whose rate does not fit into their box (docs/physics section 2.15). An inlet that lets in no more
    /// spheres than have room in its box at once needs no rate that fits.
    pub fn inlet_concerns(&self) -> Vec<String> {
        self.inlets.iter().enumerate().filter_map(|(number, inlet)| self.too_fast(number, inlet)).collect()
    }

    fn too_fast(&self, number: usize, inlet: &Inlet) -> Option<String> {
        let sequence = self.sequence(inlet, number);
        // The mean of spheres of the sequence.
        const SAMPLE: u64 = 1000;
        let (mut mass, mut volume) = (0.0, 0.0);
        for serial in 0..SAMPLE {
            let grain = sequence.grain(serial);
            mass += f64::from(grain.mass) / SAMPLE as f64;
            volume += grain.volume() / SAMPLE as f64;
        }
        let (rate, of_volume, unit) = match inlet.rate {
            Rate::Number(rate) => (rate, volume, "spheres"),
            Rate::Mass(rate) => (rate, volume / mass, "mass"),
            Rate::Volume(rate) => (rate, 1.0, "units³"),
        };
        let size = inlet.corners[1] - inlet.corners[0];
        let velocity = inlet.velocity.as_dvec3();
        // Spheres also fall out of the box.
        let down =
            self.settings.gravity_direction.as_dvec3().normalize_or_zero().abs() * f64::from(self.settings.gravity).abs();
        let speed = (velocity * velocity + 2.0 * down * size).map(f64::sqrt);
        let flow = speed.x * size.y * size.z + speed.y * size.z * size.x + speed.z * size.x * size.y;
        let largest = SOLID * flow / of_volume;
        let number = (rate * (inlet.to - inlet.from) * of_volume / volume).min(inlet.limit.unwrap_or(u64::MAX) as f64);
        let room = (SOLID * size.element_product() / volume).max(1.0);
        (rate > largest && number > room).then(|| {
            format!(
                "the inlet {} lets in {} {unit}/s, but no more than about {} {unit}/s fit through its box at the speed with which the \
                 spheres leave it: spheres will wait",
                inlet.name,
                short_number(rate, 3),
                short_number(largest, 3)
            )
        })
    }
}
