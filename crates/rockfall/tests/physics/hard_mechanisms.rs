//! Mechanisms of joints under the contact law `rigid` (docs/physics section 11.14) against closed forms and
//! published solutions. Those of
//! IFToMM's library of computational benchmark problems (www.iftomm-multibody.org/benchmark) are named so.

use std::f64::consts::TAU;
use std::path::Path;

use rockfall::glam::{DVec2, DVec3};
use rockfall::{Backend, JointReading, Scene, Simulation};

use crate::common::{on, simulation};

both! {
    a_double_pendulum_keeps_to_its_modes,
    a_hanging_chain_swings_with_the_root_of_laguerre,
    the_end_of_a_folded_chain_outruns_a_free_fall,
    an_atwood_machine_of_a_balance,
    a_gyroscope_turns_its_gimbal,
    four_bars_in_a_row_fall_as_one,
    a_bricard_mechanism_swings_without_loss,
    the_squeezer_of_andrews_opens_as_published,
}

const FRAME: f32 = 1.0 / 60.0;
const G: f64 = 9.81;

fn read(text: &str) -> Scene {
    Scene::parse(text, Path::new("mechanism.txt")).unwrap_or_else(|error| panic!("{error}\n{text}")).scene
}

fn advance(simulation: &mut Simulation, frames: u64) -> Vec<JointReading> {
    simulation.run(frames, FRAME).expect("frames");
    simulation.joints().expect("joints")
}

fn head(substeps: u32, gravity: f64) -> String {
    format!("set contact_law rigid\nset gravity {gravity}\n@run substeps={substeps}\n")
}

fn point(at: DVec3) -> String {
    format!("{},{},{}", at.x, at.y, at.z)
}

/// A slender rod of a mass from one point to another one. Its shape is small: the bodies of a mechanism pass through each other.
fn rod(name: &str, [from, to]: [DVec3; 2], mass: f64) -> String {
    let along = to - from;
    let across = mass * along.length_squared() / 12.0;
    let (axis, turn) = turn_of_x(along.normalize());
    // The part about the rod itself is that of a cylinder of a radius of a thirtieth.
    let about = 0.5 * mass * along.length_squared() / 900.0;
    format!(
        "@body {name} mass={mass} centre=0,0,0 inertia={about},{across},{across},0,0,0\nS 1 0 0 0 0 0 0 0 0 0 1 0.01\n@end\n\
         @place {name} at={} axis={} turn={turn} name={name}\n",
        point(0.5 * (from + to)),
        point(axis)
    )
}

/// The axis, and the angle in degrees, that turn x into a direction.
fn turn_of_x(to: DVec3) -> (DVec3, f64) {
    let axis = DVec3::X.cross(to);
    (if axis.length() > 1e-9 { axis } else { DVec3::Y }, axis.length().atan2(to.x).to_degrees())
}

fn hinge(a: &str, b: &str, at: DVec3, axis: DVec3) -> String {
    format!("@joint hinge {a} {b} at={} axis={}\n", point(at), point(axis))
}

