//! Lines about moving walls: `@motion`, `@move` and `@surface`.

use glam::{DVec3, Vec3};

use super::Reader;
use super::line::{Kind, Line, MOTION, MOVE, SURFACE};
use super::tags::only_word;
use crate::error::{nearest, quoted};
use crate::scene::{Motion, MotionTerm};

const KEYS: [&str; 9] = ["velocity", "spin", "axis", "through", "amplitude", "frequency", "phase", "from", "to"];

impl Reader<'_> {
    pub(super) fn motion(&mut self, line: &str, number: usize) -> Line<()> {
        let mut words = line.split_ascii_whitespace().skip(1);
        let name = words.next().filter(|name| !name.contains('='));
        if !line.contains('=') || name.is_none() {
            return self
                .not_understood(number, MOTION.wrong("NAME", format!("missing, or no value, expected {}", MOTION.form())));
        }
        let mut term = MotionTerm::default();
        let mut given = Vec::new();
        for word in words {
            let key = read(word, &mut term)?;
            if given.contains(&key) {
                return Err(MOTION.wrong(key, "given twice in the line"));
            }
            given.push(key);
        }
        for (key, needed) in [
            ("amplitude", "frequency"),
            ("frequency", "amplitude"),
            ("phase", "frequency"),
            ("axis", "spin"),
            ("through", "spin"),
            ("spin", "axis"),
        ] {
            if given.contains(&key) && !given.contains(&needed) {
                return Err(MOTION.wrong(key, format!("given without {needed}, expected both")));
            }
        }
        let name = name.unwrap_or_default();
        let refused = |error| MOTION.refused(&error);
        match self.scene.find_motion(name) {
            Some(known) => self.scene.update_motion(known, |motion| motion.terms.push(term)).map_err(refused),
            None => self.scene.add_motion(Motion::new(name, term)).map(drop).map_err(refused),
        }
    }

    pub(super) fn follow(&mut self, line: &str, number: usize) -> Line<()> {
        let name = match only_word(&MOVE, line) {
            Ok(name) => name,
            Err(wrong) => return self.not_understood(number, wrong),
        };
        self.motion = match name {
            "-" => None,
            _ => Some(self.scene.find_motion(name).ok_or_else(|| {
                let known: Vec<&str> = self.scene.motions().iter().map(|motion| motion.name.as_str()).collect();
                let hint = match nearest(name, &known) {
                    Some(near) => format!("did you mean {}?", quoted(near)),
                    None => "expected the name of an @motion line above".to_owned(),
                };
                MOVE.wrong(&quoted(name), format!("an unknown motion, {hint}"))
            })?),
        };
        Ok(())
    }
}

impl Reader<'_> {
    pub(super) fn surface(&mut self, line: &str, number: usize) -> Line<()> {
        let word = match only_word(&SURFACE, line) {
            Ok(word) => word,
            Err(wrong) => return self.not_understood(number, wrong),
        };
        self.surface = match word.split_once('=') {
            _ if word == "-" => Vec3::ZERO,
            Some(("velocity", value)) => vector(&SURFACE, "velocity", value)?.as_vec3(),
            _ => return Err(SURFACE.wrong(&quoted(word), format!("expected `{}`, or `@surface -` for none", SURFACE.form()))),
        };
        Ok(())
    }
}

/// Reads a word KEY=VALUE. Returns the key.
fn read(word: &str, term: &mut MotionTerm) -> Line<&'static str> {
    let Some((key, value)) = word.split_once('=') else {
        return Err(MOTION.wrong(&quoted(word), format!("expected KEY=VALUE with a key of {}", KEYS.join(", "))));
    };
    let Some(known) = KEYS.into_iter().find(|known| *known == key) else {
        let known = || format!("expected one of {}", KEYS.join(", "));
        let hint = nearest(key, &KEYS).map_or_else(known, |near| format!("did you mean {near}?"));
        return Err(MOTION.wrong(&quoted(key), format!("an unknown key, {hint}")));
    };
    match known {
        "velocity" => term.velocity = vector(&MOTION, key, value)?,
        "axis" => term.axis = vector(&MOTION, key, value)?,
        "through" => term.through = vector(&MOTION, key, value)?,
        "amplitude" => term.amplitude = vector(&MOTION, key, value)?,
        "spin" => term.spin = number(&MOTION, key, value)?,
        "frequency" => term.frequency = number(&MOTION, key, value)?,
        "phase" => term.phase = number(&MOTION, key, value)?,
        "from" => term.from = number(&MOTION, key, value)?,
        _ => term.to = number(&MOTION, key, value)?,
    }
    Ok(known)
}

pub(super) fn number(kind: &Kind, key: &str, value: &str) -> Line<f64> {
    let number = value.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| kind.wrong(key, format!("{} is not a finite number", quoted(value))))
}

/// Three numbers with commas between them.
pub(super) fn vector(kind: &Kind, key: &str, value: &str) -> Line<DVec3> {
    numbers(kind, key, value, "three numbers x,y,z").map(DVec3::from_array)
}

/// Numbers with commas between them.
pub(super) fn numbers<const N: usize>(kind: &Kind, key: &str, value: &str, expected: &str) -> Line<[f64; N]> {
    let words: Vec<&str> = value.split(',').collect();
    if words.len() != N {
        let message = format!("{} is not allowed, expected {expected} without spaces", quoted(value));
        return Err(kind.wrong(key, message));
    }
    let mut all = [0.0; N];
    for (place, word) in all.iter_mut().zip(words) {
        *place = number(kind, key, word)?;
    }
    Ok(all)
}

#[cfg(test)]
#[path = "motion_tests.rs"]
mod tests;
