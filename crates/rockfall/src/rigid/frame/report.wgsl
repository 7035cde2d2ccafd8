// requires

// What a frame reports: bodies whose path is longer than their margin; bodies whose state stopped being finite; 0xffffffff less the
// first of these; whether a block was reflected in this substep; points that touch; the deepest overlap; joints that broke;
// whether a block was hit in a frame without impacts.
@group(0) @binding(10) var<storage, read_write> report: array<atomic<u32>, 8>;
