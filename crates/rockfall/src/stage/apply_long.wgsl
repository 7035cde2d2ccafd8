@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> words: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(7) var<storage, read> cells: array<u32>;
@group(0) @binding(8) var<storage, read> row_sums: array<array<f32, SLICE>>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

var<workgroup> due: u32;
// What so many entries give, array by array: x, y and z of the shares; factors into velocity and position.
var<workgroup> shares: array<f32, 3u * TEAM>;
var<workgroup> factors: array<f32, 2u * TEAM>;
// x, y and z of the change in velocity, then in position.
var<workgroup> sums: array<f32, 6>;

fn put_next(region: u32, i: u32, row: vec4f) {
    next[region * step.spheres + i] = row;
}

// Adds up what so many entries give, in their order: a thread a component.
fn add_parts(local: u32, count: u32) {
    if local >= 6u {
        return;
    }
    let axis = local % 3u * TEAM;
    let kind = local / 3u * TEAM;
    var sum = sums[local];
    for (var k = 0u; k < count; k++) {
        sum = fma(shares[axis + k], factors[kind + k], sum);
    }
    sums[local] = sum;
}

// All threads of the workgroup must come here.
fn sum_changes(sphere: u32, local: u32) {
    if local < 6u {
        sums[local] = 0.0;
    }
    let count = count_of(sphere);
    for (var first = 0u; first < count; first += TEAM) {
        var part = no_part();
        if first + local < count {
            let slot = slot_of(sphere, first + local);
            if (entry_at(slot) & ENTRY_COLLIDES) != 0u {
                part = part_of_entry(sphere, sphere, slot);
            }
        }
        shares[local] = part.share.x;
        shares[TEAM + local] = part.share.y;
        shares[2u * TEAM + local] = part.share.z;
        factors[local] = part.velocity;
        factors[TEAM + local] = part.position;
        workgroupBarrier();
        add_parts(local, min(count - first, TEAM));
        workgroupBarrier();
    }
}

@compute @workgroup_size(256)
fn apply_long(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if local == 0u {
        due = u32(has_changes());
    }
    if workgroupUniformLoad(&due) == 0u {
        return;
    }
    for (var turn = linear_group(group, groups); turn < long_movers(); turn += groups.x * groups.y) {
        let sphere = long_mover(turn);
        // Rods have no state of their own.
        if sphere >= step.spheres {
            continue;
        }
        if !is_shared_out(sphere) | !has_collisions(sphere) {
            continue;
        }
        workgroupBarrier();
        sum_changes(sphere, local);
        if local == 0u {
            write_changed(sphere, Change(vec3f(sums[0], sums[1], sums[2]), vec3f(sums[3], sums[4], sums[5])));
        }
    }
}
