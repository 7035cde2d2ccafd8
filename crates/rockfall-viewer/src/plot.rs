//! Plots of quantities over time beside pictures, and the names of the quantities.

use std::collections::HashSet;

use rockfall::glam::Vec3;
use rockfall::{Body, Energy, Gauge, GaugeReading, Gauged, ObjectId, Result, RodId, Scene, Simulation, SphereId};

use crate::palette::Rgb;
use crate::tags::{colour_of, name_of, object_of};
use crate::whole::{motion, whole};

pub(crate) mod axes;
mod chart;
mod history;
mod joints;

pub use chart::Layout;
pub use history::Plots;
pub use joints::JointValue;

use joints::Joints;

/// Names and colours of the energies. The colours here and in [`COLOURS`] are those of Okabe and Ito, which can be told apart
/// with any kind of colour vision.
pub(crate) const ENERGIES: [(&str, Rgb); 5] = [
    ("total", [0x30, 0x30, 0x30]),
    ("kinetic", [0xd5, 0x5e, 0x00]),
    ("potential", [0x00, 0x72, 0xb2]),
    ("springs", [0x00, 0x9e, 0x73]),
    ("contacts", [0xcc, 0x79, 0xa7]),
];
/// Energies that many scenes do not have.
pub(crate) const ABSENT: [&str; 2] = ["springs", "contacts"];
/// Colours of bodies in plots.
pub(crate) const COLOURS: [Rgb; 6] =
    [[0x00, 0x72, 0xb2], [0xd5, 0x5e, 0x00], [0x00, 0x9e, 0x73], [0xcc, 0x79, 0xa7], [0xe6, 0x9f, 0x00], [0x56, 0xb4, 0xe9]];

/// The energies, in the order of [`ENERGIES`].
pub(crate) fn energies(energy: &Energy) -> [f64; 5] {
    // Without contacts the energy is -0; adding 0 makes it 0.
    [energy.total(), energy.kinetic, energy.potential, energy.spring, energy.contact].map(|value| value + 0.0)
}

/// A quantity that a plot shows over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The energies of the scene. The potential energy is relative to that in the first state, because it is larger than all
    /// others where the scene is far from the origin.
    Energy,
    /// The kinetic energy of the scene.
    Kinetic,
    /// The potential energy of the scene.
    Potential,
    /// The components of the momentum of the scene.
    Momentum,
    /// The number of contacts of the scene.
    Contacts,
    /// The x coordinate of bodies.
    X,
    /// The y coordinate of bodies.
    Y,
    /// The z coordinate of bodies.
    Z,
    /// The coordinate of bodies against gravity.
    Height,
    /// The speed of bodies.
    Speed,
    /// The x component of the velocity of bodies.
    Vx,
    /// The y component of the velocity of bodies.
    Vy,
    /// The z component of the velocity of bodies.
    Vz,
    /// The size of the force on the walls of gauges.
    Gauge,
    /// A value of joints.
    Joint(JointValue),
}

impl Quantity {
    /// All values, with the position of joints in place of all values of joints.
    pub const ALL: [Self; 15] = [
        Self::Energy,
        Self::Kinetic,
        Self::Potential,
        Self::Momentum,
        Self::Contacts,
        Self::X,
        Self::Y,
        Self::Z,
        Self::Height,
        Self::Speed,
        Self::Vx,
        Self::Vy,
        Self::Vz,
        Self::Gauge,
        Self::Joint(JointValue::Position),
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Energy => "energy",
            Self::Kinetic => "kinetic",
            Self::Potential => "potential",
            Self::Momentum => "momentum",
            Self::Contacts => "contacts",
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::Height => "height",
            Self::Speed => "speed",
            Self::Vx => "vx",
            Self::Vy => "vy",
            Self::Vz => "vz",
            Self::Gauge => "gauge",
            Self::Joint(_) => "joint",
        }
    }

    /// Unit of the values; empty for a number. Joints are taken to be hinges or balls: the positions of others are in units.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Energy | Self::Kinetic | Self::Potential => "mass units²/s²",
            Self::Momentum => "mass units/s",
            Self::Contacts => "",
            Self::X | Self::Y | Self::Z | Self::Height => "units",
            Self::Speed | Self::Vx | Self::Vy | Self::Vz => "units/s",
            Self::Gauge => "mass units/s²",
            Self::Joint(value) => value.unit(true),
        }
    }

    /// What the axis of a plot shows.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Kinetic => "kinetic energy",
            Self::Potential => "potential energy",
            Self::Joint(value) => value.title(),
            other => other.name(),
        }
    }

    fn is_of_scene(self) -> bool {
        matches!(self, Self::Energy | Self::Kinetic | Self::Potential | Self::Momentum | Self::Contacts)
    }

    /// Whether bodies have it, and not the scene as a whole.
    pub fn is_of_bodies(self) -> bool {
        !self.is_of_scene() && !matches!(self, Self::Gauge | Self::Joint(_))
    }

    /// The value of a body at a place with a velocity, where `up` is the unit vector against gravity. NaN for other quantities.
    pub(crate) fn of_body(self, (place, velocity): (Vec3, Vec3), up: Vec3) -> f32 {
        match self {
            Self::X => place.x,
            Self::Y => place.y,
            Self::Z => place.z,
            Self::Height => place.dot(up),
            Self::Speed => velocity.length(),
            Self::Vx => velocity.x,
            Self::Vy => velocity.y,
            Self::Vz => velocity.z,
            Self::Energy | Self::Kinetic | Self::Potential | Self::Momentum | Self::Contacts => f32::NAN,
            Self::Gauge | Self::Joint(_) => f32::NAN,
        }
    }
}

