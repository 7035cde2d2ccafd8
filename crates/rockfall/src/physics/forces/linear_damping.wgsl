// requires model/step.wgsl physics/forces/rates.wgsl

// Linear damping: v' = -C v (docs/physics section 4.8).
fn add_linear_damping(i: u32, rates: ptr<function, Rates>) {
    (*rates).acceleration -= step.linear_damping * state[velocity_at(i)].xyz;
}
