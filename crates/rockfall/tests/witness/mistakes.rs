//! Deliberate mistakes of the witness, by which the comparison itself is checked.

/// All deliberate mistakes.
pub(crate) const MISTAKES: [Mistake; 18] = [
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
}
