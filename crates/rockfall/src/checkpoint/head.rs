//! The head of a checkpoint, which precedes its objects. Structs are destructured field by field, so that the compiler reports
//! a new field that is missing here.

use super::laws::{KeptContactLaw, KeptLaw};
use super::words::{Damage, Head, Words};
use super::{Checkpoint, History};
use super::{gauges, motions, periods, run};
use crate::model::layout::{most_pair_rows, words_of_rows};
use crate::model::muscles::MuscleClock;
use crate::options::Options;
use crate::report::{Passage, Report};
use crate::scene::{Counts, FlowState, Material, Pair, Scene};
use crate::settings::Settings;
use crate::user_laws::{ForceLaw, PairParameter};

pub(super) fn bytes(checkpoint: &Checkpoint) -> Vec<u8> {
    let Checkpoint {
        scene,
        options,
        time_step,
        report,
        note,
        device,
        program,
        history,
        flow: _,
        springs: _,
        rates: _,
        residues: _,
        frames: _,
        fronts,
        kept_laws: _,
        kept_contact_law,
    } = checkpoint;
    let mut head = Head::default();
    for text in [program, device, note] {
        head.text(text);
    }
    settings(&mut head, &scene.settings);

    // How steps are dispatched does not change results, and is chosen by the device that continues.
    let Options {
        backend,
        device: _,
        integrator,
        broad_phase,
        pair_capacity,
        keep_going,
        without: _,
        force_laws,
        contact_force_law,
    } = options;
    for text in [backend.to_string(), integrator.to_string(), broad_phase.to_string()] {
        head.text(&text);
    }
    head.u32(pair_capacity.is_some().into());
    // Results do not depend on it. It may be more than a file may ask for.
    head.u32(pair_capacity.unwrap_or(0).min(most_pair_capacity(&scene.counts())));
    head.u32(u32::from(*keep_going));

    let Report {
        steps,
        time,
        contacts,
        max_overlap,
        collisions,
        total_collisions,
        replays,
        list_builds,
        non_finite,
        passages,
        first_passage,
    } = report;
    head.f32(*time_step);
    head.u64(*steps);
    head.f64(*time);
    head.u32(*contacts);
    head.f32(*max_overlap);
    head.u32(*collisions);
    for count in [total_collisions, replays, list_builds, non_finite, passages] {
        head.u64(*count);
    }
    // The step is 0 where there was none.
    let (sphere, step) = first_passage.map_or((0, 0), |Passage { sphere, step }| (sphere as u64, step));
    head.u64(step);
    head.u64(sphere);

    let History { lengths_due, margin_scale, lookahead, clock } = history;
    head.u32(u32::from(*lengths_due));
    head.f32(*margin_scale);
    head.f32(*lookahead);
    let MuscleClock { start, written_start, dt, steps } = clock;
    head.f64(*start);
    head.f64(*written_start);
    head.f32(*dt);
    head.u64(*steps);

    let Counts { spheres, rods, capsules, springs, tethers, boxes, polygons, .. } = scene.counts();
    for count in [spheres, rods, capsules, springs, tethers, boxes, polygons] {
        head.u64(count as u64);
    }
    materials(&mut head, scene);
    motions::put(&mut head, scene);
    periods::put(&mut head, scene);
    gauges::put(&mut head, scene, fronts);
    run::put(&mut head, &scene.run);
    laws(&mut head, force_laws, &checkpoint.kept_laws);
    let given = contact_force_law.as_ref().map(KeptContactLaw::of);
    contact_law(&mut head, given.as_ref().or(kept_contact_law.as_ref()));
    head.bytes
}

fn read_passage(words: &mut Words) -> Result<Option<Passage>, Damage> {
    let (step, sphere) = (words.u64()?, words.u64()?);
    let sphere = usize::try_from(sphere).map_err(|_| Damage::new("its first passage is of a sphere beyond all numbers"))?;
    if step == 0 && sphere > 0 {
        return Err(Damage::new(format!("its first passage, of sphere number {sphere}, is before the first step")));
    }
    Ok((step > 0).then_some(Passage { sphere, step }))
}

/// Words of pair lists that a file may ask for.
fn most_pair_capacity(counts: &Counts) -> u32 {
    let movers = u32::try_from(counts.spheres.saturating_add(counts.rods)).unwrap_or(u32::MAX);
    u32::try_from(words_of_rows(most_pair_rows(movers))).unwrap_or(u32::MAX)
}

