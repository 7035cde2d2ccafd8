//! The line `@gauge`.

use glam::DVec3;

use super::Reader;
use super::line::{GAUGE, Line, Wrong};
use super::motion::numbers;
use crate::error::{Error, nearest, quoted};
use crate::scene::{Gauge, Gauged};

const KEYS: [&str; 3] = ["name", "wall", "plane"];

impl Reader<'_> {
    pub(super) fn gauge(&mut self, line: &str, number: usize) -> Line<()> {
        let words: Vec<&str> = line.split_ascii_whitespace().skip(1).collect();
        if !words.iter().any(|word| word.contains('=')) {
            return self.not_understood(number, GAUGE.wrong("line", format!("no value, expected `{}`", GAUGE.form())));
        }
        let (mut name, mut of) = (None, None);
        for word in words {
            match key_and_value(word)? {
                ("name", value) => once(&mut name, "name", value.to_owned())?,
                ("wall", value) => once(&mut of, "wall", Gauged::Wall(value.to_owned()))?,
                (_, value) => once(&mut of, "plane", plane(value)?)?,
            }
        }
        let missing = |key: &str| GAUGE.wrong(key, format!("missing, expected `{}`", GAUGE.form()));
        let gauge = Gauge { name: name.ok_or_else(|| missing("name"))?, of: of.ok_or_else(|| missing("wall or plane"))? };
        gauge.validate().map_err(|error| GAUGE.refused(&error))?;
        self.gauges.push((self.at, gauge));
        Ok(())
    }

    /// Adds the gauges when all walls are known. Returns the wrong line.
    pub(super) fn add_gauges(&mut self) -> Result<(), (usize, Wrong)> {
        for (line, gauge) in std::mem::take(&mut self.gauges) {
            self.scene.add_gauge(gauge).map_err(|error: Error| (line, GAUGE.refused(&error)))?;
        }
        Ok(())
    }
}

fn key_and_value(word: &str) -> Line<(&str, &str)> {
    let Some((key, value)) = word.split_once('=') else {
        return Err(GAUGE.wrong(&quoted(word), format!("expected KEY=VALUE with a key of {}", KEYS.join(", "))));
    };
    if KEYS.contains(&key) {
        return Ok((key, value));
    }
    let known = || format!("expected one of {}", KEYS.join(", "));
    let hint = nearest(key, &KEYS).map_or_else(known, |near| format!("did you mean {near}?"));
    Err(GAUGE.wrong(&quoted(key), format!("an unknown key, {hint}")))
}

/// A point and a normal.
fn plane(value: &str) -> Line<Gauged> {
    let [x, y, z, nx, ny, nz] = numbers(&GAUGE, "plane", value, "six numbers x,y,z,nx,ny,nz")?;
    Ok(Gauged::Plane { point: DVec3::new(x, y, z), normal: DVec3::new(nx, ny, nz) })
}

fn once<T>(place: &mut Option<T>, key: &str, value: T) -> Line<()> {
    match place.replace(value) {
        None => Ok(()),
        Some(_) => {
            let expected = if key == "name" { "one name" } else { "either one wall or one plane" };
            Err(GAUGE.wrong(key, format!("given twice in the line, expected {expected}")))
        }
    }
}
