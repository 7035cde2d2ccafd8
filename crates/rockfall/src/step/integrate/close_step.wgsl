// requires model/step.wgsl

// Closes a step, in a workgroup of at least COUNTER_BLOCKS threads. All of them must call `close_step`.

var<workgroup> contacts: atomic<u32>;
var<workgroup> max_overlap: atomic<u32>;
var<workgroup> collisions: atomic<u32>;
// One thread decides, because it changes what the decision depends on.
var<workgroup> repeats_step: bool;

// Whether the next step repeats this one: it was rejected only because a body left its AABB, for the first time, and has new lists.
fn is_repeated() -> bool {
    let has_new_lists = atomicLoad(&status.rebuild) == REBUILD_DONE;
    return has_only_escaped(atomicLoad(&status.rejected)) & has_new_lists & (status.repeated == 0u);
}

// Drops what a rejected step has counted. Collisions that are done are not repeated.
fn drop_counters(block: u32) {
    atomicStore(&status.counters[block].contacts, 0u);
    atomicStore(&status.counters[block].max_overlap, 0u);
    if atomicLoad(&status.collided) == 0u {
        atomicStore(&status.counters[block].collisions, 0u);
    }
}

fn repeat_step() {
    status.builds += 1u;
    status.repeats += 1u;
    status.repeated = 1u;
    status.repeat_escape = atomicExchange(&status.escape_ratio, 0u);
    atomicStore(&status.rebuild, 0u);
    atomicStore(&status.listed, 0u);
    atomicStore(&status.bad_count, 0u);
    atomicStore(&status.bad_body, NO_BODY);
    atomicStore(&status.counters[0].fast, 0u);
    if atomicLoad(&status.collided) == 0u {
        atomicStore(&status.collides, 0u);
        atomicStore(&status.clustered, 0u);
    } else {
        atomicStore(&status.collided, 1u);
    }
    atomicStore(&status.rejected, 0u);
}

// Adds up the counters of the step and resets them.
fn sum_counters(local: u32) {
    if local == 0u {
        repeats_step = is_repeated();
        atomicStore(&contacts, 0u);
        atomicStore(&max_overlap, 0u);
        atomicStore(&collisions, 0u);
    }
    workgroupBarrier();
    if (local < COUNTER_BLOCKS) & (atomicLoad(&status.rejected) == 0u) {
        atomicAdd(&contacts, atomicExchange(&status.counters[local].contacts, 0u));
        atomicMax(&max_overlap, atomicExchange(&status.counters[local].max_overlap, 0u));
        atomicAdd(&collisions, atomicExchange(&status.counters[local].collisions, 0u));
    }
    if (local < COUNTER_BLOCKS) & repeats_step {
        drop_counters(local);
    }
    workgroupBarrier();
}

fn count_step() {
    status.steps += 1u;
    status.repeated = 0u;
    status.last_contacts = atomicLoad(&contacts);
    status.last_max_overlap = atomicLoad(&max_overlap);
    status.last_collisions = atomicLoad(&collisions);
    let low = status.total_collisions_low + status.last_collisions;
    if low < status.last_collisions {
        status.total_collisions_high += 1u;
    }
    status.total_collisions_low = low;
    status.total_bad += atomicLoad(&status.bad_count);
    let listed = atomicExchange(&status.listed, 0u);
    if atomicExchange(&status.clustered, 0u) != 0u {
        status.clustered_steps += 1u;
        status.many_steps += u32(listed > FEW_COLLISIONS);
    }
}

// Adds the passages of the step, and records the first of all.
fn count_passages() {
    let passages = atomicExchange(&status.counters[0].passages, 0u);
    let passing = atomicExchange(&status.counters[0].passing, 0u);
    status.total_passages += passages;
    if (passages != 0u) & (status.first_passing == NO_BODY) {
        status.first_passing = ~passing;
        status.passage_step = status.steps;
    }
    atomicStore(&status.counters[0].fast, 0u);
}

// Records the first body whose state stopped being finite. Rejects the steps after this one unless FLAG_CONTINUE is set.
fn note_bad_body() {
    let bad_body = atomicLoad(&status.bad_body);
    if bad_body == NO_BODY {
        return;
    }
    if status.first_bad == NO_BODY {
        status.first_bad = bad_body;
        status.bad_step = status.steps;
    }
    // The first condition holds here. It is tested again for the reason given in `adjacency` (objects.wgsl).
    if (bad_body != NO_BODY) & ((step.flags & FLAG_CONTINUE) == 0u) {
        atomicOr(&status.rejected, REJECTED_NON_FINITE);
    }
}

// Returns the blocks of springs to the pool, also after a rejected step, which is repeated. Steps that follow a rejected one in the
// same submission evaluate the same contacts again, so they need as many blocks.
fn return_blocks() {
    let blocks = atomicExchange(&status.history_blocks, 0u);
    if blocks > step.history_pool {
        status.history_needed = blocks;
    }
}

fn close_step(local: u32) {
    sum_counters(local);
    if local != 0u {
        return;
    }
    return_blocks();
    if repeats_step {
        repeat_step();
        return;
    }
    if atomicLoad(&status.rejected) != 0u {
        atomicOr(&status.rejected, REJECTED_BEFORE);
        return;
    }
    count_step();
    count_passages();
    note_bad_body();
    atomicStore(&status.collides, 0u);
    atomicStore(&status.bad_count, 0u);
    atomicStore(&status.bad_body, NO_BODY);
    atomicStore(&status.collided, 0u);
    status.lengths_due = 0u;
    status.history_table ^= 1u;
}
