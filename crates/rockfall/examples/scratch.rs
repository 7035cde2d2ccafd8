use rockfall::scene::generate::Benchmark;
use rockfall::*;
fn main() -> Result<()> {
    let args: Vec<String> = std::env::args().collect();
    let kind = match args[1].as_str() {
        "pile" => Benchmark::Pile,
        "lattice" => Benchmark::Lattice,
        "settled" => Benchmark::Settled,
        "shuffled" => Benchmark::Shuffled,
        "mixed" => Benchmark::Mixed,
        "radii" => Benchmark::Radii,
        _ => Benchmark::Thesis,
    };
    let n: u32 = args[2].parse().unwrap();
    let checkpoints: Vec<u64> = args[3].split(',').map(|a| a.parse().unwrap()).collect();
    let backend: Backend = args.get(4).map_or(Backend::Gpu, |b| b.parse().unwrap());
    let bp: BroadPhase = args.get(5).map_or(BroadPhase::Auto, |b| b.parse().unwrap());
    let t = std::time::Instant::now();
    let scene = kind.generate(n, 1)?;
    let mut sim = Simulation::with_options(scene, Options::new().backend(backend).broad_phase(bp))?;
    println!(
        "== {} {n} on {} {} built in {:?}, {} B/sphere",
        args[1],
        sim.backend().device,
        sim.broad_phase_method(),
        t.elapsed(),
        sim.device_memory() / u64::from(n)
    );
    let mut at = 0;
    for c in checkpoints {
        let d = c - at;
        at = c;
        let t = std::time::Instant::now();
        sim.run(d, 0.02)?;
        let s = t.elapsed().as_secs_f64();
        let r = sim.report();
        println!(
            "-- to step {c}: {:.3} ms/step {:.3} G/s contacts {} overlap {:.4} collisions {} replays {} mem {}",
            1e3 * s / d as f64,
            n as f64 * d as f64 / s / 1e9,
            r.contacts,
            r.max_overlap,
            r.collisions,
            r.replays,
            sim.device_memory() / u64::from(n)
        );
    }
    let p = sim.profile(32, 0.02)?;
    println!(
        "profile {:.3} ms/step wall; stages {:.3}",
        1e3 * p.seconds / p.steps as f64,
        1e3 * p.stage_seconds() / p.steps as f64
    );
    for s in &p.stages {
        println!(
            "  {:20} runs {:5} {:8.4} ms/step  {:6.2} TB/s least",
            s.name,
            s.runs / p.steps,
            1e3 * s.seconds / p.steps as f64,
            s.least_bytes as f64 / s.seconds / 1e12
        );
    }
    Ok(())
}
