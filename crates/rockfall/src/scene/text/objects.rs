//! Lines of objects, and lines that change the object before them.

use glam::{Quat, Vec3};

use super::Reader;
use super::line::{BOX, CAPSULE, FORCE, Kind, Line, MARK, MUSCLE, ORIENTATION, POLYGON, ROD, SPHERE, SPRING, TETHER, TRIANGLE};
use crate::scene::{Capsule, CapsuleParts, Cuboid, Muscle, Polygon, Rod, Sphere, SphereId, Spring, Surface, Tether};

fn vector(numbers: &[f32]) -> Vec3 {
    Vec3::from_slice(numbers)
}

impl Reader<'_> {
    pub(super) fn find(&self, kind: &Kind, name: &str, reference: u32) -> Line<SphereId> {
        let reference = self.counted_on(reference);
        self.references.get(&reference).copied().ok_or_else(|| {
            let message = format!("no sphere with reference {reference} yet, expected one that a line above defined");
            kind.wrong(name, message)
        })
    }

    fn pair(&self, kind: &Kind, [a, b]: [u32; 2]) -> Line<(SphereId, SphereId)> {
        let [first, second] = [0, 1].map(|end| kind.references[end]);
        let ends = (self.find(kind, first, a)?, self.find(kind, second, b)?);
        if ends.0 == ends.1 {
            return Err(kind.wrong(second, format!("{b} is the same sphere as {first}, expected another one")));
        }
        Ok(ends)
    }

    pub(super) fn sphere(&mut self, line: &str) -> Line<()> {
        let ([reference], n) = SPHERE.read::<1, 12>(line)?;
        let reference = self.counted_on(reference);
        let mut sphere = Sphere::new(self.point(&n[0..3]), n[10])
            .velocity(vector(&n[3..6]))
            .angular_momentum(vector(&n[6..9]))
            .group(self.group);
        // The digits beyond those of an f32. Which precision the scene has is known at its end.
        let (digits, offset) = (line.split_ascii_whitespace().skip(2), self.offset());
        for (axis, word) in digits.take(3).enumerate() {
            let x = word.parse::<f64>().unwrap_or_default();
            if offset[axis] != 0.0 {
                sphere.position[axis] = (x + offset[axis]) as f32;
            }
            sphere.position_low[axis] = (x + offset[axis] - f64::from(sphere.position[axis])) as f32;
        }
        sphere.mass = self.mass(&SPHERE, n[9], |density| sphere.density(density).mass)?;
        sphere.fixed = n[11] > 0.0;
        if sphere.fixed && self.motion.is_some() {
            return self.moving_ball(&sphere);
        }
        sphere.material = self.material;
        let id = self.scene.add_sphere(sphere).map_err(|error| SPHERE.refused(&error))?;
        self.references.insert(reference, id);
        self.scene.references.set(id, reference);
        self.tag_object(&SPHERE, id)
    }

    /// A fixed sphere that follows a motion is a smooth wall.
    fn moving_ball(&mut self, sphere: &Sphere) -> Line<()> {
        if sphere.velocity != Vec3::ZERO || sphere.angular_momentum != Vec3::ZERO {
            return Err(SPHERE.wrong("velocity", "a fixed sphere that follows a motion has no velocity of its own, expected 0"));
        }
        let (group, material, motion, surface_velocity) = (self.group, self.material, self.motion, self.surface);
        let ball = Polygon::ball(sphere.position, sphere.radius);
        let id = self.scene.add_polygon(Polygon { group, material, motion, surface_velocity, ..ball });
        let id = id.map_err(|error| SPHERE.refused(&error))?;
        self.tag_object(&SPHERE, id)
    }

    pub(super) fn rod(&mut self, line: &str) -> Line<()> {
        let (references, [radius, length]) = ROD.read::<2, 2>(line)?;
        let (end1, end2) = self.pair(&ROD, references)?;
        let mut rod = Rod::new(end1, end2, radius).group(self.group);
        rod.length = (length > 0.0).then_some(length);
        rod.material = self.material;
        let id = self.scene.add_rod(rod).map_err(|error| ROD.refused(&error))?;
        self.tag_object(&ROD, id)
    }

    pub(super) fn capsule(&mut self, line: &str) -> Line<()> {
        let ([], n) = CAPSULE.read::<0, 11>(line)?;
        let capsule =
            Capsule::new(self.point(&n[0..3]), self.point(&n[3..6]), n[10]).velocity(vector(&n[6..9])).group(self.group);
        let mass = self.mass(&CAPSULE, n[9], |density| capsule.density(density).mass)?;
        let capsule = Capsule { material: self.material, ..capsule.mass(mass) };
        let id = self.scene.add_capsule(capsule).map_err(|error| CAPSULE.refused(&error))?;
        self.tag_object(&CAPSULE, id)
    }

    pub(super) fn polygon(&mut self, line: &str) -> Line<()> {
        self.face(&POLYGON, line, Surface::Parallelogram)
    }

    pub(super) fn triangle(&mut self, line: &str) -> Line<()> {
        self.face(&TRIANGLE, line, Surface::Triangle)
    }

    fn face(&mut self, kind: &Kind, line: &str, surface: Surface) -> Line<()> {
        let ([], n) = kind.read::<0, 9>(line)?;
        let polygon = Polygon::new(self.point(&n[0..3]), vector(&n[3..6]), vector(&n[6..9])).group(self.group);
        let polygon =
            Polygon { surface, material: self.material, motion: self.motion, surface_velocity: self.surface, ..polygon };
        let id = self.scene.add_polygon(polygon).map_err(|error| kind.refused(&error))?;
        self.tag_object(kind, id)
    }

    pub(super) fn spring(&mut self, line: &str) -> Line<()> {
        let (references, [stiffness, length, damping]) = SPRING.read::<2, 3>(line)?;
        let (a, b) = self.pair(&SPRING, references)?;
        let spring = Spring::new(a, b, stiffness, length).damping(damping);
        let id = self.scene.add_spring(spring).map_err(|error| SPRING.refused(&error))?;
        self.tag_object(&SPRING, id)
    }

    pub(super) fn cuboid(&mut self, line: &str) -> Line<()> {
        let ([], n) = BOX.read::<0, 12>(line)?;
        let cuboid = Cuboid::new(self.point(&n[0..3]), vector(&n[3..6]), vector(&n[6..9]), vector(&n[9..12])).group(self.group);
        let cuboid = Cuboid { material: self.material, motion: self.motion, surface_velocity: self.surface, ..cuboid };
        let id = self.scene.add_box(cuboid).map_err(|error| BOX.refused(&error))?;
        self.tag_object(&BOX, id)
    }

    pub(super) fn tether(&mut self, line: &str) -> Line<()> {
        let ([reference], n) = TETHER.read::<1, 6>(line)?;
        let sphere = self.find(&TETHER, "sphere", reference)?;
        let tether = Tether::new(sphere, self.point(&n[0..3]), n[3]).length(n[4]).damping(n[5]);
        self.scene.add_tether(tether).map_err(|error| TETHER.refused(&error))?;
        Ok(())
    }

    /// Changes an existing sphere, and checks that it is still valid.
    fn change(&mut self, kind: &Kind, reference: u32, change: impl FnOnce(&mut Sphere)) -> Line<()> {
        let id = self.find(kind, "sphere", reference)?;
        let sphere = self.scene.spheres.get_mut(id).map_err(|error| kind.refused(&error))?;
        change(sphere);
        sphere.validate().map_err(|error| kind.refused(&error))
    }

    pub(super) fn orientation(&mut self, line: &str) -> Line<()> {
        let ([reference], [w, x, y, z]) = ORIENTATION.read::<1, 4>(line)?;
        self.change(&ORIENTATION, reference, |sphere| {
            sphere.orientation = Quat::from_xyzw(x, y, z, w);
        })
    }

    pub(super) fn force(&mut self, line: &str) -> Line<()> {
        let ([reference], n) = FORCE.read::<1, 3>(line)?;
        self.change(&FORCE, reference, |sphere| sphere.force = vector(&n))
    }

    pub(super) fn mark(&mut self, line: &str) -> Line<()> {
        let (references, []) = MARK.read::<2, 0>(line)?;
        let (end1, end2) = self.pair(&MARK, references)?;
        let rods = &self.scene.rods;
        let last = rods.len().checked_sub(1).map(|index| rods.handle_at(index));
        let fits = rods.objects().last().is_some_and(|rod| rod.end1 == end1 && rod.end2 == end2 && rod.length.is_some());
        let taken = self.scene.capsules.objects().last().map(|parts| parts.rod);
        match last {
            Some(rod) if fits && taken != last => {
                let id = self.scene.capsules.add(CapsuleParts { end1, end2, rod });
                // Its parts have tags of their own.
                self.scene.put_tag(id.into(), self.tag.clone()).map_err(|error| MARK.refused(&error))
            }
            _ => Err(MARK.wrong("end1", "expected right after the R line, with a length, of these two spheres")),
        }
    }

    pub(super) fn muscle(&mut self, line: &str) -> Line<()> {
        let ([], [amplitude, frequency, phase]) = MUSCLE.read::<0, 3>(line)?;
        let Some(spring) = self.scene.springs.objects_mut().last_mut() else {
            return Err(MUSCLE.wrong("line", "expected after the K line of a spring"));
        };
        if spring.muscle.is_some() {
            return Err(MUSCLE.wrong("line", "the spring of the last K line has a muscle already, expected one per spring"));
        }
        let muscle = Muscle::new(amplitude, frequency, phase);
        muscle.validate().map_err(|error| MUSCLE.refused(&error))?;
        spring.muscle = Some(muscle);
        Ok(())
    }
}
