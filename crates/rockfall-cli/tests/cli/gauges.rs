//! Gauges, work and dissipation on the command line.

use super::common::Rockfall;

/// Balls that fall on a floor, a drum that turns below others, and a plane that they fall through.
const SCENE: &str = "set contact_law linear\nset gravity 10\n@run dt=0.0005 integrator=velocity-verlet steps=60\n\
                     @material m density=1000\n@pair m m stiffness=10000 restitution=0.5 friction=0.4\n@use m\n\
                     @motion disk spin=3 axis=0,1,0 through=0,0,0\n@name floor\nB 2 -1 -1 2 0 0 0 1 0 0 0 2\n@name -\n@move disk\n\
                     B -1 -1 -1 2 0 0 0 1 0 0 0 2\n@move -\nS 1 3 0.0999 0 0 0 0 0 0 0 2 0.1\nS 2 0.5 0.0999 0 0 0 0 0 0 0 2 0.1\n\
                     S 3 3 0.501 0 0 -1 0 0 0 0 4 0.1\n@gauge name=weight wall=floor\n@gauge name=torque wall=disk\n\
                     @gauge name=down plane=0,0.5,0,0,-1,0\n";

fn columns(line: &str) -> Vec<&str> {
    line.split(',').collect()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap()
}

#[test]
fn gauges_write_the_final_state_or_means() {
    let rockfall = Rockfall::with(SCENE);
    let fields = "step,time,gauge,fx,fy,fz,tx,ty,tz,mass,count";
    rockfall.run("run scene.txt --backend cpu --gauges last.csv", 0);
    rockfall.run("run scene.txt --backend cpu --gauges each.csv --every 1", 0);
    rockfall.run("run scene.txt --backend cpu --gauges tens.csv --every 10", 0);
    let [last, each, tens] = ["last.csv", "each.csv", "tens.csv"].map(|name| rockfall.read(name));
    let [last, each, tens] = [&last, &each, &tens].map(|text| text.lines().collect::<Vec<_>>());
    assert_eq!((last[0], each[0], tens[0]), (fields, fields, fields));
    assert_eq!((last.len(), each.len(), tens.len()), (4, 1 + 3 * 61, 1 + 3 * 7));
    // Means of one step are the states; those of ten are the means of ten.
    assert_eq!(last[1..], each[each.len() - 3..]);
    assert_eq!(tens[1..4], each[1..4]);
    for (place, line) in tens[1..].iter().enumerate() {
        let (sample, gauge) = (place / 3, place % 3);
        let found = columns(line);
        assert_eq!(
            found[..3],
            [&(10 * sample).to_string(), columns(each[1 + 30 * sample])[1], ["weight", "torque", "down"][gauge]]
        );
        let first = if sample == 0 { 0 } else { 10 * sample - 9 };
        let of = |column: usize| {
            let states = (first..=10 * sample).map(|step| number(columns(each[1 + 3 * step + gauge])[column]));
            states.clone().sum::<f64>() / states.count() as f64
        };
        match gauge {
            2 => assert_eq!(found[3..9], [""; 6]),
            _ => (3..9).for_each(|column| {
                let (mean, expected) = (number(found[column]), of(column));
                assert!((mean - expected).abs() <= 1e-12 * expected.abs(), "{line}: {mean} {expected}");
            }),
        }
    }
    assert!(columns(last[1])[4].starts_with('-') && columns(last[2])[7].starts_with('-'), "{last:?}");
    assert_eq!((columns(tens[3])[9], columns(last[3])[9..].to_vec()), ("0", vec!["4", "1"]));
}

/// Runs a scene as a whole and in two parts, and leaves the checkpoint between them in `a.ckpt`.
fn stop(rockfall: &Rockfall, backend: &str) {
    for substeps in [1, 2] {
        let run = format!("run scene.txt --backend {backend} --substeps {substeps} --every 8");
        rockfall.run(&format!("{run} --steps 24 --gauges whole.csv --trace whole-trace.csv --trace-every 3"), 0);
        rockfall.run(&format!("{run} --steps 13 --gauges a.csv --trace a-trace.csv --trace-every 3 --checkpoint a.ckpt"), 0);
        rockfall.run("run --resume a.ckpt --steps 24", 0);
        assert_eq!(rockfall.read("whole.csv"), rockfall.read("a.csv"), "{backend}");
        let trace = rockfall.read("a-trace.csv");
        assert_eq!(rockfall.read("whole-trace.csv"), trace, "{backend}");
        let work = number(columns(trace.lines().last().unwrap())[15]);
        assert!(work > 0.0, "{trace}");
    }
}

