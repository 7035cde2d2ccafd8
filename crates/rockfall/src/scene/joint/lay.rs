//! Joints of a scene: where their ends are.

use glam::{DQuat, DVec3, Vec3};

use super::{Anchor, Joint, JointFrame, JointId, JointKind, Laid};
use crate::error::{Error, Result, nearest, quoted};
use crate::scene::rigid::wide;
use crate::scene::statics::upright;
use crate::scene::{Scene, SphereId};

/// The origin of coordinates and their turn into those of the world.
pub(crate) type EndPose = (DVec3, DQuat);

/// An end of a joint at a loose sphere, and where it is in the world.
pub(in crate::scene) struct EndAtSphere {
    joint: usize,
    end: usize,
    pub(in crate::scene) sphere: SphereId,
    pose: EndPose,
}

pub(crate) fn name_is_taken(name: &str) -> Error {
    Error::Invalid { field: "joint.name", value: quoted(name), expected: "a name that no other joint has" }
}

/// The turn of the joint frame with an axis. The other axes follow from it by a fixed rule.
fn frame_of(axis: Option<DVec3>) -> DQuat {
    let axis = axis.map_or(DVec3::X, DVec3::normalize);
    let size = axis.abs();
    let second = if size.x >= size.y && size.x >= size.z {
        DVec3::Y
    } else if size.y >= size.z {
        DVec3::Z
    } else {
        DVec3::X
    };
    upright(axis, second)
}

impl JointFrame {
    fn seen_from((centre, turn): EndPose, point: DVec3, frame: DQuat) -> Self {
        let back = turn.inverse();
        // What is left of rounding in coordinates of the world would be a tail of digits in texts.
        let noise = 4.0 * f64::EPSILON * (point.abs() + centre.abs()).max_element();
        let place = (back * (point - centre)).to_array().map(|x| if x.abs() <= noise { 0.0 } else { x as f32 });
        Self { place: place.into(), turn: (back * frame).normalize().as_quat() }
    }

    fn in_world(&self, (centre, turn): EndPose) -> EndPose {
        (centre + turn * self.place.as_dvec3(), (turn * wide(self.turn)).normalize())
    }
}

impl Scene {
    /// Where an end of a joint has its coordinates. `fine` counts the low part of its position.
    fn pose_of_end(&self, anchor: Anchor, fine: bool) -> Result<EndPose> {
        let at = |centre: [f64; 3], position: Vec3| if fine { DVec3::from_array(centre) } else { position.as_dvec3() };
        Ok(match anchor {
            Anchor::Body(id) => {
                let body = self.bodies.get(id)?;
                (at(body.centre(), body.position), wide(body.orientation))
            }
            Anchor::Sphere(id) if !self.sphere(id)?.fixed => {
                let sphere = self.sphere(id)?;
                (at(sphere.centre(), sphere.position), wide(sphere.orientation))
            }
            Anchor::World | Anchor::Sphere(_) => (DVec3::ZERO, DQuat::IDENTITY),
        })
    }

    /// Puts the ends of a joint into coordinates of its bodies.
    pub(crate) fn laid_joint(&self, mut joint: Joint, fine: bool) -> Result<Joint> {
        if let Laid::World { at, to, axis } = joint.laid {
            let poses = [self.pose_of_end(joint.a, fine)?, self.pose_of_end(joint.b, fine)?];
            let frame = frame_of(axis);
            joint.laid = Laid::Ends([JointFrame::seen_from(poses[0], at, frame), JointFrame::seen_from(poses[1], to, frame)]);
            if joint.kind == JointKind::Distance {
                joint.length = joint.length.or(Some(at.distance(to) as f32));
            }
            joint.check_start()?;
        } else if joint.kind == JointKind::Distance && joint.length.is_none() {
            let [one, other] = self.joint_poses_of(&joint, fine)?;
            joint.length = Some(one.0.distance(other.0) as f32);
        }
        Ok(joint)
    }

    /// Adds a joint between two bodies in their present places.
    ///
    /// # Errors
    /// [`Error::Invalid`] for numbers out of their range, limits that do not contain the position at the start, an axis of 0, a
    /// value that its kind does not have, a name that another joint has or that is not one word, and for ends that are
    /// the same body or cannot move.
    /// [`Error::StaleHandle`] for a body or sphere that is not in the scene.
    pub fn add_joint(&mut self, mut joint: Joint) -> Result<JointId> {
        [joint.a, joint.b] = joint.anchors().map(|anchor| self.whole_end(anchor));
        joint.validate()?;
        joint.check_idle()?;
        self.check_joint_ends(&joint)?;
        let is_taken = |name: &&str| self.joints().iter().any(|known| known.name.as_deref() == Some(*name));
        if let Some(name) = joint.name.as_deref().filter(is_taken) {
            return Err(name_is_taken(name));
        }
        let joint = self.laid_joint(joint, true)?;
        self.keep_joint(joint)
    }

    /// The rigid body in place of a sphere of it.
    pub(crate) fn whole_end(&self, anchor: Anchor) -> Anchor {
        match anchor {
            Anchor::Sphere(id) => self.body_of_sphere(id).map_or(anchor, Anchor::Body),
            other => other,
        }
    }

