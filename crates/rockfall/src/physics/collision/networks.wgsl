// requires model/objects.wgsl model/step.wgsl step/collisions/rows.wgsl

// Networks of fixed-length rods: impulses on their spheres are projected so that no rod changes its length (docs/physics
// section 3.4). A workgroup solves (J W J^T) lambda = J W p by conjugate gradients. J holds the directions of the rods, W
// the inverse masses, p the impulses, lambda the tensions of the rods.
//
// Each direction is divided by the square root of the inverse masses of both ends, so that all diagonal elements of the matrix
// are 1. Each rod has four rows in `wrenches`. The first holds the divided direction, the second lambda, the residual, the search
// direction and the product of the matrix with the search direction. The other two are unused. Each sphere uses two rows in
// `next`: the position row for the impulse or the sum of the rods' pulls, the velocity row for the resulting change of
// velocity.
//
// Loops that are followed by a barrier have the same number of rounds for all threads (see sweep_at_once.wgsl).

// The iteration ends when the squared residual is at most this fraction of the squared velocities of the rods' ends, or after
// this number of rounds per rod. The step is rejected if the squared residual then exceeds the second fraction.
const SOLVED: f32 = 1e-12;
const UNSOLVED: f32 = 1e-6;
const ROUNDS_PER_ROD: u32 = 16u;

struct Network {
    spheres: u32,
    rods: u32,
    // Index of the first word of the spheres, each stored as 2 rod + end, and index of the first word of the rods.
    spheres_at: u32,
    rods_at: u32,
}

fn network_at(number: u32) -> Network {
    let at = topology[step.networks_at + number];
    return Network(topology[at], topology[at + 1u], at + 2u, at + 2u + topology[at]);
}

fn network_sphere(network: Network, place: u32) -> u32 {
    let name = topology[network.spheres_at + place];
    let ends = rod_ends(name / 2u);
    return select(ends.x, ends.y, (name & 1u) == 1u);
}

fn network_rod(network: Network, place: u32) -> u32 {
    return topology[network.rods_at + place];
}

var<workgroup> partial: array<f32, WORKGROUP>;

// The sum of a value over the threads, in a fixed order. All threads of the workgroup must call this function. They get the
// same sum.
fn total_of(local: u32, value: f32) -> f32 {
    workgroupBarrier();
    partial[local] = value;
    for (var stride = WORKGROUP / 2u; stride > 0u; stride /= 2u) {
        workgroupBarrier();
        if local < stride {
            partial[local] += partial[local + stride];
        }
    }
    return workgroupUniformLoad(&partial[0]);
}

// Stores the present directions of the rods, divided as above.
fn put_directions(network: Network, local: u32) {
    for (var first_place = 0u; first_place < network.rods; first_place += WORKGROUP) {
        let place = first_place + local;
        if place < network.rods {
            let rod = network_rod(network, place);
            let ends = rod_ends(rod);
            let d = state[position_at(ends.y)].xyz - state[position_at(ends.x)].xyz;
            let squared = dot(d, d);
            let n = select(vec3f(0.0), d / sqrt(squared * (inverse_mass(ends.x) + inverse_mass(ends.y))), squared > TINY);
            wrenches[4u * rod] = vec4f(n, 0.0);
        }
    }
}

// The pull of the rods on a sphere: J^T applied to the search directions of the rods, or to their lambdas.
fn pull_of_rods(sphere: u32, of_lambda: bool) -> vec3f {
    var sum = vec3f(0.0);
    let rods = rods_of(sphere);
    for (var r = 0u; r < rods.y; r++) {
        let rod = index_of(topology[rods.x + r]);
        if network_of_rod(rod) != NO_NETWORK {
            let row = wrenches[4u * rod + 1u];
            let times = select(row.z, row.x, of_lambda);
            sum = fma(wrenches[4u * rod].xyz, vec3f(select(times, -times, rod_ends(rod).x == sphere)), sum);
        }
    }
    return sum;
}

// The change of velocity of a rod's end by the impulse or pull in its position row.
fn pushed(end: u32) -> vec3f {
    let w = inverse_mass(end);
    return select(vec3f(0.0), w * next[position_at(end)].xyz, w > 0.0);
}

