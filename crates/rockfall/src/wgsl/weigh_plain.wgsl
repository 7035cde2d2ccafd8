// What the collisions of small spheres weigh, where there are no rods: all of them are plain. Neighbours have more or fewer of them, so
// those of a workgroup are put down first, and then weighed by a thread each, whosever they are.

const QUEUE: u32 = 256u;

// A mover, and an entry of its list.
var<workgroup> queue: array<vec2u, QUEUE>;

// Puts down a mover's collisions from an entry on, as many as there is room for; gives the entry to go on from.
fn queue_up(mover: u32, begin: u32) -> u32 {
    let count = count_of(mover);
    var e = next_own(mover, begin);
    while e < count {
        let place = atomicAdd(&count_up, 1u);
        if place >= QUEUE {
            break;
        }
        queue[place] = vec2u(mover, e);
        e = next_own(mover, e + 1u);
    }
    return e;
}

// All threads of the workgroup must come here.
fn weigh_plain(mover: u32, local: u32) {
    var works = false;
    if mover < step.spheres {
        works = has_collisions(mover);
    }
    var next = 0u;
    loop {
        if works {
            next = queue_up(mover, next);
            works = next < count_of(mover);
        }
        let queued = counted_up(local, QUEUE);
        if queued == 0u {
            break;
        }
        for (var first = 0u; first < queued; first += WORKGROUP) {
            if first + local < queued {
                let collision = queue[first + local];
                weighs_plain(collision.x, collision.y);
            }
        }
        workgroupBarrier();
    }
}
