use super::*;

const COUNT: u64 = 20_000;

fn inlet(radii: Radii, by: SizedBy) -> Inlet {
    Inlet::new("in", [[0.0; 3], [10.0; 3]], Rate::Number(1.0), 1.0).radii(radii, by).density(1.0).seed(7)
}

fn radii_of(inlet: &Inlet) -> Vec<f64> {
    let scene = Scene::new();
    let sequence = scene.sequence(inlet, 0);
    (0..COUNT).map(|serial| sequence.grain(serial).radius.into()).collect()
}

/// Chi squared of numbers from 0 to 1 that are uniform if the radii have the distribution, in 20 bins.
fn chi_squared(uniform: impl Iterator<Item = f64>) -> f64 {
    let mut bins = [0.0; 20];
    uniform.for_each(|share| bins[((share * 20.0) as usize).min(19)] += 1.0);
    let expected = COUNT as f64 / 20.0;
    bins.iter().map(|count: &f64| (count - expected).powi(2) / expected).sum()
}

/// Distribution function of the standard normal distribution (Abramowitz and Stegun 7.1.26, error below 1e-7).
fn normal(x: f64) -> f64 {
    let z = x.abs() / 2.0_f64.sqrt();
    let t = 1.0 / (1.0 + 0.327_591_1 * z);
    let sum =
        [1.061_405_429, -1.453_152_027, 1.421_413_741, -0.284_496_736, 0.254_829_592].into_iter().fold(0.0, |s, a| s * t + a);
    let tail = 0.5 * sum * t * (-z * z).exp();
    if x < 0.0 { tail } else { 1.0 - tail }
}

// With 19 degrees of freedom, chi squared exceeds 43.8 in one of 1000 cases.
const BOUND: f64 = 43.8;

#[test]
fn radii_have_the_distribution() {
    let (from, to) = (0.1, 0.3);
    let by_number = radii_of(&inlet(Radii::Uniform(from, to), SizedBy::Number));
    let found = chi_squared(by_number.iter().map(|radius| (radius - from) / (to - from)));
    assert!(found < BOUND, "uniform by number: {found}");
    // By mass, the number of spheres of a radius r is in proportion to r^-3, so that the mass is uniform.
    let by_mass = radii_of(&inlet(Radii::Uniform(from, to), SizedBy::Mass));
    let cdf = |radius: f64| (from.powi(-2) - radius.powi(-2)) / (from.powi(-2) - to.powi(-2));
    let found = chi_squared(by_mass.iter().map(|radius| cdf(*radius)));
    assert!(found < BOUND, "uniform by mass: {found}");
    let wrong = chi_squared(by_mass.iter().map(|radius| (radius - from) / (to - from)));
    assert!(wrong > 100.0 * BOUND, "the test tells the two apart: {wrong}");

    let (median, sigma) = (0.2, 0.25);
    let share = |radius: &f64, median: f64| normal((radius / median).ln() / sigma);
    let log_normal = Radii::LogNormal { median, sigma };
    let by_number = radii_of(&inlet(log_normal, SizedBy::Number));
    let found = chi_squared(by_number.iter().map(|radius| share(radius, median)));
    assert!(found < BOUND, "log-normal by number: {found}");
    let by_mass = radii_of(&inlet(log_normal, SizedBy::Mass));
    let found = chi_squared(by_mass.iter().map(|radius| share(radius, median * (-3.0 * sigma * sigma).exp())));
    assert!(found < BOUND, "log-normal by mass: {found}");
}

/// Half of the mass is in spheres up to the median by mass: d_mass = d_num e^(3 sigma²).
#[test]
fn the_medians_by_mass_and_by_number_differ_by_a_known_factor() {
    let (median, sigma) = (0.2, 0.25);
    let mass_below = |radii: &[f64], bound: f64| {
        let mass = |radius: &f64| radius.powi(3);
        radii.iter().filter(|radius| **radius <= bound).map(mass).sum::<f64>() / radii.iter().map(mass).sum::<f64>()
    };
    let log_normal = Radii::LogNormal { median, sigma };
    let share = mass_below(&radii_of(&inlet(log_normal, SizedBy::Mass)), median);
    assert!((share - 0.5).abs() < 0.015, "{share}");
    let by_number = radii_of(&inlet(log_normal, SizedBy::Number));
    let share = mass_below(&by_number, median * (3.0 * sigma * sigma).exp());
    assert!((share - 0.5).abs() < 0.015, "{share}");
    assert!(mass_below(&by_number, median) < 0.3);
}

#[test]
fn spheres_follow_from_the_key_alone() {
    let one = inlet(Radii::Uniform(0.1, 0.3), SizedBy::Number);
    let key = |inlet: &Inlet, number, serial, attempt| {
        let grain = Scene::new().sequence(inlet, number).grain(serial);
        (grain, inlet.place(number, serial, grain.radius, attempt).to_array())
    };
    assert_eq!(key(&one, 0, 5, 3), key(&one.clone(), 0, 5, 3));
    let all =
        [key(&one, 0, 5, 3), key(&one, 1, 5, 3), key(&one, 0, 6, 3), key(&one, 0, 5, 4), key(&one.clone().seed(8), 0, 5, 3)];
    for (index, first) in all.iter().enumerate() {
        for second in &all[index + 1..] {
            assert_ne!(first.1, second.1);
        }
    }
    assert_eq!(all[0].0, all[3].0, "another try has the same radius");
    let scene = Scene::new();
    let sequence = scene.sequence(&one, 0);
    let (mut least, mut greatest) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for serial in 0..COUNT {
        let radius = sequence.grain(serial).radius;
        let place = one.place(0, serial, radius, 0);
        least = least.min(place - f64::from(radius));
        greatest = greatest.max(place + f64::from(radius));
    }
    assert!(least.min_element() >= 0.0 && greatest.max_element() <= 10.0, "{least} {greatest}");
    assert!(least.max_element() < 0.01 && greatest.min_element() > 9.99, "{least} {greatest}");
}

