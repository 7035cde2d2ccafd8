//! Links that move as one.

use crate::error::Result;
use crate::mass::{Mass, Pose};
use crate::model::{Link, LinkJoint, Model, Motion};
use crate::notes::Notes;

use rockfall::glam::DQuat;

/// Greatest number of joints of a link: a body has six ways to move.
const MOST_JOINTS: usize = 6;

/// Where links are and with which others they move.
#[derive(Debug)]
pub(super) struct Merged {
    /// Pose of every link in the world.
    pub(super) poses: Vec<Pose>,
    /// The topmost link that it is fixed to.
    pub(super) tops: Vec<usize>,
    /// Position of every joint of every link in the place of the scene.
    pub(super) starts: Vec<Vec<f64>>,
}

impl Merged {
    /// The links that a link contains, with their poses in its coordinates.
    pub(super) fn parts(&self, top: usize) -> impl Iterator<Item = (usize, Pose)> {
        let back = self.poses[top].inverse();
        let parts = self.tops.iter().enumerate().filter(move |(_, of)| **of == top);
        parts.map(move |(part, _)| (part, back.then(&self.poses[part])))
    }

    /// The mass of a link with all that are fixed to it.
    pub(super) fn mass(&self, model: &Model, top: usize) -> Mass {
        self.parts(top).fold(Mass::NONE, |sum, (part, pose)| sum.and(&model.links[part].mass.moved(&pose)))
    }
}

/// Places all links. A joint whose limits do not contain 0 starts at the nearer limit.
pub(super) fn merged(model: &Model, notes: &mut Notes) -> Result<Merged> {
    let count = model.links.len();
    let (mut poses, mut tops) = (vec![Pose::NONE; count], vec![0; count]);
    let mut starts: Vec<Vec<f64>> = Vec::with_capacity(count);
    for (number, link) in model.links.iter().enumerate() {
        if link.joints.len() > MOST_JOINTS {
            return Err(link.element.wrong(format!("it has {} joints, expected at most {MOST_JOINTS}", link.joints.len())));
        }
        starts.push(link.joints.iter().map(|joint| start(joint, notes)).collect());
        let Some(parent) = link.parent else { continue };
        poses[number] = poses[parent].then(&link.pose);
        for (joint, start) in link.joints.iter().zip(&starts[number]) {
            poses[number] = poses[number].then(&turned(joint, *start));
        }
        let moves = link.is_free || !link.joints.is_empty();
        tops[number] = if moves { number } else { tops[parent] };
        check_free(model, link, tops[parent])?;
    }
    Ok(Merged { poses, tops, starts })
}

/// A free joint is relative to the world.
fn check_free(model: &Model, link: &Link, above: usize) -> Result<()> {
    if link.is_free && above != 0 && !link.joints.is_empty() {
        let name = &model.links[above].name;
        return Err(link.element.wrong(format!("it moves freely against {name} and has joints, expected one of both")));
    }
    Ok(())
}

fn start(joint: &LinkJoint, notes: &mut Notes) -> f64 {
    let Some([least, greatest]) = joint.limits.filter(|_| joint.motion != Motion::Ball) else { return 0.0 };
    let start = 0.0_f64.clamp(least, greatest.max(least));
    if start != 0.0 {
        let unit = if joint.motion == Motion::Hinge { "rad" } else { "m" };
        let text =
            format!("the place of the file is beyond a limit, so the joint starts at that limit, {start:.4} {unit} away");
        notes.add(&joint.element, text);
    }
    start
}

/// The motion of a joint in coordinates of its link.
pub(super) fn turned(joint: &LinkJoint, position: f64) -> Pose {
    match joint.motion {
        Motion::Slide => Pose { at: position * joint.axis, ..Pose::NONE },
        Motion::Hinge => {
            let turn = DQuat::from_axis_angle(joint.axis, position);
            Pose { at: joint.at - turn * joint.at, turn }
        }
        Motion::Ball => Pose::NONE,
    }
}