/// A plot that was asked for: a quantity, and the names or numbers of the bodies or joints, or the names of gauges.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plot {
    quantity: Quantity,
    /// Bodies, gauges or joints.
    names: Vec<String>,
}

impl Plot {
    /// Parses a text such as `energy`, `height:left,right` or `joint:door.speed`.
    ///
    /// # Errors
    /// A text that says what was expected.
    pub fn parse(text: &str) -> std::result::Result<Self, String> {
        let (name, names) = text.split_once(':').map_or((text, None), |(name, names)| (name, Some(names)));
        let known = || Quantity::ALL.map(Quantity::name).join(", ");
        let found = Quantity::ALL.into_iter().find(|quantity| quantity.name() == name);
        let quantity = found.ok_or_else(|| format!("{name} is not known, expected one of: {}", known()))?;
        let names: Vec<String> = names.map_or_else(Vec::new, |all| all.split(',').map(|one| one.trim().to_owned()).collect());
        let has_names = !quantity.is_of_scene();
        if names.iter().any(String::is_empty) || has_names == names.is_empty() {
            return Err(match quantity {
                Quantity::Gauge => "expected names of gauges, as in gauge:weight".to_owned(),
                Quantity::Joint(_) => "expected names or numbers of joints, as in joint:door or joint:door.speed".to_owned(),
                _ if has_names => format!("expected names or numbers of bodies, as in {name}:left,right or {name}:3"),
                _ => format!("{name} is that of the whole scene, expected no bodies"),
            });
        }
        if names.len() > COLOURS.len() {
            let what = match quantity {
                Quantity::Gauge => "gauges",
                Quantity::Joint(_) => "joints",
                _ => "bodies",
            };
            return Err(format!("expected at most {} {what}, got {}", COLOURS.len(), names.len()));
        }
        if let Quantity::Joint(_) = quantity {
            let (value, names) = joints::parse(names)?;
            return Ok(Self { quantity: Quantity::Joint(value), names });
        }
        Ok(Self { quantity, names })
    }

    /// The quantity that the plot shows.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// The names or numbers of the bodies; none for other quantities.
    pub fn bodies(&self) -> &[String] {
        if self.quantity.is_of_bodies() { &self.names } else { &[] }
    }

    /// Checks that a scene has the gauges, and that they are those of walls, or that it has the joints, and that they fit into one plot.
    ///
    /// # Errors
    /// A text that says what was expected.
    pub fn check_names(&self, scene: &Scene) -> std::result::Result<(), String> {
        self.joints(scene)?;
        let names = if self.quantity == Quantity::Gauge { self.names.as_slice() } else { &[] };
        for name in names {
            match scene.gauges().iter().find(|gauge| gauge.name == *name) {
                Some(Gauge { of: Gauged::Wall(_), .. }) => {}
                Some(_) => return Err(format!("gauge:{name}: the gauge of a plane, expected that of a wall")),
                None if scene.gauges().is_empty() => return Err(format!("gauge:{name}: the scene has no gauges")),
                None => {
                    let known: Vec<&str> = scene.gauges().iter().map(|gauge| gauge.name.as_str()).collect();
                    return Err(format!("gauge:{name}: unknown, expected one of {}", known.join(", ")));
                }
            }
        }
        Ok(())
    }

