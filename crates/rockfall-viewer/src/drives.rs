//! Motors and springs of joints that sliders change.

use std::ops::RangeInclusive;

use rockfall::{Joint, JointId, JointKind, Scene};

/// Greatest number of sliders.
const MOST: usize = 100;
/// Least speed at the ends of the slider of a motor, in rad/s or units/s.
const LEAST_SPEED: f32 = 1.0;

/// What acts in a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// The speed of the motor, in rad/s or units/s.
    Speed(f32),
    /// The position at which the spring rests, in rad or units.
    Target(f32),
}

impl Drive {
    /// Sets it in a joint.
    pub fn give(self, joint: &mut Joint) {
        match self {
            Self::Speed(speed) => joint.speed = Some(speed),
            Self::Target(position) => joint.target = Some(position),
        }
    }

    /// What it is, in words.
    pub fn title(self) -> &'static str {
        match self {
            Self::Speed(_) => "Speed of the motor",
            Self::Target(_) => "Target of the spring",
        }
    }
}

/// Whether a joint has a motor or a spring with a target.
pub fn has_drive(joint: &Joint) -> bool {
    joint.speed.is_some() || joint.stiffness > 0.0
}

/// A slider for a joint.
#[derive(Clone, Debug)]
pub struct Control {
    /// The joint.
    pub id: JointId,
    /// Index of the joint in the scene.
    pub place: usize,
    /// Name of the joint, or its kind and its number from 0.
    pub name: String,
    /// What acts at present.
    pub drive: Drive,
    /// Range in rad or units, or their rates.
    pub range: RangeInclusive<f32>,
    /// Whether its position is an angle.
    pub is_angle: bool,
}

impl Control {
    /// Unit of the value that a slider shows: rad/s or units/s of a motor, degrees or units of a target.
    pub fn unit(&self) -> &'static str {
        match (self.drive, self.is_angle) {
            (Drive::Speed(_), true) => "rad/s",
            (Drive::Speed(_), false) => "units/s",
            (Drive::Target(_), true) => "degrees",
            (Drive::Target(_), false) => "units",
        }
    }

    fn scale(&self) -> f32 {
        if self.unit() == "degrees" { 1.0_f32.to_degrees() } else { 1.0 }
    }

    /// The value and the range of a slider.
    pub fn shown(&self) -> (f32, RangeInclusive<f32>) {
        let (Drive::Speed(value) | Drive::Target(value)) = self.drive;
        let scale = self.scale();
        (scale * value, scale * *self.range.start()..=scale * *self.range.end())
    }

    /// What a value of the slider means.
    pub fn drive_of(&self, value: f32) -> Drive {
        match self.drive {
            Drive::Speed(_) => Drive::Speed(value),
            Drive::Target(_) => Drive::Target(value / self.scale()),
        }
    }
}

/// The sliders of a scene: those of joints with names first. The ranges are those of the initial scene, so that they stay while a slider
/// moves.
pub fn controls(scene: &Scene, initial: &Scene) -> Vec<Control> {
    let all = scene.joint_ids().zip(scene.joints()).enumerate();
    let (named, others): (Vec<_>, Vec<_>) = all.partition(|(_, (_, joint))| joint.name.is_some());
    let of = |(place, (id, joint)): (usize, (JointId, &Joint))| {
        let first = initial.joint(id).unwrap_or(joint);
        let name = joint.name.clone().unwrap_or_else(|| format!("{} {place}", joint.kind));
        let control = |drive: Drive, range: RangeInclusive<f32>| Control {
            id,
            place,
            name: name.clone(),
            drive,
            range,
            is_angle: joint.kind.turns(),
        };
        let motor = joint.speed.map(|speed| control(Drive::Speed(speed), speeds(first)));
        let spring = (joint.stiffness > 0.0).then(|| control(Drive::Target(joint.rest()), targets(first)));
        [motor, spring].into_iter().flatten().collect::<Vec<_>>()
    };
    named.into_iter().chain(others).flat_map(of).take(MOST).collect()
}

fn speeds(joint: &Joint) -> RangeInclusive<f32> {
    let most = 2.0 * joint.speed.unwrap_or_default().abs().max(0.5 * LEAST_SPEED);
    -most..=most
}

fn targets(joint: &Joint) -> RangeInclusive<f32> {
    let rest = joint.rest();
    let half = if joint.kind.turns() { std::f32::consts::PI } else { rest.abs().max(1.0) };
    let least = if joint.kind == JointKind::Distance { 0.0 } else { rest - half };
    let [least, most] = joint.limits.unwrap_or([least, rest + half]);
    least..=most
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn joints_with_names_come_first_and_ranges_stay() {
        let text = "set contact_law rigid\n@body bar mass=2\nB 0 -0.05 -0.05 1 0 0 0 0.1 0 0 0 0.1\n@end\n\
                    @place bar at=0,0,0 name=one\n@place bar at=0,0,5 name=two\n@place bar at=0,0,9 name=three\n\
                    @joint hinge world one at=0,0,0 axis=0,1,0 speed=2\n@joint slider world two at=0,0,5 name=plain\n\
                    @joint hinge world three at=0,0,9 axis=0,1,0 limits=-90..90 target=30 stiffness=5 name=leg\n";
        let initial = Scene::parse(text, Path::new("test")).unwrap().scene;
        let mut scene = initial.clone();
        let first = scene.joint_ids().next().unwrap();
        scene.update_joint(first, |joint| joint.speed = Some(3.0)).unwrap();
        let found = controls(&scene, &initial);
        let names: Vec<&str> = found.iter().map(|control| control.name.as_str()).collect();
        assert_eq!(names, ["leg", "hinge 0"]);
        assert_eq!((found[1].drive, found[1].range.clone()), (Drive::Speed(3.0), -4.0..=4.0));
        let half = std::f32::consts::FRAC_PI_2;
        assert_eq!((found[0].drive, found[0].range.clone()), (Drive::Target(30.0_f32.to_radians()), -half..=half));
    }

    #[test]
    fn sliders_of_targets_are_in_degrees() {
        let text = "set contact_law rigid\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\n@joint hinge world 1 at=0,1,0 axis=0,0,1 target=30 stiffness=5\n";
        let scene = Scene::parse(text, Path::new("test")).unwrap().scene;
        let found = &controls(&scene, &scene)[0];
        let (value, range) = found.shown();
        assert!((value - 30.0).abs() < 1e-4 && (range.end() - 210.0).abs() < 1e-3 && found.unit() == "degrees");
        let mut joint = scene.joints()[0].clone();
        found.drive_of(90.0).give(&mut joint);
        assert!((joint.target.unwrap() - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
    }
}
