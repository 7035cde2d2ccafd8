// requires model/step.wgsl

// What `head_of` reads, for stages that write it.
fn put_head(mover: u32, word: u32) {
    lists[mover / SLICE][mover % SLICE] = word;
}
