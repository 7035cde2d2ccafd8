//! Tables on the device: reading and writing states without a copy through the host.

#![cfg(feature = "gpu")]

use rockfall::generate::Benchmark;
use rockfall::glam::{Quat, Vec3};
use rockfall::gpu::Table;
use rockfall::{
    Backend, BroadPhase, Capsule, ContactLaw, Error, Integrator, Material, Options, Pair, Placement, Precision, RigidBody,
    Scene, Shape, Simulation, Sphere, Spring, wgpu,
};

const STATE: [Table; 4] = [Table::Positions, Table::Velocities, Table::AngularMomenta, Table::Orientations];
const DT: f32 = 0.005;

/// A moving pile with sorted memory, so that slots and insertion indices differ.
fn pile(spheres: u32) -> Simulation {
    let _device = rockfall::gpu::SharedDevice::new();
    let scene = Benchmark::Pile.generate(spheres, 3).unwrap();
    let options = Options::new().backend(Backend::Gpu).broad_phase(BroadPhase::Grid);
    let mut simulation = Simulation::with_options(scene, options).unwrap();
    simulation.run(20, DT).unwrap();
    simulation.sort_memory().unwrap();
    assert!((0..spheres as usize).any(|sphere| simulation.slot(sphere) != sphere), "memory is in insertion order");
    simulation
}

fn device(simulation: &Simulation) -> (wgpu::Device, wgpu::Queue) {
    let gpu = simulation.gpu_view().unwrap().gpu();
    (gpu.device().clone(), gpu.queue().clone())
}

fn buffer(simulation: &Simulation, bytes: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
    let descriptor = wgpu::BufferDescriptor { label: None, size: bytes, usage, mapped_at_creation: false };
    device(simulation).0.create_buffer(&descriptor)
}

fn uploaded(simulation: &Simulation, numbers: &[f32]) -> wgpu::Buffer {
    let made = buffer(simulation, size_of_val(numbers) as u64);
    device(simulation).1.write_buffer(&made, 0, bytemuck::cast_slice(numbers));
    made
}

fn downloaded(simulation: &Simulation, table: &wgpu::Buffer) -> Vec<f32> {
    let (device, queue) = device(simulation);
    let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
    let size = table.size();
    let staging = device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(table, 0, &staging, 0, size);
    queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |done| done.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let view = staging.get_mapped_range(..).unwrap();
    bytemuck::pod_collect_to_vec(&view)
}

fn read(simulation: &mut Simulation, table: Table) -> Vec<f32> {
    let into = buffer(simulation, table.bytes(simulation.scene().spheres().len()));
    simulation.read_table(table, &into).unwrap();
    downloaded(simulation, &into)
}

/// A table made from the scene on the host.
fn expected(simulation: &mut Simulation, table: Table) -> Vec<f32> {
    let spheres = simulation.sync().unwrap().spheres().iter();
    spheres
        .flat_map(|sphere| match table {
            Table::Positions => sphere.position.to_array().to_vec(),
            Table::Velocities => sphere.velocity.to_array().to_vec(),
            Table::AngularMomenta => sphere.angular_momentum.to_array().to_vec(),
            Table::Orientations => {
                let q = sphere.orientation;
                vec![q.w, q.x, q.y, q.z]
            }
            Table::Forces => sphere.force.to_array().to_vec(),
            _ => panic!("{table:?} has no row for a sphere"),
        })
        .collect()
}

/// Some numbers that differ from sphere to sphere.
fn numbers(count: usize) -> Vec<f32> {
    (0..count).map(|k| ((k * 37 % 101) as f32 - 50.0) * 0.01).collect()
}

fn all(simulation: &mut Simulation) -> Vec<f32> {
    STATE.into_iter().flat_map(|table| expected(simulation, table)).collect()
}

#[test]
fn tables_hold_the_state_in_order_of_addition() {
    let mut simulation = pile(1_500);
    for table in STATE {
        assert_eq!(read(&mut simulation, table), expected(&mut simulation, table), "{table:?}");
    }
}

#[test]
fn reading_a_table_applies_edits_first_and_changes_nothing() {
    let [mut plain, mut watched] = [pile(1_200), pile(1_200)];
    for simulation in [&mut plain, &mut watched] {
        let moved = simulation.scene().sphere_ids().nth(7).unwrap();
        simulation.set_velocity(moved, [1.0, 2.0, 3.0]).unwrap();
    }
    assert_eq!(read(&mut watched, Table::Velocities)[21..24], [1.0, 2.0, 3.0]);
    for simulation in [&mut plain, &mut watched] {
        simulation.run(20, DT).unwrap();
    }
    assert_eq!(all(&mut plain), all(&mut watched));
}

