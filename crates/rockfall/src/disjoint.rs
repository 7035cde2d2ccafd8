//! Disjoint sets (union-find).

/// Sets of the numbers from 0 to `count - 1`. At first, every number is a set of its own. The root of a set is its lowest number.
#[derive(Clone, Debug)]
pub(crate) struct DisjointSets {
    parents: Vec<u32>,
}

impl DisjointSets {
    pub(crate) fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect() }
    }

    /// The lowest number in the set of a number. Shortens the way to it.
    pub(crate) fn root(&mut self, number: usize) -> usize {
        let mut at = number as u32;
        while self.parents[at as usize] != at {
            let above = self.parents[at as usize];
            self.parents[at as usize] = self.parents[above as usize];
            at = above;
        }
        at as usize
    }

    /// Joins the sets of some numbers into one.
    pub(crate) fn join(&mut self, numbers: impl IntoIterator<Item = usize>) {
        let mut numbers = numbers.into_iter();
        let Some(first) = numbers.next() else { return };
        for other in numbers {
            let (a, b) = (self.root(first), self.root(other));
            self.parents[a.max(b)] = a.min(b) as u32;
        }
    }

    /// Groups items by the set of their numbers. Groups are in the order of their first items.
    pub(crate) fn group<T>(&mut self, items: impl IntoIterator<Item = (usize, T)>) -> Vec<Vec<T>> {
        const NONE: u32 = u32::MAX;
        let mut groups: Vec<Vec<T>> = Vec::new();
        let mut place_of_root = vec![NONE; self.parents.len()];
        for (number, item) in items {
            let place = &mut place_of_root[self.root(number)];
            if *place == NONE {
                *place = groups.len() as u32;
                groups.push(Vec::new());
            }
            groups[*place as usize].push(item);
        }
        groups
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_numbers_are_in_one_set_whose_root_is_the_lowest() {
        let mut sets = DisjointSets::new(7);
        sets.join([5, 3]);
        sets.join([6, 2, 5]);
        sets.join([4]);
        sets.join([]);
        assert_eq!((0..7).map(|number| sets.root(number)).collect::<Vec<_>>(), [0, 1, 2, 2, 4, 2, 2]);
        let items = [(6, 'a'), (1, 'b'), (3, 'c'), (4, 'd'), (1, 'e')];
        assert_eq!(sets.group(items), [vec!['a', 'c'], vec!['b', 'e'], vec!['d']]);
    }
}
