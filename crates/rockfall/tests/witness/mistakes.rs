//! Deliberate mistakes of the witness, by which the comparison itself is checked.

/// All deliberate mistakes.
pub(crate) const MISTAKES: [Mistake; 32] = [
    Mistake::Restitution,
    Mistake::RodShares,
    Mistake::CapsuleTorque,
    Mistake::NoProjection,
    Mistake::NoReturn,
    Mistake::OneSweep,
    Mistake::FrictionBound,
    Mistake::Arms,
    Mistake::Separating,
    Mistake::CapsuleTurn,
    Mistake::NoRattle,
    Mistake::FixedEnds,
    Mistake::SpringWork,
    Mistake::Hidden,
    Mistake::Covered,
    Mistake::WallVelocity,
    Mistake::WallReturn,
    Mistake::Belts,
    Mistake::BodyLever,
    Mistake::WallFactor,
    Mistake::PairFactor,
    Mistake::BodyTurn,
    Mistake::BodyForces,
    Mistake::BodyDamping,
    Mistake::BodyBound,
    Mistake::WallWeights,
    Mistake::FrameInertia,
    Mistake::CoreLever,
    Mistake::EdgeTaper,
    Mistake::WallCorners,
    Mistake::SolidFactor,
    Mistake::BodyFriction,
];

/// A deliberate mistake of the witness. The comparison must detect each of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mistake {
    /// Restitution too large by 1 %.
    Restitution,
    /// The ends of a rod have their shares of impulses and forces exchanged.
    RodShares,
    /// Capsules do not turn in collisions.
    CapsuleTorque,
    /// Impulses act on networks as if their rods had free length.
    NoProjection,
    /// Lone collisions are computed in the present state, not at their time of contact.
    NoReturn,
    /// One sweep over clusters instead of all.
    OneSweep,
    /// Friction without its stability bound.
    FrictionBound,
    /// Arms of friction with the full radius.
    Arms,
    /// Contact forces also between pairs that separate fast.
    Separating,
    /// The moments of inertia of the end spheres are ignored when a capsule turns.
    CapsuleTurn,
    /// No RATTLE.
    NoRattle,
    /// A rod includes the surface velocity of a fixed end.
    FixedEnds,
    /// The work of lone collisions on springs is ignored.
    SpringWork,
    /// Shapes that another shape hides have contacts.
    Hidden,
    /// Contacts that another part of a chain covers count.
    Covered,
    /// Moving walls have no velocity.
    WallVelocity,
    /// Walls stay where they are when the bodies of a lone collision are moved back.
    WallReturn,
    /// Surface velocities of walls are ignored.
    Belts,
    /// Rigid bodies have their mass alone at a contact.
    BodyLever,
    /// Several contacts of a rigid body with a wall damp as if each were alone.
    WallFactor,
    /// Several contacts of two bodies damp as if each were alone.
    PairFactor,
    /// Rigid bodies turn about their angular velocity.
    BodyTurn,
    /// Contacts of rigid bodies get no impulses, and forces at every overlap.
    BodyForces,
    /// Contacts of rigid bodies damp as those with forces alone.
    BodyDamping,
    /// The bound of friction ignores the distance of a contact from the centre of a rigid body.
    BodyBound,
    /// Contacts of a rigid body with a wall count as equally stiff.
    WallWeights,
    /// The moments of inertia of the balls of a frame are ignored.
    FrameInertia,
    /// The solid of a box of a body is touched at its centre.
    CoreLever,
    /// Edges of boxes of bodies touch with their whole overlap near their ends.
    EdgeTaper,
    /// Corners of walls do not touch boxes of bodies.
    WallCorners,
    /// Several contacts of two bodies through solids damp as if each were alone.
    SolidFactor,
    /// The tangential inverse mass of a rigid body ignores the lever of the contact.
    BodyFriction,
}
