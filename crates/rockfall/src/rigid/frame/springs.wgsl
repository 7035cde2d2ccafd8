// requires rigid/frame/rows.wgsl physics/quaternion.wgsl physics/sine.wgsl physics/product.wgsl

// Forces of springs, tethers and muscles (docs/physics section 11.9). `rigid/gpu/springs.rs` makes the arrays.
//
// | array | rows or words |
// |---|---|
// | `springs` | rows: of each spring: place at a, stiffness; place at b, damping; belt, rest length; a, b, muscle. Then of each body of `ends`: g + F/m; torque |
// | `ends` | springs, bodies, muscles; of each body its number and its first entry; 0 and the end; then the entries: spring * 2, + 1 for the end B |
// | `muscles` | of each body of `ends`: substeps that are done; then of each muscle: amplitude, phase at the start of the frame, its change in a substep |
// | `kicks` | `constants` |

@group(0) @binding(3) var<storage, read_write> kicks: array<vec4f>;
@group(0) @binding(39) var<storage, read> springs: array<vec4u>;
@group(0) @binding(40) var<storage, read> ends: array<u32>;
@group(0) @binding(41) var<storage, read_write> muscles: array<u32>;

const SPRING_ROWS: u32 = 4u;
const HEAD: u32 = 3u;
const MUSCLE_WORDS: u32 = 5u;
const NO_MUSCLE: u32 = 0xffffffffu;

// Force on the end A, and the arms of both ends.
struct Pull {
    force: vec3f,
    arm_a: vec3f,
    arm_b: vec3f,
}

fn sine_of_muscle(at: u32, substep: u32) -> f32 {
    let change = muscles[at + 3u];
    let low = change * substep;
    let carry = u32(low + muscles[at + 1u] < low);
    let high = muscles[at + 4u] * substep + upper_product(change, substep);
    // 2 pi / 2^32.
    return sine_cosine(f32(bitcast<i32>(muscles[at + 2u] + high + carry)) * 1.4629180792671596e-9).x;
}

fn rest_length(length: f32, muscle: u32, substep: u32) -> f32 {
    if muscle == NO_MUSCLE {
        return length;
    }
    let at = ends[1] + MUSCLE_WORDS * muscle;
    return length * (1.0 + bitcast<f32>(muscles[at]) * sine_of_muscle(at, substep));
}

fn speed_at(body: u32, arm: vec3f) -> vec3f {
    let motion = motion_of(body);
    return motion.velocity + cross(motion.spin, arm);
}

fn pull_of(spring: u32, substep: u32) -> Pull {
    let at = SPRING_ROWS * spring;
    let sides = springs[at + 3u];
    let one = bitcast<vec4f>(springs[at]);
    let two = bitcast<vec4f>(springs[at + 1u]);
    let rest = bitcast<vec4f>(springs[at + 2u]);
    let arm_a = turned_vector(turn_of(sides.x), one.xyz);
    let arm_b = turned_vector(turn_of(sides.y), two.xyz);
    let way = (place_of(sides.y) - place_of(sides.x)) + (arm_b - arm_a);
    let apart = way + to_nearest(way);
    let distance = length(apart);
    if distance == 0.0 {
        return Pull(vec3f(0.0), arm_a, arm_b);
    }
    let along = apart / distance;
    let speed = dot(speed_at(sides.y, arm_b) - speed_at(sides.x, arm_a) + rest.xyz, along);
    let force = one.w * (distance - rest_length(rest.w, sides.z, substep)) + two.w * speed;
    return Pull(force * along, arm_a, arm_b);
}

// The force and the torque of the springs of a body.
fn pull_body(k: u32) {
    let body = ends[HEAD + 2u * k];
    let substep = muscles[k];
    var force = vec3f(0.0);
    var torque = vec3f(0.0);
    for (var entry = ends[HEAD + 2u * k + 1u]; entry < ends[HEAD + 2u * k + 3u]; entry++) {
        let own = pull_of(ends[entry] >> 1u, substep);
        if (ends[entry] & 1u) == 0u {
            force += own.force;
            torque += cross(own.arm_a, own.force);
        } else {
            force -= own.force;
            torque -= cross(own.arm_b, own.force);
        }
    }
    let base = SPRING_ROWS * ends[0] + 2u * k;
    let at = CONSTANT_ROWS * body;
    kicks[at + 2u] = vec4f(bitcast<vec4f>(springs[base]).xyz + bodies[BODY_ROWS * body + 2u].w * force, kicks[at + 2u].w);
    kicks[at + 3u] = vec4f(bitcast<vec4f>(springs[base + 1u]).xyz + torque, kicks[at + 3u].w);
    muscles[k] = substep + 1u;
}

@compute @workgroup_size(THREADS)
fn pull(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k < ends[1] {
        pull_body(k);
    }
}
