//! The line `@periodic`.

use super::Reader;
use super::line::{Line, PERIODIC};
use super::motion::number;
use crate::error::quoted;
use crate::scene::periodic::AXES;

impl Reader<'_> {
    pub(super) fn periodic(&mut self, line: &str, at: usize) -> Line<()> {
        let words: Vec<&str> = line.split_ascii_whitespace().skip(1).collect();
        let [axis, from, to] = words[..] else {
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
        self.scene.set_periodic(place, Some(bounds)).map_err(|error| PERIODIC.refused(&error))
    }
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
    fn wrong_lines_say_what_is_expected() {
        let head = "# a box\n";
        for (line, expected) in [
            ("@periodic x 1", "box.txt:2: @periodic line: 2 words, expected `@periodic AXIS FROM TO`"),
            ("@periodic w 0 1", "box.txt:2: @periodic axis: 'w' is not allowed, expected x, y or z"),
            ("@periodic x 0 inf", "box.txt:2: @periodic to: 'inf' is not a finite number"),
            (
                "@periodic y 2 1",
                "box.txt:2: @periodic bounds: 2 to 1 is not allowed, expected two finite numbers in ascending order",
            ),
            ("@periodic x 0 1\n@periodic x 0 2", "box.txt:3: @periodic x: given again, expected one line for each axis"),
        ] {
            assert_eq!(error(&format!("{head}{line}\n")), expected);
        }
    }
}
