//! Checks of joints.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::{Anchor, Joint, JointFrame, JointKind, Laid};
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::scene::checks::{finite, invalid, not_negative};
use crate::scene::tag::check_name;
use crate::settings::ContactLaw;

/// Room for rounding where a range of angles is a whole turn.
const ROUNDING: f32 = 1e-6;
/// Greatest coordinate of an anchor, as that of a point of a hull, in units.
const GREATEST: f32 = 1e15;

impl Joint {
    /// Checks all but its ends.
    pub(crate) fn validate(&self) -> Result<()> {
        if let Some(name) = &self.name {
            check_name("joint.name", name)?;
        }
        match self.laid {
            Laid::World { at, to, axis } => {
                for (field, point) in [("joint.at", at), ("joint.to", to)] {
                    check_point(field, point.as_vec3())?;
                }
                if let Some(axis) = axis.filter(|axis| axis.try_normalize().is_none()) {
                    return Err(invalid("joint.axis", axis.to_array(), "a direction, not 0"));
                }
            }
            Laid::Ends(ends) => ends.into_iter().try_for_each(check_frame)?,
        }
        self.check_kind()?;
        self.check_limits()?;
        self.check_drive()
    }

    /// Refuses what the kind does not have.
    fn check_kind(&self) -> Result<()> {
        let expected = match self.kind {
            JointKind::Ball => "nothing in a ball joint, only distance joints have it",
            JointKind::Fixed => "nothing in a fixed joint: it has no free axis",
            JointKind::Distance => "nothing in a distance joint, only ball joints have it",
            JointKind::Hinge => "nothing in a hinge: distance joints have a length, and ball joints a cone",
            JointKind::Slider => "nothing in a slider: distance joints have a length, and ball joints a cone",
        };
        let is_fixed = self.kind == JointKind::Fixed;
        if let Laid::World { axis: Some(axis), .. } = self.laid
            && matches!(self.kind, JointKind::Fixed | JointKind::Distance)
        {
            return Err(invalid(
                "joint.axis",
                axis.to_array(),
                "none: the joints of the kinds ball, hinge and slider have an axis",
            ));
        }
        let given = [
            ("joint.cone", self.cone, self.kind != JointKind::Ball),
            ("joint.length", self.length, self.kind != JointKind::Distance),
            ("joint.limits", self.limits.map(|[least, _]| least), is_fixed),
            ("joint.speed", self.speed, is_fixed),
            ("joint.target", self.target, is_fixed),
            ("joint.stiffness", Some(self.stiffness).filter(|k| *k != 0.0), is_fixed),
            ("joint.damping", Some(self.damping).filter(|c| *c != 0.0), is_fixed),
            ("joint.effort", Some(self.effort).filter(|f| *f != 0.0), is_fixed),
            ("joint.drag", Some(self.drag).filter(|c| *c != 0.0), is_fixed),
            ("joint.armature", Some(self.armature).filter(|j| *j != 0.0), is_fixed),
            ("joint.max_force", Some(self.max_force).filter(|f| f.is_finite()), is_fixed),
            ("joint.friction", Some(self.friction).filter(|f| *f != 0.0), is_fixed),
        ];
        let found = given.into_iter().find_map(|(field, value, is_refused)| Some((field, value.filter(|_| is_refused)?)));
        found.map_or(Ok(()), |(field, value)| Err(invalid(field, value, expected)))
    }

    fn check_limits(&self) -> Result<()> {
        if let Some(length) = self.length {
            not_negative("joint.length", length)?;
        }
        if let Some(cone) = self.cone.filter(|cone| !(0.0..=PI * (1.0 + ROUNDING)).contains(cone)) {
            return Err(invalid("joint.cone", cone, "an angle from 0 to half a turn"));
        }
        let Some(limits @ [least, greatest]) = self.limits else { return Ok(()) };
        if !(least.is_finite() && greatest.is_finite() && least <= greatest) {
            return Err(invalid("joint.limits", limits, "two finite numbers in ascending order"));
        }
        if self.kind.turns() && greatest - least > TAU * (1.0 + ROUNDING) {
            return Err(invalid("joint.limits", limits, "a range of at most one turn"));
        }
        if self.kind == JointKind::Distance && least < 0.0 {
            return Err(invalid("joint.limits", limits, "distances, not negative"));
        }
        Ok(())
    }

    fn check_drive(&self) -> Result<()> {
        if let Some(speed) = self.speed.filter(|speed| !speed.is_finite()) {
            return Err(invalid("joint.speed", speed, "a finite number"));
        }
        let is_distance = self.kind == JointKind::Distance;
        if let Some(target) = self.target.filter(|target| !target.is_finite() || is_distance && *target < 0.0) {
            let expected = if is_distance { "a finite number, not negative" } else { "a finite number" };
            return Err(invalid("joint.target", target, expected));
        }
        not_negative("joint.stiffness", self.stiffness)?;
        not_negative("joint.damping", self.damping)?;
        not_negative("joint.drag", self.drag)?;
        not_negative("joint.armature", self.armature)?;
        if !self.effort.is_finite() {
            return Err(invalid("joint.effort", self.effort, "a finite number"));
        }
        not_negative("joint.friction", self.friction)?;
        if self.max_force.is_nan() || self.max_force < 0.0 {
            return Err(invalid("joint.max_force", self.max_force, "a number, not negative"));
        }
        for (field, strength) in [("joint.break_force", self.break_force), ("joint.break_torque", self.break_torque)] {
            if strength.is_nan() || strength <= 0.0 {
                return Err(invalid(field, strength, "a number greater than 0"));
            }
        }
        Ok(())
    }

