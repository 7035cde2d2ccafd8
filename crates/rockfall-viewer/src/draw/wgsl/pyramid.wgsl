// Builds the depth pyramid: the farthest depth of blocks of pixels, level by level.

@group(0) @binding(0) var samples: texture_depth_multisampled_2d;
@group(0) @binding(1) var blocks: texture_2d<f32>;
@group(0) @binding(2) var level: texture_storage_2d<r32float, write>;

/// Returns the end of the pixels or blocks that a block covers. The last block also covers the remainder of an odd number.
fn end_of(block: vec2u, count: vec2u, size: vec2u) -> vec2u {
    return select(min(2u * block + 2u, size), size, block + 1u == count);
}

@compute @workgroup_size(8, 8)
fn first_level(@builtin(global_invocation_id) id: vec3u) {
    let block = id.xy;
    let count = textureDimensions(level);
    if any(block >= count) {
        return;
    }
    let end = end_of(block, count, textureDimensions(samples));
    var depth = 1.0;
    for (var y = 2u * block.y; y < end.y; y++) {
        for (var x = 2u * block.x; x < end.x; x++) {
            for (var index = 0; index < 4; index++) {
                depth = min(depth, textureLoad(samples, vec2u(x, y), index));
            }
        }
    }
    textureStore(level, block, vec4f(depth));
}

@compute @workgroup_size(8, 8)
fn next_level(@builtin(global_invocation_id) id: vec3u) {
    let block = id.xy;
    let count = textureDimensions(level);
    if any(block >= count) {
        return;
    }
    let end = end_of(block, count, textureDimensions(blocks));
    var depth = 1.0;
    for (var y = 2u * block.y; y < end.y; y++) {
        for (var x = 2u * block.x; x < end.x; x++) {
            depth = min(depth, textureLoad(blocks, vec2u(x, y), 0).r);
        }
    }
    textureStore(level, block, vec4f(depth));
}
