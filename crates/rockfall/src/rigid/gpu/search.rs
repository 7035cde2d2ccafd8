//! The search for the contacts of a frame on a device (docs/physics sections 11.2 and 11.3): from the bodies to manifolds, in no
//! order. `rigid/broad/search.wgsl` tells what its arrays have.

use std::mem::size_of;
use std::sync::PoisonError;

use bytemuck::{Pod, Zeroable, bytes_of, cast_slice};
use wgpu::BufferUsages;

use crate::rigid::gpu::kernels::{
    APART, BODIES, BOUND, BOUNDS, CANDIDATES, CELLS, COLLIDERS, CONSTANTS, COUNTS, ENDS, FOUND, HULLS, Kernel, MEMBERS,
    NARROW_BOXES, NARROW_ROUND, NARROW_SOLIDS, OPEN, OWNED, PAIR_UP, SCALES, SCATTER, SEARCH, SEARCH_STAGES, join,
};
use crate::rigid::gpu::scan::Scan;
use crate::rigid::gpu::{MOST_GROUPS, RigidGpu, THREADS};
use crate::rigid::shape::{Core, Shape};
use crate::rigid::world::{Body, Kind, RigidWorld};

/// A manifold in FOUND. `rigid/broad/search.wgsl` has the same rows.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct FoundRow {
    pub(crate) colliders: [u32; 2],
    pub(crate) bodies: [u32; 2],
    /// In coordinates of body a.
    pub(crate) normal: [f32; 3],
    /// Points, room << 8, flags ROUND and BELT.
    pub(crate) info: u32,
    pub(crate) points: [FoundPoint; 4],
}

/// The places of a point in coordinates of the bodies.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct FoundPoint {
    pub(crate) on_a: [f32; 3],
    pub(crate) id: u32,
    pub(crate) on_b: [f32; 3],
    pub(crate) unused: u32,
}

/// The uniform block of the search.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
struct SearchRow {
    dt: f32,
    colliders: u32,
    slots: u32,
    candidates: u32,
    found: u32,
    fineness: f32,
    unused: [u32; 2],
}

const _: () = assert!(size_of::<FoundRow>() == 10 * 16 && size_of::<SearchRow>() == 32);

/// Bytes of a row of CANDIDATES and of FOUND.
const CANDIDATE_BYTES: u64 = 8;
const FOUND_BYTES: u64 = size_of::<FoundRow>() as u64;
/// Level of the boxes of the usual size, of 32.
const USUAL_LEVEL: u32 = 16;
/// Words of COUNTS: candidates, manifolds, then others.
pub(crate) const COUNT_WORDS: u32 = 64;

/// Arrays of a frame that the search reads. It writes margins and what counts from 0 to the bodies.
#[derive(Clone, Debug)]
pub(crate) struct Inputs {
    /// Uniform, a `FrameRow`: its field and its number of bodies.
    pub(crate) frame: wgpu::Buffer,
    pub(crate) bodies: wgpu::Buffer,
    pub(crate) constants: wgpu::Buffer,
    pub(crate) colliders: wgpu::Buffer,
    pub(crate) hulls: wgpu::Buffer,
    /// Bodies that joints keep apart: one word, 0, if there are none.
    pub(crate) apart: wgpu::Buffer,
}

/// What shapes a scene has, so that its kernels have no more than they need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Content {
    /// Balls or capsules.
    round: bool,
    capsules: bool,
    hulls: bool,
    /// Pairs of faces, boxes and hulls other than two boxes without radii.
    solids: bool,
    /// Boxes, faces or hulls.
    flat: bool,
    periodic: bool,
    /// Worlds share the frame.
    joined: bool,
}

