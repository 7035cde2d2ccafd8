// requires model/order.wgsl model/step.wgsl physics/forces/rates.wgsl

// Keeps the rates of a sphere for the next step of velocity Verlet.
fn put_rates(i: u32, rates: Rates) {
    let at = RATE_WORDS * insertion_index(i);
    for (var k = 0u; k < 3u; k++) {
        kept_rates[at + k] = rates.acceleration[k];
        kept_rates[at + 3u + k] = rates.torque[k];
    }
}