/// Reads the checkpoint without its objects, and the numbers of objects.
pub(super) fn read(words: &mut Words) -> Result<(Checkpoint, Counts), Damage> {
    let (program, device, note) = (words.text()?, words.text()?, words.text()?);
    let mut scene = Scene::new();
    scene.settings = read_settings(words)?;

    let (backend, integrator, broad_phase) = (words.text()?.parse()?, words.text()?.parse()?, words.text()?.parse()?);
    let (limited, capacity, keep_going) = (words.bool()?, words.u32()?, words.bool()?);
    let pair_capacity = limited.then_some(capacity);
    let options = Options { backend, integrator, broad_phase, pair_capacity, keep_going, ..Options::default() };

    let time_step = words.f32()?;
    if !(time_step.is_finite() && time_step > 0.0) {
        return Err(Damage::new(format!("its time step of {time_step} s is not positive and finite")));
    }
    let is_time = |time: f64| time.is_finite() && time >= 0.0;
    let report = Report {
        steps: words.u64()?,
        time: words.f64()?,
        contacts: words.u32()?,
        max_overlap: words.f32()?,
        collisions: words.u32()?,
        total_collisions: words.u64()?,
        replays: words.u64()?,
        list_builds: words.u64()?,
        non_finite: words.u64()?,
        passages: words.u64()?,
        first_passage: read_passage(words)?,
    };
    if (report.passages > 0) != report.first_passage.is_some() {
        return Err(Damage::new(format!("it has {} passages through walls without a first one", report.passages)));
    }
    if !(is_time(report.time) && report.max_overlap >= 0.0) {
        return Err(Damage::new(format!("its time is {} s and its deepest overlap {}", report.time, report.max_overlap)));
    }
    let (lengths_due, margin_scale, lookahead) = (words.bool()?, words.f32()?, words.f32()?);
    let clock = MuscleClock { start: words.f64()?, written_start: words.f64()?, dt: words.f32()?, steps: words.u64()? };
    if !(is_time(clock.start) && is_time(clock.written_start) && clock.dt.is_finite() && clock.dt > 0.0) {
        return Err(Damage::new(format!("its muscles and motions began at {} s with steps of {} s", clock.start, clock.dt)));
    }
    let history = History { lengths_due, margin_scale, lookahead, clock };
    let is_usable = |number: f32, least: f32| number.is_finite() && number >= least;
    if !(is_usable(history.margin_scale, 0.0) && is_usable(history.lookahead, 1.0)) {
        return Err(Damage::new(format!(
            "its AABB margin {} or its lookahead of {} steps is out of range",
            history.margin_scale, history.lookahead
        )));
    }

    let mut count = || -> Result<usize, Damage> {
        usize::try_from(words.u64()?).map_err(|_| Damage::new("it has more objects than fit in memory"))
    };
    let counts = Counts {
        spheres: count()?,
        rods: count()?,
        capsules: count()?,
        springs: count()?,
        tethers: count()?,
        boxes: count()?,
        polygons: count()?,
        // They are stored below.
        bodies: 0,
        hulls: 0,
        joints: 0,
    };
    let most = most_pair_capacity(&counts);
    if capacity > most {
        return Err(Damage::new(format!("it asks for pair lists of {capacity} words, expected at most {most}")));
    }
    read_materials(words, &mut scene)?;
    motions::read(words, &mut scene)?;
    periods::read(words, &mut scene)?;
    let fronts = gauges::read(words, &mut scene)?;
    scene.run = run::read(words)?;
    let kept_laws = read_laws(words)?;
    let kept_contact_law = read_contact_law(words)?;
    let (springs, rates, residues, frames) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let checkpoint = Checkpoint {
        scene,
        options,
        time_step,
        report,
        note,
        device,
        program,
        history,
        flow: FlowState::default(),
        springs,
        rates,
        residues,
        frames,
        fronts,
        kept_laws,
        kept_contact_law,
    };
    Ok((checkpoint, counts))
}

/// Writes the constants by name, as text that reads back bitwise identical. The direction of gravity is also stored as numbers,
/// because reading it by name normalizes it, and a direction set in code need not have length 1.
fn settings(head: &mut Head, settings: &Settings) {
    head.u32(Settings::NAMES.len() as u32);
    for name in Settings::NAMES {
        head.text(name);
        head.text(&settings.get(name).unwrap_or_default());
    }
    for number in settings.gravity_direction.to_array() {
        head.f32(number);
    }
}

fn read_settings(words: &mut Words) -> Result<Settings, Damage> {
    let mut settings = Settings::default();
    let mut constants = Vec::new();
    for _ in 0..words.u32()? {
        constants.push((words.text()?, words.text()?));
    }
    settings.set_all(constants.iter().map(|(name, value)| (name.as_str(), value.as_str())))?;
    settings.gravity_direction = words.vec3()?;
    settings.validate()?;
    Ok(settings)
}

