use std::path::Path;

use crate::scene::{Loaded, Scene};
use crate::{CohesionModel, Material, Pair, Result, RollingModel};

fn parse(text: &str) -> Result<Loaded> {
    Scene::parse(text, Path::new("a.txt"))
}

const GLASS: &str = "@material glass density=2 young=5e10 poisson=0.25\n";

#[test]
fn materials_and_pairs_are_read() {
    let text = format!(
        "{GLASS}@material clay\n@pair glass clay restitution=0.25 friction=0.5\n@pair clay clay friction=0.9 # soft\n\
         S 1 0 0 0 0 0 0 0 0 0 1 0.5\n@use glass\nS 2 3 0 0 0 0 0 0 0 0 - 0.5 0\nR 1 2 0.1\nC 0 5 0 0 7 0 0 0 0 - 0.5\n\
         @use clay\nB 0 -1 0 1 0 0 0 2 0 0 0 3\nP 0 0 0 0 0 1 1 0 0\n@use -\nB 9 -1 0 1 0 0 0 2 0 0 0 3\n"
    );
    let Loaded { scene, warnings, .. } = parse(&text).unwrap();
    assert_eq!(warnings, []);
    assert_eq!(scene.materials()[0], Material::new("glass").density(2.0).young(5e10).poisson(0.25));
    let (glass, clay) = (scene.find_material("glass"), scene.find_material("clay"));
    assert!(glass.is_some() && clay.is_some() && scene.find_material("Glass").is_none());
    let of_spheres: Vec<_> = scene.spheres().iter().map(|sphere| sphere.material).collect();
    assert_eq!(of_spheres, [None, glass, glass, glass]);
    assert_eq!(scene.rods().iter().map(|rod| rod.material).collect::<Vec<_>>(), [glass; 2]);
    assert_eq!(scene.boxes().iter().map(|cuboid| cuboid.material).collect::<Vec<_>>(), [clay, None]);
    assert_eq!(scene.polygons()[0].material, clay);
    // 2 * 4/3 pi / 8, and half of 2 pi / 4 (2 + 2/3).
    let pi = std::f32::consts::PI;
    assert!((scene.spheres()[1].mass - pi / 3.0).abs() < 1e-6 && (scene.spheres()[2].mass - pi / 1.5).abs() < 1e-6);
    assert_eq!(scene.pair(clay, glass).unwrap(), Pair::default().restitution(0.25).friction(0.5));
    // Not given: glass has nothing of its own.
    assert_eq!(scene.pair(glass, glass).unwrap(), Pair::default());
    assert_eq!(scene.pair(None, clay).unwrap(), Pair::default().friction(0.9));
    assert_eq!(scene.pair(None, None).unwrap(), Pair::default());
}

#[test]
fn pairs_that_are_not_given_are_geometric_means() {
    let text = "@material a\n@material b\n@material c\n@pair a a restitution=0.9 friction=0.2\n\
                @pair b b restitution=0.4 friction=0.8\n@pair a c restitution=0\n";
    let scene = parse(text).unwrap().scene;
    let [a, b, c] = ["a", "b", "c"].map(|name| scene.find_material(name));
    assert_eq!(scene.pair(a, b).unwrap(), Pair::default().restitution(0.6).friction(0.4));
    assert_eq!(scene.pair(b, a).unwrap(), scene.pair(a, b).unwrap());
    // The friction is that of `a` with itself, because `c` has none.
    assert_eq!(scene.pair(a, c).unwrap(), Pair::default().restitution(0.0).friction(0.2));
    assert_eq!(scene.pair(b, c).unwrap(), Pair::default().restitution(0.4).friction(0.8));
}

#[test]
fn resistance_is_read_mixed_and_written() {
    let text = "@material a\n@material b\n@material c\n@pair a a rolling_friction=0.25 rolling_model=a twisting_friction=0.5\n\
                @pair b b rolling_friction=1 rolling_model=c rolling_damping=0.25 surface_energy=2 cohesion=jkr\n\
                @pair c c cohesion=dmt\n";
    let scene = parse(text).unwrap().scene;
    let [a, b, c] = ["a", "b", "c"].map(|name| scene.find_material(name));
    let given = Pair::default().rolling_friction(0.25).rolling_model(RollingModel::ConstantTorque).twisting_friction(0.5);
    assert_eq!(scene.pair(a, a).unwrap(), given);
    assert_eq!(scene.pair(a, c).unwrap(), given.cohesion(CohesionModel::Dmt));
    // Two models of cohesion give the default.
    assert_eq!(scene.pair(b, c).unwrap().cohesion, Some(CohesionModel::Dmt));
    let mixed = Pair::default().rolling_friction(0.5).rolling_model(RollingModel::SpringDashpot);
    let mixed = mixed.rolling_damping(0.25).twisting_friction(0.5).surface_energy(2.0);
    assert_eq!(scene.pair(a, b).unwrap(), mixed.cohesion(CohesionModel::Jkr));
    let again = parse(&scene.to_text()).unwrap().scene;
    let same = ["a", "b"].map(|name| again.find_material(name)).map(|own| again.pair(own, own).unwrap());
    assert_eq!(same, [given, scene.pair(b, b).unwrap()]);
}

