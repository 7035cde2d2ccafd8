//! Joints of the scene.

use std::f64::consts::TAU;

use rockfall::{Anchor, Joint, RigidBodyId};

use crate::error::Result;
use crate::mass::Pose;
use crate::model::{LinkJoint, Model, Motion, Spring};

use super::bodies::{Body, Edge};
use super::{Builder, anchor};

/// Greatest distance of two bodies whose contact a joint prevents, in units.
const FAR: f32 = 1e9;

impl Builder<'_> {
    pub(super) fn add_joints(
        &mut self,
        model: &Model,
        bodies: &[Body],
        ids: &[Option<RigidBodyId>],
        poses: &[Pose],
    ) -> Result<()> {
        for (number, body) in bodies.iter().enumerate() {
            for edge in &body.joints {
                let ends = [anchor(ids, edge.above), anchor(ids, number)];
                self.add_joint(&model.links[edge.link].joints[edge.joint], edge, ends)?;
            }
            if let (Some(other), Some(own)) = (body.apart_from.and_then(|other| ids[other]), ids[number]) {
                self.part(other, own)?;
            }
        }
        self.add_loops(model, ids, poses)?;
        self.part_pairs(model, ids)
    }

    fn add_loops(&mut self, model: &Model, ids: &[Option<RigidBodyId>], poses: &[Pose]) -> Result<()> {
        for closing in &model.loops {
            let [a, b] = closing.links.map(|link| self.contacts.numbers[link]);
            if a == b {
                self.notes.add(&closing.element, "it connects two links of one body, so it is left out");
                continue;
            }
            let frame = poses[closing.links[0]];
            let name = self.joints.word(&closing.name, &closing.element, &mut self.notes);
            let ends = [anchor(ids, a), anchor(ids, b)];
            let joint = match closing.ball_at {
                Some(at) => Joint::ball(ends[0], ends[1], frame.point(at)),
                None => Joint::fixed(ends[0], ends[1], frame.at),
            };
            self.scene.add_joint(joint.name(name)).map_err(|error| closing.element.wrong(error.to_string()))?;
        }
        Ok(())
    }

    /// Keeps the pairs apart that the file excludes.
    fn part_pairs(&mut self, model: &Model, ids: &[Option<RigidBodyId>]) -> Result<()> {
        for pair in &model.apart {
            let [a, b] = pair.map(|link| ids[self.contacts.numbers[link]]);
            if let (Some(a), Some(b)) = (a, b) {
                if a != b {
                    self.part(a, b)?;
                }
            } else {
                let names = pair.map(|link| model.links[link].name.as_str()).join(" and ");
                self.notes.push(format!("{}: {names} touch, because one of them is the world", self.path.display()));
            }
        }
        Ok(())
    }

    fn add_joint(&mut self, of: &LinkJoint, edge: &Edge, ends: [Anchor; 2]) -> Result<()> {
        let (at, axis) = (edge.frame.point(of.at), edge.frame.turn * of.axis);
        let [a, b] = ends;
        let mut joint = match of.motion {
            Motion::Hinge => Joint::hinge(a, b, at, axis),
            Motion::Slide => Joint::slider(a, b, at, axis),
            Motion::Ball => Joint::ball(a, b, at).axis(axis),
        };
        joint = joint.name(self.joints.word(&of.name, &of.element, &mut self.notes));
        joint = self.limited(joint, of, edge.start);
        joint = self.sprung(joint, of, edge.start);
        joint.friction = of.friction as f32;
        let added = self.scene.add_joint(joint);
        added.map_err(|error| of.element.wrong(error.to_string()))?;
        Ok(())
    }

    fn limited(&mut self, joint: Joint, of: &LinkJoint, start: f64) -> Joint {
        let Some([least, greatest]) = of.limits else { return joint };
        if of.motion == Motion::Hinge && greatest - least > TAU {
            self.notes.add(&of.element, "it has no limits, because they are more than one turn apart");
            return joint;
        }
        if of.motion == Motion::Ball {
            let text = "the limit of the angle of the ball joint holds for its cone and for its twist, each on its own";
            self.notes.add(&of.element, text);
            let most = greatest.min(TAU / 2.0) as f32;
            return joint.cone(most).limits(-most, most);
        }
        joint.limits(((least - start) as f32).min(0.0), ((greatest - start) as f32).max(0.0))
    }

    /// Adds all springs and dampers of a joint as one. The bound of actuators does not hold for the damping of the joint.
    fn sprung(&mut self, joint: Joint, of: &LinkJoint, start: f64) -> Joint {
        let springs: Vec<&Spring> = of.springs.iter().filter(|spring| spring.stiffness > 0.0 || spring.damping > 0.0).collect();
        let bounds: Vec<f64> = springs.iter().filter_map(|spring| spring.most).chain(of.motors.iter().copied()).collect();
        let together = if bounds.is_empty() { f64::INFINITY } else { bounds.iter().sum() };
        let most = together.min(of.effort.unwrap_or(f64::INFINITY)) as f32;
        let has_own = springs.iter().any(|spring| spring.most.is_none() && spring.stiffness > 0.0);
        let is_bounded = most.is_finite() && !has_own;
        if most.is_finite() && has_own {
            let text =
                "the greatest force of its actuators is not taken over, because it would bound the spring of the joint, too";
            self.notes.add(&of.element, text);
        }
        let stiffness: f64 = springs.iter().map(|spring| spring.stiffness).sum();
        let damping = |is_drag: bool| {
            let of_it = springs.iter().filter(|spring| (is_bounded && spring.most.is_none()) == is_drag);
            of_it.map(|spring| spring.damping).sum::<f64>() as f32
        };
        let mut joint = joint.spring(stiffness as f32, damping(false)).drag(damping(true)).armature(of.armature as f32);
        if stiffness > 0.0 {
            let moment: f64 = springs.iter().map(|spring| spring.stiffness * spring.target).sum();
            joint = joint.target((moment / stiffness - start) as f32);
        }
        if is_bounded { joint.max_force(most) } else { joint }
    }

    /// Lets two bodies never touch: a distance joint that allows every distance.
    pub(super) fn part(&mut self, a: RigidBodyId, b: RigidBodyId) -> Result<()> {
        let failed = |error| self.failed(error);
        let bodies = [a, b].map(|id| self.scene.body(id).map(|body| body.centre()).map_err(failed));
        let [one, other] = bodies;
        let joint = Joint::distance(a, b, one?, other?).limits(0.0, FAR);
        let name = format!("apart_{}_{}", self.name_of(a), self.name_of(b));
        let element = crate::xml::Element::empty("robot", self.path);
        let name = self.joints.word(&name, &element, &mut crate::notes::Notes::default());
        let added = self.scene.add_joint(joint.name(name));
        added.map_err(|error| self.failed(error))?;
        Ok(())
    }
}
