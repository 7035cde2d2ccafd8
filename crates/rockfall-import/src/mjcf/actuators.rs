//! `<actuator>`.

use super::Mjcf;
use super::defaults::{Attributes, Defaults};
use super::joints::greatest;
use crate::error::Result;
use crate::model::{LinkJoint, Motion, Spring};
use crate::urdf::not_negative;
use crate::xml::{Element, quoted};

/// Greatest number of names in a note.
const MOST_NAMES: usize = 100;

/// What the force of an actuator is, before its gear.
enum Force {
    /// kp (control - position) - kv speed.
    Spring {
        kp: f64,
        kv: f64,
    },
    /// The control times this.
    Control(f64),
    Other,
}

impl Mjcf<'_> {
    /// Notes the actuators whose force a control gives, and those that are left out.
    pub(super) fn note_forces(&mut self) {
        let texts = [
            "a program sets the effort of joints in place of actuators with a force or torque that a control gives, that of",
            "actuators that are no motor, spring or damper are left out, those of",
        ];
        for (text, forces) in texts.iter().zip(&self.forces) {
            let Some((place, _)) = forces.first() else { continue };
            let joints: Vec<&str> = forces.iter().map(|(_, joint)| joint.as_str()).take(MOST_NAMES).collect();
            let more = if forces.len() > joints.len() { " and others" } else { "" };
            self.notes.push(format!("{place}: {text} {}{more}", joints.join(", ")));
        }
    }

    /// Adds the spring of an actuator to its joint, with the control 0.
    pub(super) fn actuator(&mut self, element: &Element) -> Result<()> {
        let of = self.defaults.attributes(element, Defaults::MAIN)?;
        let Some(name) = of.get("joint").or(of.get("jointinparent")) else {
            self.notes.add(element, "it drives no joint, so it is left out");
            return Ok(());
        };
        let Some((link, number)) = self.joints.get(name).copied() else {
            if self.links.iter().any(|link| link.is_free) {
                self.notes.add(element, format!("no joint of one axis has the name {}, so it is left out", quoted(name)));
                return Ok(());
            }
            return Err(element.wrong(format!("no joint has the name {}, expected the name of a joint", quoted(name))));
        };
        let force = force(&of)?;
        let gear = of.first("gear")?.unwrap_or(1.0);
        let bound = |range: &str, limited: &str| {
            let bounds = of.range(range)?;
            let is_bounded = of.is_limited(limited, bounds.is_some(), self.compiler.autolimits);
            Ok(bounds.filter(|_| is_bounded).map_or(f64::INFINITY, |bounds| greatest(bounds) * gear.abs()))
        };
        let most = bound("forcerange", "forcelimited")?;
        let controlled = bound("ctrlrange", "ctrllimited")?;
        let joint: &mut LinkJoint = &mut self.links[link].joints[number];
        if joint.motion == Motion::Ball {
            self.notes.add(element, "it drives a ball joint, so it is left out");
            return Ok(());
        }
        match force {
            Force::Spring { kp, kv } => {
                // The control is a position of the file.
                let (stiffness, damping, target) = (kp * gear * gear, kv * gear * gear, -joint.reference);
                joint.springs.push(Spring { stiffness, damping, target, most: Some(most) });
            }
            Force::Control(gain) => {
                joint.motors.push(most.min(controlled * gain.abs()));
                self.forces[0].push((element.place(), name.to_owned()));
            }
            Force::Other => self.forces[1].push((element.place(), name.to_owned())),
        }
        Ok(())
    }
}

fn force(of: &Attributes<'_>) -> Result<Force> {
    let element = of.element;
    let gain = |key: &str, default: f64| not_negative(element, key, of.number(key)?.unwrap_or(default));
    Ok(match element.name.as_str() {
        "position" => Force::Spring { kp: gain("kp", 1.0)?, kv: gain("kv", 0.0)? },
        "velocity" => Force::Spring { kp: 0.0, kv: gain("kv", 1.0)? },
        "motor" => Force::Control(1.0),
        "general" if !matches!(of.get("gaintype"), None | Some("fixed")) => Force::Other,
        "general" if of.get("biastype") == Some("affine") => {
            let bias = of.list("biasprm")?.unwrap_or_default();
            let at = |place: usize| -bias.get(place).copied().unwrap_or(0.0);
            let (kp, kv) = (not_negative(element, "-biasprm", at(1))?, not_negative(element, "-biasprm", at(2))?);
            Force::Spring { kp, kv }
        }
        "general" if matches!(of.get("biastype"), None | Some("none")) => {
            Force::Control(of.list("gainprm")?.and_then(|gains| gains.first().copied()).unwrap_or(1.0))
        }
        _ => Force::Other,
    })
}
