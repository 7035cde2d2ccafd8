//! Joints on a device: their rows, their states, the calls of their colours, and the pairs of bodies that they keep apart
//! (`rigid/frame/joint.wgsl`, `rigid/broad/apart.wgsl`).

use bytemuck::cast_slice;
use glam::Vec3;

use crate::rigid::gpu::arrays::Arrays;
use crate::rigid::gpu::joint_groups::Groups;
use crate::rigid::gpu::kernels::{
    APART, CLOSE_JOINTS, JOINT_ORDER, JOINT_STATES, JOINTS, OPEN_JOINTS, PUSH_GROUPS, PUSH_JOINTS, PUSH_JOINTS_AGAIN,
    RELAX_GROUPS, RELAX_JOINTS, RELAX_JOINTS_AGAIN, WARM_GROUPS, WARM_JOINTS,
};
use crate::rigid::gpu::{CALL, Part, calls};
use crate::rigid::joints::{Drive, Free, Joint, JointImpulses, JointState, Joints};

/// Flags of a joint, after the three bits of its linear rows and those of its angular ones.
const TURNS: u32 = 1 << 6;
const SLIDES: u32 = 1 << 7;
const LINE: u32 = 1 << 8;
const LOWER: u32 = 1 << 9;
const UPPER: u32 = 1 << 10;
const CONE: u32 = 1 << 11;
const LOCKED: u32 = 1 << 12;
const SPRUNG: u32 = 1 << 13;
const DRIVEN: u32 = 1 << 14;

/// Stands for an infinite force.
const ENDLESS: f32 = 1e30;

/// What a device has of a joint.
type JointRow = [[u32; 4]; 9];
type StateRow = [[f32; 4]; 7];

/// What the host keeps of the joints on a device.
#[derive(Clone, Debug, Default)]
pub(super) struct OnDevice {
    count: u32,
    /// First entry of each colour in the order, and the end.
    colours: Vec<u32>,
    /// Offset of the call of all joints. Those of the colours follow, or the one of the groups.
    first_call: u32,
    /// How many workgroups have whole mechanisms; `None` where each colour is a dispatch.
    groups: Option<u32>,
    /// Pairs of bodies that do not collide, each with its joint.
    apart: Vec<([u32; 2], u32)>,
    bodies: usize,
    /// Of each joint the frequency of its rows times the substep.
    frequencies: Vec<f32>,
    /// The states at the start of the frame.
    backup: Option<wgpu::Buffer>,
}

impl OnDevice {
    /// Uploads the joints of a world with these bodies, each with whether it has mass.
    pub(super) fn new(arrays: &mut Arrays, joints: &Joints, has_mass: &[bool]) -> Self {
        let mut this = Self { bodies: has_mass.len(), apart: joints.apart(), ..Self::default() };
        // Room for all pairs: joints may be whole again in a state that is put.
        arrays.upload(APART, cast_slice(&this.apart_words(&[])));
        if joints.is_empty() {
            return this;
        }
        this.part(arrays, &joints.states);
        (this.count, this.colours) = (joints.list.len() as u32, joints.colours.clone());
        let mut blocks = calls();
        this.first_call = blocks.len() as u32;
        let groups = arrays.gpu.merges.then(|| Groups::of(joints, has_mass)).flatten();
        this.groups = groups.as_ref().map(|groups| groups.groups);
        let first = groups.as_ref().map_or(0, Groups::first);
        let mut starts = vec![[first, first + this.count]];
        match &groups {
            Some(groups) => starts.push([groups.groups, groups.colours]),
            None => starts.extend(this.colours.windows(2).map(|ends| [ends[0], ends[1]])),
        }
        for call in starts {
            let end = blocks.len();
            blocks.resize(end + CALL as usize, 0);
            blocks[end..end + 8].copy_from_slice(cast_slice(&call));
        }
        arrays.upload_uniform(1, &blocks);
        this.frequencies.clone_from(&joints.frequencies);
        arrays.upload(JOINTS, cast_slice(&this.rows_of(&joints.list)));
        arrays.upload(JOINT_ORDER, cast_slice(groups.as_ref().map_or(&joints.order, |groups| &groups.words)));
        arrays.upload(JOINT_STATES, cast_slice(&state_rows(&joints.states)));
        this.backup = Some(arrays.gpu.storage(arrays.get(JOINT_STATES).size()));
        this
    }

