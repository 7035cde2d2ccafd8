//! How a scene is meant to be run, in a checkpoint. A value that is not given is written as 0 or as an empty text, which no
//! value is.

use super::words::{Damage, Head, Words};
use crate::scene::RunDefaults;

pub(super) fn put(head: &mut Head, run: &RunDefaults) {
    let RunDefaults { dt, integrator, steps, every, substeps, speed } = run;
    head.f32(dt.unwrap_or(0.0));
    head.text(&integrator.map(|integrator| integrator.to_string()).unwrap_or_default());
    head.u64(steps.unwrap_or(0));
    head.u64(every.unwrap_or(0));
    head.u32(substeps.unwrap_or(0));
    head.f64(speed.unwrap_or(0.0));
}

pub(super) fn read(words: &mut Words) -> Result<RunDefaults, Damage> {
    let dt = Some(words.f32()?).filter(|dt| *dt != 0.0);
    let integrator = Some(words.text()?).filter(|name| !name.is_empty()).map(|name| name.parse()).transpose()?;
    let [steps, every] = [words.u64()?, words.u64()?].map(|count| Some(count).filter(|count| *count != 0));
    let substeps = Some(words.u32()?).filter(|parts| *parts != 0);
    let speed = Some(words.f64()?).filter(|speed| *speed != 0.0);
    let run = RunDefaults { dt, integrator, steps, every, substeps, speed };
    run.validate()?;
    Ok(run)
}
