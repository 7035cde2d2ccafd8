//! `<compiler>`: units and rules of the file.

use std::f64::consts::PI;

use rockfall::glam::{DMat3, DQuat, DVec3};

use super::defaults::Attributes;
use crate::error::Result;
use crate::mass::Pose;
use crate::notes::Notes;
use crate::xml::{Element, quoted};

/// Where the inertia of a body comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InertiaFrom {
    Geoms,
    Inertial,
    InertialOrGeoms,
}

#[derive(Debug)]
pub(super) struct Compiler {
    /// Factor of angles.
    pub(super) radians: f64,
    /// Axes of Euler angles, in lower case those of the turned frame.
    sequence: [char; 3],
    pub(super) autolimits: bool,
    pub(super) inertia_from: InertiaFrom,
    /// Folder of meshes.
    pub(super) mesh_folder: String,
    pub(super) strips_paths: bool,
    pub(super) total_mass: Option<f64>,
    pub(super) least_mass: f64,
    pub(super) least_inertia: f64,
    /// Groups of geoms whose mass counts.
    pub(super) inertia_groups: [f64; 2],
}

impl Compiler {
    pub(super) fn of(root: &Element, notes: &mut Notes) -> Result<Self> {
        let mut compiler = Self {
            radians: PI / 180.0,
            sequence: ['x', 'y', 'z'],
            autolimits: true,
            inertia_from: InertiaFrom::InertialOrGeoms,
            mesh_folder: String::new(),
            strips_paths: false,
            total_mass: None,
            least_mass: 0.0,
            least_inertia: 0.0,
            inertia_groups: [f64::NEG_INFINITY, f64::INFINITY],
        };
        for element in root.all("compiler") {
            compiler.read(element, notes)?;
        }
        Ok(compiler)
    }

    fn read(&mut self, element: &Element, notes: &mut Notes) -> Result<()> {
        match element.attribute("angle") {
            Some("radian") => self.radians = 1.0,
            Some("degree") => self.radians = PI / 180.0,
            None => {}
            Some(other) => return Err(element.wrong(format!("angle={}, expected degree or radian", quoted(other)))),
        }
        if let Some(text) = element.attribute("eulerseq") {
            let letters: Vec<char> = text.chars().take(4).collect();
            let wrong = || element.wrong(format!("eulerseq={}, expected three of the letters x, y, z, X, Y, Z", quoted(text)));
            self.sequence = letters.try_into().map_err(|_| wrong())?;
            if !self.sequence.iter().all(|letter| "xyzXYZ".contains(*letter)) {
                return Err(wrong());
            }
        }
        if element.attribute("coordinate") == Some("global") {
            return Err(element.wrong("coordinate=\"global\" is not read, expected local coordinates"));
        }
        self.autolimits = element.attribute("autolimits").map_or(self.autolimits, |text| text != "false");
        match element.attribute("inertiafromgeom") {
            Some("true") => self.inertia_from = InertiaFrom::Geoms,
            Some("false") => self.inertia_from = InertiaFrom::Inertial,
            _ => {}
        }
        if let Some(folder) = element.attribute("meshdir").or(element.attribute("assetdir")) {
            folder.clone_into(&mut self.mesh_folder);
        }
        self.strips_paths = element.attribute("strippath") == Some("true");
        self.total_mass = element.number("settotalmass")?.filter(|mass| *mass > 0.0).or(self.total_mass);
        self.least_mass = element.number("boundmass")?.unwrap_or(self.least_mass).max(0.0);
        self.least_inertia = element.number("boundinertia")?.unwrap_or(self.least_inertia).max(0.0);
        if let Some(text) = element.attribute("inertiagrouprange") {
            self.inertia_groups = element.numbers("inertiagrouprange", text)?;
        }
        if element.attribute("balanceinertia") == Some("true") {
            notes.ignored_attribute(element, "balanceinertia");
        }
        Ok(())
    }

    /// The pose of an element.
    pub(super) fn pose(&self, of: &Attributes<'_>) -> Result<Pose> {
        Ok(Pose { at: of.vector("pos")?.unwrap_or(DVec3::ZERO), turn: self.turn(of)? })
    }

    fn turn(&self, of: &Attributes<'_>) -> Result<DQuat> {
        let wrong = |key: &str, text: &str| of.element.wrong(format!("{key} is {text}, expected a direction"));
        if let Some([w, x, y, z]) = of.numbers("quat")? {
            let turn = DQuat::from_xyzw(x, y, z, w);
            return if turn.length_squared() > 1e-20 { Ok(turn.normalize()) } else { Err(wrong("quat", "0")) };
        }
        if let Some([x, y, z, angle]) = of.numbers("axisangle")? {
            let axis = DVec3::new(x, y, z).try_normalize().ok_or_else(|| wrong("axisangle", "without an axis"))?;
            return Ok(DQuat::from_axis_angle(axis, angle * self.radians));
        }
        if let Some([a, b, c, d, e, f]) = of.numbers("xyaxes")? {
            let x = DVec3::new(a, b, c).try_normalize().ok_or_else(|| wrong("xyaxes", "0"))?;
            let y =
                DVec3::new(d, e, f).reject_from_normalized(x).try_normalize().ok_or_else(|| wrong("xyaxes", "on one line"))?;
            return Ok(DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize());
        }
        if let Some(z) = of.vector("zaxis")? {
            return Ok(DQuat::from_rotation_arc(DVec3::Z, z.try_normalize().ok_or_else(|| wrong("zaxis", "0"))?));
        }
        let Some(angles) = of.numbers::<3>("euler")? else { return Ok(DQuat::IDENTITY) };
        let mut turn = DQuat::IDENTITY;
        for (letter, angle) in self.sequence.into_iter().zip(angles) {
            let axis = match letter.to_ascii_lowercase() {
                'x' => DVec3::X,
                'y' => DVec3::Y,
                _ => DVec3::Z,
            };
            let next = DQuat::from_axis_angle(axis, angle * self.radians);
            turn = if letter.is_ascii_lowercase() { turn * next } else { next * turn };
        }
        Ok(turn.normalize())
    }
}