/// Of each kind the shares of the spheres and of the mass.
fn parts(inlet: &Inlet) -> Vec<[f64; 2]> {
    let scene = Scene::new();
    let sequence = scene.sequence(inlet, 3);
    let mut sums = vec![[0.0; 2]; inlet.kinds.len()];
    for grain in (0..COUNT).map(|serial| sequence.grain(serial)) {
        sums[grain.kind][0] += 1.0;
        sums[grain.kind][1] += f64::from(grain.mass);
    }
    let all = [0, 1].map(|what| sums.iter().map(|sum| sum[what]).sum::<f64>());
    sums.iter().map(|sum| [sum[0] / all[0], sum[1] / all[1]]).collect()
}

/// Shares count spheres or mass, whatever the distributions of the radii.
#[test]
fn mixtures_keep_their_shares() {
    let kind = |name: &str, radii, by| GrainKind::spheres(1.0).name(name).radii(radii, by).density(2.0);
    let kinds = [
        (kind("equal", Radii::Equal(0.3), SizedBy::Number), 1.0),
        (kind("uniform", Radii::Uniform(0.1, 0.3), SizedBy::Number), 2.0),
        (kind("fine", Radii::Uniform(0.1, 0.3), SizedBy::Mass), 3.0),
        (kind("wide", Radii::LogNormal { median: 0.2, sigma: 0.3 }, SizedBy::Mass), 4.0),
        (GrainKind::spheres(0.1).name("light").mass(0.05), 2.5),
    ];
    for (what, shares) in [SizedBy::Number, SizedBy::Mass].into_iter().enumerate() {
        let mixed = inlet(Radii::Equal(1.0), SizedBy::Number).mix(kinds.clone(), shares);
        for (found, (kind, share)) in parts(&mixed).iter().zip(&kinds) {
            let wanted = share / 12.5;
            assert!((found[what] - wanted).abs() < 0.1 * wanted, "{} by {shares}: {} of {wanted}", kind.name, found[what]);
        }
        let [number, mass] = parts(&mixed)[0];
        assert!((number - mass).abs() > 0.03, "the spheres of radius 0.3 are heavier than most");
    }
}

#[test]
fn mixtures_need_names_and_shares() {
    let refused = |kinds: Vec<(GrainKind, f64)>| {
        let one = inlet(Radii::Equal(1.0), SizedBy::Number).mix(kinds, SizedBy::Number);
        Scene::new().add_inlet(one).unwrap_err().to_string()
    };
    let kind = |name: &str| GrainKind::spheres(0.1).name(name);
    for kinds in [
        vec![],
        vec![(kind("a"), 1.0), (kind("a"), 1.0)],
        vec![(kind("a"), 1.0), (kind(""), 1.0)],
        vec![(kind("a"), 0.0)],
        vec![(kind("a"), f64::NAN)],
    ] {
        let error = refused(kinds);
        assert!(error.contains("inlet.mix"), "{error}");
    }
}

#[test]
fn the_concern_is_the_rate_that_fits() {
    let concern = |rate: f64, velocity: [f32; 3], gravity: f32| {
        let mut scene = Scene::new();
        scene.settings.gravity = gravity;
        // 0.3 of an area of 4 at 2 units/s is 2.4 units³/s.
        let inlet = Inlet::new("feed", [[0.0; 3], [2.0, 1.0, 2.0]], Rate::Volume(rate), 0.1).velocity(velocity);
        scene.add_inlet(inlet).unwrap();
        scene.inlet_concerns()
    };
    assert!(concern(2.3, [0.0, -2.0, 0.0], 0.0).is_empty());
    let found = concern(2.5, [0.0, -2.0, 0.0], 0.0);
    assert!(found.len() == 1 && found[0].contains("lets in 2.5 units³/s, but no more than about 2.4 units³/s"), "{found:?}");
    assert!(!concern(1e-9, [0.0; 3], 0.0).is_empty(), "spheres at rest without gravity stay");
    // From rest they fall out of the box of height 1 at 2 units/s.
    assert!(concern(2.3, [0.0; 3], 2.0).is_empty());
    assert_eq!(concern(2.5, [0.0; 3], 2.0).len(), 1);
}

/// A box of 4 units³ has room for 0.3 * 4 / (4/3 pi 0.3³) = 10.6 spheres at once, and a box as large as a sphere for one.
#[test]
fn few_spheres_need_no_rate_that_fits() {
    let has_concern = |size: [f64; 3], change: &dyn Fn(Inlet) -> Inlet| {
        let mut scene = Scene::new();
        scene.settings.gravity = 0.0;
        scene.add_inlet(change(Inlet::new("feed", [[0.0; 3], size], Rate::Number(1e4), 0.3))).unwrap();
        !scene.inlet_concerns().is_empty()
    };
    let (box_of_ten, box_of_one) = ([2.0, 1.0, 2.0], [0.61; 3]);
    for (size, limit) in [(box_of_ten, 10), (box_of_one, 1)] {
        assert!(!has_concern(size, &|inlet| inlet.limit(limit)), "{limit}");
        assert!(has_concern(size, &|inlet| inlet.limit(limit + 1)), "{limit}");
    }
    // 10,000 spheres/s for 1 ms are 10 spheres.
    assert!(!has_concern(box_of_ten, &|inlet| Inlet { to: 1e-3, ..inlet }));
    assert!(has_concern(box_of_ten, &|inlet| Inlet { to: 1.2e-3, ..inlet }));
}
