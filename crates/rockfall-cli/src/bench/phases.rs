//! Phases of a step, as in Figure 2.11 of the thesis.

use rockfall::step::schedule::Phase;

/// Phases of a step, in the order of the stacked bars from the bottom up. Each has a name for tables and charts and a JSON key.
pub(crate) const PHASES: [(Phase, &str, &str); 4] = [
    (Phase::UpdateAabbs, "AABB update", "aabb_update"),
    (Phase::BroadPhase, "Collision detection", "collision_detection"),
    (Phase::HandleCollisions, "Collision response", "collision_response"),
    (Phase::UpdatePositions, "Force calculations & integration", "forces_and_integration"),
];
