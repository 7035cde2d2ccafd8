// Up to 32 keys put in order in registers, by networks: few instructions, none of which depends on what the keys are, so that
// neighbouring threads do the same. (Batcher 1968.)

struct Sixteen {
    a: vec4u,
    b: vec4u,
    c: vec4u,
    d: vec4u,
}

// Four keys that first rise and then fall, or the other way round, in order.
fn ordered_4(v: vec4u) -> vec4u {
    let halves = vec4u(min(v.xy, v.zw), max(v.xy, v.zw));
    return vec4u(min(halves.x, halves.y), max(halves.x, halves.y), min(halves.z, halves.w), max(halves.z, halves.w));
}

fn sorted_4(v: vec4u) -> vec4u {
    return ordered_4(vec4u(min(v.x, v.y), max(v.x, v.y), max(v.z, v.w), min(v.z, v.w)));
}

// Sixteen keys that rise and fall.
fn ordered_16(s: Sixteen) -> Sixteen {
    let a = min(s.a, s.c);
    let b = min(s.b, s.d);
    let c = max(s.a, s.c);
    let d = max(s.b, s.d);
    return Sixteen(ordered_4(min(a, b)), ordered_4(max(a, b)), ordered_4(min(c, d)), ordered_4(max(c, d)));
}

// Puts the less half of two ordered sixteens into the first, in order, and gives the greater one.
fn merged(low: ptr<function, Sixteen>, high: Sixteen) -> Sixteen {
    let s = *low;
    let falling = Sixteen(high.d.wzyx, high.c.wzyx, high.b.wzyx, high.a.wzyx);
    *low = ordered_16(Sixteen(min(s.a, falling.a), min(s.b, falling.b), min(s.c, falling.c), min(s.d, falling.d)));
    return ordered_16(Sixteen(max(s.a, falling.a), max(s.b, falling.b), max(s.c, falling.c), max(s.d, falling.d)));
}

fn sorted_16(s: Sixteen) -> Sixteen {
    // Four columns, each in order.
    let p = min(s.a, s.b);
    let q = max(s.a, s.b);
    let r = min(s.c, s.d);
    let t = max(s.c, s.d);
    let first = min(p, r);
    let last = max(q, t);
    let x = max(p, r);
    let y = min(q, t);
    let second = min(x, y);
    let third = max(x, y);
    // They are rows now; the second and the fourth fall.
    let a = vec4u(first.x, second.x, third.x, last.x);
    let b = vec4u(last.y, third.y, second.y, first.y);
    let c = vec4u(first.z, second.z, third.z, last.z);
    let d = vec4u(last.w, third.w, second.w, first.w);
    // Two eights, of which the second falls.
    return ordered_16(
        Sixteen(ordered_4(min(a, b)), ordered_4(max(a, b)), ordered_4(max(c, d)).wzyx, ordered_4(min(c, d)).wzyx),
    );
}
