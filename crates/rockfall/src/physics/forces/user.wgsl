// requires physics/forces/rates.wgsl

// Forces of the laws that the program gave (docs/physics.md section 4.14). In simulations with such laws,
// user_laws/forces.rs replaces this function.
fn add_user(i: u32, rates: ptr<function, Rates>) {}
