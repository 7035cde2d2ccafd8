// requires physics/forces/body_forces.wgsl physics/forces/net_force.wgsl physics/forces/rates.wgsl

// The rates of change of a moving sphere: the net force of contacts and attachments, then the body forces.
fn sphere_rates(i: u32, inverse_mass: f32, net: Net) -> Rates {
    var rates = Rates(inverse_mass * net.force, net.torque);
    add_body_forces(i, &rates);
    return rates;
}