/// Two rods of length 1: omega² = g (3 -+ 6 / sqrt 7). A mode keeps the ratio of its angles.
fn a_double_pendulum_keeps_to_its_modes(backend: Backend) {
    for sign in [-1.0, 1.0] {
        let square = 3.0 + sign * 6.0 / 7.0_f64.sqrt();
        // From the first row of (K - omega² M) (one, other) = 0.
        let ratio = (1.5 - 4.0 / 3.0 * square) / (0.5 * square);
        let (one, other) = if ratio.abs() > 1.0 { (0.02 / ratio, 0.02) } else { (0.02, 0.02 * ratio) };
        let down = |angle: f64| DVec3::new(angle.sin(), -angle.cos(), 0.0);
        let (middle, end) = (down(one), down(one) + down(other));
        let text = [
            head(16, G),
            rod("a", [DVec3::ZERO, middle], 1.0),
            rod("b", [middle, end], 1.0),
            hinge("world", "a", DVec3::ZERO, DVec3::Z),
            hinge("a", "b", middle, DVec3::Z),
        ];
        let mut simulation = simulation(read(&text.concat()), backend);
        let omega = (G * square).sqrt();
        for frame in 1..=on(backend, 240, 20) {
            let joints = advance(&mut simulation, 1);
            let phase = (omega * f64::from(FRAME) * frame as f64).cos();
            let [a, b] = [f64::from(joints[0].position), f64::from(joints[0].position + joints[1].position)];
            let [wanted_a, wanted_b] = [one * (phase - 1.0), other * (phase - 1.0)];
            let off = (a - wanted_a).abs().max((b - wanted_b).abs());
            assert!(off < 1.5e-3, "mode {sign}, frame {frame}: {a} {b}, not {wanted_a} {wanted_b}");
        }
    }
}

/// Ten equal masses at equal distances: the lowest frequency is that of the least root x of the Laguerre polynomial L10, omega² = x g / a.
fn a_hanging_chain_swings_with_the_root_of_laguerre(backend: Backend) {
    const ROOT: f64 = 0.137793470540493;
    let (count, length) = (10_usize, 0.1);
    // Displacement of the mass k from the bottom: L_k(x).
    let mut shape = vec![1.0, 1.0 - ROOT];
    for k in 1..count {
        let k = k as f64;
        let next = ((2.0 * k + 1.0 - ROOT) * shape[k as usize] - k * shape[k as usize - 1]) / (k + 1.0);
        shape.push(next);
    }
    assert!(shape[count].abs() < 1e-9, "a root: {}", shape[count]);
    let place = |mass: usize| DVec3::new(0.02 * shape[mass], -length * (count - mass) as f64, 0.0);
    let mut text = head(16, G);
    for mass in 0..count {
        let at = place(mass);
        text += &format!("S {} {} {} 0 0 0 0 0 0 0 1 0.01\n", mass + 1, at.x, at.y);
    }
    for mass in 0..count {
        let above = if mass + 1 == count { DVec3::ZERO } else { place(mass + 1) };
        let other = if mass + 1 == count { "world".to_owned() } else { (mass + 2).to_string() };
        text += &format!("@joint distance {} {other} at={} to={}\n", mass + 1, point(place(mass)), point(above));
    }
    let mut simulation = simulation(read(&text), backend);
    let omega = (ROOT * G / length).sqrt();
    for frame in 1..=on(backend, 200, 20) {
        advance(&mut simulation, 1);
        let found = f64::from(simulation.sync().expect("states").spheres()[0].position.x);
        let wanted = 0.02 * (omega * f64::from(FRAME) * frame as f64).cos();
        assert!((found - wanted).abs() < 6e-4, "frame {frame}: {found}, not {wanted}");
    }
}

