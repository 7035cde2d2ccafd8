// requires model/step.wgsl

// Read access to the objects in `state` and `topology`.

fn inverse_mass(sphere: u32) -> f32 {
    return state[velocity_at(sphere)].w;
}

// Whether boxes, polygons, springs and muscles are stored field by field: the first word of each of them, then the second word of
// each. Only `run_worlds` has this layout, so that neighbouring threads read neighbouring words. The host replaces this constant.
const BY_FIELD: bool = true;

// First word of a record of such objects. `table` is the first word of them all, `words` the length of a record.
fn word_of_record(table: u32, index: u32, words: u32) -> u32 {
    return table + index * select(words, 1u, BY_FIELD);
}

// Distance of the words of such a record. `count` is the number of records.
fn stride_of(count: u32) -> u32 {
    return select(1u, count, BY_FIELD);
}

fn vector_at(word: u32) -> vec3f {
    return spread_vector_at(word, 1u);
}

// A vector whose words have a distance of `stride`.
fn spread_vector_at(word: u32, stride: u32) -> vec3f {
    return bitcast<vec3f>(vec3u(topology[word], topology[word + stride], topology[word + 2u * stride]));
}

fn float_at(word: u32) -> f32 {
    return bitcast<f32>(topology[word]);
}

fn rod_ends(rod: u32) -> vec2u {
    let at = step.rods_at + rod * ROD_WORDS;
    return vec2u(topology[at], topology[at + 1u]);
}

fn rod_radius(rod: u32) -> f32 {
    return float_at(step.rods_at + rod * ROD_WORDS + 2u);
}

// Fixed length of a rod; not positive when the length is free.
fn rod_length(rod: u32) -> f32 {
    return float_at(step.rods_at + rod * ROD_WORDS + 3u);
}

fn other_end(rod: u32, sphere: u32) -> u32 {
    let ends = rod_ends(rod);
    return select(ends.x, ends.y, ends.x == sphere);
}

fn spring_count() -> u32 {
    return (step.tethers_at - step.springs_at) / SPRING_WORDS;
}

struct Cuboid {
    corner: vec3f,
    i: vec3f,
    j: vec3f,
    k: vec3f,
}

fn cuboid(index: u32) -> Cuboid {
    let at = word_of_record(step.boxes_at, index, BOX_WORDS);
    let stride = stride_of(step.boxes);
    return Cuboid(
        spread_vector_at(at, stride),
        spread_vector_at(at + 3u * stride, stride),
        spread_vector_at(at + 6u * stride, stride),
        spread_vector_at(at + 9u * stride, stride),
    );
}

struct Polygon {
    corner: vec3f,
    left: vec3f,
    right: vec3f,
    // One of the SURFACE_ constants.
    surface: u32,
}

fn is_triangle(polygon: Polygon) -> bool {
    return TRIANGLES && (polygon.surface == SURFACE_TRIANGLE);
}

fn polygon(index: u32) -> Polygon {
    let at = word_of_record(step.polygons_at, index, POLYGON_WORDS);
    let stride = stride_of(step.polygons);
    return Polygon(
        spread_vector_at(at, stride),
        spread_vector_at(at + 3u * stride, stride),
        spread_vector_at(at + 6u * stride, stride),
        topology[at + 9u * stride],
    );
}

// First word, and one past the last word, of what is attached to a sphere. Rods come first, because a rod is kind 0.
fn adjacency(sphere: u32) -> vec2u {
    // The second condition is never true. It is here because software Vulkan recompiles the kernel in every dispatch where a
    // branch depends on the uniform block alone.
    if (step.adjacency_at == 0u) | (sphere >= step.spheres) {
        return vec2u(0u);
    }
    let at = step.adjacency_at + 2u * sphere;
    return vec2u(topology[at], topology[at + 1u]);
}

fn kind_of(attached: u32) -> u32 {
    return attached >> KIND_SHIFT;
}

fn index_of(attached: u32) -> u32 {
    return attached & ((1u << KIND_SHIFT) - 1u);
}

// Which rods end in a sphere: NO_ROD, SOME_RODS, or the index of its only rod if that has a fixed length. This is stored in one
// word, because every contact test needs it.
fn end_of(sphere: u32) -> u32 {
    if !RODS {
        return NO_ROD;
    }
    return topology[step.ends_at + sphere];
}

// First word of a sphere's rods, and the number of rods.
fn rods_of(sphere: u32) -> vec2u {
    if end_of(sphere) == NO_ROD {
        return vec2u(0u);
    }
    let range = adjacency(sphere);
    var end = range.x;
    while end < range.y {
        if kind_of(topology[end]) != KIND_ROD {
            break;
        }
        end += 1u;
    }
    return vec2u(range.x, end - range.x);
}

// The rod of a sphere that has exactly one rod, of fixed length; otherwise NONE. Only such a sphere can be an end of a rigid
// capsule.
fn capsule_rod(sphere: u32) -> u32 {
    let end = end_of(sphere);
    return select(end, NONE, end == SOME_RODS);
}
