//! Points of bodies that are pulled (docs/physics section 11.15).

use glam::{DMat3, DQuat, DVec3};

use crate::rigid::frame::motions_of_joints;
use crate::rigid::joints::{Free, Joint};
use crate::rigid::world::{Body, RigidWorld};

/// Most bodies that count with the pulled one.
const MOST_BODIES: usize = 32;
/// Angular frequency of the spring, in rad/s, and the greatest angle in a frame.
const FREQUENCY: f64 = 10.0;
/// Rate at which the bodies lose their motion relative to the point, in 1/s.
const SWING_RATE: f64 = 4.5;
/// Greatest product of one of these rates and a frame.
const MOST_IN_FRAME: f64 = 0.5;
/// Greatest distance of the goal that counts: in radii of the body, and in gravities of acceleration.
const MOST_RADII: f64 = 20.0;
const MOST_GRAVITIES: f64 = 4.0;
/// Share of a row by which its bodies give way, so that rows that say the same can be solved.
const SLACK: f64 = 1e-9;
/// A limit is reached at this distance from it, in rad or units.
const NEAR: f32 = 0.01;

/// A force and a torque on a body in a frame.
pub(crate) type Load = (u32, [DVec3; 2]);

/// A body of the group, in `f64`.
struct Member {
    number: u32,
    turn: DQuat,
    inverse_mass: f64,
    inverse_inertia: DMat3,
    /// Acceleration and angular acceleration by the field and by all forces on the body alone.
    free: [DVec3; 2],
    load: [DVec3; 2],
}

/// A row of the group: the gradient along the coordinates of each member that it moves.
struct Row {
    gradient: Vec<(usize, [DVec3; 2])>,
    /// A limit, which pushes and does not pull.
    is_limit: bool,
}

/// What the rows of a group make of a force at the point.
struct System {
    /// How the point answers a force, and its acceleration without one.
    mobility: DMat3,
    free: DVec3,
    /// The impulses of the rows without a force, and those for a unit of it along each axis.
    rest: Vec<f64>,
    answers: [Vec<f64>; 3],
}

impl Member {
    fn answer(&self, [linear, angular]: [DVec3; 2]) -> [DVec3; 2] {
        [self.inverse_mass * linear, self.inverse_inertia * angular]
    }
}