/// A chain of length L hangs from both ends, side by side. One is let go, and falls earlier than a body that falls
/// freely: without loss by L in 0.847213
/// sqrt(2 L / g) (Calkin and March, Am. J. Phys. 57, 154 (1989)). Here it falls by 0.9 L, and the fold of a chain of links loses a little.
fn the_end_of_a_folded_chain_outruns_a_free_fall(backend: Backend) {
    let count = 40;
    let link = 1.0 / count as f64;
    // Down on the left and up on the right of a narrow fold.
    let half = count / 2;
    let place = |k: usize| {
        let depth = if k <= half { k } else { count - k };
        DVec3::new(if k <= half { 0.0 } else { 0.25 * link }, -(depth as f64) * link, 0.0)
    };
    let mut text = head(32, G);
    for k in 1..=count {
        let at = place(k);
        text += &format!("@group {k}\nS {k} {} {} 0 0 0 0 0 0 0 1 0.001\n", at.x, at.y);
    }
    for k in 1..=count {
        let before = if k == 1 { "world".to_owned() } else { (k - 1).to_string() };
        text += &format!("@joint distance {k} {before} at={} to={}\n", point(place(k)), point(place(k - 1)));
    }
    let mut simulation = simulation(read(&text), backend);
    let (mut before, mut frame) = (0.0, 0_u32);
    let time = loop {
        advance(&mut simulation, 1);
        frame += 1;
        let height = f64::from(simulation.sync().expect("states").spheres()[count - 1].position.y);
        if height < -0.9 {
            break f64::from(FRAME) * (f64::from(frame) - (-0.9 - height) / (before - height));
        }
        before = height;
        assert!(frame < 60, "the end is still at {height}");
    };
    // The time without loss: an integral over the way, with the speed that the energy gives.
    let steps = 2000;
    let wanted: f64 = (0..steps)
        .map(|k| {
            let y = 0.9 * (f64::from(k) + 0.5) / f64::from(steps);
            // Mass (1 - y) / 2 moves; the potential energy falls by g (y / 2 - y² / 4) per mass of the chain.
            let speed = (2.0 * G * (0.5 * y - 0.25 * y * y) / (0.5 * (1.0 - y))).sqrt();
            0.9 / f64::from(steps) / speed
        })
        .sum();
    let free = (2.0 * 0.9 / G).sqrt();
    assert!((time / wanted - 1.0).abs() < 0.1, "{time}, not {wanted}; a free fall takes {free}");
    assert!(time < 0.96 * free, "{time}, a free fall takes {free}");
}

/// Two masses on threads at the ends of a light balance: a = g (m1 - m2) / (m1 + m2) while it turns little.
fn an_atwood_machine_of_a_balance(backend: Backend) {
    let text = [
        head(16, G),
        rod("beam", [DVec3::new(-1.0, 0.0, 0.0), DVec3::new(1.0, 0.0, 0.0)], 0.03),
        hinge("world", "beam", DVec3::ZERO, DVec3::Z),
        "S 1 -1 -1 0 0 0 0 0 0 0 1.1 0.05\nS 2 1 -1 0 0 0 0 0 0 0 1 0.05\n".to_owned(),
        "@joint distance beam 1 at=-1,0,0 to=-1,-1,0\n@joint distance beam 2 at=1,0,0 to=1,-1,0\n".to_owned(),
    ];
    let mut simulation = simulation(read(&text.concat()), backend);
    let joints = advance(&mut simulation, 20);
    let time = 20.0 * f64::from(FRAME);
    // The beam, as a third of its mass at both ends together.
    let pull = G * 0.1 / (2.1 + 0.01);
    // The threads are as long as each other: a light beam between heavy bodies gives way by 0.6 mm at both ends.
    let spheres = simulation.sync().expect("states").spheres();
    let found = 0.5 * f64::from(spheres[2].position.y - spheres[1].position.y);
    let wanted = 0.5 * pull * time * time;
    assert!((found / wanted - 1.0).abs() < 0.01, "{found}, not {wanted}");
    for (reading, mass, way) in [(joints[1], 1.1, -1.0), (joints[2], 1.0, 1.0)] {
        let (force, wanted) = (f64::from(reading.force.y), mass * (G + way * pull));
        assert!((force / wanted - 1.0).abs() < 0.01, "{force}, not {wanted}");
    }
}