/// The search of a scene. Its arrays stay on the device.
#[derive(Debug)]
pub(crate) struct Search {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// By stage; none for stages that the scene does not need.
    kernels: Vec<Option<Kernel>>,
    groups: Vec<Option<wgpu::BindGroup>>,
    inputs: Inputs,
    row: SearchRow,
    uniform: wgpu::Buffer,
    bodies: u32,
    bounds: wgpu::Buffer,
    cells: wgpu::Buffer,
    members: wgpu::Buffer,
    scan: Scan,
    /// Pairs of colliders, two words each.
    pub(crate) candidates: wgpu::Buffer,
    /// [`FoundRow`]s, in no order.
    pub(crate) found: wgpu::Buffer,
    /// The numbers of candidates and of manifolds, which go on beyond the rooms, and others.
    pub(crate) counts: wgpu::Buffer,
    /// Of each body the number of manifolds that it owns: of the bodies a < b of a manifold, b if it has mass, else a.
    pub(crate) owned: wgpu::Buffer,
    /// Of each body the factor of its margin, then of each three words: its periods. At the start those of the world.
    pub(crate) scales: wgpu::Buffer,
    /// Dispatches so far.
    pub(crate) dispatches: u32,
}

impl Content {
    pub(super) fn of(world: &RigidWorld) -> Self {
        let any = |is: fn(&Shape) -> bool| world.shapes.iter().any(is);
        let sharp_box = |shape: &Shape| matches!(shape.core, Core::Box { .. }) && shape.radius <= 0.0;
        let flat = |shape: &Shape| matches!(shape.core, Core::Box { .. } | Core::Face { .. } | Core::Hull(_));
        Self {
            round: any(Shape::is_round),
            capsules: any(|shape| matches!(shape.core, Core::Segment { .. })),
            hulls: any(|shape| matches!(shape.core, Core::Hull(_))),
            solids: world.shapes.iter().any(|shape| flat(shape) && !sharp_box(shape)),
            flat: world.shapes.iter().any(flat),
            periodic: world.periods.any(),
            joined: world.bodies.iter().any(|body| body.home > 0),
        }
    }

    /// The stages that the search of such a scene has.
    pub(super) fn stages(self) -> Vec<usize> {
        (0..SEARCH_STAGES.len()).filter(|stage| self.needs(*stage)).collect()
    }

    fn needs(self, stage: usize) -> bool {
        match stage {
            NARROW_BOXES => self.flat,
            NARROW_SOLIDS => self.solids,
            NARROW_ROUND => self.round,
            _ => true,
        }
    }

    /// The text of a kernel without what the scene does not have.
    fn text(self, file: &str) -> String {
        let without = |text: String, name: &str, is_there: bool| {
            if is_there {
                text
            } else {
                text.replace(&format!("const {name}: bool = true;"), &format!("const {name}: bool = false;"))
            }
        };
        let flags = [
            ("HULLS", self.hulls),
            ("CAPSULES", self.capsules),
            ("SOLIDS", self.solids),
            ("PERIODIC", self.periodic),
            ("JOINED", self.joined),
        ];
        let text = flags.into_iter().fold(join(file), |text, (name, is_there)| without(text, name, is_there));
        // A hull has more vertices than two quadrilaterals.
        if self.hulls { text.replace("const MOST_CANDIDATES: u32 = 8u;", "const MOST_CANDIDATES: u32 = 64u;") } else { text }
    }
}

impl RigidGpu {
    /// A kernel of the search for scenes with this content, compiled at its first use.
    pub(super) fn search_kernel(&self, number: usize, content: Content) -> Kernel {
        let kernels = || self.search_kernels.lock().unwrap_or_else(PoisonError::into_inner);
        let known = kernels().get(&(number, content)).cloned();
        // Without the lock, so that several are compiled at a time.
        known.unwrap_or_else(|| {
            let stage = &SEARCH_STAGES[number];
            let text = self.text(content.text(stage.file));
            let kernel = Kernel::build(&self.device, stage, text, &[(0, false), (SEARCH, false)]);
            kernels().entry((number, content)).or_insert(kernel).clone()
        })
    }
}

