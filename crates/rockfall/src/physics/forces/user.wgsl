// requires model/step.wgsl physics/forces/muscle.wgsl physics/forces/rates.wgsl

// Forces of the laws that the program gave (docs/physics section 4.14). In simulations with such laws,
// user_laws/forces.rs replaces this function.
fn add_user(i: u32, rates: ptr<function, Rates>) {}

// Time of the present force evaluation, in s. For such laws.
fn law_time() -> f32 {
    return fma(0.5 * step.dt, f32(half_steps()), step.time_base);
}
