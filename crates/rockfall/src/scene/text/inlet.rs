//! Lines of boxes that let spheres in and out or report them: `@inlet` with its `@grain` lines, `@outlet` and `@sensor`.

use glam::DVec3;

use super::Reader;
use super::line::{GRAIN, INLET, Line, OUTLET, SENSOR};
use super::motion::{number, vector};
use super::values::Values;
use crate::error::quoted;
use crate::scene::{GrainKind, GrainMass, Inlet, Outlet, Rate, Sensor, SizedBy};

const GRAIN_KEYS: [&str; 4] = ["radius", "by", "mass", "density"];
const INLET_KEYS: [&str; 18] = [
    "name",
    "box",
    "rate",
    "mass_rate",
    "volume_rate",
    "shape",
    "mix",
    "radius",
    "by",
    "mass",
    "density",
    "velocity",
    "from",
    "to",
    "limit",
    "seed",
    "every",
    "after",
];
const OUTLET_KEYS: [&str; 3] = ["name", "box", "every"];
const SENSOR_KEYS: [&str; 2] = ["name", "box"];

impl Reader<'_> {
    pub(super) fn inlet(&mut self, line: &str, number: usize) -> Line<()> {
        if !line.contains('=') {
            return self.not_understood(number, INLET.wrong("box", format!("missing, expected {}", INLET.form())));
        }
        let values = Values::read(&INLET, &INLET_KEYS, line.split_ascii_whitespace().skip(1))?;
        let mut inlet = Inlet::new("", [[0.0; 3]; 2], values.rate()?, 0.0);
        inlet.corners = values.corners(self.offset())?;
        if let Some(mix) = values.of("mix") {
            values.without(&["radius", "mass", "density", "shape"], "mix", "each kind has its own size and mass")?;
            inlet = inlet.mix(self.mixture(mix)?, values.by()?);
        } else if let Some(name) = values.of("shape") {
            let own = ["radius", "by", "mass", "density", "volume_rate"];
            values.without(&own, "shape", "a shape has its own size and mass")?;
            inlet.kinds = vec![(GrainKind::bodies(self.known_shape(&INLET, name)?), 1.0)];
        } else {
            inlet.kinds = vec![(self.kind(&values)?, 1.0)];
        }
        if let Some(velocity) = values.of("velocity") {
            inlet.velocity = vector(&INLET, "velocity", velocity)?.as_vec3();
        }
        inlet.from = values.number("from")?.unwrap_or(inlet.from);
        inlet.to = values.number("to")?.unwrap_or(inlet.to);
        inlet.limit = values.parsed("limit", WHOLE)?;
        inlet.seed = values.parsed("seed", WHOLE)?.unwrap_or(0);
        inlet.every = values.parsed("every", WHOLE)?;
        inlet.after = values.parsed("after", WHOLE)?.unwrap_or(0);
        inlet.name = values.name("inlet", |name| self.scene.inlets().iter().any(|known| known.name == name));
        self.scene.add_inlet(inlet).map_err(|error| INLET.refused(&error))
    }

    /// A kind of spheres, for the mixtures of the inlets below.
    pub(super) fn grain(&mut self, line: &str, number: usize) -> Line<()> {
        let mut words = line.split_ascii_whitespace().skip(1);
        let Some(name) = words.next().filter(|name| !name.contains(['=', ',', ':'])) else {
            return self.not_understood(number, GRAIN.wrong("NAME", format!("missing, expected {}", GRAIN.form())));
        };
        let values = Values::read(&GRAIN, &GRAIN_KEYS, words)?;
        let kind = self.kind(&values)?.name(name);
        kind.validate().map_err(|error| GRAIN.refused(&error))?;
        self.grains.insert(name.to_owned(), kind);
        Ok(())
    }

    /// The spheres of a line, with the material, group and tag in use.
    fn kind(&self, values: &Values) -> Line<GrainKind> {
        let mut kind = values.grains()?;
        (kind.material, kind.group) = (self.material, self.group);
        kind.tag = self.tag.as_deref().cloned().unwrap_or_default();
        Ok(kind)
    }

    /// Kinds of grains and shapes of bodies with their shares.
    fn mixture(&self, mix: &str) -> Line<Vec<(GrainKind, f64)>> {
        let expected = "expected NAME:SHARE,... with names of @grain or @body lines above and shares greater than 0";
        let kind = |word: &str| {
            let wrong = || INLET.wrong("mix", format!("{} is not allowed, {expected}", quoted(word)));
            let (name, share) = word.split_once(':').ok_or_else(wrong)?;
            let share = share.parse().ok().filter(|share: &f64| share.is_finite() && *share > 0.0).ok_or_else(wrong)?;
            let shape = || self.scene.find_shape(name).map(GrainKind::bodies);
            let unknown = || INLET.wrong("mix", format!("an unknown kind {}, {expected}", quoted(name)));
            Ok((self.grains.get(name).cloned().or_else(shape).ok_or_else(unknown)?, share))
        };
        mix.split(',').map(kind).collect()
    }

    pub(super) fn outlet(&mut self, line: &str, number: usize) -> Line<()> {
        if !line.contains('=') {
            return self.not_understood(number, OUTLET.wrong("box", format!("missing, expected {}", OUTLET.form())));
        }
        let values = Values::read(&OUTLET, &OUTLET_KEYS, line.split_ascii_whitespace().skip(1))?;
        let mut outlet = Outlet::new("", [[0.0; 3]; 2]);
        outlet.corners = values.corners(self.offset())?;
        outlet.every = values.parsed("every", WHOLE)?;
        outlet.name = values.name("outlet", |name| self.scene.outlets().iter().any(|known| known.name == name));
        self.scene.add_outlet(outlet).map_err(|error| OUTLET.refused(&error))
    }

    pub(super) fn sensor(&mut self, line: &str, number: usize) -> Line<()> {
        if !line.contains('=') {
            return self.not_understood(number, SENSOR.wrong("box", format!("missing, expected {}", SENSOR.form())));
        }
        let values = Values::read(&SENSOR, &SENSOR_KEYS, line.split_ascii_whitespace().skip(1))?;
        let mut sensor = Sensor::new("", [[0.0; 3]; 2]);
        sensor.corners = values.corners(self.offset())?;
        sensor.name = values.name("sensor", |name| self.scene.sensors().iter().any(|known| known.name == name));
        self.scene.add_sensor(sensor).map_err(|error| SENSOR.refused(&error))
    }
}

