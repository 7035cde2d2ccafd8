use std::path::Path;
use rockfall::{Backend, Options, Scene, Simulation};
#[test]
fn scratch_trace() {
    let text = std::fs::read_to_string(std::env::var("SCENE").unwrap()).unwrap();
    let from: u64 = std::env::var("FROM").ok().map_or(0, |x| x.parse().unwrap());
    let to: u64 = std::env::var("TO").ok().map_or(40, |x| x.parse().unwrap());
    let scene = Scene::parse(&text, Path::new("x")).unwrap().scene;
    let mut s = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap();
    for frame in 0..to {
        s.run(1, 1.0 / 60.0).unwrap();
        if frame < from { continue; }
        println!("frame {frame} replays {} contacts {} substeps {:?} E {}", s.report().replays, s.report().contacts, s.substeps(), s.energy().unwrap().kinetic);
        let sc = s.sync().unwrap();
        for (n, b) in sc.bodies().iter().enumerate() { println!("   b{n} {} v {} L {}", b.position, b.velocity, b.angular_momentum); }
        for id in sc.sphere_ids() { if sc.body_of_sphere(id).is_none() { let b = sc.sphere(id).unwrap(); println!("   s {} v {}", b.position, b.velocity); } }
        if std::env::var("CONTACTS").is_ok() { for c in s.contacts().unwrap() { println!("   c {:?} {:?} p {} n {} d {} {:?}", c.a, c.b, c.point, c.normal, c.overlap, c.action); } }
    }
}