impl Search {
    /// The search of a world in frames of `dt` seconds. The inputs have the rows of all its bodies and colliders.
    ///
    /// # Panics
    ///
    /// If an array of the inputs is shorter than the world.
    pub(crate) fn new(gpu: &RigidGpu, world: &RigidWorld, dt: f32, inputs: Inputs) -> Self {
        let (device, queue) = (gpu.device.clone(), gpu.queue.clone());
        let (bodies, colliders) = (world.bodies.len() as u32, world.colliders.len() as u32);
        assert!(inputs.bodies.size() >= 144 * u64::from(bodies) && inputs.colliders.size() >= 80 * u64::from(colliders));
        let content = Content::of(world);
        let kernel = |number| content.needs(number).then(|| gpu.search_kernel(number, content));
        let kernels = (0..SEARCH_STAGES.len()).map(kernel).collect();
        // At most half of the slots are in use.
        let slots = (2 * colliders.max(1)).next_power_of_two();
        let fineness = (f64::from(1 << USUAL_LEVEL) / usual_size(world, dt)) as f32;
        let row = SearchRow { dt, colliders, slots, fineness, ..SearchRow::default() };
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let words = |label, count: u64| gpu.buffer(label, 4 * count, storage);
        let [wide_bodies, wide_colliders] = [bodies, colliders].map(u64::from);
        let cells = words("rigid cells", u64::from(slots));
        let scan = Scan::new(&device, gpu.scans(), &cells, slots);
        let scales = words("rigid scales", 4 * wide_bodies);
        queue.write_buffer(&scales, 0, cast_slice(&scales_of(world)));
        let mut search = Self {
            kernels,
            groups: Vec::new(),
            inputs,
            row,
            uniform: gpu.buffer("rigid search", size_of::<SearchRow>() as u64, BufferUsages::UNIFORM),
            bodies,
            bounds: words("rigid bounds", 8 * wide_colliders),
            members: words("rigid members", 2 * wide_colliders),
            cells,
            scan,
            candidates: words("rigid candidates", 1),
            found: words("rigid found", 1),
            counts: words("rigid counts", u64::from(COUNT_WORDS)),
            owned: words("rigid owned", wide_bodies + 1),
            scales,
            dispatches: 0,
            device,
            queue,
        };
        search.make_room(8 * wide_colliders + 64, 4 * wide_colliders + 64);
        search
    }

    /// Rooms for candidates and for manifolds.
    pub(crate) fn rooms(&self) -> [u32; 2] {
        [self.row.candidates, self.row.found]
    }

    /// Makes room for at least so many candidates and manifolds, and a quarter more. The search has to be run again. False if the
    /// device has no buffers of that size.
    #[must_use]
    pub(crate) fn grow(&mut self, candidates: u32, found: u32) -> bool {
        let wider = |wanted: u32, room: u32| {
            let wanted = u64::from(wanted);
            if wanted <= u64::from(room) { u64::from(room) } else { wanted + wanted / 4 }
        };
        self.make_room(wider(candidates, self.row.candidates), wider(found, self.row.found));
        self.row.candidates >= candidates && self.row.found >= found
    }

    /// Exact rooms, as far as the device has buffers of their size.
    pub(crate) fn make_room(&mut self, candidates: u64, found: u64) {
        let limits = self.device.limits();
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        // The last bit of a collider in CANDIDATES and numbers of rows in FOUND are 32 bits wide.
        let fit = |wanted: u64, bytes: u64| wanted.min(most / bytes).min(u64::from(u32::MAX) / 10).max(1) as u32;
        let rooms = [fit(candidates, CANDIDATE_BYTES), fit(found, FOUND_BYTES)];
        let create = |label, count: u32, bytes: u64| {
            let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
            let size = u64::from(count) * bytes;
            self.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
        };
        if rooms[0] != self.row.candidates {
            self.candidates = create("rigid candidates", rooms[0], CANDIDATE_BYTES);
        }
        if rooms[1] != self.row.found {
            self.found = create("rigid found", rooms[1], FOUND_BYTES);
        }
        [self.row.candidates, self.row.found] = rooms;
        self.write_row();
        self.groups = SEARCH_STAGES
            .iter()
            .zip(&self.kernels)
            .map(|(stage, kernel)| self.group(stage.bindings, kernel.as_ref()?))
            .collect();
    }

    /// Sets the length of the frames, in s.
    pub(crate) fn set_dt(&mut self, dt: f32) {
        self.row.dt = dt;
        self.write_row();
    }

    fn write_row(&self) {
        self.queue.write_buffer(&self.uniform, 0, bytes_of(&self.row));
    }

