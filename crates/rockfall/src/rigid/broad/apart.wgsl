// requires

// Bodies that joints keep apart (docs/physics section 11.14). `rigid/gpu/joints.rs` makes the words: 0 without such pairs; otherwise the
// number of bodies; the first entry of each body, and the end; then the partners of each body in ascending order.
@group(0) @binding(45) var<storage, read> apart: array<u32>;

fn are_apart(one: u32, other: u32) -> bool {
    if apart[0] == 0u {
        return false;
    }
    var first = apart[1u + one];
    var end = apart[2u + one];
    while first < end {
        let middle = (first + end) / 2u;
        let partner = apart[middle];
        if partner == other {
            return true;
        }
        if partner < other {
            first = middle + 1u;
        } else {
            end = middle;
        }
    }
    return false;
}
