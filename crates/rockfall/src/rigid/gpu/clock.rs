//! Times of the stages of frames.

use std::collections::BTreeMap;
use std::sync::Mutex;

const ROOM: u32 = 4096;

#[derive(Debug)]
pub(super) struct Clock {
    set: wgpu::QuerySet,
    names: Vec<&'static str>,
    totals: BTreeMap<&'static str, (u32, f64)>,
    frames: u32,
}

pub(super) static CLOCK: Mutex<Option<Clock>> = Mutex::new(None);

pub(super) fn start(device: &wgpu::Device) {
    if std::env::var_os("ROCKFALL_FRAME_TIMES").is_none() {
        return;
    }
    let set = device.create_query_set(&wgpu::QuerySetDescriptor { label: None, ty: wgpu::QueryType::Timestamp, count: ROOM });
    *CLOCK.lock().unwrap() = Some(Clock { set, names: Vec::new(), totals: BTreeMap::new(), frames: 0 });
}

pub(super) fn tick(pass: &mut wgpu::ComputePass<'_>, name: &'static str) {
    if let Some(clock) = CLOCK.lock().unwrap().as_mut() {
        if (clock.names.len() as u32) < ROOM {
            pass.write_timestamp(&clock.set, clock.names.len() as u32);
            clock.names.push(name);
        }
    }
}

/// Reads the times and begins anew.
pub(super) fn collect(gpu: &super::RigidGpu) {
    let mut clock = CLOCK.lock().unwrap();
    let Some(clock) = clock.as_mut() else { return };
    let count = clock.names.len() as u32;
    if count < 2 {
        return;
    }
    let size = u64::from(count) * 8;
    let resolve = gpu.buffer("times", size, wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC);
    let back = gpu.buffer("times", size, wgpu::BufferUsages::MAP_READ);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.resolve_query_set(&clock.set, 0..count, &resolve, 0);
    encoder.copy_buffer_to_buffer(&resolve, 0, &back, 0, size);
    let times: Vec<u64> = gpu.submit_and_read(encoder, &back, size).unwrap();
    let period = f64::from(gpu.queue.get_timestamp_period());
    for k in 0..count as usize - 1 {
        let entry = clock.totals.entry(clock.names[k]).or_default();
        entry.0 += 1;
        entry.1 += period * 1e-3 * times[k + 1].saturating_sub(times[k]) as f64;
    }
    clock.names.clear();
    clock.frames += 1;
    if clock.frames % 60 == 0 {
        eprintln!("stage: us per frame, dispatches per frame, us per dispatch");
        for (name, (count, micros)) in &clock.totals {
            eprintln!("  {name:20} {:9.1} {:7.1} {:8.2}", micros / 60.0, f64::from(*count) / 60.0, micros / f64::from(*count));
        }
        clock.totals.clear();
    }
}
