//! What both formats have in common: a tree of links with joints.

use rockfall::glam::DVec3;

use crate::mass::{Mass, Pose};
use crate::solid::Solid;
use crate::xml::Element;

/// A robot, or several, and the world. The first link is the world.
#[derive(Debug)]
pub(crate) struct Model {
    /// Parents come before their children.
    pub(crate) links: Vec<Link>,
    pub(crate) loops: Vec<Loop>,
    /// Pairs of links that never touch.
    pub(crate) apart: Vec<[usize; 2]>,
    pub(crate) gravity: DVec3,
    /// Whether the file says which geoms meet. Bodies that overlap at the start do not meet otherwise.
    pub(crate) has_masks: bool,
}

#[derive(Debug)]
pub(crate) struct Link {
    pub(crate) name: String,
    /// Where errors and notes point to. Without its children.
    pub(crate) element: Element,
    /// Number of the parent, lower than its own. `None` for the world.
    pub(crate) parent: Option<usize>,
    /// In coordinates of the parent, with all joints at 0.
    pub(crate) pose: Pose,
    /// The joints to the parent, the outermost first. Empty for a link that is fixed to its parent.
    pub(crate) joints: Vec<LinkJoint>,
    pub(crate) is_free: bool,
    pub(crate) mass: Mass,
    pub(crate) geoms: Vec<Geom>,
}

impl Link {
    /// A link without a parent, at the origin.
    pub(crate) fn alone(name: String, element: Element, mass: Mass, geoms: Vec<Geom>) -> Self {
        Self { name, element, parent: None, pose: Pose::NONE, joints: Vec::new(), is_free: false, mass, geoms }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Motion {
    Hinge,
    Slide,
    Ball,
}

#[derive(Debug)]
pub(crate) struct LinkJoint {
    pub(crate) name: String,
    pub(crate) element: Element,
    pub(crate) motion: Motion,
    /// Anchor and unit axis in coordinates of the link.
    pub(crate) at: DVec3,
    pub(crate) axis: DVec3,
    /// What the file calls the position in its place.
    pub(crate) reference: f64,
    /// Least and greatest position from the place of the file.
    pub(crate) limits: Option<[f64; 2]>,
    /// Its own springs and dampers, and those of actuators.
    pub(crate) springs: Vec<Spring>,
    /// Greatest forces of its actuators whose force a control gives. Infinite for one without a bound.
    pub(crate) motors: Vec<f64>,
    /// Greatest force of all its actuators together.
    pub(crate) effort: Option<f64>,
    pub(crate) armature: f64,
    pub(crate) friction: f64,
}

/// A spring with a damper. Those of a joint act side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spring {
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) target: f64,
    /// Greatest force. `None` for what is no actuator, infinite for one without a bound.
    pub(crate) most: Option<f64>,
}

/// A collider of a link.
#[derive(Clone, Debug)]
pub(crate) struct Geom {
    pub(crate) element: Element,
    pub(crate) pose: Pose,
    pub(crate) solid: Solid,
    pub(crate) mask: Mask,
    pub(crate) friction: Option<Friction>,
}

/// Two geoms meet if one has a bit of its type among those of the affinity of the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Mask {
    pub(crate) kind: u32,
    pub(crate) affinity: u32,
}

impl Mask {
    pub(crate) const ALL: Self = Self { kind: 1, affinity: 1 };

    pub(crate) fn meets(self, other: Self) -> bool {
        self.kind & other.affinity != 0 || other.kind & self.affinity != 0
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Friction {
    pub(crate) coefficient: f64,
    /// Whether contacts of two such geoms have no friction.
    pub(crate) is_smooth: bool,
}

/// A joint that closes a loop.
#[derive(Debug)]
pub(crate) struct Loop {
    pub(crate) name: String,
    pub(crate) element: Element,
    pub(crate) links: [usize; 2],
    /// In coordinates of the first link. `None` for a weld.
    pub(crate) ball_at: Option<DVec3>,
}
