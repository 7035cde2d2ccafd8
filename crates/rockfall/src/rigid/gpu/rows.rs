//! Rows of the arrays on the device. `rigid/frame/rows.wgsl` has the same rows.

use bytemuck::{Pod, Zeroable};

use crate::rigid::common::FREQUENCY;
use crate::rigid::gpu::shapes::ColliderRow;
use crate::rigid::periods::Periods;
use crate::rigid::world::Body;

/// A block has one side without mass.
pub(crate) const FIXED: u32 = 1 << 24;
/// A block has no rows in this substep.
pub(crate) const WAITS: u32 = 1 << 26;
/// A pair of a block has e > 0.
pub(crate) const ELASTIC: u32 = 1 << 27;
/// Balls of a block may touch several static shapes.
pub(crate) const SEAMS: u32 = 1 << 28;
/// The first point of a pair opens a chunk.
pub(crate) const OPENS: u32 = 1 << 16;
/// The points of a pair are found anew at every refresh.
pub(crate) const ROUND: u32 = 1 << 17;
/// A surface of a pair has a velocity of its own.
pub(crate) const BELT: u32 = 1 << 18;

/// The state of a body.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct BodyRow {
    pub(crate) position: [f32; 3],
    pub(crate) clock: f32,
    pub(crate) turn: [f32; 4],
    pub(crate) velocity: [f32; 3],
    /// 0 without mass.
    pub(crate) inverse_mass: f32,
    pub(crate) spin: [f32; 3],
    /// Length of the path of the frame.
    pub(crate) path: f32,
    /// Inverse of the inertia: xx, yy, zz.
    pub(crate) diagonal: [f32; 3],
    /// The left-over blocks of the body.
    pub(crate) share: f32,
    /// Inverse of the inertia: xy, xz, yz.
    pub(crate) beside: [f32; 3],
    pub(crate) margin: f32,
    pub(crate) momentum: [f32; 3],
    pub(crate) radius: f32,
    /// The velocity after the kick.
    pub(crate) kicked_velocity: [f32; 3],
    /// 1 if the state has stopped being finite.
    pub(crate) stopped: f32,
    /// The spin that belongs to the momentum; after the kick, that of the kick.
    pub(crate) kicked_spin: [f32; 3],
    pub(crate) unused: f32,
}

impl BodyRow {
    /// A body without mass at the start of a frame.
    pub(crate) fn without_mass(body: &Body) -> Self {
        let (velocity, spin) = (body.velocity.to_array(), body.spin.to_array());
        Self {
            position: body.pose.position.to_array(),
            turn: body.pose.turn.to_array(),
            velocity,
            spin,
            momentum: body.momentum.to_array(),
            radius: body.radius,
            kicked_velocity: velocity,
            kicked_spin: spin,
            ..Self::default()
        }
    }
}

/// What does not change in a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct ConstantRow {
    pub(crate) axes: [f32; 4],
    pub(crate) moments: [f32; 3],
    pub(crate) width: f32,
    /// g + (F + F_s)/m; 1 if springs or joints end at the body.
    pub(crate) acceleration: [f32; 4],
    /// The torque; the home of the body.
    pub(crate) torque: [f32; 4],
}

/// All contacts of two bodies.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct BlockRow {
    pub(crate) bodies: [u32; 2],
    pub(crate) first_pair: u32,
    pub(crate) pairs: u32,
    pub(crate) first_point: u32,
    /// Room for points, colour << 16, flags.
    pub(crate) info: u32,
    /// Bits of what is left of the substep, in s.
    pub(crate) time: u32,
    pub(crate) unused: u32,
}

/// One manifold.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct PairRow {
    pub(crate) normal: [f32; 3],
    pub(crate) friction: f32,
    /// Velocity of the surface of b less that of a, along the tangents.
    pub(crate) belt: [f32; 2],
    pub(crate) first: u32,
    /// Points, room << 8, flags.
    pub(crate) info: u32,
    /// The normal in coordinates of body a.
    pub(crate) inner_normal: [f32; 3],
    pub(crate) restitution: f32,
    pub(crate) colliders: [u32; 2],
    pub(crate) bodies: [u32; 2],
}

