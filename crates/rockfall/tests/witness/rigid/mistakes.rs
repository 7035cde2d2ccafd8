//! Deliberate mistakes of the witness, which the comparison must detect.

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mistake {
    /// Free flight is symplectic Euler (section 11.9).
    NoParabola,
    /// A free body turns about its angular velocity (section 5.9).
    NoGyroscope,
    /// Impacts have half of the restitution (section 11.7).
    HalfRestitution,
    /// Impacts have no friction.
    SmoothImpacts,
    /// A new path begins at the place of the impact.
    KeptPlace,
    /// Rows of the relax pass have no friction (section 11.8).
    SmoothRows,
    /// Impulses of the last substep do not act again.
    ColdStart,
    /// The biased pass does not push out.
    NoPush,
    /// Points of rows far from each other act without the gap.
    NoGap,
    /// Both impulses of a contact act at the surfaces, not at one point (section 11.4).
    TwoPoints,
    /// Joints have no bias (section 11.14).
    LooseJoints,
    /// Joints are visited once in a pass.
    OneVisit,
}

pub(crate) const MISTAKES: [Mistake; 12] = [
    Mistake::NoParabola,
    Mistake::NoGyroscope,
    Mistake::HalfRestitution,
    Mistake::SmoothImpacts,
    Mistake::KeptPlace,
    Mistake::SmoothRows,
    Mistake::ColdStart,
    Mistake::NoPush,
    Mistake::NoGap,
    Mistake::TwoPoints,
    Mistake::LooseJoints,
    Mistake::OneVisit,
];
