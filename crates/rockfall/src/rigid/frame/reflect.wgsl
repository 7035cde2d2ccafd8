// requires rigid/frame/rows.wgsl rigid/frame/halt.wgsl rigid/frame/turn.wgsl rigid/frame/sweeps.wgsl rigid/frame/times.wgsl
// requires physics/quaternion.wgsl rigid/frame/belt.wgsl

// The reflection of a block at its time of contact (docs/physics section 11.7).

// Points of a block that take part in an impact at most.
const MOST_POINTS: u32 = 64u;
const IMPACT_SWEEPS: u32 = 16u;
const FRICTION_SWEEPS: u32 = 4u;

// A body after an impact, back at the start of the substep.
struct After {
    place: vec3f,
    turn: vec4f,
    velocity: vec3f,
    momentum: vec3f,
}

struct Reflected {
    acted: bool,
    a: After,
    b: After,
}

fn mass_seen(body: u32, state: State, share: f32) -> Mass {
    if !has_mass(body) {
        return Mass(0.0, vec3f(0.0), vec3f(0.0));
    }
    let inverse = bodies[BODY_ROWS * body + 2u].w;
    let mass = mass_in(top_of(body), state.turn, inverse);
    return Mass(share * mass.inverse, share * mass.diagonal, share * mass.beside);
}

// Between the motion before and that after inelastic impulses, and beyond.
fn scaled(before: Motion, after: Motion, scale: f32) -> Motion {
    return Motion(
        before.velocity + scale * (after.velocity - before.velocity), before.spin + scale * (after.spin - before.spin)
    );
}

fn taken_back(body: u32, state: State, velocity: vec3f, momentum: vec3f, time: f32) -> After {
    var after = After(state.place, state.turn, velocity, momentum);
    if time > 0.0 && has_mass(body) {
        after.place = state.place - (time * velocity - (0.5 * time * time) * frame.gravity);
        after.turn = freely_turned(top_of(body), state.turn, momentum, -time);
        after.velocity = velocity - time * frame.gravity;
    }
    return after;
}

// Each body takes part with its mass and inertia divided by its share.
fn reflect(block: Block, hit: Hit, share_a: f32, share_b: f32) -> Reflected {
    let sight = sight_at(block, hit.time);
    let start_a = sight.a.motion;
    let start_b = sight.b.motion;
    var sides = Sides(
        start_a, start_b, mass_seen(block.a, sight.a, share_a), mass_seen(block.b, sight.b, share_b), sight.apart
    );
    // Of each point: the normal impulse, both tangential ones, and the approach speed before.
    var kept: array<vec4f, MOST_POINTS>;
    let end = block.first_pair + block.pairs;
    for (var sweep = 0u; sweep <= IMPACT_SWEEPS; sweep++) {
        var k = 0u;
        for (var pair = block.first_pair; pair < end; pair++) {
            let face = face_at(pair);
            let normal = normal_met(sight, pair, face.first);
            for (var point = face.first; point < face.first + count_met(face) && k < MOST_POINTS; point++) {
                let at = met(sight, normal, point);
                if at.w <= hit.depth {
                    let along = along_of(&sides, at.xyz, normal);
                    let u = -speed_along(&sides, normal, along);
                    if sweep == 0u {
                        kept[k] = vec4f(0.0, 0.0, 0.0, u);
                    } else {
                        let old = kept[k].x;
                        let next = max(old + u / (inverse_masses(&sides) + coupling(along, along)), 0.0);
                        kept[k].x = next;
                        push(&sides, normal, along, next - old);
                    }
                }
                k++;
            }
        }
    }
    // D and W, and the sums for the mean coefficient of restitution.
    var loss = 0.0;
    var work = 0.0;
    var sum = 0.0;
    var bounce = 0.0;
    var k = 0u;
    for (var pair = block.first_pair; pair < end; pair++) {
        let face = face_at(pair);
        let normal = normal_met(sight, pair, face.first);
        let restitution = bitcast<f32>(pairs[PAIR_ROWS * pair + 2u].w);
        for (var point = face.first; point < face.first + count_met(face) && k < MOST_POINTS; point++) {
            let at = met(sight, normal, point);
            if at.w <= hit.depth {
                let own = kept[k];
                loss += own.x * (own.w + speed_along(&sides, normal, along_of(&sides, at.xyz, normal)));
                work += own.x * own.w;
                sum += own.x;
                bounce += own.x * restitution;
            }
            k++;
        }
    }
    var reflected: Reflected;
    if !(loss > 0.0) {
        return reflected;
    }
    let scale = (1.0 + bounce / sum) * (work / loss);
    sides.a = scaled(start_a, sides.a, scale);
    sides.b = scaled(start_b, sides.b, scale);
    var moment_a = vec3f(0.0);
    var moment_b = vec3f(0.0);
    for (var sweep = 0u; sweep < FRICTION_SWEEPS; sweep++) {
        k = 0u;
        for (var pair = block.first_pair; pair < end; pair++) {
            let face = face_at(pair);
            let normal = normal_met(sight, pair, face.first);
            let axes = Axes(normal, tangent_one(normal), tangent_two(normal), face.friction, belt_in(sight, pair, normal));
            var struck = 0.0;
            for (var point = face.first; point < face.first + count_met(face) && k < MOST_POINTS; point++) {
                let at = met(sight, normal, point);
                if at.w <= hit.depth {
                    let own = kept[k];
                    let tangent = friction_row(&sides, grip_of(&sides, at.xyz, axes), axes, scale * own.x, own.yz);
                    kept[k] = vec4f(own.x, tangent, own.w);
                    struck += scale * own.x;
                    if sweep == FRICTION_SWEEPS - 1u {
                        let impulse = (scale * own.x) * normal + tangent.x * axes.one + tangent.y * axes.two;
                        moment_a -= cross(at.xyz, impulse);
                        moment_b += cross(at.xyz - sight.apart, impulse);
                    }
                }
                k++;
            }
            if sweep == 0u {
                // Where the first point of a pair has room, and no other block looks.
                let row = POINT_ROWS * face.first + 1u;
                points[row].w = bitcast<u32>(bitcast<f32>(points[row].w) + struck);
            }
        }
    }
    reflected.acted = true;
    let momentum_a = momentum_of(block.a) + share_a * moment_a;
    let momentum_b = momentum_of(block.b) + share_b * moment_b;
    reflected.a = taken_back(block.a, sight.a, sides.a.velocity, momentum_a, hit.time);
    reflected.b = taken_back(block.b, sight.b, sides.b.velocity, momentum_b, hit.time);
    return reflected;
}

// The state of a body with mass after an impact. Its spin is the one of its momentum.
fn put_after(body: u32, after: After, clock: f32) {
    if !fits(body, after.place, after.turn) {
        halt(body);
        return;
    }
    let at = BODY_ROWS * body;
    let mass = mass_in(top_of(body), after.turn, bodies[at + 2u].w);
    let spin = respond(mass, after.momentum);
    bodies[at] = vec4f(after.place, clock);
    bodies[at + 1u] = after.turn;
    put_motion(body, Motion(after.velocity, spin));
    bodies[at + 4u] = vec4f(mass.diagonal, bodies[at + 4u].w);
    bodies[at + 5u] = vec4f(mass.beside, bodies[at + 5u].w);
    bodies[at + 6u] = vec4f(after.momentum, bodies[at + 6u].w);
    // Of a body with left-over blocks, this is the number of those that are hit.
    bodies[at + 8u] = vec4f(spin, select(0.0, bodies[at + 8u].w + 1.0, share_of(body) == 0.0));
}