/// The places of a contact point on both bodies, in coordinates of the bodies.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct PointRow {
    pub(crate) on_a: [f32; 3],
    pub(crate) id: u32,
    pub(crate) on_b: [f32; 3],
    pub(crate) unused: u32,
}

/// What the passes read and write of a contact point.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct ContactRow {
    /// The common point from the centre of body a.
    pub(crate) arm: [f32; 3],
    pub(crate) gap: f32,
    pub(crate) normal: f32,
    pub(crate) tangent: [f32; 2],
    /// kappa.
    pub(crate) spare: f32,
}

/// The uniform block of a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct FrameRow {
    pub(crate) gravity: [f32; 3],
    pub(crate) h: f32,
    pub(crate) bodies: u32,
    pub(crate) blocks: u32,
    /// First left-over block.
    pub(crate) left_over: u32,
    pub(crate) substeps: u32,
    /// `m_s`, r, `i_s` of blocks with two masses, and of fixed ones.
    pub(crate) soft: [[f32; 4]; 2],
    /// First block of each colour, of the left-over ones, and their end.
    pub(crate) colours: [u32; 20],
    /// Periods, and 1 over them; 0 along axes that are not periodic.
    pub(crate) period: [f32; 4],
    pub(crate) per_period: [f32; 4],
    /// The lower corner of the periodic box.
    pub(crate) box_start: [f32; 4],
}

/// All arrays of a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct FrameRows {
    pub(crate) frame: FrameRow,
    pub(crate) bodies: Vec<BodyRow>,
    pub(crate) constants: Vec<ConstantRow>,
    /// Velocities of the surfaces of the colliders.
    pub(crate) belts: Vec<[f32; 4]>,
    pub(crate) blocks: Vec<BlockRow>,
    pub(crate) pairs: Vec<PairRow>,
    pub(crate) points: Vec<PointRow>,
    pub(crate) contacts: Vec<ContactRow>,
    /// First entry of each body, their end, and the entries: block * 2, + 1 if the body is b.
    pub(crate) lists: Vec<u32>,
    pub(crate) colliders: Vec<ColliderRow>,
    pub(crate) hulls: Vec<[u32; 4]>,
}

impl FrameRow {
    /// A row that knows the periods alone.
    pub(crate) fn of_periods(periods: &Periods) -> Self {
        let [period, per_period, box_start] =
            [periods.lengths, periods.inverse(), periods.least].map(|vector| vector.extend(0.0).to_array());
        Self { period, per_period, box_start, ..Self::default() }
    }

    /// The softness of blocks with two masses, and of fixed ones, which are twice as stiff.
    pub(crate) fn softness_of_both(h: f32) -> [[f32; 4]; 2] {
        [FREQUENCY, 2.0 * FREQUENCY].map(|frequency| Self::softness(frequency, h))
    }

    /// `m_s`, r and `i_s` for a frequency times the substep (docs/physics section 11.8).
    fn softness(frequency_h: f32, h: f32) -> [f32; 4] {
        const DAMPING: f32 = 10.0;
        let wh = 2.0 * std::f32::consts::PI * frequency_h;
        let a1 = 2.0 * DAMPING + wh;
        let a2 = wh * a1;
        let a3 = 1.0 / (1.0 + a2);
        let ms = a2 * a3;
        [ms, ms * (wh / h) / a1, a3, 0.0]
    }
}

/// Bytes of the rows in `rigid/frame/rows.wgsl`.
const _: () = {
    assert!(size_of::<BodyRow>() == 9 * 16);
    assert!(size_of::<ConstantRow>() == 4 * 16);
    assert!(size_of::<BlockRow>() == 2 * 16);
    assert!(size_of::<PairRow>() == 4 * 16);
    assert!(size_of::<PointRow>() == 2 * 16);
    assert!(size_of::<ContactRow>() == 2 * 16);
    assert!(size_of::<FrameRow>() == 12 * 16);
};