#[test]
fn a_pair_that_is_given_again_is_replaced_with_a_warning() {
    let text = "@material a\n@pair a a restitution=0.5 friction=1\n@pair a a restitution=0.25\n";
    let Loaded { scene, warnings, .. } = parse(text).unwrap();
    assert_eq!(warnings.len(), 1);
    assert_eq!(warnings[0].line, 3);
    let a = scene.find_material("a");
    assert_eq!(scene.pair(a, a).unwrap(), Pair::default().restitution(0.25));
}

#[test]
fn wrong_lines_about_materials_are_errors() {
    let cases = [
        ("@material", "NAME"),
        ("@material density=2", "not a name"),
        ("@material glass", "no other material"),
        ("@material -", "a word other than"),
        ("@material m densty=2", "did you mean density?"),
        ("@material m density", "expected KEY=NUMBER"),
        ("@material m density=heavy", "not a finite number"),
        ("@material m density=1e99", "not a finite number"),
        ("@material m density=1 density=2", "given twice"),
        ("@material m density=0", "greater than 0"),
        ("@material m young=-1", "greater than 0"),
        ("@material m poisson=0.5", "less than 0.5"),
        ("@pair glass", "missing"),
        ("@pair glass glas", "did you mean 'glass'?"),
        ("@pair glass glass restitution=1.5", "from 0 to 1"),
        ("@pair glass glass rolling_friction=-1", "not negative"),
        ("@pair glass glass rolling_model=b", "a or c"),
        ("@pair glass glass surface_energy=-1", "not negative"),
        ("@pair glass glass characteristic_velocity=0", "greater than 0"),
        ("@pair glass glass cohesion=glue", "dmt or jkr"),
        ("@pair glass glass cohesion=jkr cohesion=jkr", "given twice"),
        ("@pair glass glass rolling_model=a rolling_model=c", "given twice"),
        ("@pair glass glass roling_model=a", "did you mean rolling_model"),
        ("@pair glass glass friction=-0.1", "not negative"),
        ("@pair glass glass young=1", "unknown key"),
        ("@use", "missing"),
        ("@use wood", "an @material line above"),
        ("@use glass now", "one word too many"),
        ("S 1 0 0 0 0 0 0 0 0 0 - 0.5", "needs a material"),
        ("@material m\n@use m\nC 0 5 0 0 7 0 0 0 0 - 0.5", "needs a density"),
        ("@use glass\nS 1 0 0 0 0 0 0 0 0 0 1 -", "not a number"),
    ];
    for (line, expected) in cases {
        let error = parse(&format!("{GLASS}{line}\n")).map(drop).expect_err(line).to_string();
        let number = 1 + line.lines().count();
        assert!(error.contains(expected) && error.contains(&format!("a.txt:{number}")), "{line}: {error}");
    }
}

#[test]
fn long_names_of_materials_are_shortened_in_messages() {
    // Three bytes per character, of which a mistyped name of 40 characters changes a third.
    let name = "\u{fffd}".repeat(500);
    let near = "\u{fffd}".repeat(30);
    let cases = [
        format!("@material {name}\n@pair {near} {near}\n"),
        format!("@material {name}\n@material {name}\n"),
        format!("@material {name}\n@use {name}\nS 1 0 0 0 0 0 0 0 0 0 - 0.5\n"),
    ];
    for text in cases {
        let error = parse(&text).map(drop).expect_err(&text).to_string();
        assert!(error.chars().count() < 250, "{error}");
    }
    let pair = format!("@pair {name} {name} friction=1\n");
    let warnings = parse(&format!("@material {name}\n{pair}{pair}")).unwrap().warnings;
    assert!(warnings.len() == 1 && warnings[0].text.chars().count() < 250, "{warnings:?}");
}

#[test]
fn there_are_at_most_255_materials() {
    let text: String = (0..255).map(|k| format!("@material m{k}\n")).collect();
    assert_eq!(parse(&text).unwrap().scene.materials().len(), 255);
    let error = parse(&(text + "@material one-more\n")).map(drop).unwrap_err().to_string();
    assert!(error.contains("at most 255 materials"), "{error}");
}

#[test]
fn materials_of_other_scenes_are_refused() {
    let scene = parse(GLASS).unwrap().scene;
    let glass = scene.find_material("glass").unwrap();
    let mut other = parse(GLASS).unwrap().scene;
    let ball = crate::Sphere::new([0.0; 3], 0.5).material(glass);
    assert!(matches!(other.add_sphere(ball), Err(crate::Error::StaleHandle { kind: "material" })));
    assert!(other.set_pair(glass, glass, Pair::default()).is_err());
}