    fn joints(&self, scene: &Scene) -> std::result::Result<Joints, String> {
        match self.quantity {
            Quantity::Joint(value) => Joints::of(scene, &self.names, value),
            _ => Ok(Joints::default()),
        }
    }

    /// The plot of a scene. `found` has the bodies that each name and number of [`Plot::bodies`] means.
    ///
    /// # Errors
    /// A text that says how many bodies are too many, or which joint is unknown.
    pub fn of(&self, scene: &Scene, found: &[Vec<Body>]) -> std::result::Result<Graph, String> {
        let bodies: Vec<Body> = found.iter().flatten().map(|body| whole(scene, *body)).collect();
        if bodies.len() > COLOURS.len() {
            return Err(format!("expected at most {} bodies, got {}", COLOURS.len(), bodies.len()));
        }
        let lines = match self.quantity {
            Quantity::Energy => ENERGIES.map(|(name, colour)| (name.to_owned(), colour)).into(),
            Quantity::Momentum => ["x", "y", "z"].map(str::to_owned).into_iter().zip(COLOURS).collect(),
            Quantity::Contacts | Quantity::Kinetic | Quantity::Potential => vec![(String::new(), COLOURS[0])],
            Quantity::Gauge | Quantity::Joint(_) => self.names.iter().cloned().zip(COLOURS).collect(),
            _ => self.titles(scene, found).into_iter().zip(colours_of(scene, bodies.iter().copied())).collect(),
        };
        Ok(Graph { quantity: self.quantity, bodies, joints: self.joints(scene)?, lines, start: None })
    }

    /// What the lines of bodies are called: by their names, with numbers where a name has several bodies, or else as they were given.
    fn titles(&self, scene: &Scene, found: &[Vec<Body>]) -> Vec<String> {
        let own = |text: &String, body: &Body| match text.parse::<u32>() {
            Ok(_) => object_of(scene, *body).and_then(|object| name_of(scene, object)).unwrap_or(text).to_owned(),
            Err(_) => text.clone(),
        };
        let lines = self.names.iter().zip(found).flat_map(|(text, bodies)| (1..).zip(bodies).map(move |line| (text, line)));
        let lines: Vec<(&String, u32, String)> = lines.map(|(text, (number, body))| (text, number, own(text, body))).collect();
        let title =
            |(text, number, name): &(&String, u32, String)| match lines.iter().filter(|(.., other)| other == name).count() {
                1 => name.clone(),
                _ if *text == name => format!("{name} {number}"),
                _ => format!("{name} {text}"),
            };
        lines.iter().map(title).collect()
    }
}

/// A plot of a scene.
#[derive(Clone, Debug)]
pub struct Graph {
    quantity: Quantity,
    bodies: Vec<Body>,
    joints: Joints,
    /// Names and colours of the lines.
    lines: Vec<(String, Rgb)>,
    /// The potential energy in the first state.
    start: Option<f64>,
}

impl Graph {
    /// Unit of the values; empty for a number.
    pub(crate) fn unit(&self) -> &'static str {
        match self.quantity {
            Quantity::Joint(value) => value.unit(self.joints.are_angles),
            quantity => quantity.unit(),
        }
    }

    /// What the axis shows.
    #[cfg_attr(not(feature = "window"), allow(dead_code))]
    pub(crate) fn title(&self) -> &'static str {
        self.quantity.title()
    }

    /// Names and colours of the lines.
    #[cfg_attr(not(feature = "window"), allow(dead_code))]
    pub(crate) fn lines(&self) -> &[(String, Rgb)] {
        &self.lines
    }

    /// The present value of every line; NaN for a body or joint that was removed and for a gauge that is not there.
    pub(crate) fn values(&mut self, simulation: &mut Simulation) -> Result<Vec<f64>> {
        Ok(match self.quantity {
            Quantity::Energy => {
                let mut energy = simulation.energy()?;
                energy.potential -= *self.start.get_or_insert(energy.potential);
                energies(&energy).into()
            }
            Quantity::Kinetic => vec![simulation.energy()?.kinetic],
            Quantity::Potential => vec![simulation.energy()?.potential],
            Quantity::Momentum => simulation.energy()?.momentum.to_array().to_vec(),
            Quantity::Contacts => vec![simulation.contacts()?.len() as f64],
            Quantity::Gauge => {
                let forces = gauge_forces(simulation)?;
                let force = |name: &str| forces.iter().find(|(known, _)| known == name).map_or(f64::NAN, |(_, force)| *force);
                self.lines.iter().map(|(name, _)| force(name)).collect()
            }
            Quantity::Joint(value) => self.joints.values(simulation, value)?,
            quantity => {
                let scene = simulation.sync()?;
                let up = up(scene);
                let value = |body: &Body| motion(scene, *body).map_or(f32::NAN, |state| quantity.of_body(state, up));
                self.bodies.iter().map(|body| f64::from(value(body))).collect()
            }
        })
    }
}

