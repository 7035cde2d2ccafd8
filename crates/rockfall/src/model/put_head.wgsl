// requires model/step.wgsl

// Writes the word that `head_of` reads.
fn put_head(mover: u32, word: u32) {
    lists[mover / SLICE][mover % SLICE] = word;
}