/// A wheel that spins in two rings: a weight m on its axis at the distance l turns the outer ring at m g l / (J omega).
/// Substeps are short: with turns of
/// 0.2 rad, the nutation of the wheel in its bearings grows.
fn a_gyroscope_turns_its_gimbal(backend: Backend) {
    let body = |name: &str, mass: f64, inertia: [f64; 3], more: &str| {
        let ([x, y, z], group) = (inertia, name.len());
        format!(
            "@body {name} mass={mass} centre=0,0,0 inertia={x},{y},{z},0,0,0\n@group {group}\nS 1 0 0 0 0 0 0 0 0 0 1 0.01\n@end\n\
             @place {name} at=0,0,0 name={name} {more}\n"
        )
    };
    let (spin, along, mass, arm) = (200.0, 0.01, 0.2, 0.1);
    let text = [
        head(64, G),
        body("wheel", 1.0, [along, 0.006, 0.006], &format!("spin={spin},0,0")),
        body("ring", 0.2, [0.002, 0.002, 0.002], ""),
        body("gimbal", 0.2, [0.002, 0.002, 0.002], ""),
        format!("@group 1\nS 1 {arm} 0 0 0 0 0 0 0 0 {mass} 0.02\n"),
        hinge("world", "gimbal", DVec3::ZERO, DVec3::Y),
        hinge("gimbal", "ring", DVec3::ZERO, DVec3::Z),
        hinge("ring", "wheel", DVec3::ZERO, DVec3::X),
        format!("@joint fixed ring 1 at={arm},0,0\n"),
    ];
    let mut simulation = simulation(read(&text.concat()), backend);
    let frames = on(backend, 300, 60);
    let joints = advance(&mut simulation, frames);
    let (found, wanted) = (f64::from(joints[0].position), mass * G * arm / (along * spin) * f64::from(FRAME) * frames as f64);
    assert!((found / wanted - 1.0).abs() < 0.02, "{found}, not {wanted}");
    assert!(joints[1].position.abs() < 0.02, "the inner ring leans by {}", joints[1].position);
}

/// IFToMM's N-four-bar mechanism with N = 2: five rods of 1 m and 1 kg, which start upright with 1 m/s. It passes
/// through places in which all rods lie along one
/// line. It moves as a parallelogram, so a pendulum of one angle has its solution; the energy is to stay within 0.1 J for 10 s.
fn four_bars_in_a_row_fall_as_one(backend: Backend) {
    let mut text = head(16, G);
    let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    for k in 0..3 {
        let x = f64::from(k);
        let leg = rod(&format!("leg{k}"), [at(x, 0.0), at(x, 1.0)], 1.0);
        text += &leg.replace(&format!("name=leg{k}"), &format!("name=leg{k} velocity=0.5,0,0 spin=0,0,-1"));
        text += &hinge("world", &format!("leg{k}"), at(x, 0.0), DVec3::Z);
    }
    for k in 0..2 {
        let x = f64::from(k);
        let top = rod(&format!("top{k}"), [at(x, 1.0), at(x + 1.0, 1.0)], 1.0);
        text += &top.replace(&format!("name=top{k}"), &format!("name=top{k} velocity=1,0,0"));
        text += &hinge(&format!("leg{k}"), &format!("top{k}"), at(x, 1.0), DVec3::Z);
        text += &hinge(&format!("top{k}"), &format!("leg{}", k + 1), at(x + 1.0, 1.0), DVec3::Z);
    }
    let mut simulation = simulation(read(&text), backend);
    // Half of 3 m l² / 3 + 2 m l² = 3 times the square of the rate; the weight of 3 legs at half of the height, of 2 rods at the whole.
    let (mut angle, mut rate) = (0.0_f64, 1.0_f64);
    let energy = |simulation: &mut Simulation| {
        let energy = simulation.energy().expect("energies");
        energy.kinetic + energy.potential
    };
    let start = energy(&mut simulation);
    let frames = on(backend, 600, 60);
    for frame in 1..=frames {
        let joints = advance(&mut simulation, 1);
        let steps = 2000;
        for _ in 0..steps {
            let h = f64::from(FRAME) / f64::from(steps);
            rate += h * 3.5 * G / 3.0 * angle.sin();
            angle += h * rate;
        }
        let found = -f64::from(joints[0].position);
        let off = (found - angle - TAU * ((found - angle) / TAU).round()).abs();
        assert!(off < 0.02 + 2e-4 * frame as f64, "frame {frame}: {found}, not {angle}");
        assert!(joints.iter().all(|joint| joint.error < 3e-3), "frame {frame}: {joints:?}");
    }
    let end = energy(&mut simulation);
    assert!((end - start).abs() < 0.1, "{start} J, then {end} J");
}