/// The names of the gauges of walls, and the sizes of the forces that they measure.
pub(crate) fn gauge_forces(simulation: &mut Simulation) -> Result<Vec<(String, f64)>> {
    let readings = simulation.gauges()?;
    let gauges = simulation.scene().gauges().iter().zip(readings);
    let force = |(gauge, reading): (&Gauge, GaugeReading)| match reading {
        GaugeReading::Wall(load) => Some((gauge.name.clone(), load.force.length())),
        _ => None,
    };
    Ok(gauges.filter_map(force).collect())
}

/// The colours of the lines of bodies: those that the scene gives them, or else the next of [`COLOURS`] that no line has.
pub(crate) fn colours_of(scene: &Scene, bodies: impl Iterator<Item = Body>) -> Vec<Rgb> {
    let given = bodies.map(|body| object_of(scene, body).and_then(|object| colour_of(scene, object)));
    let given: Vec<Option<Rgb>> = given.take(COLOURS.len()).collect();
    let mut colours: Vec<Rgb> = Vec::with_capacity(given.len());
    for colour in &given {
        let is_free = |colour: &Rgb| !colours.contains(colour);
        let others = COLOURS.iter().copied().filter(|other| !given.contains(&Some(*other)));
        // Lines of the same colour could not be told apart.
        let found = colour.iter().copied().chain(others).chain(COLOURS).find(|colour| is_free(colour));
        colours.push(found.unwrap_or(COLOURS[0]));
    }
    colours
}

/// The sphere that the name of a body means: of several objects with the name, the first sphere, or else the first end of a rod or a
/// spring.
///
/// # Errors
/// A text that says what is wrong.
pub fn named(scene: &Scene, name: &str) -> std::result::Result<SphereId, String> {
    let objects = scene.named(name).map_err(|error| format!("{name}: {error}"))?;
    let sphere = |id: &ObjectId| match *id {
        ObjectId::Sphere(id) => Some(id),
        ObjectId::Rod(id) => scene.rod(id).ok().map(|rod| rod.end1),
        ObjectId::Spring(id) => scene.spring(id).ok().map(|spring| spring.a),
        _ => None,
    };
    objects.iter().find_map(sphere).ok_or_else(|| format!("{name}: only static objects have this name, expected a body"))
}

/// The bodies of a name in a plot: rigid bodies, capsules and spheres, or else rods.
///
/// # Errors
/// A text that says what is wrong.
pub fn bodies_named(scene: &Scene, name: &str) -> std::result::Result<Vec<Body>, String> {
    let objects = scene.named(name).map_err(|error| format!("{name}: {error}"))?;
    let body = |id: &ObjectId| match *id {
        ObjectId::Sphere(id) => Some(whole(scene, Body::Sphere(id))),
        ObjectId::Rod(id) => Some(whole(scene, Body::Rod(id))),
        _ => None,
    };
    let capsules: HashSet<RodId> = scene.capsules().iter().map(|parts| parts.rod).collect();
    let is_rod = |body: &Body| matches!(body, Body::Rod(id) if !capsules.contains(id));
    let mut seen = HashSet::new();
    let all = objects.iter().filter_map(body).filter(|body| seen.insert(*body));
    let (rods, others): (Vec<Body>, Vec<Body>) = all.partition(is_rod);
    let bodies = if others.is_empty() { rods } else { others };
    let expected = "only springs and static objects have this name, expected a body";
    if bodies.is_empty() { Err(format!("{name}: {expected}")) } else { Ok(bodies) }
}

/// Unit vector against gravity.
pub(crate) fn up(scene: &Scene) -> Vec3 {
    -scene.settings.gravity_direction.try_normalize().unwrap_or(Vec3::NEG_Y)
}

#[cfg(test)]
mod tests;
