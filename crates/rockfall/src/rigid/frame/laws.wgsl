// requires rigid/frame/rows.wgsl

// Forces of the program (docs/physics sections 4.14 and 11.9). They come on top of what `pull` has written, for all bodies with mass.
// `user_laws/forces.rs` puts the text of the laws in the place of `load_of_laws`.
//
// | array | numbers |
// |---|---|
// | `laws` | where the coordinates of the world begin (3); time at the start of the frame; parameters of the laws |
// | `ends`, `muscles` | those of `rigid/frame/springs.wgsl` |
// | `kicks` | `constants` |

@group(0) @binding(3) var<storage, read_write> kicks: array<vec4f>;
@group(0) @binding(40) var<storage, read> ends: array<u32>;
@group(0) @binding(41) var<storage, read_write> muscles: array<u32>;
@group(0) @binding(46) var<storage, read> laws: array<f32>;

const HEAD: u32 = 3u;

struct LawLoad {
    force: vec3f,
    torque: vec3f,
}

fn load_of_laws(position: vec3f, velocity: vec3f, spin: vec3f, mass: f32, radius: f32, time: f32) -> LawLoad { return LawLoad(vec3f(0.0), vec3f(0.0)); }

fn add_to_body(k: u32) {
    let body = ends[HEAD + 2u * k];
    let at = BODY_ROWS * body;
    let position = vec3f(laws[0], laws[1], laws[2]) + place_of(body);
    let motion = motion_of(body);
    // `pull` has counted this substep already.
    let time = laws[3] + f32(muscles[k] - 1u) * frame.h;
    let inverse = bodies[at + 2u].w;
    let load = load_of_laws(position, motion.velocity, motion.spin, 1.0 / inverse, bodies[at + 6u].w, time);
    let own = CONSTANT_ROWS * body;
    kicks[own + 2u] += vec4f(inverse * load.force, 0.0);
    kicks[own + 3u] += vec4f(load.torque, 0.0);
}

@compute @workgroup_size(THREADS)
fn add_laws(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k < ends[1] {
        add_to_body(k);
    }
}