/// IFToMM's Bricard mechanism: five rods of 1 m and 1 kg along edges of a cube, hinged at right angles, move only
/// because of their symmetry.
fn a_bricard_mechanism_swings_without_loss(backend: Backend) {
    let corners = [[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]];
    let corners = corners.map(|corner| DVec3::from_array(corner.map(f64::from)));
    let mut text = head(32, G);
    for k in 0..5 {
        text += &rod(&format!("rod{k}"), [corners[k], corners[k + 1]], 1.0);
    }
    let name = |k: usize| if k < 5 { format!("rod{k}") } else { "world".to_owned() };
    for k in 0..6 {
        let before = (k + 5) % 6;
        let axis = (corners[k] - corners[before]).cross(corners[(k + 1) % 6] - corners[k]);
        text += &hinge(&name(before), &name(k), corners[k], axis);
    }
    let mut simulation = simulation(read(&text), backend);
    let energy = |simulation: &mut Simulation| simulation.energy().expect("energies");
    let start = energy(&mut simulation);
    let start = start.kinetic + start.potential;
    let (mut fastest, mut widest) = (0.0_f64, 0.0_f32);
    for frame in 1..=on(backend, 600, 60) {
        let joints = advance(&mut simulation, 1);
        let now = energy(&mut simulation);
        let change = now.kinetic + now.potential - start;
        fastest = fastest.max(now.kinetic);
        widest = joints.iter().fold(widest, |widest, joint| widest.max(joint.error));
        assert!(change.abs() < 0.05, "frame {frame}: {change} J of {fastest}");
    }
    assert!(fastest > on(backend, 44, 20) as f64 / 10.0, "it moves: {fastest} J");
    assert!(widest < 1e-4, "its hinges open by {widest}");
}

/// Cosine and sine.
fn unit(angle: f64) -> DVec2 {
    DVec2::from_angle(angle)
}

/// The angles of the squeezer in rad: beta, theta, gamma, phi, delta, omega, epsilon.
type Angles = [f64; 7];

const AT_START: Angles = [
    -0.061_713_890_014_276_45,
    0.0,
    0.455_279_819_163_070_4,
    0.222_668_390_165_885_9,
    0.487_364_979_543_842_55,
    -0.222_668_390_165_885_9,
    1.230_547_444_549_821_2,
];
const AFTER_30_MS: Angles = [
    15.810_771_196_299_04,
    -15.756_371_059_842_98,
    0.040_822_240_130_731_01,
    -0.534_730_116_322_694_8,
    0.524_409_965_880_530_4,
    0.534_730_116_322_694_8,
    1.048_080_741_042_263,
];

/// The points of the squeezer that do not move, in cm.
const A: DVec2 = DVec2::new(-6.934, -0.227);
const B: DVec2 = DVec2::new(-3.635, 3.273);
const C: DVec2 = DVec2::new(1.4, 7.2);

/// The joints of the squeezer that move: of K1 and K2, of K4 and K5, of K6 and K7, and where four rods meet.
fn joints_of_squeezer([beta, theta, _, _, delta, _, epsilon]: Angles) -> [DVec2; 4] {
    let elbow = 0.7 * unit(beta);
    [elbow, A + 4.0 * unit(delta), A - 4.0 * unit(epsilon).perp(), elbow - 2.8 * unit(beta + theta)]
}