    fn buffer(&self, binding: u32) -> &wgpu::Buffer {
        match binding {
            0 => &self.inputs.frame,
            BODIES => &self.inputs.bodies,
            CONSTANTS => &self.inputs.constants,
            COLLIDERS => &self.inputs.colliders,
            HULLS => &self.inputs.hulls,
            APART => &self.inputs.apart,
            BOUNDS => &self.bounds,
            CELLS | ENDS => &self.cells,
            MEMBERS => &self.members,
            CANDIDATES => &self.candidates,
            FOUND => &self.found,
            COUNTS => &self.counts,
            OWNED => &self.owned,
            SEARCH => &self.uniform,
            SCALES => &self.scales,
            _ => unreachable!("no stage of the search has the binding {binding}"),
        }
    }

    fn group(&self, bindings: &[u32], kernel: &Kernel) -> Option<wgpu::BindGroup> {
        let entry =
            |binding: &u32| wgpu::BindGroupEntry { binding: *binding, resource: self.buffer(*binding).as_entire_binding() };
        let entries: Vec<_> = [0, SEARCH].iter().chain(bindings).map(entry).collect();
        let layout = &kernel.layout;
        Some(self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries }))
    }

    /// Adds the search of a frame: margins, AABBs, candidates and manifolds.
    pub(crate) fn encode(&mut self, encoder: &mut wgpu::CommandEncoder) {
        [&self.cells, &self.counts, &self.owned].into_iter().for_each(|buffer| encoder.clear_buffer(buffer, 0, None));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        let SearchRow { colliders, candidates, .. } = self.row;
        self.dispatch(&mut pass, OPEN, self.bodies);
        self.dispatch(&mut pass, BOUND, colliders);
        self.scan.encode(&mut pass);
        self.dispatches += 2;
        self.dispatch(&mut pass, SCATTER, colliders);
        self.dispatch(&mut pass, PAIR_UP, colliders);
        // Boxes first: they leave some pairs to the solids.
        for stage in [NARROW_BOXES, NARROW_SOLIDS, NARROW_ROUND] {
            self.dispatch(&mut pass, stage, candidates);
        }
    }

    /// A dispatch of at least so many threads, if the scene needs the stage.
    fn dispatch(&mut self, pass: &mut wgpu::ComputePass<'_>, stage: usize, threads: u32) {
        let (Some(kernel), Some(group)) = (&self.kernels[stage], &self.groups[stage]) else { return };
        let groups = threads.div_ceil(THREADS);
        if groups == 0 {
            return;
        }
        let rows = groups.div_ceil(MOST_GROUPS);
        pass.set_pipeline(&kernel.pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.dispatch_workgroups(groups.div_ceil(rows), rows, 1);
        self.dispatches += 1;
    }
}

/// The factors of the margins of all bodies, then their periods.
pub(super) fn scales_of(world: &RigidWorld) -> Vec<f32> {
    let factors = world.bodies.iter().map(|body| body.margin_scale);
    factors.chain(world.bodies.iter().flat_map(|body| body.periods.as_vec3().to_array())).collect()
}

/// The size of AABBs that nine of ten do not exceed now, and a little more.
fn usual_size(world: &RigidWorld, dt: f32) -> f64 {
    let field = world.gravity.length() * dt * dt;
    let margin = |body: &Body| {
        let turn = if body.spin == glam::Vec3::ZERO { 0.0 } else { body.spin.length() * body.radius };
        let reach = (body.velocity.length() + turn) * dt;
        match body.kind {
            Kind::World => 0.0,
            Kind::Kinematic => 1.001 * reach,
            Kind::Dynamic => (0.02 * body.radius).max(reach + field),
        }
    };
    let size = |collider: &crate::rigid::world::Collider| {
        let body = &world.bodies[collider.body as usize];
        let bounds = world.shapes[collider.shape as usize].aabb(&body.pose.compose(&collider.place));
        f64::from((bounds.max - bounds.min).max_element()) + 2.0 * f64::from(margin(body))
    };
    let mut sizes: Vec<f64> = world.colliders.iter().map(size).filter(|size| size.is_finite() && *size > 0.0).collect();
    if sizes.is_empty() {
        return 1.0;
    }
    let rank = sizes.len() * 9 / 10;
    let usual = *sizes.select_nth_unstable_by(rank, f64::total_cmp).1;
    (1.01 * usual).clamp(1e-18, 1e18)
}