// The rate at which a rod would lengthen under the impulses or pulls in the position rows, divided like its direction.
fn lengthening(rod: u32) -> f32 {
    let ends = rod_ends(rod);
    return dot(pushed(ends.y) - pushed(ends.x), wrenches[4u * rod].xyz);
}

// The squared velocities of both ends of a rod, divided like the squared rate of lengthening.
fn squared_velocities(rod: u32) -> f32 {
    let ends = rod_ends(rod);
    let n = wrenches[4u * rod].xyz;
    let v1 = pushed(ends.x);
    let v2 = pushed(ends.y);
    return dot(n, n) * (dot(v1, v1) + dot(v2, v2));
}

// Reads the impulses on the spheres from the position rows, and writes the changes of velocity to the velocity rows. All
// threads of the workgroup must call this function.
fn project(network: Network, local: u32) {
    storageBarrier();
    var squares = 0.0;
    var velocities = 0.0;
    for (var first_place = 0u; first_place < network.rods; first_place += WORKGROUP) {
        let place = first_place + local;
        if place < network.rods {
            let rod = network_rod(network, place);
            let residual = lengthening(rod);
            wrenches[4u * rod + 1u] = vec4f(0.0, residual, residual, 0.0);
            squares += residual * residual;
            velocities += squared_velocities(rod);
        }
    }
    // Moves the impulses to the velocity rows, because the search uses the position rows for its pulls.
    storageBarrier();
    for (var first_place = 0u; first_place < network.spheres; first_place += WORKGROUP) {
        let place = first_place + local;
        if place < network.spheres {
            let sphere = network_sphere(network, place);
            next[velocity_at(sphere)] = next[position_at(sphere)];
        }
    }
    let whole = total_of(local, velocities);
    var rest = total_of(local, squares);
    for (var round = 0u; (round < ROUNDS_PER_ROD * network.rods) & (rest > SOLVED * whole); round++) {
        rest = search(network, local, rest);
    }
    if (local == 0u) & (rest > UNSOLVED * whole) {
        atomicOr(&status.rejected, REJECTED_NETWORKS);
    }
    storageBarrier();
    for (var first_place = 0u; first_place < network.spheres; first_place += WORKGROUP) {
        let place = first_place + local;
        if place < network.spheres {
            let sphere = network_sphere(network, place);
            let impulse = next[velocity_at(sphere)].xyz - pull_of_rods(sphere, true);
            next[velocity_at(sphere)] = vec4f(inverse_mass(sphere) * impulse, 0.0);
        }
    }
    storageBarrier();
}

// Makes a round of conjugate gradients. Returns the squared residual after it.
fn search(network: Network, local: u32, squares: f32) -> f32 {
    storageBarrier();
    for (var first_place = 0u; first_place < network.spheres; first_place += WORKGROUP) {
        let place = first_place + local;
        if place < network.spheres {
            let sphere = network_sphere(network, place);
            next[position_at(sphere)] = vec4f(pull_of_rods(sphere, false), 0.0);
        }
    }
    storageBarrier();
    var product = 0.0;
    for (var first_place = 0u; first_place < network.rods; first_place += WORKGROUP) {
        let place = first_place + local;
        if place < network.rods {
            let rod = network_rod(network, place);
            var row = wrenches[4u * rod + 1u];
            row.w = lengthening(rod);
            wrenches[4u * rod + 1u] = row;
            product += row.z * row.w;
        }
    }
    let whole = total_of(local, product);
    let along = select(0.0, squares / whole, whole > 0.0);
    var left = 0.0;
    for (var first_place = 0u; first_place < network.rods; first_place += WORKGROUP) {
        let place = first_place + local;
        if place < network.rods {
            let rod = network_rod(network, place);
            var row = wrenches[4u * rod + 1u];
            row.x += along * row.z;
            row.y -= along * row.w;
            wrenches[4u * rod + 1u] = row;
            left += row.y * row.y;
        }
    }
    let after = total_of(local, left);
    for (var first_place = 0u; first_place < network.rods; first_place += WORKGROUP) {
        let place = first_place + local;
        if place < network.rods {
            let rod = network_rod(network, place);
            var row = wrenches[4u * rod + 1u];
            row.z = row.y + (after / squares) * row.z;
            wrenches[4u * rod + 1u] = row;
        }
    }
    return after;
}
