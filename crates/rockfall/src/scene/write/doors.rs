//! Lines of inlets, outlets and sensors.

use std::fmt::Write as _;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::Writer;
use crate::scene::{GrainKind, GrainMass, Inlet, Rate, SizedBy};

impl Writer<'_> {
    pub(super) fn doors(&mut self) {
        for inlet in self.scene.inlets() {
            // Writing to a string cannot fail.
            let is_mixed = inlet.kinds.len() > 1;
            for (kind, _) in inlet.kinds.iter().filter(|(kind, _)| kind.shape.is_none()) {
                self.set_group(kind.group, kind.material);
                self.set_tag(Some(&Arc::new(kind.tag.clone())));
                if is_mixed {
                    let _ = writeln!(self.text, "@grain {}{}", kind.name, joined(self.kind_values(kind)));
                }
            }
            let _ = writeln!(self.text, "@inlet name={}{}", inlet.name, self.values(inlet));
        }
        for outlet in self.scene.outlets() {
            let every = outlet.every.map_or(String::new(), |steps| format!(" every={steps}"));
            let _ = writeln!(self.text, "@outlet name={} box={}{every}", outlet.name, numbers(&outlet.corners));
        }
        for sensor in self.scene.sensors() {
            let _ = writeln!(self.text, "@sensor name={} box={}", sensor.name, numbers(&sensor.corners));
        }
    }

    /// The values that are not those of a new inlet.
    fn values(&self, inlet: &Inlet) -> String {
        let Inlet { corners, rate, kinds, shares, velocity, from, to, limit, seed, every, after, .. } = inlet;
        let Vec3 { x, y, z } = *velocity;
        let (rate_key, rate) = match rate {
            Rate::Number(rate) => ("rate", rate),
            Rate::Mass(rate) => ("mass_rate", rate),
            Rate::Volume(rate) => ("volume_rate", rate),
        };
        let own = match &kinds[..] {
            [(kind, _)] => self.kind_values(kind),
            _ => vec![("mix", Some(self.mix(kinds))), ("by", (*shares != SizedBy::Number).then(|| shares.to_string()))],
        };
        let number = |number: Option<u64>| number.map(|number| number.to_string());
        let first = [("box", Some(numbers(corners))), (rate_key, Some(rate.to_string()))];
        let last = [
            ("velocity", (super::bits(*velocity) != [0; 3]).then(|| format!("{x},{y},{z}"))),
            ("from", (from.to_bits() != 0).then(|| from.to_string())),
            ("to", to.is_finite().then(|| to.to_string())),
            ("limit", number(*limit)),
            ("seed", (*seed != 0).then(|| seed.to_string())),
            ("every", number(*every)),
            ("after", (*after != 0).then(|| after.to_string())),
        ];
        joined(first.into_iter().chain(own).chain(last))
    }

    /// The values of a kind that are not those of a new one.
    fn kind_values(&self, kind: &GrainKind) -> Vec<(&'static str, Option<String>)> {
        let GrainKind { shape, radii, by, mass, .. } = kind;
        let (mass_key, mass) = match *mass {
            GrainMass::Mass(mass) if shape.is_none() => ("mass", mass),
            GrainMass::Density(density) => ("density", density),
            _ => ("", 0.0),
        };
        vec![
            ("shape", shape.map(|shape| self.name_of_shape(shape))),
            ("radius", shape.is_none().then(|| radii.to_string())),
            ("by", (*by != SizedBy::Number).then(|| by.to_string())),
            (mass_key, (!mass_key.is_empty()).then(|| mass.to_string())),
        ]
    }

    fn mix(&self, kinds: &[(GrainKind, f64)]) -> String {
        let name = |kind: &GrainKind| kind.shape.map_or_else(|| kind.name.clone(), |shape| self.name_of_shape(shape));
        kinds.iter().map(|(kind, share)| format!("{}:{share}", name(kind))).collect::<Vec<_>>().join(",")
    }
}

fn joined(values: impl IntoIterator<Item = (&'static str, Option<String>)>) -> String {
    values.into_iter().filter_map(|(key, value)| Some(format!(" {key}={}", value?))).collect()
}

fn numbers(corners: &[DVec3; 2]) -> String {
    let numbers: Vec<String> = corners.iter().flat_map(|corner| corner.to_array()).map(|x| x.to_string()).collect();
    numbers.join(",")
}
