//! The phases as Figure 2.11 of the thesis has them.

use rockfall::step::schedule::Phase;

/// The phases of a step from the lowest bar to the highest, their names in tables and charts, and their keys in JSON.
pub(crate) const PHASES: [(Phase, &str, &str); 4] = [
    (Phase::UpdateAabbs, "AABB update", "aabb_update"),
    (Phase::BroadPhase, "Collision detection", "collision_detection"),
    (Phase::HandleCollisions, "Collision response", "collision_response"),
    (Phase::UpdatePositions, "Force calculations & integration", "forces_and_integration"),
];
