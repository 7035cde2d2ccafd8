// requires rigid/frame/rows.wgsl

// Colours of the blocks (docs/physics section 11.6).
//
// | array | entry |
// |---|---|
// | `states` | of each block: colour, 16 for none; bit 8 if it waits for one; the round in which it took it << 16 |
// | `ranks` | of each block its rank among those that wait, the far ones last; later its place in the order of colours |

@group(0) @binding(30) var<storage, read_write> states: array<atomic<u32>>;
@group(0) @binding(31) var<storage, read_write> ranks: array<u32>;

const LEFT_OVER: u32 = 16u;
const WAITING: u32 = 0x100u;