#[test]
fn a_stopped_run_writes_the_same_gauges_and_work_on_the_gpu() {
    stop(&Rockfall::with(SCENE), "gpu");
}

#[test]
fn a_stopped_run_writes_the_same_gauges_and_work() {
    let rockfall = Rockfall::with(SCENE);
    stop(&rockfall, "cpu");
    // A new file begins at the checkpoint: the mean is that of the steps since.
    rockfall.run("run --resume a.ckpt --steps 32 --gauges b.csv --trace b-trace.csv --trace-every 4", 0);
    assert!(rockfall.read("b.csv").lines().nth(1).unwrap().starts_with("24,0.012,weight,"));
    let first = rockfall.read("b-trace.csv");
    assert_eq!(columns(first.lines().nth(1).unwrap())[15..], ["0", "0"]);
}

/// The energy balance of a ball that slides on a turning disk: what it does not keep was dissipated, by mu m g times the slip.
#[test]
fn a_trace_has_the_work_and_what_was_dissipated() {
    let rockfall = Rockfall::with(SCENE);
    rockfall.run("run scene.txt --backend cpu --trace fine.csv", 0);
    rockfall.run("run scene.txt --backend cpu --trace coarse.csv --trace-every 20", 0);
    let [fine, coarse] = ["fine.csv", "coarse.csv"].map(|name| rockfall.read(name));
    assert_eq!(fine.lines().last(), coarse.lines().last());
    let end = columns(coarse.lines().last().unwrap());
    let (work, dissipated) = (number(end[15]), number(end[16]));
    // Over 0.03 s, with 0.5 units of arm and 3 rad/s. The force of the ball's contact begins at 0.
    let most = 0.4 * 2.0 * 10.0 * 0.5 * 3.0 * 0.03;
    assert!((0.7 * most..most).contains(&work), "{work}");
    let energy = |line: &str| columns(line)[2..6].iter().map(|text| number(text)).sum::<f64>();
    let gained = energy(coarse.lines().last().unwrap()) - energy(coarse.lines().nth(1).unwrap());
    assert!((work - gained - dissipated).abs() < 1e-12, "{work} {gained} {dissipated}");
    assert!(dissipated > 0.5 * work, "{dissipated}");
    // External forces do work of their own, and so do the forces of other laws.
    for (old, new) in [("@gauge name=weight wall=floor", "@force 1 0 0 1"), ("set contact_law linear\n", "")] {
        let other = Rockfall::with(&SCENE.replace(old, new).replace("integrator=velocity-verlet ", ""));
        other.run("run scene.txt --backend cpu --steps 2 --trace a.csv", 0);
        assert!(other.read("a.csv").lines().skip(1).all(|line| line.ends_with(',')), "{new}");
    }
}

#[test]
fn wrong_gauges_are_errors() {
    let rockfall = Rockfall::with(&SCENE.replace("wall=floor", "wall=flor"));
    let (_, err) = rockfall.run("run scene.txt --backend cpu", 2);
    let expected =
        "scene.txt:17: @gauge wall: 'flor' (similar: 'floor') is not allowed, expected the name of a motion, or of boxes";
    assert!(err.contains(expected), "{err}");
    let rockfall = Rockfall::with("S 1 0 1 0 0 0 0 0 0 0 1 0.1\n");
    let (_, err) = rockfall.run("run scene.txt --backend cpu --steps 1 --gauges a.csv", 0);
    assert!(err.contains("note: --gauges: the scene has no gauges"), "{err}");
    assert_eq!(rockfall.read("a.csv"), "step,time,gauge,fx,fy,fz,tx,ty,tz,mass,count\n");
    for (more, expected) in [
        ("--gauges a.npz", "--gauges a.npz: unknown extension .npz, expected a name that ends in .csv"),
        ("--gauges a.csv --trace a.csv", "--gauges and --trace name the same file"),
    ] {
        let (_, err) = rockfall.run(&format!("run scene.txt --backend cpu --steps 1 {more}"), 2);
        assert!(err.contains(expected), "{more}: {err}");
    }
}
