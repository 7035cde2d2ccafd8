//! The rows of a frame for the device.

use glam::Mat3A;

use crate::rigid::frame::Frame;
use crate::rigid::frame::bodies::Bodies;
use crate::rigid::frame::contacts::{Block, COLOURS, Contacts, LEFT_OVER, Pair};
use crate::rigid::gpu::rows::{
    BELT, BlockRow, BodyRow, ConstantRow, ContactRow, ELASTIC, FIXED, FrameRow, FrameRows, OPENS, PairRow, PointRow, ROUND,
    SEAMS, WAITS,
};
use crate::rigid::gpu::shapes::collider_rows;
use crate::rigid::world::RigidWorld;

/// The rows of a world whose contacts are not known.
pub(crate) fn bodies_alone(world: &RigidWorld) -> FrameRows {
    let bodies = Bodies::load(world, 1.0);
    let mut contacts = Contacts::default();
    contacts.list_by_body(bodies.count(), &[]);
    Frame::new(world, bodies, contacts, 1.0).rows(1)
}

/// What does not change of the bodies of a world in a frame.
pub(crate) fn constants_alone(world: &RigidWorld) -> Vec<ConstantRow> {
    let bodies = Bodies::load(world, 1.0);
    (0..bodies.count()).map(|i| constant_row(world, &bodies, i)).collect()
}

fn constant_row(world: &RigidWorld, bodies: &Bodies, i: usize) -> ConstantRow {
    let (body, fixed) = (&world.bodies[i], &bodies.constants[i]);
    if !fixed.dynamic {
        return ConstantRow { axes: [0.0, 0.0, 0.0, 1.0], moments: [1.0; 3], ..ConstantRow::default() };
    }
    ConstantRow {
        axes: body.axes.to_array(),
        moments: body.moments.to_array(),
        width: body.width,
        acceleration: (world.gravity + body.inverse_mass * body.force).extend(f32::from(u8::from(fixed.sprung))).to_array(),
        torque: body.torque.extend(body.home as f32).to_array(),
    }
}

impl Frame<'_> {
    /// The rows of a frame.
    pub(crate) fn rows(&self, substeps: u32) -> FrameRows {
        let contacts = &self.contacts;
        let mut colours = [0; 20];
        colours[..COLOURS + 2].copy_from_slice(&contacts.colours);
        let count = self.bodies.count();
        let (colliders, hulls) = collider_rows(self.world);
        let entries = contacts.list.iter().map(|(block, second)| 2 * block + u32::from(*second));
        FrameRows {
            frame: FrameRow {
                gravity: self.world.gravity.to_array(),
                h: self.h,
                bodies: count as u32,
                blocks: contacts.blocks.len() as u32,
                left_over: contacts.colours[COLOURS],
                substeps,
                soft: FrameRow::softness_of_both(self.h),
                colours,
                ..FrameRow::of_periods(&self.world.periods)
            },
            bodies: (0..count).map(|i| self.body_row(i)).collect(),
            constants: (0..count).map(|i| constant_row(self.world, &self.bodies, i)).collect(),
            belts: self.world.colliders.iter().map(|collider| collider.surface_velocity.extend(0.0).to_array()).collect(),
            blocks: contacts.blocks.iter().map(block_row).collect(),
            pairs: contacts.pairs.iter().map(|pair| self.pair_row(pair)).collect(),
            points: contacts
                .points
                .iter()
                .map(|point| PointRow { on_a: point.on_a.to_array(), id: point.id, on_b: point.on_b.to_array(), unused: 0 })
                .collect(),
            contacts: (0..contacts.points.len()).map(|k| self.contact_row(k)).collect(),
            lists: contacts.lists.iter().copied().chain(entries).collect(),
            colliders,
            hulls,
        }
    }

    fn body_row(&self, i: usize) -> BodyRow {
        let (bodies, pose) = (&self.bodies, &self.bodies.poses[i]);
        let blocks = &self.contacts.blocks;
        let of_body = self.contacts.of_body(i).iter().map(|(block, _)| &blocks[*block as usize]);
        let shares = of_body.filter(|block| block.colour == LEFT_OVER).count();
        let (diagonal, beside) = parts(&bodies.masses[i].inverse_inertia);
        let (velocity, spin) = (bodies.motions[i].velocity.to_array(), bodies.motions[i].spin.to_array());
        BodyRow {
            position: pose.position.to_array(),
            clock: bodies.clocks[i],
            turn: pose.turn.to_array(),
            velocity,
            inverse_mass: bodies.masses[i].inverse_mass,
            spin,
            path: bodies.paths[i],
            diagonal,
            share: shares as f32,
            beside,
            margin: bodies.constants[i].margin,
            momentum: bodies.momenta[i].to_array(),
            radius: bodies.constants[i].radius,
            kicked_velocity: bodies.before[i].velocity.to_array(),
            stopped: f32::from(u8::from(bodies.stopped.contains(&(i as u32)))),
            kicked_spin: bodies.set[i].to_array(),
            unused: 0.0,
        }
    }

    fn pair_row(&self, pair: &Pair) -> PairRow {
        let moves = pair.colliders.iter().any(|k| self.world.colliders[*k as usize].surface_velocity != glam::Vec3::ZERO);
        let flag = |is_set: bool, flag: u32| if is_set { flag } else { 0 };
        let flags = flag(pair.opens, OPENS) | flag(pair.round, ROUND) | flag(moves, BELT);
        PairRow {
            normal: pair.normal.to_array(),
            friction: pair.friction,
            belt: pair.belt.to_array(),
            first: pair.first,
            info: u32::from(pair.count) | u32::from(pair.room) << 8 | flags,
            inner_normal: pair.inner_normal.to_array(),
            restitution: pair.restitution,
            colliders: pair.colliders,
            bodies: pair.colliders.map(|collider| self.world.colliders[collider as usize].body),
        }
    }

    fn contact_row(&self, k: usize) -> ContactRow {
        let (row, impulse) = (&self.contacts.rows[k], &self.contacts.impulses[k]);
        ContactRow {
            arm: row.arm_a.to_array(),
            gap: row.gap,
            normal: impulse.normal,
            tangent: impulse.tangent.to_array(),
            spare: row.spare,
        }
    }
}

fn block_row(block: &Block) -> BlockRow {
    BlockRow {
        bodies: block.bodies,
        first_pair: block.first_pair,
        pairs: block.pairs,
        first_point: block.first_point,
        info: block.points
            | u32::from(block.colour) << 16
            | if block.fixed { FIXED } else { 0 }
            | if block.elastic { ELASTIC } else { 0 }
            | if block.waits { WAITS } else { 0 }
            | if block.seams { SEAMS } else { 0 },
        time: block.time.to_bits(),
        unused: 0,
    }
}

/// The diagonal of a symmetric matrix, and xy, xz, yz.
fn parts(m: &Mat3A) -> ([f32; 3], [f32; 3]) {
    ([m.x_axis.x, m.y_axis.y, m.z_axis.z], [m.y_axis.x, m.z_axis.x, m.z_axis.y])
}
