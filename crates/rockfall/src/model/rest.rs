//! Whether the bodies of a world rest.

use glam::{Vec4, Vec4Swizzles as _};

/// Counts the steps at whose end every sphere is slow. `run_worlds` does the same on a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rest {
    /// Greatest speed of a sphere at rest, in units/s: that of its centre, and that of its surface about the centre.
    pub(crate) speed: f32,
    /// Steps one after the other at whose end all spheres were slow.
    pub(crate) calm: u32,
}

impl Rest {
    /// Notes the state after a step: positions and radii, velocities, angular momenta and inverse inertias.
    pub(crate) fn note(&mut self, rows: &[Vec4]) {
        let spheres = rows.len() / 3;
        let (positions, rest) = rows.split_at(spheres);
        let (velocities, momenta) = rest.split_at(spheres);
        let most = self.speed * self.speed;
        let mut all = positions.iter().zip(velocities).zip(momenta);
        let are_slow = all.all(|((position, velocity), momentum)| {
            let (velocity, spin) = (velocity.xyz(), momentum.xyz() * momentum.w);
            velocity.dot(velocity) <= most && spin.dot(spin) * position.w * position.w <= most
        });
        self.calm = if are_slow { self.calm.saturating_add(1) } else { 0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocity_and_spin_both_count() {
        let calm = |velocity: f32, momentum: f32| {
            let rows = [Vec4::new(0.0, 9.0, 0.0, 0.5), Vec4::new(0.0, 0.0, velocity, 1.0), Vec4::new(momentum, 0.0, 0.0, 10.0)];
            let mut rest = Rest { speed: 0.01, calm: 3 };
            rest.note(&rows);
            rest.calm
        };
        // A spin of 10 times the momentum moves the surface with half of that.
        assert_eq!([calm(0.0099, 0.0), calm(0.0, 0.0019), calm(0.0101, 0.0), calm(0.0, 0.0021)], [4, 4, 0, 0]);
        assert_eq!(calm(f32::NAN, 0.0), 0);
    }
}
