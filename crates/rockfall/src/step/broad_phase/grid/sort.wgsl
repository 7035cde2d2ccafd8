// Sorting networks for up to 32 keys in registers (Batcher 1968). They take few instructions, which do not depend on the
// keys, so that neighbouring threads execute the same ones.

struct Sixteen {
    a: vec4u,
    b: vec4u,
    c: vec4u,
    d: vec4u,
}

// Sorts four keys that first rise and then fall, or first fall and then rise.
fn ordered_4(v: vec4u) -> vec4u {
    let halves = vec4u(min(v.xy, v.zw), max(v.xy, v.zw));
    return vec4u(min(halves.x, halves.y), max(halves.x, halves.y), min(halves.z, halves.w), max(halves.z, halves.w));
}

// Sorts any four keys.
fn sorted_4(v: vec4u) -> vec4u {
    return ordered_4(vec4u(min(v.x, v.y), max(v.x, v.y), max(v.z, v.w), min(v.z, v.w)));
}

// Sorts sixteen keys that first rise and then fall, or first fall and then rise.
fn ordered_16(s: Sixteen) -> Sixteen {
    let a = min(s.a, s.c);
    let b = min(s.b, s.d);
    let c = max(s.a, s.c);
    let d = max(s.b, s.d);
    return Sixteen(ordered_4(min(a, b)), ordered_4(max(a, b)), ordered_4(min(c, d)), ordered_4(max(c, d)));
}

// Merges two sorted sequences of sixteen keys. Writes the sixteen least keys to `low`, and returns the sixteen greatest, both
// sorted.
fn merged(low: ptr<function, Sixteen>, high: Sixteen) -> Sixteen {
    let s = *low;
    let falling = Sixteen(high.d.wzyx, high.c.wzyx, high.b.wzyx, high.a.wzyx);
    *low = ordered_16(Sixteen(min(s.a, falling.a), min(s.b, falling.b), min(s.c, falling.c), min(s.d, falling.d)));
    return ordered_16(Sixteen(max(s.a, falling.a), max(s.b, falling.b), max(s.c, falling.c), max(s.d, falling.d)));
}

// Sorts any sixteen keys.
fn sorted_16(s: Sixteen) -> Sixteen {
    // Sorts the four columns.
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
    // Turns the columns into rows. The second and the fourth row fall.
    let a = vec4u(first.x, second.x, third.x, last.x);
    let b = vec4u(last.y, third.y, second.y, first.y);
    let c = vec4u(first.z, second.z, third.z, last.z);
    let d = vec4u(last.w, third.w, second.w, first.w);
    // Makes two sequences of eight, a rising one and a falling one.
    return ordered_16(
        Sixteen(ordered_4(min(a, b)), ordered_4(max(a, b)), ordered_4(max(c, d)).wzyx, ordered_4(min(c, d)).wzyx),
    );
}