fn dot([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> f64 {
    a.dot(c) + b.dot(d)
}

impl Row {
    /// The change of this row by an impulse of 1 along another one.
    fn by(&self, other: &Self, group: &[Member]) -> f64 {
        let shared = self.gradient.iter().flat_map(|own| other.gradient.iter().map(move |theirs| (own, theirs)));
        shared.filter(|((a, _), (b, _))| a == b).map(|((a, own), (_, theirs))| dot(*own, group[*a].answer(*theirs))).sum()
    }

    /// The acceleration along the row of bodies on which their own forces act.
    fn free(&self, group: &[Member]) -> f64 {
        self.gradient.iter().map(|(a, own)| dot(*own, group[*a].free)).sum()
    }
}

/// The forces on a body and on those that joints connect to it in a frame of `dt` seconds. They take the point at `place`, in coordinates
/// of the body, towards `goal`.
pub(crate) fn pull(world: &RigidWorld, (body, place): (u32, DVec3), goal: DVec3, dt: f64) -> Vec<Load> {
    let numbers = connected(world, body);
    let held = &world.bodies[body as usize];
    let turn = held.pose.turn.as_dquat().normalize();
    let (arm, spin) = (turn * place, held.spin.as_dvec3());
    let (point, velocity) = (held.pose.position.as_dvec3() + arm, held.velocity.as_dvec3() + spin.cross(arm));
    let rate = |wanted: f64| wanted.min(MOST_IN_FRAME / dt);
    let gravity = world.gravity.as_dvec3();
    let group: Vec<Member> =
        numbers.iter().map(|number| Member::new(world, *number, [gravity, velocity], rate(SWING_RATE))).collect();
    let frequency = rate(FREQUENCY);
    let farthest = MOST_RADII * f64::from(held.radius) + MOST_GRAVITIES * gravity.length() / frequency.powi(2);
    let apart = (goal - point).clamp_length_max(farthest);
    let wanted = frequency * frequency * apart - 2.0 * frequency * velocity;
    let all: f64 = group.iter().map(|member| member.inverse_mass.recip()).sum();
    let turning = spin.cross(spin.cross(arm));
    let mut rows = rows(world, &group);
    let force = loop {
        let system = System::new(&rows, &group, arm);
        let force = solve(system.mobility, wanted - system.free - turning, all.recip());
        // A limit from which the bodies go away does not count.
        match system.opening(&rows, force) {
            Some(row) => drop(rows.remove(row)),
            None => break force,
        }
    };
    let mut loads: Vec<Load> = group.iter().map(|member| (member.number, member.load)).collect();
    loads[0].1[0] += force;
    loads[0].1[1] += arm.cross(force);
    loads
}

/// The body and those with mass that joints connect to it, the nearest ones first.
fn connected(world: &RigidWorld, body: u32) -> Vec<u32> {
    let mut found = vec![body];
    let mut next = 0;
    while let Some(own) = found.get(next).copied() {
        next += 1;
        for (joint, _) in holding(world) {
            let [a, b] = joint.ends.map(|end| end.body);
            let other = if a == own { b } else { a };
            let is_new = (a == own || b == own) && world.bodies[other as usize].inverse_mass > 0.0 && !found.contains(&other);
            if is_new && found.len() < MOST_BODIES {
                found.push(other);
            }
        }
    }
    found
}

/// The joints that hold something, with their numbers.
fn holding(world: &RigidWorld) -> impl Iterator<Item = (&Joint, usize)> {
    let all = world.joints.list.iter().zip(&world.joints.states).zip(0..);
    all.filter(|((joint, state), _)| !state.broken && holds(joint)).map(|((joint, _), number)| (joint, number))
}

fn holds(joint: &Joint) -> bool {
    joint.kind.linear | joint.kind.angular != 0 || joint.kind.free == Free::Line && joint.drive.locked
}

/// What a joint holds: whether it is a rotation, and the axis of the joint frame; axis 3 is its line.
fn directions(joint: &Joint) -> Vec<(bool, usize)> {
    let axes = |bits: u8, turns: bool| (0..3).filter(move |axis| bits >> axis & 1 == 1).map(move |axis| (turns, axis));
    let line = (joint.kind.free == Free::Line && joint.drive.locked).then_some((false, 3));
    axes(joint.kind.linear, false).chain(axes(joint.kind.angular, true)).chain(line).collect()
}

impl Member {
    fn new(world: &RigidWorld, number: u32, [gravity, drift]: [DVec3; 2], rate: f64) -> Self {
        let Body { velocity, momentum, inverse_mass, force, torque, moments, axes, pose, .. } = &world.bodies[number as usize];
        let turn = pose.turn.as_dquat().normalize();
        let own = DMat3::from_quat(turn * axes.as_dquat());
        let inverse_inertia = own * DMat3::from_diagonal(moments.as_dvec3().recip()) * own.transpose();
        let inverse_mass = f64::from(*inverse_mass);
        let load = [-rate / inverse_mass * (velocity.as_dvec3() - drift), -rate * momentum.as_dvec3()];
        let mut member = Self { number, turn, inverse_mass, inverse_inertia, free: [DVec3::ZERO; 2], load };
        let [linear, angular] = member.answer([force.as_dvec3() + load[0], torque.as_dvec3() + load[1]]);
        member.free = [gravity + linear, angular];
        member
    }
}

/// The rows of the joints of a group and of the limits that they have reached. Joints to bodies that are left out of it have none.
fn rows(world: &RigidWorld, group: &[Member]) -> Vec<Row> {
    let place = |number: u32| group.iter().position(|member| member.number == number);
    let mut rows = Vec::new();
    let motions = motions_of_joints(world);
    for (joint, number) in holding(world) {
        let sides = joint.ends.map(|end| place(end.body));
        let leaves = |side: usize| sides[side].is_none() && world.bodies[joint.ends[side].body as usize].inverse_mass > 0.0;
        if sides == [None, None] || leaves(0) || leaves(1) {
            continue;
        }
        let poses = joint.ends.map(|end| world.bodies[end.body as usize].pose);
        let turns = [0, 1].map(|side| poses[side].turn.as_dquat().normalize());
        let reach = [0, 1].map(|side| turns[side] * joint.ends[side].place.as_dvec3());
        let between = poses[1].position.as_dvec3() - poses[0].position.as_dvec3();
        let axes = DMat3::from_quat(turns[0] * joint.ends[0].turn.as_dquat());
        let other = turns[1] * joint.ends[1].turn.as_dquat() * DVec3::X;
        let arms = [between + reach[1], reach[1]];
        let line = (arms[0] - reach[0]).try_normalize().unwrap_or(axes.x_axis);
        let held = directions(joint).into_iter().map(|(turns, axis)| {
            let along = if axis < 3 { axes.col(axis) } else { line };
            (turns, along, false)
        });
        let limits = reached(joint, motions[number].position, [axes.x_axis, other]);
        for (turns, along, is_limit) in held.chain(limits.into_iter().map(|(turns, along)| (turns, along, true))) {
            let of = |side: usize| {
                let signed = if side == 0 { -along } else { along };
                let gradient = if turns { [DVec3::ZERO, signed] } else { [signed, arms[side].cross(signed)] };
                sides[side].map(|member| (member, gradient))
            };
            rows.push(Row { gradient: [of(0), of(1)].into_iter().flatten().collect(), is_limit });
        }
    }
    rows
}

/// The limits that a joint has reached: whether they are rotations, and the directions away from them. `axes` are its axis in both bodies.
fn reached(joint: &Joint, position: f32, [own, other]: [DVec3; 2]) -> Vec<(bool, DVec3)> {
    let [low, high] = joint.drive.limits;
    let free = match joint.kind.free {
        Free::Turn => Some((true, (own + other) / (1.0 + own.dot(other)))).filter(|(_, axis)| axis.is_finite()),
        Free::Slide => Some((false, own)),
        Free::Line | Free::None => None,
    };
    let sides = [(position - low < NEAR, 1.0), (high - position < NEAR, -1.0)];
    let ends = free
        .into_iter()
        .flat_map(|(turns, axis)| sides.into_iter().filter(|(is_near, _)| *is_near).map(move |(_, sign)| (turns, sign * axis)));
    let angle = own.cross(other).length().atan2(own.dot(other)) as f32;
    let back = -own.cross(other).normalize_or_zero();
    let swing = (joint.drive.cone - angle < NEAR && back != DVec3::ZERO).then_some((true, back));
    ends.chain(swing).collect()
}

impl System {
    /// The point is at an arm from the centre of the first member.
    fn new(rows: &[Row], group: &[Member], arm: DVec3) -> Self {
        let point = DVec3::AXES.map(|axis| Row { gradient: vec![(0, [axis, arm.cross(axis)])], is_limit: false });
        let lower = |i: usize| (0..=i).map(|j| rows[i].by(&rows[j], group)).collect();
        let mut matrix: Vec<Vec<f64>> = (0..rows.len()).map(lower).collect();
        for (i, row) in matrix.iter_mut().enumerate() {
            row[i] *= 1.0 + SLACK;
        }
        factor(&mut matrix);
        let solved = |mut values: Vec<f64>| {
            substitute(&matrix, &mut values);
            values
        };
        let held: Vec<[f64; 3]> = rows.iter().map(|row| point.each_ref().map(|point| row.by(point, group))).collect();
        let answers = [0, 1, 2].map(|k| solved(held.iter().map(|row| row[k]).collect()));
        let rest = solved(rows.iter().map(|row| row.free(group)).collect());
        let lost = |k: usize, impulses: &[f64]| held.iter().zip(impulses).map(|(row, impulse)| row[k] * impulse).sum::<f64>();
        let element = |k: usize, l: usize| point[k].by(&point[l], group) - lost(k, &answers[l]);
        let mobility = [0, 1, 2].map(|l| DVec3::from_array([0, 1, 2].map(|k| element(k, l))));
        let free = DVec3::from_array([0, 1, 2].map(|k| point[k].free(group) - lost(k, &rest)));
        Self { mobility: DMat3::from_cols(mobility[0], mobility[1], mobility[2]), free, rest, answers }
    }

    /// The limit that would pull most, if there is one.
    fn opening(&self, rows: &[Row], force: DVec3) -> Option<usize> {
        let impulse = |row: usize| -self.rest[row] - (0..3).map(|k| self.answers[k][row] * force[k]).sum::<f64>();
        let limits = rows.iter().enumerate().filter(|(_, row)| row.is_limit).map(|(row, _)| (row, impulse(row)));
        limits.filter(|(_, impulse)| *impulse < 0.0).min_by(|one, other| one.1.total_cmp(&other.1)).map(|(row, _)| row)
    }
}

/// Turns the lower half of a symmetric positive matrix into its factor of Cholesky.
fn factor(matrix: &mut [Vec<f64>]) {
    for i in 0..matrix.len() {
        let (before, rest) = matrix.split_at_mut(i);
        let own = &mut rest[0];
        for j in 0..i {
            let sum: f64 = (0..j).map(|k| own[k] * before[j][k]).sum();
            own[j] = (own[j] - sum) / before[j][j];
        }
        let whole = own[i];
        let left = whole - own[..i].iter().map(|element| element * element).sum::<f64>();
        own[i] = left.max(SLACK * whole).sqrt();
    }
}

/// Solves with a factor of [`factor`].
fn substitute(factor: &[Vec<f64>], values: &mut [f64]) {
    for i in 0..values.len() {
        let sum: f64 = (0..i).map(|k| factor[i][k] * values[k]).sum();
        values[i] = (values[i] - sum) / factor[i][i];
    }
    for i in (0..values.len()).rev() {
        let sum: f64 = (i + 1..values.len()).map(|k| factor[k][i] * values[k]).sum();
        values[i] = (values[i] - sum) / factor[i][i];
    }
}

/// The force with this acceleration by a symmetric mobility, of which no eigenvalue counts as less than `least`.
fn solve(mobility: DMat3, acceleration: DVec3, least: f64) -> DVec3 {
    let at = |i: usize, j: usize| 0.5 * (mobility.col(i)[j] + mobility.col(j)[i]);
    let (values, vectors) = crate::eigen::eigen([0, 1, 2].map(|i| [0, 1, 2].map(|j| at(i, j))));
    (0..3)
        .map(|k| {
            let axis = DVec3::from_array([0, 1, 2].map(|row| vectors[row][k]));
            axis.dot(acceleration) / values[k].max(least) * axis
        })
        .sum()
}
