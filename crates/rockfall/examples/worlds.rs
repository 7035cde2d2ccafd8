//! Runs many creatures side by side and prints which one walked furthest: `cargo run --example worlds`.

use std::time::Instant;

use rockfall::generate::creature;
use rockfall::{Options, Worlds};

fn main() -> rockfall::Result<()> {
    let count = 64;
    let scenes = (0..count).map(|seed| creature(20, seed)).collect::<rockfall::Result<Vec<_>>>()?;
    let mut worlds = Worlds::new(scenes, Options::new())?;
    println!("{count} worlds on {}", worlds.backend().device);

    let start = Instant::now();
    let steps = 1000;
    worlds.run(steps, 0.005)?;
    let seconds = start.elapsed().as_secs_f64();
    println!("{:.0} world-steps/s", (count * steps) as f64 / seconds);

    let mut best = (0, 0.0);
    for (world, states) in worlds.all_states()?.iter().enumerate() {
        let mean = states.iter().map(|state| state.position.x).sum::<f32>() / states.len() as f32;
        if mean.abs() > best.1 {
            best = (world, mean.abs());
        }
    }
    println!("creature {} walked {:.2} units in {} s", best.0, best.1, worlds.report(best.0, None)?.report.time);
    Ok(())
}
