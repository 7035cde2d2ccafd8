// requires model/step.wgsl physics/sine.wgsl

@group(0) @binding(2) var<storage, read> contributions: array<vec2f>;
@group(0) @binding(3) var<storage, read_write> servos: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> poses: array<vec4f>;
@group(0) @binding(5) var<storage, read> status: Status;

// Vectors of the record of a servo (model/servo.rs).
const SERVO_ROWS: u32 = 4u;
// Partial sums of the loads of a servo, one for each thread.
const SERVO_SUMS: u32 = 256u;
// Pass at the end of a step.
const SERVO_END: u32 = 1u;
// Part of the error of the force that is corrected within a step.
const GAIN: f32 = 0.25;

var<workgroup> sums: array<vec2f, SERVO_SUMS>;

// The same number, hidden from the compiler, which would compute the rounding errors of sums as 0.
fn opaque(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ pass_.zero);
}

// A displacement and its low part, moved on.
fn moved_on(place: vec2f, by: f32) -> vec2f {
    let sum = opaque(place.x + by);
    let share_of_way = opaque(sum - place.x);
    let share_of_place = opaque(sum - share_of_way);
    let low = opaque(opaque(place.x - share_of_place) + opaque(by - share_of_way)) + place.y;
    let high = opaque(sum + low);
    // Beyond the range of f32, it stays.
    return select(place, vec2f(high, low - opaque(high - sum)), abs(high) <= 3.4e38);
}

// The angle less whole turns, in [-pi, pi]. 2 pi is the sum of three numbers. Products with the first two are exact for up to 2^15 turns.
fn within_turn(angle: vec2f) -> f32 {
    let turns = round(angle.x * 0.15915494);
    let rest = opaque(opaque(angle.x - turns * 6.28125) - turns * 0.0019340515136719);
    return rest - turns * 1.2556658146e-6 + angle.y;
}

// Writes the pose of a body at a displacement.
fn put_pose(row: u32, servo: u32, place: vec2f, rate: f32) {
    let axis = servos[servo + 1u].xyz;
    let at = (row * step.bodies + u32(servos[servo + 2u].w) - 1u) * (POSE_FLOATS / 4u);
    for (var k = 0u; k < POSE_FLOATS / 4u; k++) {
        poses[at + k] = vec4f(0.0);
    }
    if servos[servo + 3u].x == 0.0 {
        poses[at + 4u] = vec4f(place.x * axis, 0.0);
        poses[at + 5u] = vec4f(rate * axis, 0.0);
        return;
    }
    // Rodrigues' formula for the rotation less 1, by the half of the angle.
    let of_half = sine_cosine(0.5 * within_turn(place));
    let s = 2.0 * of_half.x * of_half.y;
    let c = 2.0 * of_half.x * of_half.x;
    poses[at] = vec4f(c * (axis.x * axis.x - 1.0), c * axis.x * axis.y - s * axis.z, c * axis.x * axis.z + s * axis.y, 0.0);
    poses[at + 1u] = vec4f(c * axis.y * axis.x + s * axis.z, c * (axis.y * axis.y - 1.0), c * axis.y * axis.z - s * axis.x, 0.0);
    poses[at + 2u] = vec4f(c * axis.z * axis.x - s * axis.y, c * axis.z * axis.y + s * axis.x, c * (axis.z * axis.z - 1.0), 0.0);
    poses[at + 3u] = vec4f(servos[servo + 2u].xyz, 0.0);
    poses[at + 7u] = vec4f(rate * axis, 0.0);
}

// Writes the pose of a servo at the start of the step, in its middle or at its end.
fn put_pose_of_step(servo: u32, half_steps: u32) {
    let row = 2u * (status.steps - step.pose_step) + half_steps;
    if row < step.pose_rows {
        let now = servos[servo];
        put_pose(row, servo, moved_on(now.xy, opaque(now.z * (0.5 * f32(half_steps) * step.dt))), now.z);
    }
}

// The rate of the next step.
fn rate_for(target_force: f32, load: vec2f, most: f32) -> f32 {
    let error = target_force - load.x;
    var rate = sign(error) * most;
    if load.y > 0.0 {
        rate = GAIN * error / (load.y * step.dt);
    }
    rate = clamp(rate, -most, most);
    // A rate that is not a number is not inside of the bounds, whatever clamp makes of it.
    let is_number = (abs(error) <= 3.4e38) & (abs(load.y) <= 3.4e38);
    return select(0.0, rate, is_number & (abs(rate) <= most));
}

// A workgroup per motion. That number k moves servo k, if there are so many.
@compute @workgroup_size(256)
fn drive_servos(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let number = linear_group(group, groups);
    let is_one = number < u32(servos[3].y);
    let servo = number * SERVO_ROWS;
    if pass_.index != SERVO_END {
        if is_one & (local < 3u) {
            put_pose_of_step(servo, local);
        }
        return;
    }
    let movers = select(0u, step.spheres + step.rods, is_one);
    var sum = vec2f(0.0);
    for (var mover = local; mover < movers; mover += SERVO_SUMS) {
        sum += contributions[number * movers + mover];
    }
    sums[local] = sum;
    for (var half = SERVO_SUMS / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if local < half {
            sums[local] += sums[local + half];
        }
    }
    if is_one & (local == 0u) & (status.rejected == 0u) {
        let now = servos[servo];
        let place = moved_on(now.xy, opaque(now.z * step.dt));
        servos[servo] = vec4f(place, rate_for(servos[servo + 1u].w, sums[0], now.w), now.w);
    }
}
