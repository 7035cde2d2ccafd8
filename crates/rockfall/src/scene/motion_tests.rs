use super::*;

fn near(one: DVec3, other: DVec3, error: f64) {
    assert!((one - other).length() <= error, "{one} {other}");
}

#[test]
fn terms_move_points_as_the_formula_says() {
    let slide = MotionTerm::translation([1.0, 2.0, 0.0]).during(0.5, 2.0);
    for (time, moved) in [(0.0, 0.0), (0.5, 0.0), (1.0, 0.5), (2.0, 1.5), (9.0, 1.5)] {
        near(Motion::new("a", slide).pose(time).of_point(DVec3::Z)[0], DVec3::Z + moved * DVec3::new(1.0, 2.0, 0.0), 0.0);
    }
    let shake = MotionTerm::oscillation([0.0, 0.1, 0.0], 2.0).phase(0.25);
    let [place, velocity, acceleration] = Motion::new("b", shake).pose(0.125).of_point(DVec3::ZERO);
    // A quarter of a period after the greatest displacement.
    near(place, DVec3::new(0.0, -0.1, 0.0), 1e-15);
    near(velocity, DVec3::new(0.0, -0.1 * 2.0 * TAU, 0.0), 1e-14);
    near(acceleration, DVec3::ZERO, 1e-13);
    let turn = MotionTerm::turn(0.5 * TAU, [0.0, 0.0, 3.0], [1.0, 0.0, 0.0]);
    let pose = Motion::new("c", turn).pose(0.5);
    let [place, velocity, acceleration] = pose.of_point(DVec3::new(2.0, 0.0, 7.0));
    near(place, DVec3::new(1.0, 1.0, 7.0), 1e-15);
    near(velocity, DVec3::new(-0.5 * TAU, 0.0, 0.0), 1e-14);
    near(acceleration, DVec3::new(0.0, -0.25 * TAU * TAU, 0.0), 1e-13);
    near(pose.spin(), DVec3::new(0.0, 0.0, 0.5 * TAU), 1e-14);
}

#[test]
fn nothing_drifts_in_a_hundred_thousand_turns() {
    let turn = Motion::new("drum", MotionTerm::turn(TAU, DVec3::X, DVec3::ZERO));
    near(turn.pose(1e5 + 0.25).of_point(DVec3::Y)[0], DVec3::Z, 1e-9);
}

/// Derivatives of nested motions, by differences.
#[test]
fn velocities_and_accelerations_are_derivatives() {
    let outer = MotionTerm::turn(1.3, [0.3, 1.0, -0.2], [1.0, 2.0, 3.0]);
    let swing =
        MotionTerm { velocity: DVec3::new(0.1, -0.3, 0.2), ..MotionTerm::oscillation([0.4, 0.0, -0.1], 0.7).phase(0.2) };
    let inner = MotionTerm::turn(-2.1, [1.0, 0.1, 0.0], [-0.5, 0.2, 0.0]);
    let motion = Motion::new("nested", outer).and(swing).and(inner);
    let (time, h, point) = (0.83, 1e-4, DVec3::new(0.3, -0.7, 1.1));
    let at = |time: f64| motion.pose(time).of_point(point);
    let [before, now, after] = [at(time - h), at(time), at(time + h)];
    near(now[1], (after[0] - before[0]) / (2.0 * h), 1e-7);
    near(now[2], (after[1] - before[1]) / (2.0 * h), 1e-6);
    // The spin tells the relative velocity of two points.
    let other = motion.pose(time).of_point(DVec3::ZERO);
    near(now[1] - other[1], motion.pose(time).spin().cross(now[0] - other[0]), 1e-12);
}

#[test]
fn a_later_motion_begins_where_the_earlier_one_is() {
    let term = MotionTerm { velocity: DVec3::X, ..MotionTerm::turn(2.0, DVec3::Y, DVec3::X) };
    let motion = Motion::new("m", term.during(1.0, 4.0));
    for time in [0.0, 1.5, 7.0] {
        near(motion.after(2.0).pose(time).of_point(DVec3::ONE)[0], motion.pose(2.0 + time).of_point(DVec3::ONE)[0], 1e-14);
    }
}

#[test]
fn wrong_motions_are_refused() {
    let mut scene = Scene::new();
    let refused = |scene: &mut Scene, motion: Motion| scene.add_motion(motion).unwrap_err().to_string();
    let plain = MotionTerm::default();
    for (term, field) in [
        (MotionTerm { velocity: DVec3::NAN, ..plain }, "motion.velocity"),
        (MotionTerm { spin: f64::INFINITY, ..plain }, "motion.spin"),
        (MotionTerm { axis: DVec3::ZERO, ..plain }, "motion.axis"),
        (MotionTerm { frequency: -1.0, ..plain }, "motion.frequency"),
        (plain.during(2.0, 1.0), "motion.to"),
    ] {
        assert!(refused(&mut scene, Motion::new("a", term)).contains(field), "{field}");
    }
    assert!(refused(&mut scene, Motion::new("two words", plain)).contains("motion.name"));
    scene.add_motion(Motion::new("a", plain)).unwrap();
    assert!(refused(&mut scene, Motion::new("a", plain)).contains("no other motion"));
}

#[test]
fn a_table_goes_through_its_points_and_rests_outside() {
    let places = [DVec3::ZERO, DVec3::new(1.0, 0.0, 0.0), DVec3::new(1.0, 2.0, 0.0)];
    let motion = Motion::table("lift", &[1.0, 2.0, 4.0], &places).unwrap();
    let at = |time: f64| motion.pose(time).of_point(DVec3::ZERO);
    for (time, place, velocity) in [
        (0.5, [0.0, 0.0, 0.0], [0.0; 3]),
        (1.5, [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]),
        (2.0, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        (3.0, [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]),
        (9.0, [1.0, 2.0, 0.0], [0.0; 3]),
    ] {
        assert!(at(time)[0].distance(DVec3::from(place)) < 1e-14, "{time}: {}", at(time)[0]);
        assert!(at(time)[1].distance(DVec3::from(velocity)) < 1e-14, "{time}: {}", at(time)[1]);
    }
    for (times, places) in [(&[0.0][..], &places[..1]), (&[0.0, 1.0], &places), (&[1.0, 1.0, 2.0], &places)] {
        assert!(Motion::table("lift", times, places).is_err(), "{times:?}");
    }
}

#[test]
fn a_motion_goes_on_without_a_jump() {
    let shake = MotionTerm::oscillation([0.0, 0.3, 0.0], 2.0);
    let mut motion = Motion::new("drum", MotionTerm::turn(3.0, [0.0, 0.0, 1.0], [1.0, 2.0, 0.0])).and(shake);
    let point = DVec3::new(4.0, -1.0, 2.0);
    let [before, _, _] = motion.pose(0.7).of_point(point);
    motion.go_on(0.7, MotionTerm::turn(-1.0, [0.0, 0.0, 1.0], [1.0, 2.0, 0.0]));
    let [place, velocity, _] = motion.pose(0.7).of_point(point);
    assert!(place.distance(before) < 1e-13, "{place} {before}");
    let expected = DVec3::new(0.0, 0.0, -1.0).cross(place - DVec3::new(1.0, 2.0, 0.0));
    assert!(velocity.distance(expected) < 1e-12, "{velocity} {expected}");
    // And stops.
    motion.go_on(1.0, MotionTerm::default());
    let [there, still, _] = motion.pose(1.0).of_point(point);
    assert_eq!(motion.pose(5.0).of_point(point)[0], there);
    assert_eq!(still, DVec3::ZERO);
}
