// requires model/step.wgsl physics/forces/rates.wgsl

// Angular damping: L' = -C L (docs/physics section 4.8).
fn add_angular_damping(i: u32, rates: ptr<function, Rates>) {
    (*rates).torque -= step.angular_damping * state[momentum_at(i)].xyz;
}