    /// Checks that a new joint has no target without a spring. That of a joint that changes may wait for one.
    pub(crate) fn check_idle(&self) -> Result<()> {
        if let Some(target) = self.target.filter(|_| self.stiffness == 0.0) {
            return Err(invalid("joint.target", target, "a target together with a stiffness"));
        }
        Ok(())
    }

    /// Checks that the limits contain the position at the start.
    pub(super) fn check_start(&self) -> Result<()> {
        let start = self.length.unwrap_or(0.0);
        let Some(limits) = self.limits.filter(|[least, greatest]| !(*least..=*greatest).contains(&start)) else {
            return Ok(());
        };
        let expected = if self.kind == JointKind::Distance {
            "a range that contains the distance at the start"
        } else {
            "a range that contains 0, the position at the start"
        };
        Err(invalid("joint.limits", limits, expected))
    }
}

fn check_point(field: &'static str, point: Vec3) -> Result<()> {
    finite(field, point)?;
    if point.abs().max_element() <= GREATEST {
        return Ok(());
    }
    Err(invalid(field, point.to_array(), "coordinates of at most 1e15"))
}

fn check_frame(frame: JointFrame) -> Result<()> {
    check_point("joint.place", frame.place)?;
    if frame.turn.is_normalized() {
        return Ok(());
    }
    let q = frame.turn;
    Err(invalid("joint.turn", [q.w, q.x, q.y, q.z], "a unit quaternion w, x, y, z"))
}

impl Scene {
    /// Checks the ends of a joint, whose spheres are no parts of rigid bodies.
    pub(crate) fn check_joint_ends(&self, joint: &Joint) -> Result<()> {
        for anchor in joint.anchors() {
            match anchor {
                Anchor::World => {}
                Anchor::Body(id) => self.bodies.index(id).map(drop)?,
                Anchor::Sphere(id) => {
                    self.spheres.index(id)?;
                    if self.body_of_sphere(id).is_some() {
                        return Err(invalid("joint.a", id, "the rigid body in place of a sphere of it"));
                    }
                }
            }
        }
        if joint.a == joint.b {
            return Err(Error::Invalid { field: "joint.b", value: self.name_of_end(joint.b), expected: "another body than a" });
        }
        if joint.anchors().into_iter().all(|anchor| self.is_still(anchor)) {
            let value = joint.anchors().map(|anchor| self.name_of_end(anchor)).join(" and ");
            return Err(Error::Invalid { field: "joint.b", value, expected: "at least one body that can move" });
        }
        Ok(())
    }

    /// Whether an end of a joint never moves.
    pub(crate) fn is_still(&self, anchor: Anchor) -> bool {
        match anchor {
            Anchor::World => true,
            Anchor::Body(_) => false,
            Anchor::Sphere(id) => self.sphere(id).is_ok_and(|sphere| sphere.fixed),
        }
    }

    fn name_of_end(&self, anchor: Anchor) -> String {
        match anchor {
            Anchor::World => "the world".to_owned(),
            Anchor::Body(id) => {
                let number = self.bodies.index(id).unwrap_or_default();
                format!("rigid body number {number}{}", self.called(id))
            }
            Anchor::Sphere(id) => self.name_of(crate::scene::Body::Sphere(id)),
        }
    }

    /// Checks that the contact law suits the joints of the scene, and that their ends can move against each other.
    pub(crate) fn check_joints(&self) -> Result<()> {
        let Some(first) = self.joints().first() else { return Ok(()) };
        let law = self.contact_law();
        if law != ContactLaw::Rigid {
            let called = first.name.as_deref().map_or(String::new(), |name| format!(" ({})", crate::error::quoted(name)));
            let expected = "rigid: joints need `set contact_law rigid`";
            return Err(Error::Invalid { field: "contact_law", value: format!("{law} with a joint{called}"), expected });
        }
        let whole = |anchor| if let Anchor::Sphere(id) = anchor { self.implied_of(id) } else { None };
        for joint in self.joints() {
            self.check_joint_ends(joint)?;
            if whole(joint.a).is_some() && whole(joint.a) == whole(joint.b) {
                let value = joint.anchors().map(|anchor| self.name_of_end(anchor)).join(" and ");
                let expected = "spheres that rods do not hold together";
                return Err(Error::Invalid { field: "joint.b", value, expected });
            }
        }
        Ok(())
    }
}
