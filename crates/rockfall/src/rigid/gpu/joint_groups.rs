//! Mechanisms that are not connected to each other, for workgroups that have whole ones (`rigid/frame/joint_groups.wgsl`).

use crate::rigid::gpu::THREADS;
use crate::rigid::joints::Joints;

/// The joints of a mechanism for which a workgroup is not too slow.
const MOST_JOINTS: usize = 4 * THREADS as usize;

/// The joints in groups of whole mechanisms.
pub(super) struct Groups {
    /// The table of `rigid/frame/joint_groups.wgsl`, then the numbers of the joints.
    pub(super) words: Vec<u32>,
    pub(super) groups: u32,
    pub(super) colours: u32,
}

impl Groups {
    /// The number of words before those of the joints.
    pub(super) fn first(&self) -> u32 {
        self.groups * (self.colours + 1)
    }

    /// Of joints in a world with these bodies with mass; `None` where a mechanism has too many joints for a workgroup.
    pub(super) fn of(joints: &Joints, has_mass: &[bool]) -> Option<Self> {
        let mechanisms = mechanisms(joints, has_mass);
        if mechanisms.iter().any(|joints| joints.len() > MOST_JOINTS) {
            return None;
        }
        let mut packed: Vec<Vec<u32>> = Vec::new();
        for mechanism in mechanisms {
            match packed.last_mut() {
                Some(group) if group.len() + mechanism.len() <= THREADS as usize => group.extend(mechanism),
                _ => packed.push(mechanism),
            }
        }
        let colours = joints.colours.len().saturating_sub(1);
        let mut colour_of = vec![0; joints.list.len()];
        for colour in 0..colours {
            let range = joints.colours[colour] as usize..joints.colours[colour + 1] as usize;
            joints.order[range].iter().for_each(|number| colour_of[*number as usize] = colour);
        }
        let (mut table, mut numbers) = (Vec::new(), Vec::new());
        let first = packed.len() * (colours + 1);
        for group in &packed {
            for colour in 0..colours {
                table.push((first + numbers.len()) as u32);
                numbers.extend(group.iter().filter(|number| colour_of[**number as usize] == colour));
            }
            table.push((first + numbers.len()) as u32);
        }
        let words = [table, numbers].concat();
        Some(Self { words, groups: packed.len() as u32, colours: colours as u32 })
    }
}

/// The joints of each mechanism, in order of their first joints. Bodies without mass connect nothing.
fn mechanisms(joints: &Joints, has_mass: &[bool]) -> Vec<Vec<u32>> {
    let mut root: Vec<usize> = (0..has_mass.len()).collect();
    fn find(root: &mut [usize], mut body: usize) -> usize {
        while root[body] != body {
            root[body] = root[root[body]];
            body = root[body];
        }
        body
    }
    for joint in &joints.list {
        let [a, b] = joint.ends.map(|end| end.body as usize);
        if has_mass[a] && has_mass[b] {
            let [a, b] = [find(&mut root, a), find(&mut root, b)];
            root[a.max(b)] = a.min(b);
        }
    }
    let mut place = vec![usize::MAX; has_mass.len()];
    let mut all: Vec<Vec<u32>> = Vec::new();
    for (number, joint) in (0..).zip(&joints.list) {
        let heavy = joint.ends.map(|end| end.body as usize).into_iter().find(|body| has_mass[*body]);
        let root = heavy.map_or(0, |body| find(&mut root, body));
        if place[root] == usize::MAX {
            place[root] = all.len();
            all.push(Vec::new());
        }
        all[place[root]].push(number);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid::joints::{Drive, End, Joint, Kind};
    use glam::{Quat, Vec3};

    fn joint(a: u32, b: u32) -> Joint {
        let ends = [a, b].map(|body| End { body, place: Vec3::ZERO, turn: Quat::IDENTITY });
        Joint { kind: Kind::BALL, ends, drive: Drive::default(), strength: [f32::INFINITY; 2], collides: false }
    }

    /// Two chains of three bodies at the world, whose joints are given by turns.
    #[test]
    fn a_group_has_whole_mechanisms() {
        let list = vec![joint(0, 1), joint(0, 4), joint(1, 2), joint(4, 5), joint(2, 3), joint(5, 6)];
        let has_mass: Vec<bool> = (0..7).map(|body| body > 0).collect();
        let joints = Joints::new(list, &has_mass);
        assert_eq!(mechanisms(&joints, &has_mass), [vec![0, 2, 4], vec![1, 3, 5]]);
        let groups = Groups::of(&joints, &has_mass).unwrap();
        assert_eq!((groups.groups, groups.colours), (1, 2));
        assert_eq!(groups.words, [3, 7, 9, 0, 4, 1, 5, 2, 3]);
    }

    #[test]
    fn a_mechanism_that_is_too_large_has_no_group() {
        let has_mass: Vec<bool> = (0..302).map(|body| body > 0).collect();
        let chain = (0..300).map(|body| joint(body, body + 1)).collect();
        assert!(Groups::of(&Joints::new(chain, &has_mass), &has_mass).is_none());
        let many: Vec<Joint> = (0..300).map(|body| joint(0, body + 1)).collect();
        let groups = Groups::of(&Joints::new(many, &has_mass), &has_mass).unwrap();
        assert_eq!((groups.groups, groups.colours, groups.first()), (5, 1, 10));
    }
}
