//! Mass, centre and inertia of a body, and the principal axes.

use glam::{DMat3, DQuat, DVec3};

use crate::eigen::eigen;
use crate::error::{Error, Result};

/// Elements off the diagonal count as 0 below this share of the trace.
const ROUNDING: f64 = 1e-12;

/// Mass, centre and inertia of a [`Shape`](crate::Shape).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Mass.
    pub mass: f64,
    /// Centre of mass in coordinates of the shape, in units.
    pub centre: [f64; 3],
    /// Inertia xx, yy, zz, xy, xz, yz about the centre, along the axes of the shape, in mass units². The last three are elements of the
    /// tensor, which are minus the products of inertia.
    pub inertia: [f64; 6],
}

impl MassProperties {
    /// The principal moments of inertia in mass units², and the rotation that turns coordinates along the principal axes into those of
    /// the shape.
    ///
    /// If the tensor is diagonal, the rotation is the identity. Otherwise the moments ascend, and the largest component of the first
    /// axis and of the second axis is positive.
    pub fn principal(&self) -> (DVec3, DQuat) {
        let [xx, yy, zz, xy, xz, yz] = self.inertia;
        let negligible = ROUNDING * (xx + yy + zz).abs();
        if [xy, xz, yz].iter().all(|element| element.abs() <= negligible) {
            return (DVec3::new(xx, yy, zz), DQuat::IDENTITY);
        }
        let (values, vectors) = eigen([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        let column = |place: usize| DVec3::from_array([0, 1, 2].map(|row: usize| vectors[row][order[place]]));
        let [first, second] = [0, 1].map(|place| {
            let axis = column(place);
            let largest = axis.abs().to_array().iter().position(|x| *x == axis.abs().max_element()).unwrap_or(0);
            if axis[largest] < 0.0 { -axis } else { axis }
        });
        let axes = DMat3::from_cols(first, second, first.cross(second));
        let moments = DVec3::from_array(order.map(|place| values[place]));
        (moments, DQuat::from_mat3(&axes).normalize())
    }

    /// The properties of a body of the same shape whose mass is `factor` times as large.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self { mass: self.mass * factor, centre: self.centre, inertia: self.inertia.map(|element| element * factor) }
    }

    pub(crate) fn validate(&self) -> Result<()> {
        let numbers = [&[self.mass], self.centre.as_slice(), &self.inertia].concat();
        if !numbers.iter().all(|number| number.is_finite()) {
            let value = format!("{} at {:?} with {:?}", self.mass, self.centre, self.inertia);
            return Err(Error::Invalid { field: "shape.mass_properties", value, expected: "finite numbers" });
        }
        let usable = |number: f64| (number as f32).is_normal() && number > 0.0 && (1.0 / number as f32).is_normal();
        if !usable(self.mass) {
            let expected = "a mass greater than 0 whose inverse is neither 0 nor infinite in f32";
            return Err(Error::Invalid { field: "shape.mass", value: self.mass.to_string(), expected });
        }
        let (moments, _) = self.principal();
        let value = || format!("{:?} with the principal moments {:?}", self.inertia, moments.to_array());
        if !moments.to_array().into_iter().all(usable) {
            let expected = "principal moments greater than 0 whose inverses are neither 0 nor infinite in f32";
            return Err(Error::Invalid { field: "shape.inertia", value: value(), expected });
        }
        let greatest = moments.max_element();
        // In f32, the moments of a flat body may violate it by rounding.
        if greatest > (moments.element_sum() - greatest) * (1.0 + 1e-6) {
            let expected = "principal moments none of which is greater than the sum of the other two";
            return Err(Error::Invalid { field: "shape.inertia", value: value(), expected });
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "mass_tests.rs"]
mod tests;
