// What the collisions of small spheres weigh, where there are no rods: all of them are plain. Neighbours have more or fewer of them, so
// those of a workgroup are put down first, and then weighed by a thread each, whosever they are.

// All threads of the workgroup must come here.
fn weigh_plain(mover: u32, local: u32) {
    var works = false;
    if mover < step.spheres {
        works = has_collisions(mover);
    }
    var next = 0u;
    loop {
        if works {
            next = put_down(mover, next);
            works = next < count_of(mover);
        }
        let queued = counted_up(local, QUEUE);
        if queued == 0u {
            break;
        }
        for (var first = 0u; first < queued; first += WORKGROUP) {
            if first + local < queued {
                let collision = places[first + local];
                weighs_plain(collision.x, collision.y);
            }
        }
        workgroupBarrier();
    }
}