    /// Whether workgroups have whole mechanisms.
    pub(super) fn is_grouped(&self) -> bool {
        self.groups.is_some()
    }

    /// Takes over the drives of the next frame. The joints are those of the start.
    pub(super) fn set_drives(&self, arrays: &Arrays, joints: &[Joint]) {
        if self.count > 0 {
            arrays.gpu.queue.write_buffer(arrays.get(JOINTS), 0, cast_slice(&self.rows_of(joints)));
        }
    }

    /// Takes over the states of the joints of a world.
    pub(super) fn put(&self, arrays: &Arrays, states: &[JointState]) {
        if self.count > 0 {
            arrays.gpu.queue.write_buffer(arrays.get(JOINT_STATES), 0, cast_slice(&state_rows(states)));
            self.part(arrays, states);
        }
    }

    /// Reads the states.
    ///
    /// # Errors
    /// What the device says if it is lost.
    pub(super) fn read(&self, arrays: &Arrays) -> Result<Vec<JointState>, String> {
        if self.count == 0 {
            return Ok(Vec::new());
        }
        Ok(arrays.read(JOINT_STATES, self.count)?.iter().map(state_of).collect())
    }

    /// Lets the bodies of broken joints collide again.
    ///
    /// # Errors
    /// What the device says if it is lost.
    pub(super) fn release(&self, arrays: &Arrays) -> Result<(), String> {
        if !self.apart.is_empty() {
            self.part(arrays, &self.read(arrays)?);
        }
        Ok(())
    }

    /// Adds a copy of the states at the start of a frame.
    pub(super) fn save(&self, arrays: &Arrays, encoder: &mut wgpu::CommandEncoder) {
        if let Some(backup) = &self.backup {
            encoder.copy_buffer_to_buffer(arrays.get(JOINT_STATES), 0, backup, 0, backup.size());
        }
    }

    /// Goes back to the states at the start of the frame.
    pub(super) fn restore(&self, arrays: &Arrays, encoder: &mut wgpu::CommandEncoder) {
        if let Some(backup) = &self.backup {
            encoder.copy_buffer_to_buffer(backup, 0, arrays.get(JOINT_STATES), 0, backup.size());
        }
    }

    /// Adds what the joints do in a part of a frame.
    pub(super) fn encode(&self, arrays: &Arrays, pass: &mut wgpu::ComputePass<'_>, part: Part) {
        let (of_groups, stages) = match part {
            Part::Load => return arrays.dispatch(pass, OPEN_JOINTS, self.count, self.first_call),
            Part::Settle => return arrays.dispatch(pass, CLOSE_JOINTS, self.count, self.first_call),
            Part::Kick => (WARM_GROUPS, &[WARM_JOINTS][..]),
            Part::Biased => (PUSH_GROUPS, &[PUSH_JOINTS, PUSH_JOINTS_AGAIN][..]),
            Part::Relax => (RELAX_GROUPS, &[RELAX_JOINTS, RELAX_JOINTS_AGAIN][..]),
            _ => return,
        };
        if let Some(groups) = self.groups {
            return arrays.dispatch_groups(pass, of_groups, groups, self.first_call + CALL);
        }
        let count = self.colours.len().saturating_sub(1);
        for (round, stage) in stages.iter().enumerate() {
            // There and back again; the relax pass begins at the end.
            let is_back = (round == 0) == (part == Part::Relax);
            for k in 0..count {
                let colour = if is_back { count - 1 - k } else { k };
                let size = self.colours[colour + 1] - self.colours[colour];
                arrays.dispatch(pass, *stage, size, self.first_call + CALL * (colour as u32 + 1));
            }
        }
    }

    fn rows_of(&self, joints: &[Joint]) -> Vec<JointRow> {
        joints.iter().zip(&self.frequencies).map(|(joint, frequency)| row_of(joint, *frequency)).collect()
    }

    fn part(&self, arrays: &Arrays, states: &[JointState]) {
        arrays.gpu.queue.write_buffer(arrays.get(APART), 0, cast_slice(&self.apart_words(states)));
    }

