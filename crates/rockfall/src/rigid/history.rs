//! What the solver keeps from frame to frame: impulses of points and colours of blocks.

use glam::{Vec3, Vec3A};

use crate::rigid::collide::MOST_POINTS;

/// Contacts at the end of the last frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct History {
    /// The substep of the impulses, in s.
    pub(in crate::rigid) substep: f32,
    /// In the order of their colliders.
    pub(in crate::rigid) pairs: Vec<OldPair>,
    pub(in crate::rigid) points: Vec<OldPoint>,
    /// In the order of their bodies: the two bodies, and the colour.
    pub(in crate::rigid) colours: Vec<([u32; 2], u8)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::rigid) struct OldPair {
    pub(in crate::rigid) colliders: [u32; 2],
    pub(in crate::rigid) first: u32,
    pub(in crate::rigid) count: u32,
    /// The normal impulse of all impacts of the pair in the frame.
    pub(in crate::rigid) struck: f32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::rigid) struct OldPoint {
    pub(in crate::rigid) id: u32,
    pub(in crate::rigid) on_a: Vec3A,
    pub(in crate::rigid) normal: f32,
    /// Along the axes of the world.
    pub(in crate::rigid) tangent: Vec3A,
}

impl History {
    /// Everything as words, which [`History::from_words`] reads back to the same bits.
    pub(crate) fn to_words(&self) -> Vec<u32> {
        let mut words = vec![self.substep.to_bits(), self.pairs.len() as u32];
        for OldPair { colliders, first, count, struck } in &self.pairs {
            words.extend([colliders[0], colliders[1], *count, struck.to_bits()]);
            for point in &self.points[*first as usize..(first + count) as usize] {
                words.push(point.id);
                words.extend(point.on_a.to_array().map(f32::to_bits));
                words.push(point.normal.to_bits());
                words.extend(point.tangent.to_array().map(f32::to_bits));
            }
        }
        words.push(self.colours.len() as u32);
        words.extend(self.colours.iter().flat_map(|([a, b], colour)| [*a, *b, u32::from(*colour)]));
        words
    }

    /// Reads a history. `None` if the words are not one: of another length, with numbers that are not finite, or not in order.
    pub(crate) fn from_words(words: &[u32]) -> Option<Self> {
        let mut words = words.iter().copied();
        let mut history = Self { substep: number(words.next()?)?, ..Self::default() };
        for _ in 0..words.next()? {
            let (colliders, count, struck) = ([words.next()?, words.next()?], words.next()?, number(words.next()?)?);
            let is_in_order = history.pairs.last().is_none_or(|last| last.colliders < colliders);
            if !is_in_order || count as usize > MOST_POINTS {
                return None;
            }
            history.pairs.push(OldPair { colliders, first: history.points.len() as u32, count, struck });
            for _ in 0..count {
                let id = words.next()?;
                let mut vector = || Some(Vec3::new(number(words.next()?)?, number(words.next()?)?, number(words.next()?)?));
                let on_a = vector()?;
                let normal = number(words.next()?)?;
                let tangent = Vec3::new(number(words.next()?)?, number(words.next()?)?, number(words.next()?)?);
                history.points.push(OldPoint { id, on_a: on_a.into(), normal, tangent: tangent.into() });
            }
        }
        for _ in 0..words.next()? {
            let (bodies, colour) = ([words.next()?, words.next()?], u8::try_from(words.next()?).ok()?);
            if history.colours.last().is_some_and(|(last, _)| *last >= bodies) {
                return None;
            }
            history.colours.push((bodies, colour));
        }
        words.next().is_none().then_some(history)
    }

    /// The history with other numbers of colliders and bodies. What has no number there, or another order, is left out.
    pub(crate) fn renumbered(&self, colliders: &[Option<u32>], bodies: &[Option<u32>]) -> Self {
        let both = |numbers: &[Option<u32>], [a, b]: [u32; 2]| {
            let [a, b] = [a, b].map(|number| numbers.get(number as usize).copied().flatten());
            Some([a?, b?]).filter(|[a, b]| a < b)
        };
        let mut new = Self { substep: self.substep, ..Self::default() };
        let mut pairs: Vec<_> = self.pairs.iter().filter_map(|old| Some((both(colliders, old.colliders)?, old))).collect();
        pairs.sort_unstable_by_key(|(numbers, _)| *numbers);
        for (colliders, OldPair { first, count, struck, .. }) in pairs {
            new.pairs.push(OldPair { colliders, first: new.points.len() as u32, count: *count, struck: *struck });
            new.points.extend_from_slice(&self.points[*first as usize..(first + count) as usize]);
        }
        let colours = self.colours.iter().filter_map(|(old, colour)| Some((both(bodies, *old)?, *colour)));
        new.colours = colours.collect();
        new.colours.sort_unstable_by_key(|(numbers, _)| *numbers);
        new
    }

