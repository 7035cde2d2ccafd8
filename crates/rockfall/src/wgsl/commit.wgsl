// The state that `leap` made becomes the state of a sphere.

fn commit(i: u32) {
    for (var region = 0u; region < 3u; region++) {
        state[region * step.spheres + i] = next[region * step.spheres + i];
    }
    ask_for_lists(i, next[i], next[step.spheres + i]);
}
