use std::path::Path;

use crate::scene::{GrainKind, GrainMass, Inlet, Outlet, Radii, Rate, Scene, SizedBy};

fn parse(text: &str) -> crate::Result<Scene> {
    Scene::parse(text, Path::new("silo.txt")).map(|loaded| loaded.scene)
}

const SILO: &str = "# Silo
@material grain density=2.5
@use grain
@group 3
@colour red
@inlet name=feed box=-1,2,-1,1,2.5,1 mass_rate=0.5 radius=0.1..0.2 by=mass velocity=0,-1.5,0 from=0.25 to=9 limit=70 seed=12 every=40 after=2
@use -
@inlet box=-1,2,-1,1,2.5,1 rate=0.1 radius=lognormal:0.05,0.3 density=0.7
@inlet box=-1,2,-1,1,2.5,1 volume_rate=1e-3 radius=0.05 mass=0.3
@outlet name=drain box=-1,-3,-1,1,-2,1
@outlet box=-1,-30,-1,1,-20,1 every=5
";

#[test]
fn inlets_and_outlets_are_read_and_written() {
    let scene = parse(SILO).unwrap();
    let [feed, second, third] = scene.inlets() else { panic!("three inlets") };
    assert_eq!([&feed.name, &second.name, &third.name], ["feed", "inlet", "inlet2"]);
    let kind = &feed.kinds[0].0;
    assert_eq!((feed.rate, kind.radii, kind.by), (Rate::Mass(0.5), Radii::Uniform(0.1, 0.2), SizedBy::Mass));
    assert_eq!((feed.from, feed.to, feed.limit, feed.seed, feed.every, feed.after), (0.25, 9.0, Some(70), 12, Some(40), 2));
    assert_eq!((kind.material, kind.group), (scene.find_material("grain"), 3));
    assert_eq!(feed.velocity.to_array(), [0.0, -1.5, 0.0]);
    let radii = Radii::LogNormal { median: 0.05, sigma: 0.3 };
    let plain = Inlet::new("inlet", [[-1.0, 2.0, -1.0], [1.0, 2.5, 1.0]], Rate::Number(0.1), 1.0);
    let expected = plain.radii(radii, SizedBy::Number).density(0.7).group(3).tag(kind.tag.clone());
    assert_eq!(*second, expected);
    assert_eq!((third.rate, third.kinds[0].0.mass), (Rate::Volume(1e-3), GrainMass::Mass(0.3)));
    let drain = Outlet::new("drain", [[-1.0, -3.0, -1.0], [1.0, -2.0, 1.0]]);
    assert_eq!(scene.outlets(), [drain, Outlet::new("outlet", [[-1.0, -30.0, -1.0], [1.0, -20.0, 1.0]]).every(5)]);

    let text = scene.to_text();
    let again = parse(&text).unwrap();
    assert_eq!((again.inlets().len(), again.outlets()), (3, scene.outlets()));
    assert_eq!(again.to_text(), text);
    // The material has another handle in another scene.
    for (inlet, other) in scene.inlets().iter().zip(again.inlets()) {
        let (kind, read) = (&inlet.kinds[0].0, &other.kinds[0].0);
        assert_eq!(*kind, GrainKind { material: kind.material, ..read.clone() });
        assert_eq!(kind.material.is_some(), read.material.is_some());
        assert_eq!(*inlet, Inlet { kinds: inlet.kinds.clone(), ..other.clone() });
    }
}

