// Sine and cosine with f32 accuracy. The built-in functions only guarantee an error of 2^-11, which is too much for the small
// angle of a step. The angle is reduced to [-pi/4, pi/4] by multiples of pi/2. Then Taylor series are evaluated.
fn sine_cosine(angle: f32) -> vec2f {
    let quarters = round(angle * 0.636619772);
    let x = (angle - quarters * 1.5707964) + quarters * 4.371139e-8;
    let xx = x * x;
    let s = x * (1.0 + xx * (-1.0 / 6.0 + xx * (1.0 / 120.0 + xx * (-1.0 / 5040.0 + xx * (1.0 / 362880.0)))));
    let c = 1.0 + xx * (-0.5 + xx * (1.0 / 24.0 + xx * (-1.0 / 720.0 + xx * (1.0 / 40320.0))));
    let quarter = i32(quarters - 4.0 * floor(quarters * 0.25));
    let swapped = select(vec2f(s, c), vec2f(c, s), (quarter & 1) == 1);
    return vec2f(select(swapped.x, -swapped.x, quarter >= 2), select(swapped.y, -swapped.y, (quarter == 1) | (quarter == 2)));
}
