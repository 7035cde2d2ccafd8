// Copies rows of four numbers per memory slot of a sphere, or per rigid body, to or from a table in insertion order (exchange.rs).

struct Exchange {
    // Number of spheres or bodies.
    count: u32,
    // First row of the field.
    first: u32,
    // Numbers per row of the table: 3 or 4.
    columns: u32,
    // Where the slots of the insertion indices begin in `topology`, or 0 if both are the same.
    slots_at: u32,
    // Component of a row that is in column 0 of the table.
    component: u32,
    // First row of the low parts of positions, which become 0 when the table is written; 0 for none.
    lows: u32,
    // Rows of the array from one sphere or body to the next.
    stride: u32,
}

@group(0) @binding(0) var<uniform> exchange: Exchange;
@group(0) @binding(1) var<storage, read_write> rows: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> topology: array<u32>;
@group(0) @binding(3) var<storage, read_write> table: array<f32>;
// First sphere whose row of the table is not valid.
@group(0) @binding(4) var<storage, read_write> first_bad: atomic<u32>;

// A thread in a dispatch of several rows of workgroups.
struct Thread {
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
}

fn sphere_of(thread: Thread) -> u32 {
    return (thread.group.y * thread.groups.x + thread.group.x) * 256u + thread.local;
}

fn row_of(sphere: u32) -> u32 {
    if exchange.slots_at == 0u {
        return exchange.first + exchange.stride * sphere;
    }
    return exchange.first + topology[exchange.slots_at + sphere];
}

@compute @workgroup_size(256)
fn gather(thread: Thread) {
    let sphere = sphere_of(thread);
    if sphere >= exchange.count {
        return;
    }
    let row = rows[row_of(sphere)];
    for (var column = 0u; column < exchange.columns; column++) {
        table[exchange.columns * sphere + column] = row[(exchange.component + column) % 4u];
    }
}

// The numbers of a row that the table does not have stay as they are.
@compute @workgroup_size(256)
fn scatter(thread: Thread) {
    let sphere = sphere_of(thread);
    if sphere >= exchange.count {
        return;
    }
    let at = row_of(sphere);
    var row = rows[at];
    for (var column = 0u; column < exchange.columns; column++) {
        row[(exchange.component + column) % 4u] = table[exchange.columns * sphere + column];
    }
    rows[at] = row;
    if exchange.lows != 0u {
        rows[exchange.lows + at - exchange.first] = vec4f(0.0);
    }
}

// Looks for numbers that are not finite, and for quaternions that are not unit quaternions.
@compute @workgroup_size(256)
fn check(thread: Thread) {
    let sphere = sphere_of(thread);
    if sphere >= exchange.count {
        return;
    }
    var is_good = true;
    var square = 0.0;
    for (var column = 0u; column < exchange.columns; column++) {
        let number = table[exchange.columns * sphere + column];
        // By bits, because compilers may assume that no number is NaN.
        is_good = is_good & ((bitcast<u32>(number) & 0x7f800000u) != 0x7f800000u);
        square += number * number;
    }
    if !is_good | ((exchange.columns == 4u) & (abs(square - 1.0) > 1e-4)) {
        atomicMin(&first_bad, sphere);
    }
}
