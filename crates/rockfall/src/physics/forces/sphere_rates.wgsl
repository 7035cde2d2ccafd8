// requires physics/forces/body_forces.wgsl physics/forces/load.wgsl physics/forces/rates.wgsl

// The rates of change of a moving sphere: its load, then the body forces.
fn sphere_rates(i: u32, inverse_mass: f32, load: Load) -> Rates {
    var rates = Rates(inverse_mass * load.force, load.torque);
    add_body_forces(i, &rates);
    return rates;
}
