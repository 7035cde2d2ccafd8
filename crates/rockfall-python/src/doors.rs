//! What scenes and simulations have in common: objects that are added, removed and changed.

use std::sync::PoisonError;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use rockfall::glam::{DVec3, Vec3};
use rockfall::{
    BoxId, Capsule, CapsuleId, Cuboid, Facets, Gauge, Inlet, Joint, JointId, Material, MaterialId, Mesh, Motion, MotionId,
    ObjectId, Outlet, Pair, Placement, Polygon, PolygonId, Result, RigidBody, RigidBodyId, Rod, RodId, Sensor, Settings, Shape,
    ShapeId, Sphere, SphereId, Spring, SpringId, Tag, Tether, TetherId,
};

use crate::errors::Raise;
use crate::fork::detached;
use crate::ids::Ids;
use crate::scene::Scene;
use crate::simulation::Simulation;

/// A change of an object.
pub(crate) type Change<'a, T> = &'a dyn Fn(&mut T);

macro_rules! doors {
    ($($name:ident($($argument:ident: $type:ty),*) -> $result:ty;)*) => {
        /// The methods of a [`rockfall::Scene`] and a [`rockfall::Simulation`] with the same names.
        pub(crate) trait Doors {
            /// The objects.
            fn objects(&self) -> &rockfall::Scene;
            /// Replaces the settings.
            fn put_settings(&mut self, settings: Settings) -> Result<()>;
            $(
                #[doc = concat!("`", stringify!($name), "` of both.")]
                fn $name(&mut self, $($argument: $type),*) -> Result<$result>;
            )*
        }

        impl Doors for rockfall::Scene {
            fn objects(&self) -> &rockfall::Scene {
                self
            }
            fn put_settings(&mut self, settings: Settings) -> Result<()> {
                settings.validate()?;
                self.settings = settings;
                Ok(())
            }
            $(fn $name(&mut self, $($argument: $type),*) -> Result<$result> {
                rockfall::Scene::$name(self, $($argument),*)
            })*
        }

        impl Doors for rockfall::Simulation {
            fn objects(&self) -> &rockfall::Scene {
                self.scene()
            }
            fn put_settings(&mut self, settings: Settings) -> Result<()> {
                self.set_settings(settings)
            }
            $(fn $name(&mut self, $($argument: $type),*) -> Result<$result> {
                rockfall::Simulation::$name(self, $($argument),*)
            })*
        }
    };
}

doors! {
    add_sphere(sphere: Sphere) -> SphereId;
    add_rod(rod: Rod) -> RodId;
    add_capsule(capsule: Capsule) -> CapsuleId;
    add_shape(shape: Shape) -> ShapeId;
    add_body(placement: Placement) -> RigidBodyId;
    add_static_body(placement: Placement, motion: Option<MotionId>) -> Vec<ObjectId>;
    update_body(id: RigidBodyId, change: Change<RigidBody>) -> ();
    apply_body_impulse(id: RigidBodyId, impulse: Vec3, point: DVec3) -> ();
    add_body_force(id: RigidBodyId, force: Vec3, point: DVec3) -> ();
    add_spring(spring: Spring) -> SpringId;
    add_tether(tether: Tether) -> TetherId;
    add_box(cuboid: Cuboid) -> BoxId;
    add_polygon(polygon: Polygon) -> PolygonId;
    remove_spheres(ids: &[SphereId]) -> ();
    remove_rods(ids: &[RodId]) -> ();
    remove_capsules(ids: &[CapsuleId]) -> ();
    remove_bodies(ids: &[RigidBodyId]) -> ();
    remove_springs(ids: &[SpringId]) -> ();
    remove_tethers(ids: &[TetherId]) -> ();
    remove_boxes(ids: &[BoxId]) -> ();
    remove_polygons(ids: &[PolygonId]) -> ();
    update_rod(id: RodId, change: Change<Rod>) -> ();
    update_spring(id: SpringId, change: Change<Spring>) -> ();
    update_tether(id: TetherId, change: Change<Tether>) -> ();
    add_material(material: Material) -> MaterialId;
    update_material(id: MaterialId, change: Change<Material>) -> ();
    set_pair(one: MaterialId, other: MaterialId, pair: Pair) -> ();
    set_tag(id: ObjectId, tag: Tag) -> ();
    add_mesh(mesh: &Mesh, with: &dyn Fn(Polygon) -> Polygon) -> Facets;
    add_motion(motion: Motion) -> MotionId;
    add_gauge(gauge: Gauge) -> ();
    add_joint(joint: Joint) -> JointId;
    update_joint(id: JointId, change: Change<Joint>) -> ();
    remove_joints(ids: &[JointId]) -> ();
    update_motion(id: MotionId, change: Change<Motion>) -> ();
    set_motion(id: ObjectId, motion: Option<MotionId>) -> ();
    set_surface_velocity(id: ObjectId, velocity: Vec3) -> ();
    add_inlet(inlet: Inlet) -> ();
    add_outlet(outlet: Outlet) -> ();
    add_sensor(sensor: Sensor) -> ();
}

