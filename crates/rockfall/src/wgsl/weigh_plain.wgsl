// What the collisions of small spheres weigh, where there are no rods: all of them are plain. Neighbours have more or fewer of them, so
// those of a workgroup are put down first, and then weighed by a thread each, whosever they are.

// Weighs what was put down. All threads of the workgroup must come here.
fn weigh_plain(local: u32, owned: u32) {
    for (var first = 0u; first < owned; first += WORKGROUP) {
        if first + local < owned {
            let collision = places[first + local];
            weighs_plain(collision.x, collision.y);
        }
    }
    workgroupBarrier();
}
