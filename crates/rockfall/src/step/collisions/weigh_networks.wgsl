// requires model/lists.wgsl model/objects.wgsl model/one_state.wgsl model/step.wgsl physics/collision/networks.wgsl
// requires step/collisions/has_changes.wgsl step/collisions/record_of.wgsl step/collisions/records.wgsl
// requires step/collisions/rows.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> collision_indices: array<array<u32, SLICE>>;
@group(0) @binding(7) var<storage, read_write> collisions: array<vec4u>;
@group(0) @binding(8) var<storage, read_write> wrenches: array<vec4f>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

var<workgroup> first_word: u32;

// Returns the word of thread 0 to all threads.
fn broadcast_first(local: u32, word: u32) -> u32 {
    workgroupBarrier();
    if local == 0u {
        first_word = word;
    }
    return workgroupUniformLoad(&first_word);
}

// A row of a network: a mover whose list holds contacts of the network. The rows are the spheres and rods of the network,
// and the rods of free length that end in its spheres. `sphere` is the sphere of the network that gets the impulses of the
// row. It is NONE for the network's own rods and for rods of free length with both ends in the network: their ends share the
// impulses.
struct Row {
    id: u32,
    sphere: u32,
}

// Returns the row of this number: first the spheres, then the rods of the network, then the rods of free length, sphere by
// sphere. After the last row the id is NONE.
fn network_row(network: Network, number: u32) -> Row {
    if number < network.spheres {
        let sphere = network_sphere(network, number);
        return Row(sphere, sphere);
    }
    if number < network.spheres + network.rods {
        return Row(step.spheres + network_rod(network, number - network.spheres), NONE);
    }
    var left = number - network.spheres - network.rods;
    for (var place = 0u; place < network.spheres; place++) {
        let sphere = network_sphere(network, place);
        let rods = rods_of(sphere);
        for (var r = 0u; r < rods.y; r++) {
            let rod = index_of(topology[rods.x + r]);
            // A rod of free length with both ends in the network is one side, like the network's own rods. It is counted at
            // its end 1.
            let is_both = network_of(other_end(rod, sphere)) == network_of(sphere);
            if !(rod_length(rod) > 0.0) & !(is_both & (rod_ends(rod).y == sphere)) {
                if left == 0u {
                    return Row(step.spheres + rod, select(sphere, NONE, is_both));
                }
                left -= 1u;
            }
        }
    }
    return Row(NONE, NONE);
}

// Number of collisions in the list of a row.
fn collisions_in(row: u32) -> u32 {
    var found = 0u;
    if has_collisions(row) {
        let first = first_of(row);
        for (var e = 0u; e < count_of(row); e++) {
            found += u32((entry_at(slot_at(first, e)) & ENTRY_COLLIDES) != 0u);
        }
    }
    return found;
}

// The share of a unit impulse on a row that a sphere of the network gets.
fn part_of(row: Row, at: f32, sphere: u32) -> f32 {
    if row.id < step.spheres {
        return select(0.0, 1.0, sphere == row.id);
    }
    if (row.sphere != NONE) & (row.sphere != sphere) {
        return 0.0;
    }
    let ends = rod_ends(row.id - step.spheres);
    return select(0.0, 1.0 - at, ends.x == sphere) + select(0.0, at, ends.y == sphere);
}

// Computes the changes of velocity by a unit impulse of a collision of a row. The impulse goes to the position rows of `next`.
fn push_unit(network: Network, row: Row, r: u32, local: u32) {
    let k = record_at(r);
    let at = select(k.b, k.a, k.a_id == row.id);
    for (var first_place = 0u; first_place < network.spheres; first_place += WORKGROUP) {
        let place = first_place + local;
        if place < network.spheres {
            let sphere = network_sphere(network, place);
            next[position_at(sphere)] = vec4f(part_of(row, at, sphere) * k.n, 0.0);
        }
    }
    project(network, local);
}

// The change of velocity, by the last unit impulse, of a collision of a row along its normal.
fn coupling_with(row: Row, r: u32) -> f32 {
    let k = record_at(r);
    let at = select(k.b, k.a, k.a_id == row.id);
    if row.id < step.spheres {
        return dot(k.n, next[velocity_at(row.id)].xyz);
    }
    let ends = rod_ends(row.id - step.spheres);
    var sum = 0.0;
    for (var end = 0u; end < 2u; end++) {
        let sphere = select(ends.x, ends.y, end == 1u);
        if inverse_mass(sphere) > 0.0 {
            let part = part_of(row, at, sphere);
            if part != 0.0 {
                sum += part * dot(k.n, next[velocity_at(sphere)].xyz);
            }
        }
    }
    return sum;
}

// The sum of the absolute couplings with all collisions on the network, by the last unit impulse. Each thread takes every 64th
// row, so the order of the sum is always the same.
fn sum_of_couplings(network: Network, rows: u32, local: u32) -> f32 {
    var sum = 0.0;
    for (var at = local; at < rows; at += WORKGROUP) {
        let row = network_row(network, at);
        if has_collisions(row.id) {
            let first = first_of(row.id);
            for (var e = 0u; e < count_of(row.id); e++) {
                let slot = slot_at(first, e);
                if (entry_at(slot) & ENTRY_COLLIDES) != 0u {
                    sum += abs(coupling_with(row, record_of(slot)));
                }
            }
        }
    }
    return total_of(local, sum);
}

// The end, of the four ends of a record, that the weight of this row belongs to.
fn end_of_record(row: Row, r: u32) -> u32 {
    let is_b = record_at(r).a_id != row.id;
    let is_second = ((row.sphere != NONE) & (row.id >= step.spheres)) && (rod_ends(row.id - step.spheres).y == row.sphere);
    return 2u * u32(is_b) + u32(is_second);
}

@compute @workgroup_size(64)
fn weigh_networks(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let number = linear_group(group, groups);
    if broadcast_first(local, u32((number < step.networks) & has_changes())) == 0u {
        return;
    }
    let network = network_at(number);
    put_directions(network, local);
    var count = 0u;
    var rows = 0u;
    loop {
        let row = broadcast_first(local, network_row(network, rows).id);
        if row == NONE {
            break;
        }
        count += broadcast_first(local, collisions_in(row));
        rows += 1u;
    }
    var weighed = 0u;
    for (var at = 0u; at < rows; at++) {
        let row = network_row(network, at);
        if broadcast_first(local, u32(has_collisions(row.id))) == 0u {
            continue;
        }
        let first = first_of(row.id);
        let entries = broadcast_first(local, count_of(row.id));
        for (var e = 0u; e < entries; e++) {
            let slot = slot_at(first, e);
            if broadcast_first(local, u32((entry_at(slot) & ENTRY_COLLIDES) != 0u)) == 0u {
                continue;
            }
            let r = broadcast_first(local, record_of(slot));
            push_unit(network, row, r, local);
            let weight = sum_of_couplings(network, rows, local);
            if local == 0u {
                let added = vec4f(weight, f32(count), coupling_with(row, r), 0.0);
                collisions[row_at(r, 4u + end_of_record(row, r))] = bitcast<vec4u>(added);
                weighed += 1u;
            }
        }
    }
    // Software Vulkan ends loops after 65,535 rounds of a shader.
    if (local == 0u) & (weighed != count) {
        atomicOr(&status.rejected, REJECTED_NETWORKS);
    }
}
