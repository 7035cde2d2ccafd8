//! Lines about materials: `@material`, `@pair`, `@use`, and the mass `-`.

use std::str::FromStr;

use super::line::{Kind, Line, MATERIAL, PAIR, USE};
use super::{LineWarning, Reader};
use crate::error::{Error, nearest, quoted};
use crate::scene::{Material, MaterialId, Pair, Scene};

impl Reader<'_> {
    pub(super) fn material(&mut self, line: &str) -> Line<()> {
        let (name, rest) = word(&MATERIAL, line, 1, "NAME")?;
        let mut material = Material::new(name);
        constants(&MATERIAL, rest, &Material::KEYS, &mut material, Material::constant)?;
        self.scene.add_material(material).map_err(|error| MATERIAL.refused(&error))?;
        Ok(())
    }

    pub(super) fn properties(&mut self, line: &str, number: usize) -> Line<()> {
        let (one, _) = word(&PAIR, line, 1, "NAME")?;
        let (other, rest) = word(&PAIR, line, 2, "NAME")?;
        let ids = [find(&PAIR, &self.scene, one)?, find(&PAIR, &self.scene, other)?];
        let mut pair = Pair::default();
        let is_model = |word: &&str| word.split_once('=').is_some_and(|(key, _)| [Pair::MODEL, Pair::COHESION].contains(&key));
        let (models, numbers): (Vec<_>, Vec<_>) = rest.partition(is_model);
        constants(&PAIR, numbers.into_iter(), &Pair::KEYS, &mut pair, Pair::property)?;
        models.into_iter().try_for_each(|word| model(word, &mut pair))?;
        let before = self.scene.given_pair(ids[0], ids[1]).map_err(|error| PAIR.refused(&error))?;
        if before.is_some() {
            let text =
                format!("the pair {} {} is given again; this replaces all of its properties", quoted(one), quoted(other));
            self.warnings.push(LineWarning { line: number, text });
        }
        self.scene.set_pair(ids[0], ids[1], pair).map_err(|error| PAIR.refused(&error))
    }

    pub(super) fn use_material(&mut self, line: &str) -> Line<()> {
        let (name, mut rest) = word(&USE, line, 1, "NAME")?;
        if let Some(more) = rest.next() {
            return Err(USE.wrong(&quoted(more), "one word too many, expected `@use NAME`, or `@use -` for none"));
        }
        self.material = if name == "-" { None } else { Some(find(&USE, &self.scene, name)?) };
        Ok(())
    }

    /// The mass of an S or C line. `-`, which is read as NaN, stands for the mass that follows from the density.
    pub(super) fn mass(&self, kind: &Kind, given: f32, from_density: impl Fn(f32) -> f32) -> Line<f32> {
        if !given.is_nan() {
            return Ok(given);
        }
        let wrong = |message: String| kind.wrong("mass", message);
        let missing = || wrong("`-` needs a material with a density, expected a line `@use NAME` above".to_owned());
        let material = self.scene.material(self.material.ok_or_else(missing)?).map_err(|error| kind.refused(&error))?;
        let density = material.density.ok_or_else(|| {
            wrong(format!(
                "`-` needs a density, which the material {} does not have; expected a number",
                quoted(&material.name)
            ))
        })?;
        Ok(from_density(density))
    }
}

/// Word `place` of a line, and an iterator over the words after it.
fn word<'a>(kind: &Kind, line: &'a str, place: usize, name: &str) -> Line<(&'a str, std::str::SplitAsciiWhitespace<'a>)> {
    let mut words = line.split_ascii_whitespace();
    match words.nth(place) {
        Some(word) if !word.contains('=') => Ok((word, words)),
        Some(word) => Err(kind.wrong(name, format!("{} is not a name, expected {}", quoted(word), kind.form()))),
        None => Err(kind.wrong(name, format!("missing, expected {}", kind.form()))),
    }
}

fn find(kind: &Kind, scene: &Scene, name: &str) -> Line<MaterialId> {
    scene.find_material(name).ok_or_else(|| {
        let known: Vec<&str> = scene.materials().iter().map(|material| material.name.as_str()).collect();
        let hint = match nearest(name, &known) {
            Some(near) => format!("did you mean {}?", quoted(near)),
            None => "expected the name of an @material line above".to_owned(),
        };
        kind.wrong(&quoted(name), format!("an unknown material, {hint}"))
    })
}

/// Reads a model of rolling resistance or of cohesion.
fn model(word: &str, pair: &mut Pair) -> Line<()> {
    let (key, value) = word.split_once('=').unwrap_or((word, ""));
    fn put<T: FromStr<Err = Error>>(place: &mut Option<T>, key: &str, value: &str) -> Line<()> {
        if place.is_some() {
            return Err(PAIR.wrong(key, "given twice in the line"));
        }
        *place = Some(value.parse().map_err(|error| PAIR.refused(&error))?);
        Ok(())
    }
    if key == Pair::COHESION { put(&mut pair.cohesion, key, value) } else { put(&mut pair.rolling_model, key, value) }
}

/// Reads words of the form KEY=NUMBER.
fn constants<'a, T>(
    kind: &Kind,
    words: impl Iterator<Item = &'a str>,
    keys: &[&str],
    target: &mut T,
    place: for<'t> fn(&'t mut T, &str) -> Option<&'t mut Option<f32>>,
) -> Line<()> {
    for word in words {
        let Some((key, value)) = word.split_once('=') else {
            return Err(kind.wrong(&quoted(word), format!("expected KEY=NUMBER with a key of {}", keys.join(", "))));
        };
        let Some(known) = place(target, key) else {
            let hint = nearest(key, keys)
                .map_or(format!("expected one of {}", keys.join(", ")), |near| format!("did you mean {near}?"));
            return Err(kind.wrong(&quoted(key), format!("an unknown key, {hint}")));
        };
        if known.is_some() {
            return Err(kind.wrong(key, "given twice in the line"));
        }
        match value.parse::<f32>() {
            Ok(number) if number.is_finite() => *known = Some(number),
            _ => return Err(kind.wrong(key, format!("{} is not a finite number", quoted(value)))),
        }
    }
    Ok(())
}

#[cfg(test)]
#[path = "materials_tests.rs"]
mod tests;
