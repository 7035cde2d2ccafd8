//! `<actuator>`.

use super::Mjcf;
use super::defaults::{Attributes, Defaults};
use crate::error::Result;
use crate::model::{LinkJoint, Motion, Spring};
use crate::urdf::not_negative;
use crate::xml::{Element, quoted};

/// Greatest number of names in a note.
const MOST_NAMES: usize = 100;

/// The gains of an actuator: its force is kp (control - position) - kv speed.
struct Gains {
    kp: f64,
    kv: f64,
}

impl Mjcf<'_> {
    /// Notes the actuators whose force a control gives.
    pub(super) fn note_forces(&mut self) {
        let Some((place, _)) = self.forces.first() else { return };
        let joints: Vec<&str> = self.forces.iter().map(|(_, joint)| joint.as_str()).take(MOST_NAMES).collect();
        let more = if self.forces.len() > joints.len() { " and others" } else { "" };
        let text = "actuators with a force or torque that a control gives are left out, those of";
        self.notes.push(format!("{place}: {text} {}{more}", joints.join(", ")));
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
        let Some(Gains { kp, kv }) = gains(&of)? else {
            self.forces.push((element.place(), name.to_owned()));
            return Ok(());
        };
        let gear = of.first("gear")?.unwrap_or(1.0);
        let bounds = of.range("forcerange")?;
        let is_bounded = of.is_limited("forcelimited", bounds.is_some(), self.compiler.autolimits);
        let most = match bounds.filter(|_| is_bounded) {
            Some([least, greatest]) => (least.abs().max(greatest.abs()) * gear.abs()).max(f64::MIN_POSITIVE),
            None => f64::INFINITY,
        };
        let joint: &mut LinkJoint = &mut self.links[link].joints[number];
        if joint.motion == Motion::Ball {
            self.notes.add(element, "it drives a ball joint, so it is left out");
            return Ok(());
        }
        // The control is a position of the file.
        joint.springs.push(Spring { stiffness: kp * gear * gear, damping: kv * gear * gear, target: -joint.reference, most });
        Ok(())
    }
}

/// The gains of an actuator that is a spring or a damper. `None` for others.
fn gains(of: &Attributes<'_>) -> Result<Option<Gains>> {
    let element = of.element;
    let gain = |key: &str, default: f64| not_negative(element, key, of.number(key)?.unwrap_or(default));
    Ok(match element.name.as_str() {
        "position" => Some(Gains { kp: gain("kp", 1.0)?, kv: gain("kv", 0.0)? }),
        "velocity" => Some(Gains { kp: 0.0, kv: gain("kv", 1.0)? }),
        "damper" => None,
        "general" if of.get("biastype") == Some("affine") && matches!(of.get("gaintype"), None | Some("fixed")) => {
            let bias = of.list("biasprm")?.unwrap_or_default();
            let at = |place: usize| -bias.get(place).copied().unwrap_or(0.0);
            let (kp, kv) = (not_negative(element, "-biasprm", at(1))?, not_negative(element, "-biasprm", at(2))?);
            Some(Gains { kp, kv })
        }
        _ => None,
    })
}
