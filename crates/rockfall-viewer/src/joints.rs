//! Where joints are, for marks over pictures, strings and the camera.

use rockfall::glam::Vec3;
use rockfall::{Anchor, Joint, JointId, JointKind, Result, Scene, Simulation};

/// Where a joint is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointPlace {
    /// The anchors on both bodies.
    pub(crate) ends: [Vec3; 2],
    /// The direction of the axis of a hinge or slider; 0 for others.
    pub(crate) axis: Vec3,
    /// Whether it is a distance joint.
    pub(crate) is_string: bool,
}

impl JointPlace {
    fn of(scene: &Scene, id: JointId, joint: &Joint) -> Result<Self> {
        let has_axis = matches!(joint.kind, JointKind::Hinge | JointKind::Slider);
        let axis = if has_axis { scene.joint_axis(id)? } else { Vec3::ZERO };
        Ok(Self { ends: scene.joint_anchors(id)?, axis, is_string: joint.kind == JointKind::Distance })
    }

    /// The place at a part of the way to another one, from 0 to 1.
    pub(crate) fn towards(&self, other: &Self, part: f32) -> Self {
        let [start, end] = [0, 1].map(|end| self.ends[end].lerp(other.ends[end], part));
        Self { ends: [start, end], axis: self.axis.lerp(other.axis, part), ..*self }
    }
}

/// Whether a scene has joints that are drawn in any case.
fn has_strings(scene: &Scene) -> bool {
    scene.joints().iter().any(|joint| joint.kind == JointKind::Distance)
}

/// Points of the world that distance joints are attached to.
pub(crate) fn fixed_ends(scene: &Scene) -> impl Iterator<Item = Vec3> {
    let strings = scene.joint_ids().zip(scene.joints()).filter(|(_, joint)| joint.kind == JointKind::Distance);
    strings.flat_map(|(id, joint)| {
        let ends = scene.joint_anchors(id).unwrap_or([Vec3::NAN; 2]);
        let fixed = joint.anchors().into_iter().zip(ends).filter(|(anchor, _)| *anchor == Anchor::World);
        fixed.map(|(_, end)| end).collect::<Vec<_>>()
    })
}

/// Where the joints of a simulation are that are not broken: all of them, or only distance joints.
pub(crate) fn places(simulation: &mut Simulation, all: bool) -> Result<Vec<JointPlace>> {
    if !(all || has_strings(simulation.scene())) {
        return Ok(Vec::new());
    }
    let readings = simulation.joints()?;
    let scene = simulation.sync()?;
    let joints = scene.joint_ids().zip(scene.joints()).enumerate();
    let is_broken = |number: usize| readings.get(number).is_some_and(|reading| reading.broken);
    let shown = joints.filter(|(number, (_, joint))| (all || joint.kind == JointKind::Distance) && !is_broken(*number));
    shown.map(|(_, (id, joint))| JointPlace::of(scene, id, joint)).collect()
}
