//! The native part of the Python package `rockfall`. The Python part, in `python/rockfall`, checks arguments and has the names and
//! the documentation that users see.

use pyo3::prelude::*;

mod arguments;
mod bodies;
mod doors;
mod errors;
mod events;
mod evolve;
mod fields;
mod film;
mod flow;
mod fork;
mod gauges;
mod groups;
mod ids;
mod joints;
mod laws;
mod materials;
mod memory;
mod meshes;
mod motions;
mod names;
mod objects;
mod observe;
mod periodic;
mod picture;
mod portions;
mod running;
mod scene;
#[cfg_attr(not(target_os = "linux"), path = "shared/elsewhere.rs")]
mod shared;
mod simulation;
mod smooth;
mod states;
mod tables;
#[cfg_attr(not(feature = "mpi"), path = "team/alone.rs")]
mod team;
mod trajectory;
mod worlds;

/// The native part of rockfall.
#[pymodule]
mod _rockfall {
    use super::{Bound, PyModule, PyModuleMethods, PyResult};

    #[pymodule_export]
    use crate::bodies::{add_bodies, add_shape, add_static_body, body_states, push_bodies, set_bodies, shape_mass};
    #[pymodule_export]
    use crate::doors::{get_setting, set_setting};
    #[pymodule_export]
    use crate::errors::SimulationError;
    #[pymodule_export]
    use crate::events::{add_sensor, contact_events, sensor_events, watch_contacts, watch_sensors};
    #[pymodule_export]
    use crate::evolve::Evolution;
    #[pymodule_export]
    use crate::fields::fields;
    #[pymodule_export]
    use crate::film::{Film, Filming};
    #[pymodule_export]
    use crate::flow::{add_inlet, add_outlet, flow};
    #[pymodule_export]
    use crate::fork::forked;
    #[pymodule_export]
    use crate::gauges::{add_gauge, gauges};
    #[pymodule_export]
    use crate::groups::{group_meets, set_group_meets};
    #[pymodule_export]
    use crate::joints::{add_joint, joint_names, joint_readings, set_joints};
    #[pymodule_export]
    use crate::laws::{
        add_force_law, contact_law, force_laws, impact, remove_force_law, set_contact_law_parameter, set_force_law_parameter,
    };
    #[pymodule_export]
    use crate::materials::{add_material, materials, pair, set_pair, update_material};
    #[pymodule_export]
    use crate::meshes::add_mesh;
    #[pymodule_export]
    use crate::motions::{add_motion, add_servo, follow, go_on, motions, servos, set_servo, set_surface_velocity, wall_load};
    #[pymodule_export]
    use crate::names::{check_tag, named, names, set_tags, tag};
    #[pymodule_export]
    use crate::objects::{
        add_boxes, add_capsules, add_polygons, add_rods, add_spheres, add_springs, add_tethers, remove, update,
    };
    #[pymodule_export]
    use crate::observe::{cast_rays, contacts, counts, diagnostics, energy, max_overlap, table, tensions};
    #[pymodule_export]
    use crate::periodic::{periodic, set_periodic, set_shear, shear};
    #[pymodule_export]
    use crate::picture::{Picture, Studio, framing, trails_of, warning_of_letters};
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::shared::SharedArray;
    #[pymodule_export]
    use crate::simulation::Simulation;
    #[pymodule_export]
    use crate::smooth::add_smooth;
    #[pymodule_export]
    use crate::tables::{constants, devices};
    #[pymodule_export]
    use crate::trajectory::{TrajectoryReader, TrajectoryWriter};
    #[pymodule_export]
    use crate::worlds::Worlds;
    #[pymodule_export]
    use crate::worlds::mechanisms::{
        place_world_joints, set_world_bodies, set_world_joints, world_bodies, world_joint_names, world_joints,
    };
    #[pymodule_export]
    use crate::worlds::observe::{
        set_worlds_time_step, world_concerns, world_contacts, world_energies, world_simulation, worlds_time_step,
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
