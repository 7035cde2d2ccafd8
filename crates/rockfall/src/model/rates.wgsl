// requires model/order.wgsl model/step.wgsl physics/forces/rates.wgsl

// The rates that velocity Verlet keeps from its last force evaluation. They are in insertion order, so sorting memory does not
// change them.

fn kept_rates_of(i: u32) -> Rates {
    let at = RATE_WORDS * insertion_index(i);
    return Rates(
        vec3f(kept_rates[at], kept_rates[at + 1u], kept_rates[at + 2u]),
        vec3f(kept_rates[at + 3u], kept_rates[at + 4u], kept_rates[at + 5u]),
    );
}
