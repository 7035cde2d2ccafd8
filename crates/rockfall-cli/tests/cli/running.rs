//! How a scene is run: the integrator that follows from its contact law.

use crate::common::Rockfall;

/// A grain on a floor, with Hertz's law.
const GRAIN: &str = "set contact_law hertz-mindlin\nset gravity 9.81\n@material glass density=2500 young=5e7 poisson=0.2\n\
                     @pair glass glass friction=0.3\n@use glass\nB -1 -1 -1 2 0 0 0 1 0 0 0 2\n\
                     S 1 0 0.0101 0 0 -0.5 0 0 0 0 - 0.01\n";

/// Scenes with a law that does not allow rk4 run without an option. The summary says what was chosen.
#[test]
fn the_integrator_follows_the_contact_law() {
    let rockfall = Rockfall::with(GRAIN);
    let run = "run scene.txt --backend cpu --dt 1e-5 --steps 5";
    let (out, _) = rockfall.run(run, 0);
    assert!(out.contains("integrator  velocity-verlet\n"), "{out}");
    let (out, _) = rockfall.run(&format!("{run} --integrator symplectic-euler"), 0);
    assert!(out.contains("integrator  symplectic-euler\n"), "{out}");
    let (out, _) = rockfall.run(&format!("{run} --set contact_law=thesis"), 0);
    assert!(out.contains("integrator  rk4\n"), "{out}");
    let (_, err) = rockfall.run(&format!("{run} --integrator rk4"), 2);
    assert!(err.contains("hertz-mindlin with the integrator rk4"), "{err}");
    let (out, _) = rockfall.run("check scene.txt --dt 1e-5", 0);
    assert!(out.contains("stable at a time step of 1e-5 s (velocity-verlet)"), "{out}");
}

/// A checkpoint has the integrator that was chosen. `auto` chooses again.
#[test]
fn a_resumed_run_keeps_the_integrator() {
    let rockfall = Rockfall::with(GRAIN);
    rockfall.run("run scene.txt --backend cpu --dt 1e-5 --steps 5 --integrator symplectic-euler --checkpoint a.ckpt", 0);
    let (out, _) = rockfall.run("run --resume a.ckpt --steps 8", 0);
    assert!(out.contains("integrator  symplectic-euler\n"), "{out}");
    let (_, err) = rockfall.run("run --resume a.ckpt --steps 10 --integrator auto", 0);
    assert!(err.contains("--integrator velocity-verlet instead of symplectic-euler from step 8 on"), "{err}");
}
