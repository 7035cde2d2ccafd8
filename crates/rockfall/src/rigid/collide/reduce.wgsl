// requires rigid/collide/manifold.wgsl

// The choice of four contact points (docs/physics section 11.13).

// Corners of two quadrilaterals; a kernel for hulls has 64.
const MOST_CANDIDATES: u32 = 8u;

// Points of which up to four become contacts.
struct Candidates {
    count: u32,
    // Place on the core of the first shape, and the separation of the cores: the other place is that far along the normal.
    places: array<vec4f, MOST_CANDIDATES>,
    ids: array<u32, MOST_CANDIDATES>,
}

// The first of the values that are nearly the greatest, up to a part of it and a margin.
fn first_of_greatest(values: ptr<function, array<f32, MOST_CANDIDATES>>, count: u32, part: f32, margin: f32) -> u32 {
    var most = NO_SEPARATION;
    for (var k = 0u; k < MOST_CANDIDATES && k < count; k++) {
        most = max(most, (*values)[k]);
    }
    let enough = most - part * abs(most) - margin;
    for (var k = 0u; k < MOST_CANDIDATES && k < count; k++) {
        if (*values)[k] >= enough {
            return k;
        }
    }
    return 0u;
}

// At most four of the candidates. Of more, it takes an extreme one along a fixed direction or the deepest, the farthest from that, the
// one of the largest triangle, and the farthest on the other side.
fn reduced(candidates: ptr<function, Candidates>, normal: vec3f, along: vec3f, radii: vec2f) -> Manifold {
    let count = (*candidates).count;
    var chosen = vec4u(0u, 1u, 2u, 3u);
    var taken = min(count, 4u);
    if count > 4u {
        var values: array<f32, MOST_CANDIDATES>;
        let origin = (*candidates).places[0].xyz;
        var spread = 0.0;
        for (var k = 0u; k < MOST_CANDIDATES && k < count; k++) {
            let place = (*candidates).places[k];
            spread = max(spread, distance(place.xyz, origin));
            values[k] = -place.w - 1e-3 * dot(place.xyz, along);
        }
        chosen.x = first_of_greatest(&values, count, 0.0, 0.5e-3 * spread);
        let p = (*candidates).places[chosen.x].xyz;
        for (var k = 0u; k < MOST_CANDIDATES && k < count; k++) {
            let offset = (*candidates).places[k].xyz - p;
            values[k] = dot(offset, offset);
        }
        chosen.y = first_of_greatest(&values, count, 0.01, 0.0);
        let q = (*candidates).places[chosen.y].xyz;
        let thin = 1e-5 * dot(q - p, q - p);
        for (var k = 0u; k < MOST_CANDIDATES && k < count; k++) {
            values[k] = abs(dot(cross(q - p, (*candidates).places[k].xyz - p), normal));
        }
        chosen.z = first_of_greatest(&values, count, 0.01, 0.0);
        taken = 2u;
        if values[chosen.z] > thin {
            let r = (*candidates).places[chosen.z].xyz;
            let up = unit_sign(dot(cross(q - p, r - p), normal)) * normal;
            for (var k = 0u; k < MOST_CANDIDATES && k < count; k++) {
                let place = (*candidates).places[k].xyz;
                let beyond = vec3f(
                    dot(cross(place - p, q - p), up), dot(cross(place - q, r - q), up), dot(cross(place - r, p - r), up));
                values[k] = greatest_of(beyond);
            }
            chosen.w = first_of_greatest(&values, count, 0.01, 0.0);
            taken = select(3u, 4u, values[chosen.w] > thin);
        }
    }
    var manifold = Manifold();
    manifold.normal = normal;
    manifold.count = taken;
    for (var k = 0u; k < MOST_POINTS && k < taken; k++) {
        let place = (*candidates).places[chosen[k]];
        manifold.on_a[k] = place.xyz + radii.x * normal;
        manifold.on_b[k] = place.xyz + (place.w - radii.y) * normal;
        manifold.ids[k] = (*candidates).ids[chosen[k]];
    }
    return manifold;
}
