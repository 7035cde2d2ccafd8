//! The line `@periodic`.

use super::Reader;
use super::line::{Line, PERIODIC};
use super::motion::number;
use super::values::Values;
use crate::error::quoted;
use crate::scene::Shear;
use crate::scene::periodic::AXES;

impl Reader<'_> {
    pub(super) fn periodic(&mut self, line: &str, at: usize) -> Line<()> {
        let words: Vec<&str> = line.split_ascii_whitespace().skip(1).collect();
        let (bounds, rest) = words.split_at(words.len().min(3));
        let [axis, from, to] = bounds[..] else {
            let found = format!("{} words, expected `{}`", words.len(), PERIODIC.form());
            return self.not_understood(at, PERIODIC.wrong("line", found));
        };
        let Some(place) = AXES.iter().position(|name| *name == axis) else {
            return self
                .not_understood(at, PERIODIC.wrong("axis", format!("{} is not allowed, expected x, y or z", quoted(axis))));
        };
        if self.scene.periodic()[place].is_some() {
            return Err(PERIODIC.wrong(axis, "given again, expected one line for each axis"));
        }
        let bounds = [number(&PERIODIC, "from", from)? as f32, number(&PERIODIC, "to", to)? as f32];
        let values = Values::read(&PERIODIC, &["shear"], rest.iter().copied())?;
        if let Some(value) = values.of("shear") {
            if self.scene.shear().is_some() {
                return Err(PERIODIC.wrong("shear", "given again, expected it for one axis"));
            }
            self.scene.set_shear(Some(shear(value, place)?)).map_err(|error| PERIODIC.refused(&error))?;
        }
        self.scene.set_periodic(place, Some(bounds)).map_err(|error| PERIODIC.refused(&error))
    }
}

/// Reads `RATE`, `RATE,DIRECTION` or `RATE,DIRECTION,DISPLACEMENT`. The direction is x by default, or y for the axis x.
fn shear(value: &str, gradient: usize) -> Line<Shear> {
    let words: Vec<&str> = value.split(',').collect();
    if words.len() > 3 {
        let found = format!("{} is not allowed, expected RATE,DIRECTION,DISPLACEMENT or fewer of them", quoted(value));
        return Err(PERIODIC.wrong("shear", found));
    }
    let rate = number(&PERIODIC, "shear", words[0])? as f32;
    let flow = match words.get(1) {
        None => usize::from(gradient == 0),
        Some(direction) => match AXES.iter().position(|name| name == direction) {
            Some(axis) if axis != gradient => axis,
            _ => {
                let found = format!("{} is not a direction, expected another axis of x, y and z", quoted(direction));
                return Err(PERIODIC.wrong("shear", found));
            }
        },
    };
    let turns = words.get(2).map_or(Ok(0.0), |turns| number(&PERIODIC, "shear", turns))?;
    Ok(Shear::new(gradient, flow, rate).with_turns(turns))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::scene::Scene;

    fn error(text: &str) -> String {
        Scene::parse(text, Path::new("box.txt")).unwrap_err().to_string()
    }

    #[test]
    fn periods_are_read_and_written() {
        let text = "@periodic x -1 1.5\n@periodic z 0 3\nS 0 0 0 0 0 0 0 0 0 0 1 0.1\n";
        let scene = Scene::parse(text, Path::new("box.txt")).unwrap().scene;
        assert_eq!(scene.periodic(), [Some([-1.0, 1.5]), None, Some([0.0, 3.0])]);
        let again = Scene::parse(&scene.to_text(), Path::new("again.txt")).unwrap().scene;
        assert_eq!(again.periodic(), scene.periodic());
    }

    #[test]
    fn shears_are_read_and_written() {
        let text = "@periodic x 0 4\n@periodic y 0 2 shear=0.5,x,0.25\n@periodic z 0 2\nS 0 0 0 0 0 0 0 0 0 0 1 0.1\n";
        let scene = Scene::parse(text, Path::new("box.txt")).unwrap().scene;
        let shear = scene.shear().unwrap();
        assert_eq!((shear.gradient, shear.flow, shear.rate, shear.turns()), (1, 0, 0.5, 0.25));
        let again = Scene::parse(&scene.to_text(), Path::new("again.txt")).unwrap().scene;
        assert_eq!(again.shear(), scene.shear());
        let short = Scene::parse("@periodic x 0 4 shear=-2\n", Path::new("box.txt")).unwrap().scene;
        assert_eq!(short.shear().map(|shear| (shear.gradient, shear.flow, shear.rate)), Some((0, 1, -2.0)));
    }

    #[test]
    fn wrong_lines_say_what_is_expected() {
        let head = "# a box\n";
        for (line, expected) in [
            (
                "@periodic x 1",
                "box.txt:2: @periodic line: 2 words, expected `@periodic AXIS FROM TO [shear=RATE,DIRECTION,DISPLACEMENT]`",
            ),
            ("@periodic w 0 1", "box.txt:2: @periodic axis: 'w' is not allowed, expected x, y or z"),
            ("@periodic x 0 inf", "box.txt:2: @periodic to: 'inf' is not a finite number"),
            (
                "@periodic y 2 1",
                "box.txt:2: @periodic bounds: 2 to 1 is not allowed, expected two finite numbers in ascending order",
            ),
            ("@periodic x 0 1 sheer=1", "box.txt:2: @periodic 'sheer': an unknown key, did you mean shear?"),
            (
                "@periodic x 0 1 shear=1,x",
                "box.txt:2: @periodic shear: 'x' is not a direction, expected another axis of x, y and z",
            ),
            (
                "@periodic x 0 1 shear=1\n@periodic y 0 1 shear=1",
                "box.txt:3: @periodic shear: given again, expected it for one axis",
            ),
            ("@periodic x 0 1\n@periodic x 0 2", "box.txt:3: @periodic x: given again, expected one line for each axis"),
        ] {
            assert_eq!(error(&format!("{head}{line}\n")), expected);
        }
    }
}