/// Writes materials in insertion order, then the properties of pairs with the indices of the two materials.
fn materials(head: &mut Head, scene: &Scene) {
    head.u32(scene.materials().len() as u32);
    for Material { name, density, young, poisson } in scene.materials() {
        head.text(name);
        [density, young, poisson].into_iter().for_each(|constant| head.known(*constant));
    }
    head.u32(scene.pairs.len() as u32);
    for ((one, other), pair) in &scene.pairs {
        let Pair {
            restitution,
            friction,
            stiffness,
            characteristic_velocity,
            rolling_friction,
            rolling_model,
            rolling_damping,
            twisting_friction,
            surface_energy,
            cohesion,
        } = pair;
        head.u32(u32::from(*one));
        head.u32(u32::from(*other));
        let numbers = [
            restitution,
            friction,
            stiffness,
            rolling_friction,
            rolling_damping,
            twisting_friction,
            surface_energy,
            characteristic_velocity,
        ];
        numbers.into_iter().for_each(|property| head.known(*property));
        head.text(&rolling_model.map(|model| model.to_string()).unwrap_or_default());
        head.text(&cohesion.map(|model| model.to_string()).unwrap_or_default());
    }
}

fn read_materials(words: &mut Words, scene: &mut Scene) -> Result<(), Damage> {
    for _ in 0..words.u32()? {
        let mut material = Material::new(words.text()?);
        (material.density, material.young, material.poisson) = (words.known()?, words.known()?, words.known()?);
        scene.add_material(material)?;
    }
    for _ in 0..words.u32()? {
        let [one, other] = [words.u32()?, words.u32()?].map(|index| index as usize);
        if one.max(other) >= scene.materials().len() {
            return Err(Damage::new(format!("a pair refers to material {} of {}", one.max(other), scene.materials().len())));
        }
        let (restitution, friction, stiffness) = (words.known()?, words.known()?, words.known()?);
        let mut pair = Pair { restitution, friction, stiffness, ..Pair::default() };
        (pair.rolling_friction, pair.rolling_damping) = (words.known()?, words.known()?);
        (pair.twisting_friction, pair.surface_energy) = (words.known()?, words.known()?);
        pair.characteristic_velocity = words.known()?;
        let model = words.text()?;
        pair.rolling_model = if model.is_empty() { None } else { Some(model.parse()?) };
        let model = words.text()?;
        pair.cohesion = if model.is_empty() { None } else { Some(model.parse()?) };
        let [one, other] = [one, other].map(|index| scene.materials.handle_at(index));
        scene.set_pair(one, other, pair)?;
    }
    Ok(())
}

/// Writes the force laws: those that are given, or those of the checkpoint that this one was read from.
fn laws(head: &mut Head, given: &[ForceLaw], kept: &[KeptLaw]) {
    let present: Vec<KeptLaw> = given.iter().map(KeptLaw::of).collect();
    let is_given = |law: &KeptLaw| present.iter().any(|other| other.name == law.name);
    let all = if kept.iter().all(is_given) { &present } else { kept };
    head.u32(all.len() as u32);
    all.iter().for_each(|kept| law(head, kept));
}

fn law(head: &mut Head, KeptLaw { name, text_hash, parameters }: &KeptLaw) {
    head.text(name);
    head.u64(*text_hash);
    head.u32(parameters.len() as u32);
    for (parameter, value) in parameters {
        head.text(parameter);
        head.f32(*value);
    }
}

/// Writes the contact law of the program, if there is one.
fn contact_law(head: &mut Head, kept: Option<&KeptContactLaw>) {
    head.u32(kept.is_some().into());
    if let Some(KeptContactLaw { law: kept, pairs }) = kept {
        law(head, kept);
        head.u32(pairs.len() as u32);
        for PairParameter { materials: [one, other], parameter, value } in pairs {
            [one, other, parameter].into_iter().for_each(|text| head.text(text));
            head.f32(*value);
        }
    }
}

fn read_contact_law(words: &mut Words) -> Result<Option<KeptContactLaw>, Damage> {
    if !words.bool()? {
        return Ok(None);
    }
    let law = read_law(words)?;
    let mut pairs = Vec::new();
    for _ in 0..words.u32()? {
        let (materials, parameter) = ([words.text()?, words.text()?], words.text()?);
        pairs.push(PairParameter { materials, parameter, value: words.f32()? });
    }
    Ok(Some(KeptContactLaw { law, pairs }))
}

fn read_laws(words: &mut Words) -> Result<Vec<KeptLaw>, Damage> {
    let mut laws = Vec::new();
    for _ in 0..words.u32()? {
        laws.push(read_law(words)?);
    }
    Ok(laws)
}

fn read_law(words: &mut Words) -> Result<KeptLaw, Damage> {
    let (name, text_hash) = (words.text()?, words.u64()?);
    let mut parameters = Vec::new();
    for _ in 0..words.u32()? {
        parameters.push((words.text()?, words.f32()?));
    }
    Ok(KeptLaw { name, text_hash, parameters })
}
