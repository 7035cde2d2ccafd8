//! The device finds the manifolds that the twin finds.
