//! Scenes in which a backend once deviated from the specification.

use rockfall::{Backend, Integrator};

use crate::compare::{Tally, Trial};
use crate::known::parse;
use crate::scenes::{Plan, Regime};

/// Compares one step, phase by phase.
#[track_caller]
fn assert_agreement_on(text: &str, dt: f32) {
    let scene = parse(text);
    let regimes = vec![Regime { settings: scene.settings, dt }];
    let plan = Plan { integrator: Integrator::Rk4, regimes, clusters: vec![scene] };
    let mut tally = Tally::default();
    Trial { name: String::new(), plan: &plan, backend: Backend::Cpu, steps: 1, mistake: None, phases: true }.run(&mut tally);
    assert!(tally.compared == 2 && tally.failures.is_empty(), "{tally}\n{}", tally.failures.concat());
}

/// Friction after a lone collision with edge 1 (docs/physics sections 2.10 and 3.9). After the collision the rod is
/// 0.044 away from the edge. The point of its axis that is nearest to vertex 1 is inside the box, but the rod did not
/// collide with vertex 1.
#[test]
fn friction_acts_at_the_nearer_feature_of_a_box() {
    let scene = "S 2 -0.6100964 0.6655292 -0.2699297 2.7823007 5.8145304 6.2734885 0 0 0 0.76898295 0.08707547 0
S 3 0.10412726 -0.49607384 0.5345585 2.8014944 5.9099526 6.04186 0 0 0 1.4561378 0.07546353 0
R 2 3 0.120265976
B -0.45815337 -0.69746774 -0.33333048 -0.123801544 0.8405989 1.0028952 0.63779163 -0.1765056 0.22667375 0.40231666 0.73084223 -0.562908
set collision_friction 0.78
set gravity 0";
    assert_agreement_on(scene, 0.0233);
}

/// A light ball touches a fixed ball and one of two heavy balls that collide (docs/physics section 3.7). The impulse
/// on the light ball is 9, that between the heavy balls 50,000. The impulse on the light ball changes by a relative
/// 3e-4 when the sweeps end after 12 instead of 16.
#[test]
fn a_light_ball_next_to_heavy_ones_gets_its_impulse() {
    let scene = "S 0 -0.015633345 0.1373105 0.45142108 0.31106305 0.9614935 -0.65790844 0 0 0 21316.133 0.3519951
S 1 0.21045457 0.50528646 -0.07335477 -1.3624084 -1.1025631 -0.76890886 0 0 0 1.5014361 0.2783329
S 2 0.58091843 0.36388820 -0.15398712 -2.1004171 -1.7111472 0.3996402 0 0 0 0.5783867 0.39474308 1
S 3 0.07208848 0.391635 0.38116053 1.5092633 -2.6168621 -1.9467591 0 0 0 18251.295 0.31563774
set gravity 0
set restitution 1
set friction 0";
    assert_agreement_on(scene, 0.00475);
}

/// The ends of a capsule may move apart at 0.3 at the start of a scene. At the time of contact the capsule was then
/// shorter (docs/physics sections 3.3 and 3.6).
#[test]
fn a_capsule_whose_ends_move_apart_was_shorter_at_the_time_of_contact() {
    let scene = "S 1 -0.3 0.18 -0.24 -0.5508 -1.26752 -0.05064 0.013824 0.0036 -0.02208 0.75 0.2
S 2 0.3 0.82 0.24 0.9508 -2.73248 0.65064 0.02304 0.006 -0.0368 1.25 0.2
R 1 2 0.1 1
P -5 0.02 -5 0 0 10 10 0 0
set gravity 0
set restitution 0.5";
    assert_agreement_on(scene, 0.02);
}
