// The angle of the direction (x, y) from the x-axis, in [-pi, pi], with an error below 3e-7. The built-in function only guarantees an error
// of 4096 units in the last place. The angle is reduced to [-pi/8, pi/8]. 0 without a direction.
fn arc_of(y: f32, x: f32) -> f32 {
    let low = min(abs(x), abs(y));
    let high = max(abs(x), abs(y));
    if high == 0.0 {
        return 0.0;
    }
    // tan(pi/8).
    let is_steep = low > 0.41421357 * high;
    let t = select(low, low - high, is_steep) / select(high, low + high, is_steep);
    let tt = t * t;
    let rest = tt * (-0.33332949 + tt * (0.19977711 + tt * (-0.13877686 + tt * 0.080537446)));
    var angle = select(0.0, 0.78539816, is_steep) + (t + t * rest);
    angle = select(angle, 1.5707964 - angle, abs(y) > abs(x));
    angle = select(angle, 3.1415927 - angle, x < 0.0);
    return select(angle, -angle, y < 0.0);
}
