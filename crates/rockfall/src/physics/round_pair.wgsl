// requires model/step.wgsl

// Contacts of round objects, and the rules for rounding (docs/physics sections 2.3 and 2.6). A is the object that was added first. n points
// from A to B.

struct Touch {
    n: vec3f,
    // Positive where the objects touch.
    overlap: f32,
    // Parameter of the contact on A if A is a rod, from 0 at end 1 to 1 at end 2.
    a: f32,
    // Parameter of the contact on B if B is a rod.
    b: f32,
}

// The axis of a rod.
struct Axis {
    start: vec3f,
    along: vec3f,
    radius: f32,
}

// Value of `overlap` for a pair without a contact line. It is not 0, because 0 is a possible overlap of a pair with one.
const NO_CONTACT_LINE: f32 = -3e38;

fn no_touch() -> Touch {
    return Touch(vec3f(0.0, 1.0, 0.0), NO_CONTACT_LINE, 0.0, 0.0);
}

// Relative size of a rounding error: a difference of vectors counts as 0 up to this times their length (docs/physics section
// 2.3).
const ROUNDED: f32 = 5e-7;
// A distance above this part of the distance at which a pair begins to touch never counts as a rounding error.
const SMALL: f32 = 0.01;

// A distance vector, and 0 where it is only a rounding error. `squared` is the squared length of the vectors that the distance
// is a difference of. Where the distance is nearly 0, these vectors are no longer than the segments. `reach` is the distance
// at which the pair begins to touch.
fn unrounded(distance: vec3f, squared: f32, reach: f32) -> vec3f {
    let rounded = min(ROUNDED * ROUNDED * squared, SMALL * SMALL * reach * reach);
    return select(distance, vec3f(0.0), dot(distance, distance) <= rounded);
}

// A vector without its component along an axis. `squared` is the squared length of the axis. A distance vector from a line has
// such a component only because the parameter is rounded. The component would change the direction of a very short distance.
fn across(v: vec3f, axis: vec3f, squared: f32) -> vec3f {
    return v - dot(v, axis) / squared * axis;
}

// Contact of two round objects, from the distance vector, which points from A to B, and `reach`, the sum of the radii.
fn touch_at(distance: vec3f, reach: f32, a: f32, b: f32, normal_at_zero: vec3f) -> Touch {
    let squared = dot(distance, distance);
    if squared <= TINY {
        return Touch(normal_at_zero, reach, a, b);
    }
    let d = sqrt(squared);
    return Touch(distance / d, reach - d, a, b);
}

// A parameter that is beyond an end by at most this belongs to the segment, so that rounding errors do not decide.
const AT_END: f32 = 1e-6;

fn unit_interval(x: f32) -> bool {
    return abs(x - 0.5) <= 0.5 + AT_END;
}
