//! Groups of colliders (docs/physics section 11.3).

/// A group for the search of pairs: two words, so that it needs no list. docs/physics section 11.3 has the rule.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct GroupWords {
    /// The group, and from bit 16 on its place among the groups that lists name, 31 for none.
    pub(crate) own: u32,
    /// Bit k is set if it touches the group of place k. Bit 30 says that it follows such bits. 0 for a group that touches itself alone.
    pub(crate) meets: u32,
}

impl GroupWords {
    /// Whether objects of two groups touch.
    pub(crate) fn touches(self, other: Self) -> bool {
        if self.meets == 0 { self.own == other.own } else { (self.meets >> (other.own >> 16)) & 1 == 1 }
    }
}