    /// The words of `apart`: 0 without such pairs. Otherwise the number of bodies; the first entry of each body, and the end; then the
    /// partners of each body in ascending order.
    fn apart_words(&self, states: &[JointState]) -> Vec<u32> {
        let holds = |joint: u32| !states.get(joint as usize).is_some_and(|state| state.broken);
        let both = self.apart.iter().filter(|(_, joint)| holds(*joint)).flat_map(|([a, b], _)| [[*a, *b], [*b, *a]]);
        let mut pairs: Vec<[u32; 2]> = both.collect();
        pairs.sort_unstable();
        pairs.dedup();
        if pairs.is_empty() {
            return vec![0];
        }
        let head = self.bodies as u32 + 2;
        let start = |body: u32| head + pairs.partition_point(|pair| pair[0] < body) as u32;
        let starts = (0..=self.bodies as u32).map(start);
        std::iter::once(self.bodies as u32).chain(starts).chain(pairs.iter().map(|pair| pair[1])).collect()
    }
}

fn flags_of(joint: &Joint) -> u32 {
    let Joint { kind, drive, .. } = joint;
    let flag = |is_set: bool, flag: u32| if is_set { flag } else { 0 };
    let is_free = kind.free != Free::None;
    let acts = flag(drive.limits[0] > f32::NEG_INFINITY, LOWER)
        | flag(drive.limits[1] < f32::INFINITY, UPPER)
        | flag(drive.locked, LOCKED)
        | flag(drive.acts(), SPRUNG);
    let free = match kind.free {
        Free::None => 0,
        Free::Turn => TURNS,
        Free::Slide => SLIDES,
        Free::Line => LINE,
    };
    let is_driven = is_free && (acts != 0 || drive.motor_limit > 0.0 || drive.friction > 0.0);
    u32::from(kind.linear)
        | u32::from(kind.angular) << 3
        | free
        | flag(is_free, acts)
        | flag(drive.cone < f32::INFINITY, CONE)
        | flag(is_driven, DRIVEN)
}

/// The middle of the limits, about which angles are counted; 0 without two limits.
fn middle(limits: [f32; 2]) -> f32 {
    let [least, most] = limits;
    if least.is_finite() && most.is_finite() { 0.5 * (least + most) } else { 0.0 }
}

fn row_of(joint: &Joint, frequency: f32) -> JointRow {
    let row = |vector: Vec3, last: f32| vector.extend(last).to_array();
    let [a, b] = joint.ends;
    let Drive { limits, cone, target, stiffness, damping, spring_limit, speed, motor_limit, friction, .. } = joint.drive;
    let Drive { effort, drag, armature, .. } = joint.drive;
    let finite = |force: f32| force.clamp(-ENDLESS, ENDLESS);
    // Torques and forces of an axis that is not there.
    let [motor_limit, friction] = if joint.kind.free == Free::None { [0.0; 2] } else { [motor_limit, friction].map(finite) };
    let numbers = |row: [f32; 4]| row.map(f32::to_bits);
    [
        numbers(row(a.place, finite(cone))),
        numbers(a.turn.to_array()),
        numbers(row(b.place, target)),
        numbers(b.turn.to_array()),
        [a.body, b.body, flags_of(joint), frequency.to_bits()],
        numbers([finite(limits[0]), finite(limits[1]), middle(limits), stiffness]),
        numbers([damping, finite(spring_limit), speed, motor_limit]),
        numbers([friction, joint.strength[0].min(f32::MAX), joint.strength[1].min(f32::MAX), 0.0]),
        numbers([effort, drag, armature, 0.0]),
    ]
}

fn state_rows(states: &[JointState]) -> Vec<StateRow> {
    let row = |state: &JointState| {
        let mut rows = StateRow::default();
        rows.as_flattened_mut().iter_mut().zip(state.impulses.to_array()).for_each(|(own, number)| *own = number);
        rows[4] = state.force.extend(f32::from(u8::from(state.broken))).to_array();
        rows[5] = state.torque.extend(0.0).to_array();
        rows
    };
    states.iter().map(row).collect()
}

fn state_of(rows: &StateRow) -> JointState {
    let [impulses @ .., [x, y, z, broken], [u, v, w, _], _] = *rows;
    let mut all = [0.0; JointImpulses::COUNT];
    all.iter_mut().zip(impulses.as_flattened()).for_each(|(own, number)| *own = *number);
    let (force, torque) = (Vec3::new(x, y, z), Vec3::new(u, v, w));
    JointState { impulses: JointImpulses::from_array(all), force, torque, broken: broken != 0.0, ..JointState::default() }
}
