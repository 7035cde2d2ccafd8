//! Scenes whose spheres come and go.

use crate::common::Rockfall;

/// Grains of mass 2 fall past a plate. Before step n, n / 2 of them are due.
const FEED: &str = "@run dt=0.01 steps=200\nB -1 -0.1 -1  1 0 0  0 0.1 0  0 0 2
@inlet name=feed box=-0.5,1,-0.5,0.5,2,0.5 rate=50 radius=0.05..0.1 mass=2 velocity=0,-4,0 every=1
@outlet name=drain box=-9,-5,-9,9,-1,9 every=10\n";

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_run_reports_what_came_in_and_left() {
    let rockfall = Rockfall::with(FEED);
    let (out, err) = rockfall.run("run scene.txt --backend cpu", 0);
    assert_eq!(err, "");
    let line =
        |name: &str| out.lines().find(|line| line.trim_start().starts_with(name)).unwrap_or_else(|| panic!("{out}")).to_owned();
    assert!(line("in ").contains("through feed") && line("out ").ends_with("through drain"), "{out}");
    assert!(line("inside ").contains("spheres of mass"), "{out}");
    let (out, _) = rockfall.run("run scene.txt --backend cpu --json", 0);
    let flow = &json(&out)["flow"];
    let (feed, drain) = (&flow["inlets"][0], &flow["outlets"][0]);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    assert_eq!((&feed["name"], &drain["name"]), (&"feed".into(), &"drain".into()));
    assert!(number(&feed["spheres"]) > 90.0 && number(&drain["spheres"]) > 10.0, "{flow}");
    assert_eq!(number(&feed["mass"]), 2.0 * number(&feed["spheres"]));
    assert_eq!(number(&feed["mass"]) - number(&drain["mass"]), number(&flow["mass"]));
    assert_eq!(json(&out)["objects"]["spheres"], flow["spheres"]);
}

#[test]
fn a_run_in_two_parts_writes_the_same_files() {
    let rockfall = Rockfall::with(FEED);
    rockfall.run("run scene.txt --backend cpu --out whole.csv --every 10 --trace whole.trace.csv", 0);
    rockfall.run(
        "run scene.txt --backend cpu --out parts.csv --every 10 --trace parts.trace.csv --steps 77 --checkpoint a.ckpt",
        0,
    );
    rockfall.run("run --resume a.ckpt --steps 200", 0);
    assert!(rockfall.read("whole.csv") == rockfall.read("parts.csv"));
    assert!(rockfall.read("whole.trace.csv") == rockfall.read("parts.trace.csv"));
    assert!(rockfall.read("whole.csv").lines().count() > 500);
}

/// Spheres come and go in the frames of an `.npz` file, which is drawn again.
#[test]
fn npz_files_hold_and_show_spheres_that_come_and_go() {
    let rockfall = Rockfall::with(FEED.split_once('\n').unwrap().1);
    let run = "run scene.txt --backend cpu --dt 0.01 --every 10";
    rockfall.run(&format!("{run} --steps 200 --out whole.npz"), 0);
    rockfall.run(&format!("{run} --steps 77 --out parts.npz --checkpoint a.ckpt"), 0);
    rockfall.run("run --resume a.ckpt --steps 200", 0);
    let bytes = |name: &str| std::fs::read(rockfall.path(name)).unwrap();
    assert!(bytes("whole.npz") == bytes("parts.npz"));
    assert!(bytes("whole.npz").windows(11).any(|window| window == b"offsets.npy"));
    // A picture of the last frame is that of the scene after as many steps, and other frames have other spheres.
    let camera = "--size 64x48 --plain --camera 0,1,9 --look-at 0,0,0";
    let picture = |name: &str, step: u32| {
        rockfall.run(&format!("render {name} --out a.png --at {step} {camera}"), 0);
        bytes("a.png")
    };
    let [first, middle, last] = [0, 110, 200].map(|step| picture("whole.npz", step));
    assert!(first != middle && middle != last && first != last);
    assert!(
        first == picture("scene.txt --backend cpu --dt 0.01", 0) && last == picture("scene.txt --backend cpu --dt 0.01", 200)
    );
    rockfall.run("render whole.npz --out film/ --fps 5 --size 64x48 --trails 0.2 --plot energy", 0);
    assert_eq!(std::fs::read_dir(rockfall.path("film")).unwrap().count(), 11);
}