#[test]
fn wrong_lines_name_the_field_and_what_was_expected() {
    let good = "box=0,0,0,1,1,1 rate=5 radius=0.1";
    let cases = [
        ("@inlet rate=5 radius=0.1", "@inlet box: missing, expected six numbers box=x0,y0,z0,x1,y1,z1 without spaces"),
        ("@inlet box=0,0,0,1,1,1 radius=0.1", "@inlet rate: missing, expected rate=, mass_rate= or volume_rate="),
        (
            "@inlet box=0,0,0,1,1,1 rate=5",
            "@inlet radius: missing, expected radius=r, radius=a..b or radius=lognormal:median,sigma, shape=NAME or mix=",
        ),
        ("@inlet box=0,0,0,1,1 rate=5 radius=1", "@inlet box: '0,0,0,1,1' is not allowed, expected six numbers"),
        ("@inlet box=0,0,0,1,-1,1 rate=5 radius=0.1", "with x0 < x1, y0 < y1 and z0 < z1"),
        ("@inlet box=0,0,0,1,1,1 rate=5 radius=0.6", "@inlet box: 1 wide for a diameter of 1.2 is not allowed"),
        ("@inlet box=0,0,0,1,1,1 rate=-5 radius=0.1", "@inlet rate: -5 is not allowed, expected a finite number, not negative"),
        ("@inlet box=0,0,0,1,1,1 rate=5 radius=wide", "@inlet radius: 'wide' is not allowed, expected a radius r, a range"),
        ("@inlet box=0,0,0,1,1,1 rate=5 radius=0.2..0.1", "@inlet radius: 0.1 is not allowed, expected a finite number that"),
        (&format!("@inlet {good} mass_rate=2"), "@inlet mass_rate: given together with rate, expected one of the two"),
        (&format!("@inlet {good} mass=2 density=3"), "@inlet density: given together with mass, expected one of the two"),
        (&format!("@inlet {good} mass=0"), "@inlet mass: 0 is not allowed, expected a finite number greater than 0"),
        (&format!("@inlet {good} limit=-1"), "@inlet limit: '-1' is not allowed, expected a whole number, not negative"),
        (&format!("@inlet {good} every=0"), "@inlet every: 0 is not allowed, expected a number of steps, at least 1"),
        (&format!("@inlet {good} from=2 to=1"), "@inlet to: 1 is not allowed, expected a time that is not before `from`"),
        (&format!("@inlet {good} rates=1"), "@inlet 'rates': an unknown key, did you mean rate?"),
        (&format!("@inlet {good} seed=1 seed=2"), "@inlet seed: given twice in the line"),
        (&format!("@inlet {good} by=volume"), "@inlet by: 'volume' is not allowed, expected number or mass"),
        (
            &format!("@inlet {good} name=a\n@inlet {good} name=a"),
            "silo.txt:2: @inlet name: 'a' is not allowed, expected a name that",
        ),
        (
            "@inlet box=0,0,0,1,1,1 rate=5 shape=rock",
            "@inlet 'rock': an unknown body, expected the name of an @body line above",
        ),
        ("@inlet box=0,0,0,1,1,1 rate=5 shape=rock radius=1", "@inlet radius: given with shape, expected one of them"),
        ("@inlet box=0,0,0,1,1,1 volume_rate=5 shape=rock", "@inlet volume_rate: given with shape, expected one of them"),
        ("@grain small density=3", "@grain radius: missing, expected radius=r, radius=a..b or radius=lognormal:median,sigma"),
        ("@grain small radius=-1", "@grain radius: -1 is not allowed, expected a finite number greater than 0"),
        ("@grain small radius=1 rate=3", "@grain 'rate': an unknown key"),
        ("@inlet box=0,0,0,1,1,1 rate=5 mix=small:1", "@inlet mix: an unknown kind 'small', expected NAME:SHARE,..."),
        (
            "@grain a radius=0.1\n@inlet box=0,0,0,1,1,1 rate=5 mix=a:-1",
            "@inlet mix: 'a:-1' is not allowed, expected NAME:SHARE",
        ),
        ("@grain a radius=0.1\n@inlet box=0,0,0,1,1,1 rate=5 mix=a", "@inlet mix: 'a' is not allowed, expected NAME:SHARE"),
        (
            "@grain a radius=0.1\n@inlet box=0,0,0,1,1,1 rate=5 mix=a:1,a:2",
            "@inlet mix: 'a' is not allowed, expected a name for",
        ),
        ("@inlet box=0,0,0,1,1,1 rate=5 mix=small:1 radius=1", "@inlet radius: given with mix, expected one of them"),
        ("@outlet name=a", "@outlet box: missing, expected six numbers"),
        ("@outlet box=0,0,0,1,1,1 rate=3", "@outlet 'rate': an unknown key"),
    ];
    for (text, expected) in cases {
        let error = parse(text).unwrap_err().to_string();
        assert!(error.contains(expected), "{text}: {error}");
        assert!(error.starts_with("silo.txt:"), "{error}");
    }
}

#[test]
fn inlets_of_bodies_are_read_and_written() {
    let text = "@body rock density=3\nS 1 0 0 0 0 0 0 0 0 0 - 0.1\nS 2 0.1 0 0 0 0 0 0 0 0 - 0.1\n@end\n\
                @inlet name=feed box=0,0,0,1,1,1 mass_rate=5 shape=rock velocity=0,-1,0 limit=3\n";
    let scene = parse(text).unwrap();
    let inlet = &scene.inlets()[0];
    assert_eq!((inlet.kinds[0].0.shape, inlet.rate, inlet.limit), (scene.find_shape("rock"), Rate::Mass(5.0), Some(3)));
    let again = scene.to_text();
    let line = "@inlet name=feed box=0,0,0,1,1,1 mass_rate=5 shape=rock velocity=0,-1,0 limit=3\n";
    assert!(again.ends_with(line), "{again}");
    assert_eq!(parse(&again).unwrap().to_text(), again);
}

#[test]
fn mixtures_are_read_and_written() {
    let text = "@material glass density=2500\n@body rock density=3\nS 1 0 0 0 0 0 0 0 0 0 - 0.1\n@end\n\
                @use glass\n@group 2\n@grain fine radius=0.01..0.02 by=mass\n@group 0\n@grain coarse radius=0.1 mass=2\n\
                @inlet name=feed box=0,0,0,1,1,1 mass_rate=5 mix=fine:0.25,coarse:0.5,rock:0.25 by=mass velocity=0,-1,0\n";
    let scene = parse(text).unwrap();
    let inlet = &scene.inlets()[0];
    let [(fine, _), (coarse, share), (rock, _)] = &inlet.kinds[..] else { panic!("{:?}", inlet.kinds) };
    assert_eq!((fine.name.as_str(), fine.group, fine.material), ("fine", 2, scene.find_material("glass")));
    assert_eq!((coarse.group, coarse.mass, *share, inlet.shares), (0, GrainMass::Mass(2.0), 0.5, SizedBy::Mass));
    assert_eq!(rock.shape, scene.find_shape("rock"));
    let again = scene.to_text();
    let line = "@inlet name=feed box=0,0,0,1,1,1 mass_rate=5 mix=fine:0.25,coarse:0.5,rock:0.25 by=mass velocity=0,-1,0\n";
    assert!(again.ends_with(line), "{again}");
    assert_eq!(parse(&again).unwrap().to_text(), again);
}

#[test]
fn copies_of_lines_have_boxes_and_names_of_their_own() {
    let scene = parse("@repeat 3 0 5 0\n@inlet box=0,0,0,1,1,1 rate=5 radius=0.1\n@end\n").unwrap();
    let found: Vec<_> = scene.inlets().iter().map(|inlet| (inlet.name.as_str(), inlet.corners[0].y)).collect();
    assert_eq!(found, [("inlet", 0.0), ("inlet2", 5.0), ("inlet3", 10.0)]);
}