#[test]
fn written_states_give_the_steps_of_states_set_one_by_one() {
    let [mut tables, mut single] = [pile(1_200), pile(1_200)];
    let ids: Vec<_> = single.scene().sphere_ids().collect();
    let turned: Vec<f32> = ids.iter().flat_map(|_| [0.5, 0.5, -0.5, 0.5]).collect();
    tables.write_table(Table::Orientations, &uploaded(&tables, &turned)).unwrap();
    ids.iter().for_each(|id| single.set_orientation(*id, Quat::from_xyzw(0.5, -0.5, 0.5, 0.5)).unwrap());
    for (table, by) in [(Table::Positions, 0.1), (Table::Velocities, 1.0), (Table::AngularMomenta, 0.01)] {
        let changed: Vec<f32> =
            expected(&mut tables, table).iter().zip(numbers(3 * ids.len())).map(|(old, new)| old + by * new).collect();
        let from = uploaded(&tables, &changed);
        tables.write_table(table, &from).unwrap();
        for (id, row) in ids.iter().zip(changed.chunks_exact(3)) {
            let value = Vec3::from_slice(row);
            match table {
                Table::Positions => single.set_position(*id, value),
                Table::Velocities => single.set_velocity(*id, value),
                _ => single.set_angular_momentum(*id, value),
            }
            .unwrap();
        }
        assert_eq!(expected(&mut tables, table), changed, "{table:?}");
    }
    for simulation in [&mut tables, &mut single] {
        simulation.run(30, DT).unwrap();
    }
    assert_eq!(all(&mut tables), all(&mut single));
}

#[test]
fn written_forces_act_until_they_are_changed() {
    let [mut tables, mut single] = [pile(1_100), pile(1_100)];
    let ids: Vec<_> = single.scene().sphere_ids().collect();
    for round in 1..4 {
        let forces: Vec<f32> = numbers(3 * ids.len()).iter().map(|number| (number + 0.003) * round as f32).collect();
        let from = uploaded(&tables, &forces);
        tables.write_table(Table::Forces, &from).unwrap();
        for (id, row) in ids.iter().zip(forces.chunks_exact(3)) {
            single.set_force(*id, Vec3::from_slice(row)).unwrap();
        }
        for simulation in [&mut tables, &mut single] {
            simulation.run(10, DT).unwrap();
        }
        assert_eq!(all(&mut tables), all(&mut single), "round {round}");
    }
}

/// The host does not know forces that were written on the device. Edits, checkpoints and reads must not lose them.
#[test]
fn written_forces_survive_edits_and_checkpoints() {
    let mut simulation = pile(1_100);
    let ids: Vec<_> = simulation.scene().sphere_ids().collect();
    let mut forces: Vec<f32> = numbers(3 * ids.len()).iter().map(|number| number + 0.003).collect();
    let from = uploaded(&simulation, &forces);
    simulation.write_table(Table::Forces, &from).unwrap();
    simulation.run(3, DT).unwrap();
    simulation.set_force(ids[5], [7.0, 8.0, 9.0]).unwrap();
    forces[15..18].copy_from_slice(&[7.0, 8.0, 9.0]);
    simulation.add_spring(Spring::new(ids[0], ids[1], 1.0, 1.0)).unwrap();
    simulation.run(1, DT).unwrap();
    assert_eq!(expected(&mut simulation, Table::Forces), forces);

    simulation.write_table(Table::Forces, &uploaded(&simulation, &forces.iter().map(|f| 2.0 * f).collect::<Vec<_>>())).unwrap();
    simulation.remove_sphere(ids[0]).unwrap();
    let kept = simulation.checkpoint().unwrap();
    let kept: Vec<f32> = kept.scene.spheres().iter().flat_map(|sphere| sphere.force.to_array()).collect();
    assert_eq!(kept, forces[3..].iter().map(|f| 2.0 * f).collect::<Vec<_>>());
}

#[test]
fn numbers_that_are_not_allowed_are_errors_and_change_nothing() {
    let mut simulation = pile(1_100);
    let before = all(&mut simulation);
    for table in [Table::Positions, Table::Velocities, Table::AngularMomenta, Table::Orientations, Table::Forces] {
        for (row, bad) in [(0, f32::NAN), (700, f32::INFINITY), (1_099, -f32::NAN)] {
            let columns = table.columns() as usize;
            let mut numbers = [1.0, 0.0, 0.0, 0.0][..columns].repeat(1_100);
            numbers[columns * row + columns - 1] = bad;
            let from = uploaded(&simulation, &numbers);
            let error = simulation.write_table(table, &from).unwrap_err().to_string();
            assert!(error.contains(&format!("row {row}")), "{table:?}: {error}");
        }
    }
    let from = uploaded(&simulation, &[1.0, 0.1, 0.0, 0.0].repeat(1_100));
    let error = simulation.write_table(Table::Orientations, &from).unwrap_err().to_string();
    assert!(error.contains("row 0") && error.contains("unit quaternions"), "{error}");
    assert_eq!(all(&mut simulation), before);
    simulation.run(3, DT).unwrap();
}

