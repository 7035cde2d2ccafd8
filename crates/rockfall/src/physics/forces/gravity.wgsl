// requires model/step.wgsl physics/forces/rates.wgsl

// Gravity (docs/physics section 4.1).
fn add_gravity(i: u32, rates: ptr<function, Rates>) {
    (*rates).acceleration += step.gravity;
}
