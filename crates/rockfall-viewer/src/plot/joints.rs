//! Plots of joints.

use rockfall::{Joint, JointId, JointKind, JointReading, Result, Scene, Simulation};

/// A value of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointValue {
    /// The angle in degrees of a hinge or of the twist of a ball, the way of a slider or the length of a distance joint.
    Position,
    /// The rate of the position.
    Speed,
    /// The size of the force on the second body: the mean of the last step.
    Force,
    /// The size of the torque on the second body: the mean of the last step.
    Torque,
}

impl JointValue {
    const ALL: [Self; 4] = [Self::Position, Self::Speed, Self::Force, Self::Torque];

    fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Speed => "speed",
            Self::Force => "force",
            Self::Torque => "torque",
        }
    }

    /// Title of the axis.
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Position => "joint",
            Self::Speed => "speed of joint",
            Self::Force => "force of joint",
            Self::Torque => "torque of joint",
        }
    }

    /// Unit of the value of a joint whose position is an angle, or of one whose position is a length.
    pub(super) fn unit(self, is_angle: bool) -> &'static str {
        match (self, is_angle) {
            (Self::Position, true) => "degrees",
            (Self::Position, false) => "units",
            (Self::Speed, true) => "rad/s",
            (Self::Speed, false) => "units/s",
            (Self::Force, _) => "mass units/s²",
            (Self::Torque, _) => "mass units²/s²",
        }
    }

    /// Whether the unit depends on the kind of the joint.
    fn is_of_axis(self) -> bool {
        matches!(self, Self::Position | Self::Speed)
    }

    /// The value; NaN for a joint that is broken.
    fn of(self, joint: &Joint, reading: &JointReading) -> f64 {
        if reading.broken {
            return f64::NAN;
        }
        let position = f64::from(reading.position);
        match self {
            Self::Position if joint.kind.turns() => position.to_degrees(),
            Self::Position => position,
            Self::Speed => f64::from(reading.speed),
            Self::Force => f64::from(reading.force.length()),
            Self::Torque => f64::from(reading.torque.length()),
        }
    }
}

/// The value that names such as `door.speed` have in common, and the names without it.
///
/// # Errors
/// A text that says what was expected.
pub(super) fn parse(names: Vec<String>) -> std::result::Result<(JointValue, Vec<String>), String> {
    let one = |name: String| {
        let known = |end: &str| JointValue::ALL.into_iter().find(|value| value.name() == end);
        let found = name.rsplit_once('.').and_then(|(joint, end)| Some((known(end)?, joint.to_owned())));
        found.unwrap_or((JointValue::Position, name))
    };
    let (values, names): (Vec<JointValue>, Vec<String>) = names.into_iter().map(one).unzip();
    let first = values.first().copied().unwrap_or(JointValue::Position);
    match values.iter().find(|value| **value != first) {
        Some(other) => Err(format!("{} and {} of joints need a plot each", first.name(), other.name())),
        None => Ok((first, names)),
    }
}

/// The joint of a name, or one without a name by its number, counted from 0.
fn find(scene: &Scene, name: &str) -> std::result::Result<JointId, String> {
    let numbered = || name.parse::<usize>().ok().and_then(|number| scene.joint_ids().nth(number));
    let found = scene.joint_named(name).ok().or_else(numbered);
    found.ok_or_else(|| match scene.joints().len() {
        0 => format!("joint:{name}: the scene has no joints"),
        count => {
            let known: Vec<&str> = scene.joints().iter().filter_map(|joint| joint.name.as_deref()).collect();
            let numbers = format!("a number from 0 to {}", count - 1);
            let expected = if known.is_empty() { numbers } else { format!("{}, or {numbers}", known.join(", ")) };
            format!("joint:{name}: unknown, expected {expected}")
        }
    })
}

/// Joints of a scene that a plot shows.
#[derive(Clone, Debug, Default)]
pub(super) struct Joints {
    ids: Vec<JointId>,
    /// Whether their positions are angles.
    pub(super) are_angles: bool,
}

impl Joints {
    /// Finds joints by their names.
    ///
    /// # Errors
    /// A text that says which joint is unknown, or does not fit the other ones.
    pub(super) fn of(scene: &Scene, names: &[String], value: JointValue) -> std::result::Result<Self, String> {
        let ids: Vec<JointId> = names.iter().map(|name| find(scene, name)).collect::<std::result::Result<_, _>>()?;
        let kinds: Vec<JointKind> = ids.iter().filter_map(|id| scene.joint(*id).ok()).map(|joint| joint.kind).collect();
        let are_angles = kinds.first().is_some_and(|kind| kind.turns());
        for (name, kind) in names.iter().zip(kinds).filter(|_| value.is_of_axis()) {
            if kind == JointKind::Fixed {
                return Err(format!("joint:{name}: a fixed joint has no {}, expected force or torque", value.name()));
            }
            if kind.turns() != are_angles {
                let [first, own] = [are_angles, !are_angles].map(|is_angle| value.unit(is_angle));
                return Err(format!("joint:{name}: {own} and {first} need a plot each"));
            }
        }
        Ok(Self { ids, are_angles })
    }

    /// Present values; NaN for a joint that is broken or was removed.
    pub(super) fn values(&self, simulation: &mut Simulation, value: JointValue) -> Result<Vec<f64>> {
        let readings = simulation.joints()?;
        let scene = simulation.scene();
        let places: Vec<Option<usize>> = self.ids.iter().map(|id| scene.joint_ids().position(|other| other == *id)).collect();
        let of = |place: usize| readings.get(place).map_or(f64::NAN, |reading| value.of(&scene.joints()[place], reading));
        Ok(places.into_iter().map(|place| place.map_or(f64::NAN, of)).collect())
    }
}
