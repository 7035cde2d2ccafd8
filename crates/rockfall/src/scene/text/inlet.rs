//! Lines of inlets and outlets: `@inlet` and `@outlet`.

use std::str::FromStr;

use glam::DVec3;

use super::Reader;
use super::line::{INLET, Kind, Line, OUTLET};
use super::motion::{number, vector};
use crate::error::{nearest, quoted};
use crate::scene::{GrainMass, Inlet, Outlet, Rate};

const INLET_KEYS: [&str; 16] = [
    "name",
    "box",
    "rate",
    "mass_rate",
    "volume_rate",
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
/// Keys of which a line has at most one.
const ALTERNATIVES: [&[&str]; 2] = [&["rate", "mass_rate", "volume_rate"], &["mass", "density"]];

impl Reader<'_> {
    pub(super) fn inlet(&mut self, line: &str, number: usize) -> Line<()> {
        if !line.contains('=') {
            return self.not_understood(number, INLET.wrong("box", format!("missing, expected {}", INLET.form())));
        }
        let values = Values::read(&INLET, &INLET_KEYS, line)?;
        let mut inlet = Inlet::new("", [[0.0; 3]; 2], values.rate()?, 0.0);
        inlet.corners = values.corners(self.offset())?;
        inlet.radii = values
            .parsed("radius", "a radius r, a range a..b or lognormal:median,sigma")?
            .ok_or_else(|| INLET.wrong("radius", "missing, expected radius=r, radius=a..b or radius=lognormal:median,sigma"))?;
        inlet.by = values.parsed("by", "number or mass")?.unwrap_or_default();
        inlet.mass = match (values.number("mass")?, values.number("density")?) {
            (Some(mass), _) => GrainMass::Mass(mass),
            (None, Some(density)) => GrainMass::Density(density),
            (None, None) => GrainMass::OfMaterial,
        };
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
        (inlet.material, inlet.group) = (self.material, self.group);
        inlet.tag = self.tag.as_deref().cloned().unwrap_or_default();
        self.scene.add_inlet(inlet).map_err(|error| INLET.refused(&error))
    }

    pub(super) fn outlet(&mut self, line: &str, number: usize) -> Line<()> {
        if !line.contains('=') {
            return self.not_understood(number, OUTLET.wrong("box", format!("missing, expected {}", OUTLET.form())));
        }
        let values = Values::read(&OUTLET, &OUTLET_KEYS, line)?;
        let mut outlet = Outlet::new("", [[0.0; 3]; 2]);
        outlet.corners = values.corners(self.offset())?;
        outlet.every = values.parsed("every", WHOLE)?;
        outlet.name = values.name("outlet", |name| self.scene.outlets().iter().any(|known| known.name == name));
        self.scene.add_outlet(outlet).map_err(|error| OUTLET.refused(&error))
    }
}

const WHOLE: &str = "a whole number, not negative";

/// The words KEY=VALUE of a line.
struct Values<'a> {
    kind: &'a Kind,
    values: Vec<(&'a str, &'a str)>,
}

impl<'a> Values<'a> {
    fn read(kind: &'a Kind, keys: &[&str], line: &'a str) -> Line<Self> {
        let mut found = Self { kind, values: Vec::new() };
        for word in line.split_ascii_whitespace().skip(1) {
            let Some((key, value)) = word.split_once('=') else {
                return Err(kind.wrong(&quoted(word), format!("expected KEY=VALUE with a key of {}", keys.join(", "))));
            };
            if !keys.contains(&key) {
                let known = || format!("expected one of {}", keys.join(", "));
                let hint = nearest(key, keys).map_or_else(known, |near| format!("did you mean {near}?"));
                return Err(kind.wrong(&quoted(key), format!("an unknown key, {hint}")));
            }
            if found.of(key).is_some() {
                return Err(kind.wrong(key, "given twice in the line"));
            }
            let others = ALTERNATIVES.into_iter().filter(|keys| keys.contains(&key)).flatten();
            if let Some(other) = others.copied().find(|other| found.of(other).is_some()) {
                return Err(kind.wrong(key, format!("given together with {other}, expected one of the two")));
            }
            found.values.push((key, value));
        }
        Ok(found)
    }

    fn of(&self, key: &str) -> Option<&'a str> {
        self.values.iter().find(|(known, _)| *known == key).map(|(_, value)| *value)
    }

    fn number(&self, key: &str) -> Line<Option<f64>> {
        self.of(key).map(|value| number(self.kind, key, value)).transpose()
    }

    fn parsed<T: FromStr>(&self, key: &str, expected: &str) -> Line<Option<T>> {
        let wrong = |value: &str| self.kind.wrong(key, format!("{} is not allowed, expected {expected}", quoted(value)));
        self.of(key).map(|value| value.parse().map_err(|_| wrong(value))).transpose()
    }

    fn rate(&self) -> Line<Rate> {
        let rates = [self.number("rate")?, self.number("mass_rate")?, self.number("volume_rate")?];
        match rates {
            [Some(rate), ..] => Ok(Rate::Number(rate)),
            [_, Some(rate), _] => Ok(Rate::Mass(rate)),
            [.., Some(rate)] => Ok(Rate::Volume(rate)),
            [None, None, None] => Err(self.kind.wrong("rate", "missing, expected rate=, mass_rate= or volume_rate=")),
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