#[test]
fn paraview_files_are_not_read_back() {
    let rockfall = Rockfall::with(FEED);
    rockfall.run("run scene.txt --backend cpu --out run.npz", 0);
    rockfall.run("run scene.txt --backend cpu --out run.pvd --every 10", 0);
    let (_, err) = rockfall.run("render run.pvd --out run.png --size 64x48", 2);
    assert!(err.contains("its spheres come and go") && err.contains("expected an .npz file"), "{err}");
}

#[test]
fn check_counts_inlets_and_judges_their_spheres() {
    let (out, _) = Rockfall::with(FEED).run("check scene.txt", 0);
    assert!(out.contains("1 box, 1 inlet, 1 outlet, ") && !out.contains("nothing will move"), "{out}");
    let crowded = FEED.replace("rate=50", "rate=5000");
    let (out, _) = Rockfall::with(&crowded).run("check scene.txt", 0);
    assert!(out.contains("warning: scene.txt: the inlet feed lets in 5000 spheres/s, but no more than about"), "{out}");
    // The time step of contacts is judged by the spheres that will come in.
    let stiff = format!("set contact_force 1e9\n{FEED}");
    let (out, _) = Rockfall::with(&stiff).run("check scene.txt", 0);
    assert!(out.contains("the contact force is too stiff for the time step"), "{out}");
    let (out, _) = Rockfall::with("@outlet box=-9,-5,-9,9,-1,9 every=10\n# nothing\n").run("check scene.txt", 0);
    assert!(out.contains("no spheres, so nothing will move"), "{out}");
}

#[test]
fn bodies_come_in_and_are_reported() {
    let rockfall = Rockfall::with(
        "@run dt=0.01 steps=150\n@body brick density=2\nB 0 0 0 0.2 0 0 0 0.1 0 0 0 0.1\n@end\nset gravity 9.81\n\
         @inlet name=feed box=-1,2,-1,1,3,1 rate=30 shape=brick velocity=0,-3,0\n@outlet name=drain box=-9,-5,-9,9,-1,9 every=5\n",
    );
    let (out, err) = rockfall.run("run scene.txt --backend cpu --bodies bodies.csv --every 50 --out run.npz", 0);
    assert!(!err.contains("no rigid bodies"), "{err}");
    assert!(out.contains("spheres and bodies of mass") && out.contains("through drain"), "{out}");
    let rows: Vec<String> = rockfall.read("bodies.csv").lines().map(str::to_owned).collect();
    assert!(rows.len() > 30, "{}", rows.len());
    let (_, err) = rockfall.run("render run.npz --at 1s --size 64x48 --plain --out a.png", 0);
    assert!(err.starts_with("wrote a.png"), "{err}");
    let (out, _) = rockfall.run("check scene.txt", 0);
    assert!(out.contains("1 inlet") && !out.contains("spheres will wait"), "{out}");
}

/// A scene goes on without spheres, and others come in later, with friction impulses.
#[test]
fn the_last_sphere_may_leave() {
    let drain =
        "set coulomb_friction 0.5\nset collision_friction 0.5\nset gravity 9.81\n@outlet box=-10,-10,-10,10,0,10 every=5\n";
    let ball = "S 1 0 0.5 0 0 0 0 0 0 0 1 0.1\n";
    let feed = "@inlet box=-1,1,-1,1,3,1 rate=50 radius=0.1 from=5.8 limit=3\n";
    let floor = "B 0 0 0 1 0 0 0 1 0 0 0 1\n";
    for (scene, spheres) in [([drain, ball, ""], 0), ([drain, ball, feed], 3), ([drain, floor, ""], 0)] {
        for physics in ["", "--integrator symplectic-euler", "--integrator velocity-verlet"] {
            let rockfall = Rockfall::with(&scene.concat());
            let arguments = "run scene.txt --backend cpu --dt 0.02 --steps 300 --out state.csv --contacts contacts.csv";
            rockfall.run(&format!("{arguments} {physics}"), 0);
            assert_eq!(rockfall.read("state.csv").lines().count(), 1 + spheres, "{physics}");
        }
    }
}
