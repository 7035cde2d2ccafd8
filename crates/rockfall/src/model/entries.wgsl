// requires model/step.wgsl

// What a list entry holds.

fn entry_id(entry: u32) -> u32 {
    return entry & ENTRY_ID_MASK;
}

fn entry_feature(entry: u32) -> u32 {
    return entry >> ENTRY_ID_BITS & FEATURE_MASK;
}