#[test]
fn wrong_tables_are_errors() {
    let mut simulation = pile(1_100);
    let small = buffer(&simulation, Table::Positions.bytes(1_099));
    for table in STATE {
        let error = simulation.read_table(table, &small).unwrap_err();
        assert!(matches!(error, Error::Invalid { field: "table", .. }), "{error}");
        let error = simulation.write_table(table, &small).unwrap_err();
        assert!(matches!(error, Error::Invalid { field: "table", .. }), "{error}");
    }
    assert!(simulation.write_table(Table::Forces, &small).is_err());
    let room = buffer(&simulation, Table::Forces.bytes(1_100));
    let error = simulation.read_table(Table::Forces, &room).unwrap_err();
    assert!(error.to_string().contains("forces"), "{error}");

    let options = Options::new().backend(Backend::Cpu);
    let mut cpu = Simulation::with_options(Benchmark::Pile.generate(100, 3).unwrap(), options).unwrap();
    let error = cpu.read_table(Table::Positions, &room).unwrap_err();
    assert!(error.to_string().contains("GPU backend"), "{error}");
}

/// With double precision, positions that are written have no low parts left from before, and other fields leave them.
#[test]
fn written_positions_have_no_low_part() {
    let mut scene = Scene::new();
    scene.settings.contact_law = ContactLaw::HertzMindlin;
    scene.settings.collisions = false;
    scene.settings.precision = Precision::Double;
    let material = scene.add_material(Material::new("m").young(1e4).poisson(0.3)).unwrap();
    for k in 0..3_u8 {
        let centre = [1_000.000_01 + 3.0 * f64::from(k), 0.0, 0.1];
        scene.add_sphere(Sphere::new([0.0; 3], 0.5).material(material).centred_at(centre)).unwrap();
    }
    let options = Options::new().backend(Backend::Gpu).integrator(Integrator::VelocityVerlet);
    let mut simulation = Simulation::with_options(scene, options).unwrap();
    let lows =
        |simulation: &mut Simulation| simulation.spheres().unwrap().iter().any(|sphere| sphere.position_low != Vec3::ZERO);
    let velocities = uploaded(&simulation, &[0.0; 9]);
    simulation.write_table(Table::Velocities, &velocities).unwrap();
    assert!(lows(&mut simulation));
    let positions = numbers(9);
    let table = uploaded(&simulation, &positions);
    simulation.write_table(Table::Positions, &table).unwrap();
    assert!(!lows(&mut simulation));
    assert_eq!(expected(&mut simulation, Table::Positions), positions);
}

/// Fields of rigid bodies are read in order of addition, without those of capsules that move as bodies.
#[test]
fn tables_of_rigid_bodies_are_read_on_the_gpu() {
    let mut scene = Scene::new();
    scene.settings.set("contact_law", "linear").unwrap();
    let material = scene.add_material(Material::new("stuff").density(1.0)).unwrap();
    scene.set_pair(material, material, Pair::default().stiffness(1e3)).unwrap();
    scene.add_capsule(Capsule::new([9.0, 0.0, 0.0], [10.0, 0.0, 0.0], 0.2).material(material)).unwrap();
    let shape = Shape::new().material(material).sphere([0.0; 3], 0.5).sphere([0.7, 0.0, 0.0], 0.4).sphere([0.0, 0.6, 0.0], 0.3);
    let shape = scene.add_shape(shape).unwrap();
    for number in 0..5_u8 {
        let at = [0.0, 3.0 * f64::from(number), 1.0];
        scene.add_body(Placement::new(shape).at(at).velocity([0.1, f32::from(number), 0.0]).spin([1.0, 0.0, 2.0])).unwrap();
    }
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Gpu)).unwrap();
    simulation.run(4, DT).unwrap();
    let fields = [Table::BodyPositions, Table::BodyVelocities, Table::BodyAngularMomenta, Table::BodyOrientations];
    for (number, table) in fields.into_iter().enumerate() {
        let into = buffer(&simulation, table.bytes(5));
        simulation.read_table(table, &into).unwrap();
        let found = downloaded(&simulation, &into);
        let of = |body: &RigidBody| match number {
            0 => body.position.to_array().to_vec(),
            1 => body.velocity.to_array().to_vec(),
            2 => body.angular_momentum.to_array().to_vec(),
            _ => [body.orientation.w, body.orientation.x, body.orientation.y, body.orientation.z].to_vec(),
        };
        let expected: Vec<f32> = simulation.sync().unwrap().bodies().iter().flat_map(of).collect();
        assert_eq!(found, expected, "{table:?}");
        let error = simulation.write_table(table, &into).unwrap_err().to_string();
        assert!(error.contains("can only be read"), "{error}");
    }
}