    /// Adds a joint with ends in coordinates of its bodies. No other joint has its name.
    pub(crate) fn keep_joint(&mut self, joint: Joint) -> Result<JointId> {
        joint.validate()?;
        self.check_joint_ends(&joint)?;
        Ok(self.joints.add(joint))
    }

    /// Changes the limits, the motor, the spring, the friction, the length and the strength of a joint. Its kind, its ends, its
    /// name and whether its bodies collide cannot be changed.
    ///
    /// # Errors
    /// [`Error::Invalid`] for numbers out of their range, [`Error::StaleHandle`] when it is not in the scene. Nothing is changed then.
    pub fn update_joint(&mut self, id: JointId, change: impl FnOnce(&mut Joint)) -> Result<()> {
        let before = self.joints.get(id)?;
        let mut joint = before.clone();
        change(&mut joint);
        let length = joint.length.or(before.length);
        let Joint { kind, a, b, ref name, collides, laid, .. } = *before;
        joint = Joint { kind, a, b, name: name.clone(), collides, laid, length, ..joint };
        joint.validate()?;
        *self.joints.get_mut(id)? = joint;
        Ok(())
    }

    /// The joint with a name.
    ///
    /// # Errors
    /// [`Error::UnknownName`] when no joint has it.
    pub fn joint_named(&self, name: &str) -> Result<JointId> {
        let is_it = |joint: &Joint| joint.name.as_deref() == Some(name);
        if let Some(index) = self.joints().iter().position(is_it) {
            return Ok(self.joints.handle_at(index));
        }
        let known: Vec<&str> = self.joints().iter().filter_map(|joint| joint.name.as_deref()).collect();
        let hint = match nearest(name, &known) {
            Some(near) => format!("did you mean {}?", quoted(near)),
            None => format!("expected the name of one of {} joints", self.joints().len()),
        };
        Err(Error::UnknownName { name: name.to_owned(), hint })
    }

    /// Where the anchors of a joint on both bodies are at present, in units.
    ///
    /// # Errors
    /// [`Error::StaleHandle`] when it is not in the scene.
    pub fn joint_anchors(&self, id: JointId) -> Result<[Vec3; 2]> {
        Ok(self.joint_poses_of(self.joints.get(id)?, true)?.map(|(point, _)| point.as_vec3()))
    }

    /// The direction of the axis of a joint on its first body at present: a unit vector.
    ///
    /// # Errors
    /// [`Error::StaleHandle`] when it is not in the scene.
    pub fn joint_axis(&self, id: JointId) -> Result<Vec3> {
        let [(_, turn), _] = self.joint_poses_of(self.joints.get(id)?, true)?;
        Ok((turn * DVec3::X).as_vec3())
    }

    /// Where the ends of a joint are in the world: the anchors, and the turns of the joint frames.
    pub(crate) fn joint_poses_of(&self, joint: &Joint, fine: bool) -> Result<[EndPose; 2]> {
        let poses = [self.pose_of_end(joint.a, fine)?, self.pose_of_end(joint.b, fine)?];
        Ok(match joint.laid {
            Laid::Ends([a, b]) => [a.in_world(poses[0]), b.in_world(poses[1])],
            Laid::World { at, to, axis } => [at, to].map(|point| (point, frame_of(axis))),
        })
    }

    /// Removes the joints of bodies and spheres that are no longer in the scene.
    pub(in crate::scene) fn remove_loose_joints(&mut self) {
        let (bodies, spheres) = (&self.bodies, &self.spheres);
        let is_gone = |anchor: Anchor| match anchor {
            Anchor::World => false,
            Anchor::Body(id) => bodies.index(id).is_err(),
            Anchor::Sphere(id) => spheres.index(id).is_err(),
        };
        self.joints.remove_where(|joint| joint.anchors().into_iter().any(is_gone));
    }

    /// Where the ends at loose spheres are in the world, to keep them there while the spheres get another orientation.
    pub(in crate::scene) fn ends_at_spheres(&self) -> Vec<EndAtSphere> {
        let of_joint = |(number, joint): (usize, &Joint)| {
            let poses = self.joint_poses_of(joint, true).unwrap_or([(DVec3::ZERO, DQuat::IDENTITY); 2]);
            let at_sphere = |(end, anchor): (usize, Anchor)| match anchor {
                Anchor::Sphere(sphere) if !self.is_still(anchor) => {
                    Some(EndAtSphere { joint: number, end, sphere, pose: poses[end] })
                }
                _ => None,
            };
            joint.anchors().into_iter().enumerate().filter_map(at_sphere).collect::<Vec<_>>()
        };
        self.joints().iter().enumerate().flat_map(of_joint).collect()
    }

    /// Puts an end of a joint where it is in the world.
    pub(in crate::scene) fn put_end(&mut self, EndAtSphere { joint, end, sphere, pose: (point, frame) }: EndAtSphere) {
        let Ok(pose) = self.pose_of_end(Anchor::Sphere(sphere), true) else { return };
        if let Some(Joint { laid: Laid::Ends(ends), .. }) = self.joints.objects_mut().get_mut(joint) {
            ends[end] = JointFrame::seen_from(pose, point, frame);
        }
    }
}
