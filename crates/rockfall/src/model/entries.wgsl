// requires model/step.wgsl

// Fields of a list entry.

fn entry_id(entry: u32) -> u32 {
    return entry & ENTRY_ID_MASK;
}

fn entry_feature(entry: u32) -> u32 {
    return (entry >> ENTRY_ID_BITS) & FEATURE_MASK;
}