/// Of each rod: mass in 0.1 g, moment of inertia in 0.1 g cm², centre in cm.
fn rods_of_squeezer([beta, theta, gamma, phi, delta, omega, epsilon]: Angles) -> [(f64, f64, DVec2); 7] {
    let (three, five, seven) = (unit(gamma), unit(delta), unit(epsilon));
    [
        (432.5, 219.4, 0.092 * unit(beta)),
        (36.5, 44.1, 0.7 * unit(beta) - 1.15 * unit(beta + theta)),
        (237.3, 525.5, B - 1.874 * three.perp() + 1.043 * three),
        (70.6, 56.67, A + 4.0 * five - (2.0 - 1.421) * unit(phi + delta).perp()),
        (705.0, 1169.0, A + 2.308 * five + 0.916 * five.perp()),
        (70.6, 56.67, A - 4.0 * seven.perp() + (2.0 - 1.421) * unit(omega + epsilon)),
        (549.8, 1912.0, A - 1.228 * seven.perp() - 0.449 * seven),
    ]
}

fn text_of_squeezer() -> String {
    let flat = |at: DVec2| point(at.extend(0.0));
    let mut text = head(16, 0.0);
    for (number, (mass, inertia, centre)) in (1..).zip(rods_of_squeezer(AT_START)) {
        let across = 0.6 * inertia;
        text += &format!(
            "@body k{number} mass={mass} centre=0,0,0 inertia={across},{across},{inertia},0,0,0\n@group {number}\n\
             S 1 0 0 0 0 0 0 0 0 0 1 0.1\n@end\n@place k{number} at={} name=k{number}\n",
            flat(centre)
        );
    }
    let [elbow, five, seven, meeting] = joints_of_squeezer(AT_START);
    let ends = [("world", "k1", DVec2::ZERO), ("world", "k3", B), ("world", "k5", A), ("world", "k7", A), ("k1", "k2", elbow)];
    let more = [("k5", "k4", five), ("k7", "k6", seven), ("k3", "k2", meeting), ("k3", "k4", meeting), ("k3", "k6", meeting)];
    for (a, b, at) in ends.into_iter().chain(more) {
        let motor = if b == "k1" { "speed=1000 torque=3.3" } else { "" };
        text += &format!("@joint hinge {a} {b} at={} axis=0,0,1 {motor}\n", flat(at));
    }
    let three = unit(AT_START[2]);
    let spring = B - 1.8 * three.perp() + 2.0 * three;
    text + &format!("@joint distance k3 world at={} to={} stiffness=45.3 target=7.785\n", flat(spring), flat(C))
}

/// The squeezer of Andrews with the data and the solution of Hairer and Wanner, Solving Ordinary Differential Equations
/// II, section VII.7, and the Test Set
/// for IVP Solvers: seven rods in the plane, a motor of 0.033 N m, a spring. In units of cm, 0.1 g and ms its numbers are near 1.
fn the_squeezer_of_andrews_opens_as_published(backend: Backend) {
    let [.., meeting] = joints_of_squeezer(AT_START);
    assert!(meeting.distance(B - 3.5 * unit(AT_START[2]).perp()) < 1e-9, "the places at the start");
    let mut simulation = simulation(read(&text_of_squeezer()), backend);
    // Twenty frames a millisecond.
    let frames = on(backend, 600, 40);
    simulation.run(frames, 0.05).expect("frames");
    let joints = simulation.joints().expect("joints");
    assert!(joints.iter().all(|joint| joint.error < 2e-3), "{joints:?}");
    if frames == 600 {
        // K1, K3, K5 and K7.
        for (joint, angle, bound) in [(0, 0, 0.1), (1, 2, 0.01), (2, 4, 0.01), (3, 6, 0.01)] {
            let (found, wanted) = (f64::from(joints[joint].position), AFTER_30_MS[angle] - AT_START[angle]);
            let off = (found - wanted) - TAU * ((found - wanted) / TAU).round();
            assert!(off.abs() < bound, "angle {angle} moves by {found}, not {wanted}");
        }
    }
}
