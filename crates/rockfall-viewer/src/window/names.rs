//! Names of bodies as the scene file refers to them.

use rockfall::{Body, Scene};

/// A sphere or another object of a scene file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Entry {
    /// The reference of a sphere. The spheres of a `C` line have none.
    reference: Option<String>,
    /// Line number, from 1.
    line: usize,
}

/// The lines of a scene file that bodies come from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    spheres: Vec<Entry>,
    rods: Vec<Entry>,
    boxes: Vec<Entry>,
    polygons: Vec<Entry>,
}

impl Names {
    /// Reads the names from a scene text that [`Scene::parse`] accepts.
    pub fn of(text: &str) -> Self {
        let mut names = Self::default();
        for (line, words) in text.lines().enumerate().map(|(index, text)| (index + 1, text.split_ascii_whitespace())) {
            let mut words = words;
            let entry = Entry { reference: None, line };
            match words.next() {
                Some("S") => names.spheres.push(Entry { reference: words.next().map(str::to_owned), line }),
                Some("C") => {
                    names.spheres.extend([entry.clone(), entry.clone()]);
                    names.rods.push(entry);
                }
                Some("R") => names.rods.push(entry),
                Some("B") => names.boxes.push(entry),
                Some("P") => names.polygons.push(entry),
                _ => {}
            }
        }
        names
    }

    /// Returns the number of spheres in the file.
    pub fn spheres(&self) -> usize {
        self.spheres.len()
    }

    /// Returns the name of a body: the kind, and the reference of the file or the index from 0; and the line of the file that
    /// it comes from.
    pub fn name(&self, scene: &Scene, body: Body) -> (String, Option<usize>) {
        let capsules = scene.capsules();
        let numbered = |kind: &str, index: usize, entries: &[Entry]| {
            let entry = entries.get(index);
            let name = match entry.and_then(|entry| entry.reference.as_deref()) {
                Some(reference) => format!("{kind} {reference}"),
                None => format!("{kind} {index}"),
            };
            (name, entry.map(|entry| entry.line))
        };
        match body {
            Body::Sphere(id) => {
                let index = index(scene.sphere_ids(), id);
                if let Some(capsule) = capsules.iter().position(|parts| parts.end1 == id || parts.end2 == id) {
                    let end = 1 + usize::from(capsules[capsule].end2 == id);
                    let (_, line) = numbered("", index, &self.spheres);
                    return (format!("end {end} of capsule {capsule}"), line);
                }
                let fixed = scene.sphere(id).is_ok_and(|sphere| sphere.fixed);
                numbered(if fixed { "fixed sphere" } else { "sphere" }, index, &self.spheres)
            }
            Body::Rod(id) => {
                let index = index(scene.rod_ids(), id);
                match capsules.iter().position(|parts| parts.rod == id) {
                    Some(capsule) => (format!("capsule {capsule}"), self.rods.get(index).map(|entry| entry.line)),
                    None => numbered("rod", index, &self.rods),
                }
            }
            Body::Box(id) => numbered("box", index(scene.box_ids(), id), &self.boxes),
            Body::Polygon(id) => numbered("polygon", index(scene.polygon_ids(), id), &self.polygons),
            _ => ("a body".to_owned(), None),
        }
    }
}

/// Returns the index of a handle among those of its kind.
fn index<T: PartialEq>(mut ids: impl Iterator<Item = T>, id: T) -> usize {
    ids.position(|other| other == id).unwrap_or(usize::MAX)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn bodies_are_named_as_in_the_file() {
        let text = "a comment\nS 17 0 0 0 0 0 0 0 0 0 1 0.5\nC 3 0 0 4 0 0 0 0 0 1 0.2\nS 4 9 0 0 0 0 0 0 0 0 1 0.5 1\n\
                    R 17 4 0.1\nB 0 0 0 1 0 0 0 1 0 0 0 1\n";
        let scene = Scene::parse(text, Path::new("test")).unwrap().scene;
        let names = Names::of(text);
        let spheres: Vec<_> = scene.sphere_ids().map(|id| names.name(&scene, Body::Sphere(id))).collect();
        let expected = [("sphere 17", 2), ("end 1 of capsule 0", 3), ("end 2 of capsule 0", 3), ("fixed sphere 4", 4)];
        assert_eq!(spheres, expected.map(|(name, line)| (name.to_owned(), Some(line))));
        let rods: Vec<_> = scene.rod_ids().map(|id| names.name(&scene, Body::Rod(id))).collect();
        assert_eq!(rods, [("capsule 0".to_owned(), Some(3)), ("rod 1".to_owned(), Some(5))]);
        let a_box = Body::Box(scene.box_ids().next().unwrap());
        assert_eq!(names.name(&scene, a_box), ("box 0".to_owned(), Some(6)));
        // A scene without a file, or with bodies that were added later.
        let first = Body::Sphere(scene.sphere_ids().next().unwrap());
        assert_eq!(Names::default().name(&scene, first), ("sphere 0".to_owned(), None));
    }
}