/// Calls a function with the objects of a native scene or simulation, without the GIL.
pub(crate) fn with<R: Send>(
    target: &Bound<'_, PyAny>,
    call: impl FnOnce(&mut dyn Doors, &mut Ids) -> PyResult<R> + Send,
) -> PyResult<R> {
    if let Ok(scene) = target.cast::<Scene>() {
        let scene = scene.get();
        return detached(target.py(), || {
            let mut built = scene.0.lock().unwrap_or_else(PoisonError::into_inner);
            let built = &mut *built;
            call(&mut built.scene, &mut built.ids)
        });
    }
    if let Ok(simulation) = target.cast::<Simulation>() {
        return simulation.get().edit(target.py(), |running| call(&mut running.simulation, &mut running.ids));
    }
    Err(PyTypeError::new_err("target: expected a Scene or a Simulation"))
}

/// Calls a function as [`with`] does, with spheres in their present states.
pub(crate) fn with_states<R: Send>(
    target: &Bound<'_, PyAny>,
    call: impl FnOnce(&mut dyn Doors, &mut Ids) -> PyResult<R> + Send,
) -> PyResult<R> {
    if let Ok(simulation) = target.cast::<Simulation>() {
        simulation.get().flushed(target.py(), |running| {
            running.check_alone()?;
            running.simulation.sync().map(drop).or_raise()
        })?;
    }
    with(target, call)
}

/// Calls a function with the objects of a native scene or simulation that it does not change. The states of the spheres may be
/// those of an earlier step.
pub(crate) fn look<R: Send>(
    target: &Bound<'_, PyAny>,
    call: impl FnOnce(&rockfall::Scene, &Ids) -> PyResult<R> + Send,
) -> PyResult<R> {
    match target.cast::<Simulation>() {
        Ok(simulation) => simulation.get().locked(target.py(), |running| call(running.simulation.scene(), &running.ids)),
        Err(_) => with(target, |doors, ids| call(doors.objects(), ids)),
    }
}

/// The physical constants as text: the value of a setting.
#[pyfunction]
pub(crate) fn get_setting(target: &Bound<'_, PyAny>, name: &str) -> PyResult<String> {
    look(target, |scene, _| {
        let unknown = || rockfall::Error::UnknownSetting { name: name.to_owned(), expected: Settings::NAMES.join(", ") };
        scene.settings.get(name).ok_or_else(unknown).or_raise()
    })
}

/// Sets a physical constant from text.
#[pyfunction]
pub(crate) fn set_setting(target: &Bound<'_, PyAny>, name: &str, value: &str) -> PyResult<()> {
    let put = |doors: &mut dyn Doors| {
        let mut settings = doors.objects().settings;
        settings.set(name, value).or_raise()?;
        doors.put_settings(settings).or_raise()
    };
    match target.cast::<Simulation>() {
        // Constants are not part of the memory that views show.
        Ok(simulation) => simulation.get().flushed(target.py(), |running| {
            running.check_alone()?;
            put(&mut running.simulation)
        }),
        Err(_) => with(target, |doors, _| put(doors)),
    }
}