const WHOLE: &str = "a whole number, not negative";

impl Values<'_> {
    fn rate(&self) -> Line<Rate> {
        let rates = [self.number("rate")?, self.number("mass_rate")?, self.number("volume_rate")?];
        match rates {
            [Some(rate), ..] => Ok(Rate::Number(rate)),
            [_, Some(rate), _] => Ok(Rate::Mass(rate)),
            [.., Some(rate)] => Ok(Rate::Volume(rate)),
            [None, None, None] => Err(self.kind.wrong("rate", "missing, expected rate=, mass_rate= or volume_rate=")),
        }
    }

    /// Reads the sizes and masses of spheres.
    fn grains(&self) -> Line<GrainKind> {
        let others = if self.kind.word == INLET.word { ", shape=NAME or mix=NAME:SHARE,..." } else { "" };
        let missing = || format!("missing, expected radius=r, radius=a..b or radius=lognormal:median,sigma{others}");
        let radii = self.parsed("radius", "a radius r, a range a..b or lognormal:median,sigma")?;
        let mut kind = GrainKind::spheres(0.0);
        kind.radii = radii.ok_or_else(|| self.kind.wrong("radius", missing()))?;
        kind.by = self.by()?;
        kind.mass = match (self.number("mass")?, self.number("density")?) {
            (Some(mass), _) => GrainMass::Mass(mass),
            (None, Some(density)) => GrainMass::Density(density),
            (None, None) => GrainMass::OfMaterial,
        };
        Ok(kind)
    }

    fn by(&self) -> Line<SizedBy> {
        Ok(self.parsed("by", "number or mass")?.unwrap_or_default())
    }

    /// Refuses keys that another one replaces.
    fn without(&self, keys: &[&str], key: &str, reason: &str) -> Line<()> {
        match keys.iter().find(|key| self.of(key).is_some()) {
            Some(given) => Err(self.kind.wrong(given, format!("given with {key}, expected one of them: {reason}"))),
            None => Ok(()),
        }
    }

    /// The corners of the box, moved on for a copy of the line.
    fn corners(&self, offset: DVec3) -> Line<[DVec3; 2]> {
        let expected = "expected six numbers box=x0,y0,z0,x1,y1,z1 without spaces";
        let value = self.of("box").ok_or_else(|| self.kind.wrong("box", format!("missing, {expected}")))?;
        let numbers: Vec<f64> = value.split(',').map(|word| number(self.kind, "box", word)).collect::<Line<_>>()?;
        match numbers[..] {
            [a, b, c, d, e, f] => Ok([DVec3::new(a, b, c), DVec3::new(d, e, f)].map(|corner| corner + offset)),
            _ => Err(self.kind.wrong("box", format!("{} is not allowed, {expected}", quoted(value)))),
        }
    }

    /// The name, or the first one that is not taken: `inlet`, `inlet2` and so on.
    fn name(&self, word: &str, is_taken: impl Fn(&str) -> bool) -> String {
        let mut free = std::iter::once(word.to_owned()).chain((2..).map(|number| format!("{word}{number}")));
        let given = self.of("name").map(str::to_owned);
        given.or_else(|| free.find(|name| !is_taken(name))).unwrap_or_default()
    }
}

#[cfg(test)]
#[path = "inlet_tests.rs"]
mod tests;