    /// Nothing, with the substep of another history.
    pub(crate) fn within(other: &Self) -> Self {
        Self { substep: other.substep, ..Self::default() }
    }

    /// Adds what another world remembers, with other numbers of its colliders and bodies. The order is to be restored.
    pub(crate) fn extend(&mut self, other: &Self, collider: impl Fn(u32) -> u32, body: impl Fn(u32) -> u32) {
        let first = self.points.len() as u32;
        self.pairs.extend(other.pairs.iter().map(|pair| OldPair {
            colliders: pair.colliders.map(&collider),
            first: first + pair.first,
            ..*pair
        }));
        self.points.extend_from_slice(&other.points);
        self.colours.extend(other.colours.iter().map(|(bodies, colour)| (bodies.map(&body), *colour)));
    }

    /// Restores the order.
    pub(crate) fn sort(&mut self) {
        self.pairs.sort_unstable_by_key(|pair| pair.colliders);
        self.colours.sort_unstable_by_key(|(bodies, _)| *bodies);
    }

    /// The histories of `count` worlds. Both functions tell the world of two colliders or bodies, and their numbers there.
    pub(crate) fn split(
        &self,
        count: usize,
        colliders: impl Fn([u32; 2]) -> (usize, [u32; 2]),
        bodies: impl Fn([u32; 2]) -> (usize, [u32; 2]),
    ) -> Vec<Self> {
        let mut all = vec![Self::within(self); count];
        for pair in &self.pairs {
            let (world, colliders) = colliders(pair.colliders);
            let own = &mut all[world];
            own.pairs.push(OldPair { colliders, first: own.points.len() as u32, ..*pair });
            own.points.extend_from_slice(&self.points[pair.first as usize..(pair.first + pair.count) as usize]);
        }
        for (both, colour) in &self.colours {
            let (world, both) = bodies(*both);
            all[world].colours.push((both, *colour));
        }
        all
    }

    /// The points of a pair of colliders.
    pub(in crate::rigid) fn pair(&self, colliders: [u32; 2]) -> Option<&[OldPoint]> {
        self.pair_after(&mut 0, colliders)
    }

    /// The same, where the pair is probably the one at a place, which moves on.
    pub(in crate::rigid) fn pair_after(&self, next: &mut usize, colliders: [u32; 2]) -> Option<&[OldPoint]> {
        if self.pairs.get(*next).is_none_or(|old| old.colliders != colliders) {
            *next = self.pairs.binary_search_by_key(&colliders, |old| old.colliders).ok()?;
        }
        let place = *next;
        *next += 1;
        let OldPair { first, count, .. } = self.pairs[place];
        Some(&self.points[first as usize..(first + count) as usize])
    }

    /// The pairs of colliders that struck each other in the last frame, in their order, with the normal impulse of all their impacts.
    pub(crate) fn strikes(&self) -> impl Iterator<Item = ([u32; 2], f32)> {
        self.pairs.iter().filter(|pair| pair.struck > 0.0).map(|pair| (pair.colliders, pair.struck))
    }

    /// The force of each point of a pair at the end of the last frame: its id, and the force on body b along the axes of the world,
    /// with the normal of the pair.
    pub(crate) fn forces(&self, colliders: [u32; 2], normal: Vec3) -> impl Iterator<Item = (u32, Vec3)> {
        let rate = if self.substep > 0.0 { self.substep.recip() } else { 0.0 };
        let points = self.pair(colliders).unwrap_or_default().iter();
        points.map(move |point| (point.id, rate * (point.normal * normal + Vec3::from(point.tangent))))
    }
}

fn number(word: u32) -> Option<f32> {
    Some(f32::from_bits(word)).filter(|number| number.is_finite())
}
