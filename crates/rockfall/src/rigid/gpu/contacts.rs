//! The kernels find the contacts that the twin finds.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::rigid::collide::{Manifold, collide};
use crate::rigid::gpu::shapes::{ShapeRow, shape_row};
use crate::rigid::pose::Pose;
use crate::rigid::shape::tests::Random;
use crate::rigid::shape::{Core, Hull, Shape};

/// Pairs of a kind.
const EACH: usize = 200;
/// Pairs of a kind that may differ: where two axes or points are equally good, the last bit decides.
const TIES: usize = 6;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct PairRow {
    a: ShapeRow,
    b: ShapeRow,
    position: [f32; 3],
    reach: f32,
    turn: [f32; 4],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct ManifoldRow {
    normal: [f32; 3],
    count: u32,
    on_a: [[f32; 4]; 4],
    on_b: [[f32; 4]; 4],
    ids: [u32; 4],
}

struct Case {
    kind: String,
    shapes: [Shape; 2],
    pose: Pose,
    reach: f32,
}

fn shape(kind: &str, random: &mut Random) -> Shape {
    match kind {
        "box" => Shape::cuboid(Vec3::splat(0.55) + random.vector(0.45)),
        "ball" => Shape::ball(random.between(0.1, 1.0)),
        "capsule" => Shape::capsule(random.between(0.1, 1.0), random.between(0.1, 0.5)),
        "face" => {
            let [u, v] = [Vec3::new(0.8, 0.1, 0.0), Vec3::new(random.between(-0.3, 0.3), 0.6, 0.0)];
            Shape {
                core: Core::Face { u, v, is_triangle: false, one_sided: random.between(0.0, 1.0) < 0.5, is_facet: false },
                radius: 0.0,
            }
        }
        "triangle" => {
            let [u, v] = [Vec3::new(0.8, random.between(-0.3, 0.3), 0.0), Vec3::new(random.between(-0.5, 0.1), 0.6, 0.0)];
            let one_sided = random.between(0.0, 1.0) < 0.5;
            Shape { core: Core::Face { u, v, is_triangle: true, one_sided, is_facet: false }, radius: 0.0 }
        }
        "hull" => {
            let points: Vec<Vec3> = (0..8).map(|_| random.vector(0.8)).collect();
            Shape { core: Core::Hull(Arc::new(Hull::new(&points).expect("a hull").0)), radius: 0.0 }
        }
        "cone" => {
            let radii = [random.between(0.5, 2.0), random.between(0.0, 2.0)];
            Shape {
                core: Core::Cone { half: random.between(0.2, 2.0), radii, inside: random.between(0.0, 1.0) < 0.5 },
                radius: 0.0,
            }
        }
        "bowl" => Shape { core: Core::Bowl { radius: random.between(1.0, 3.0) }, radius: 0.0 },
        "facet" => {
            let core = Core::Face { u: Vec3::X, v: Vec3::Y, is_triangle: false, one_sided: true, is_facet: true };
            Shape { core, radius: 0.0 }
        }
        _ => Shape { core: Core::HalfSpace, radius: 0.0 },
    }
}

fn cases() -> Vec<Case> {
    let mut random = Random(5);
    let mut all = Vec::new();
    for kind in [
        "box box",
        "half-space box",
        "half-space capsule",
        "half-space ball",
        "half-space hull",
        "ball ball",
        "box ball",
        "face ball",
        "capsule ball",
        "hull ball",
        "box capsule",
        "face box",
        "triangle ball",
        "triangle capsule",
        "triangle box",
        "triangle hull",
        "hull box",
        "hull hull",
        "cone ball",
        "bowl ball",
        "facet ball",
        "facet box",
        "cone box",
        "bowl capsule",
    ] {
        for _ in 0..EACH {
            let shapes: Vec<Shape> = kind.split(' ').map(|name| shape(name, &mut random)).collect();
            let turn = random.turn();
            let reach = shapes.iter().map(Shape::extent).filter(|extent| extent.is_finite()).sum::<f32>();
            let position = random.vector(1.0).normalize_or(Vec3::X) * random.between(0.2, 1.0) * reach;
            let shapes = [shapes[0].clone(), shapes[1].clone()];
            all.push(Case { kind: kind.into(), shapes, pose: Pose::new(position, turn), reach: random.between(0.0, 0.4) });
        }
    }
    all
}

/// A file with all that it requires.
fn join(name: &str, seen: &mut Vec<String>, text: &mut String) {
    if seen.iter().any(|known| known == name) {
        return;
    }
    seen.push(name.into());
    let path = format!("{}/src/{name}", env!("CARGO_MANIFEST_DIR"));
    let own = std::fs::read_to_string(path).expect("a file of the project");
    for line in own.lines().map_while(|line| line.strip_prefix("// requires")) {
        line.split_whitespace().for_each(|name| join(name, seen, text));
    }
    text.push_str(&own);
}

const MAIN: &str = "
struct Input { a: Shape, b: Shape, position: vec3f, reach: f32, turn: vec4f }
@group(0) @binding(0) var<storage, read> inputs: array<Input>;
@group(0) @binding(1) var<storage, read_write> outputs: array<Manifold>;
@group(0) @binding(2) var<storage, read> hulls: array<vec4u>;
@compute @workgroup_size(64)
fn run(@builtin(global_invocation_id) at: vec3u) {
    if at.x < arrayLength(&inputs) {
        let input = inputs[at.x];
        outputs[at.x] = collide(input.a, input.b, input.position, input.turn, input.reach);
    }
}
";

fn on_device(cases: &[Case]) -> Vec<ManifoldRow> {
    let (mut text, mut words) = (String::new(), Vec::new());
    join("rigid/collide/collide.wgsl", &mut Vec::new(), &mut text);
    // Kernels for hulls have room for more corners.
    let text = text.replace("const MOST_CANDIDATES: u32 = 8u;", "const MOST_CANDIDATES: u32 = 64u;") + MAIN;
    let input = |case: &Case, words: &mut Vec<[u32; 4]>| {
        let [a, b] = [0, 1].map(|side: usize| shape_row(&case.shapes[side], words));
        let Pose { position, turn } = case.pose;
        PairRow { a, b, position: position.to_array(), reach: case.reach, turn: turn.to_array() }
    };
    let inputs: Vec<PairRow> = cases.iter().map(|case| input(case, &mut words)).collect();
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())).expect("an adapter");
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).expect("a device");
    let module = device
        .create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source: wgpu::ShaderSource::Wgsl(text.into()) });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("run"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let buffer = |size: usize, usage: wgpu::BufferUsages| {
        device.create_buffer(&wgpu::BufferDescriptor { label: None, size: size as u64, usage, mapped_at_creation: false })
    };
    let filled = |bytes: &[u8]| {
        let buffer = buffer(bytes.len(), wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
        queue.write_buffer(&buffer, 0, bytes);
        buffer
    };
    let size = inputs.len() * size_of::<ManifoldRow>();
    let output = buffer(size, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let back = buffer(size, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let (inputs, hulls) = (filled(bytemuck::cast_slice(&inputs)), filled(bytemuck::cast_slice(&words)));
    let entry = |binding: usize, buffer: &wgpu::Buffer| (binding as u32, buffer.clone());
    let buffers = [entry(0, &inputs), entry(1, &output), entry(2, &hulls)];
    let entries = buffers
        .each_ref()
        .map(|(binding, buffer)| wgpu::BindGroupEntry { binding: *binding, resource: buffer.as_entire_binding() });
    let layout = pipeline.get_bind_group_layout(0);
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups((cases.len() as u32).div_ceil(64), 1, 1);
    }
    encoder.copy_buffer_to_buffer(&output, 0, &back, 0, size as u64);
    let submission = queue.submit([encoder.finish()]);
    back.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
    device.poll(wgpu::PollType::Wait { submission_index: Some(submission), timeout: None }).expect("it runs");
    let bytes = back.get_mapped_range(..).expect("a range");
    bytemuck::cast_slice(&bytes).to_vec()
}

/// Balls touch smooth walls, and everything else their facets.
const NEVER: [&str; 3] = ["facet ball", "cone box", "bowl capsule"];

fn agrees(twin: Option<&Manifold>, found: &ManifoldRow, size: f32) -> bool {
    let Some(twin) = twin else { return found.count == 0 };
    let near = |row: [f32; 4], point: Vec3| Vec3::new(row[0], row[1], row[2]).distance(point) < 1e-4 * size;
    let same = |k: usize| {
        let point = &twin.points[k];
        found.ids[k] == point.id && near(found.on_a[k], point.on_a) && near(found.on_b[k], point.on_b)
    };
    found.count as usize == twin.count
        && Vec3::from_array(found.normal).distance(twin.normal) < 2e-4
        && (0..twin.count).all(same)
}

#[test]
fn contacts_on_a_device_are_those_of_the_twin() {
    let cases = cases();
    let found = on_device(&cases);
    for (cases, found) in cases.chunks(EACH).zip(found.chunks(EACH)) {
        let kind = &cases[0].kind;
        let twins: Vec<Option<Manifold>> =
            cases.iter().map(|Case { shapes: [a, b], pose, reach, .. }| collide(a, b, pose, *reach)).collect();
        let touching = twins.iter().flatten().count();
        if NEVER.contains(&kind.as_str()) {
            assert_eq!(touching, 0, "{kind}");
        } else {
            assert!(touching > EACH / 10, "{kind}: {touching} of {EACH} touch");
        }
        let all = cases.iter().zip(&twins).zip(found);
        let others = all.filter(|((case, twin), found)| !agrees(twin.as_ref(), found, 1.0 + case.pose.position.length()));
        let others = others.count();
        assert!(others <= TIES, "{kind}: {others} of {EACH} differ");
    }
}
