//! Names of bodies as the scene file refers to them.

use rockfall::{Body, ObjectId, Scene};

use crate::tags::{name_of, object_of};
use crate::whole::{rigid_of, whole};

/// The lines of a scene file that bodies come from: for every object of a kind its line number, from 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    spheres: Vec<usize>,
    rods: Vec<usize>,
    boxes: Vec<usize>,
    polygons: Vec<usize>,
    /// Lines `@place`.
    rigid: Vec<usize>,
}

impl Names {
    /// Reads the lines of a scene text that [`Scene::parse`] accepts.
    pub fn of(text: &str) -> Self {
        let mut names = Self::default();
        let mut in_shape = false;
        for (line, text) in (1..).zip(text.strip_prefix('\u{feff}').unwrap_or(text).lines()) {
            match text.split_ascii_whitespace().next() {
                Some("@body") => in_shape = true,
                Some("@end") => in_shape = false,
                Some("@place") => names.rigid.push(line),
                // The parts of a shape are not in the scene.
                _ if in_shape => {}
                Some("S") => names.spheres.push(line),
                Some("C") => {
                    names.spheres.extend([line, line]);
                    names.rods.push(line);
                }
                Some("R") => names.rods.push(line),
                Some("B") => names.boxes.push(line),
                Some("P") => names.polygons.push(line),
                _ => {}
            }
        }
        names
    }

    /// Whether the file has as many spheres and rigid bodies as a scene.
    pub fn fits(&self, scene: &Scene) -> bool {
        let loose = scene.sphere_ids().filter(|id| scene.body_of_sphere(*id).is_none()).count();
        (self.spheres.len(), self.rigid.len()) == (loose, scene.bodies().len())
    }

    /// Returns the name of a body, and the line of the file that it comes from. The name is that of the scene (`@name`); where several
    /// bodies have it, it is followed by the number of the body. Without one it is the number: for a sphere its reference in the
    /// file, for other bodies and spheres without a reference their index from 0 among those of their kind.
    pub fn name(&self, scene: &Scene, body: Body) -> (String, Option<usize>) {
        let (number, line) = self.number(scene, body);
        let Some(name) = object_of(scene, body).and_then(|object| name_of(scene, object)) else {
            return (number, line);
        };
        let named_body = |id: &ObjectId| match *id {
            ObjectId::Sphere(id) => Some(whole(scene, Body::Sphere(id))),
            ObjectId::Rod(id) => Some(whole(scene, Body::Rod(id))),
            ObjectId::Box(id) => Some(Body::Box(id)),
            ObjectId::Polygon(id) => Some(Body::Polygon(id)),
            // A capsule and a rigid body are named like their parts.
            _ => None,
        };
        let found = scene.named(name).unwrap_or_default();
        let mut bodies = found.iter().filter_map(named_body);
        let first = bodies.next();
        let is_unique = bodies.all(|body| Some(body) == first);
        (if is_unique { name.to_owned() } else { format!("{name}, {number}") }, line)
    }

    fn number(&self, scene: &Scene, body: Body) -> (String, Option<usize>) {
        if let Some(rigid) = rigid_of(scene, body) {
            let index = index(scene.body_ids(), rigid);
            return (format!("rigid body {index}"), self.rigid.get(index).copied());
        }
        let capsules = scene.capsules();
        match body {
            Body::Sphere(id) => {
                let line = index(scene.sphere_ids().filter(|id| scene.body_of_sphere(*id).is_none()), id);
                let line = self.spheres.get(line).copied();
                let index = index(scene.sphere_ids(), id);
                if let Some(capsule) = capsules.iter().position(|parts| parts.end1 == id || parts.end2 == id) {
                    let end = 1 + usize::from(capsules[capsule].end2 == id);
                    return (format!("end {end} of capsule {capsule}"), line);
                }
                let kind = if scene.sphere(id).is_ok_and(|sphere| sphere.fixed) { "fixed sphere" } else { "sphere" };
                match scene.reference(id) {
                    Some(reference) => (format!("{kind} {reference}"), line),
                    None => (format!("{kind} (index {index})"), line),
                }
            }
            Body::Rod(id) => {
                let line = index(scene.rod_ids().filter(|id| scene.body_of_rod(*id).is_none()), id);
                let index = index(scene.rod_ids(), id);
                let capsule = capsules.iter().position(|parts| parts.rod == id);
                let name = capsule.map_or_else(|| format!("rod {index}"), |capsule| format!("capsule {capsule}"));
                (name, self.rods.get(line).copied())
            }
            Body::Box(id) => {
                let index = index(scene.box_ids(), id);
                (format!("box {index}"), self.boxes.get(index).copied())
            }
            Body::Polygon(id) => {
                let index = index(scene.polygon_ids(), id);
                (format!("polygon {index}"), self.polygons.get(index).copied())
            }
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
    fn bodies_have_the_names_of_the_scene() {
        let text = "@name ball1\nS 11 0 0 0 0 0 0 0 0 0 1 0.5\n@name floor\nB 0 0 0 1 0 0 0 1 0 0 0 1\n\
                    @name log\nC 3 0 0 4 0 0 0 0 0 1 0.2\nC 3 3 0 4 3 0 0 0 0 1 0.2\n@name pin\nC 3 6 0 4 6 0 0 0 0 1 0.2\n";
        let scene = Scene::parse(text, Path::new("test")).unwrap().scene;
        let names = Names::of(text);
        let name = |body: Body| names.name(&scene, body).0;
        assert_eq!(name(Body::Sphere(scene.sphere_ids().next().unwrap())), "ball1");
        assert_eq!(name(Body::Box(scene.box_ids().next().unwrap())), "floor");
        let rods: Vec<_> = scene.rod_ids().map(|id| name(Body::Rod(id))).collect();
        assert_eq!(rods, ["log, capsule 0", "log, capsule 1", "pin"]);
    }

    #[test]
    fn parts_have_the_name_of_their_rigid_body() {
        let text = "@body crate\nB 0 0 0 1 0 0 0 1 0 0 0 1\n@end\n@name boss\n@place crate at=0,0,0\n@name -\n@place crate at=3,0,0\n\
                    S 4 0 9 0 0 0 0 0 0 0 1 0.5\n";
        let scene = Scene::parse(text, Path::new("test")).unwrap().scene;
        let names = Names::of(text);
        assert!(names.fits(&scene));
        let found: Vec<_> = scene.sphere_ids().map(|id| names.name(&scene, Body::Sphere(id))).collect();
        let expected = [("boss", 5), ("rigid body 1", 7), ("sphere 4", 8)];
        assert_eq!(found, expected.map(|(name, line)| (name.to_owned(), Some(line))));
    }

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
        // A body that was added later.
        let mut scene = scene;
        let added = scene.add_sphere(rockfall::Sphere::new([0.0, 9.0, 0.0], 0.5)).unwrap();
        assert_eq!(names.name(&scene, Body::Sphere(added)), ("sphere (index 4)".to_owned(), None));
    }
}
