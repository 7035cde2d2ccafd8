//! The order of spheres in memory: along a Z-order curve (Morton 1966), so that spheres that are near in space are near in
//! memory.
//!
//! Neighbours are read together. At a million bodies the order of memory makes a step several times as fast. Large spheres come
//! after all small ones. A slice of the pair lists is as wide as its longest list, so long lists should be next to each other.
//! No result depends on the order of memory: where an order matters, objects are ordered by insertion index.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// Returns the indices of spheres (centre and radius) sorted by size class, then by the place of their cell on the curve.
pub(crate) fn spatial_order(balls: &[Vec4], cell: f32) -> Vec<u32> {
    let keyed = |(ball, index): (&Vec4, u32)| (size_class(ball.w, cell), curve(ball.truncate(), cell), index);
    let mut keyed: Vec<(u32, u64, u32)> = balls.par_iter().zip(0..balls.len() as u32).map(keyed).collect();
    keyed.par_sort_unstable();
    keyed.into_iter().map(|(.., index)| index).collect()
}

/// Returns 0 for a sphere up to 4 cells wide, 1 up to 16, 2 up to 64, 3 for a larger one.
pub(crate) fn size_class(radius: f32, cell: f32) -> u32 {
    [4.0, 16.0, 64.0].into_iter().filter(|cells| 2.0 * radius > cells * cell).count() as u32
}

/// Returns the inverse of a permutation.
pub(crate) fn inverse(order: &[u32]) -> Vec<u32> {
    let mut places = vec![0; order.len()];
    for (place, index) in order.iter().enumerate() {
        places[*index as usize] = place as u32;
    }
    places
}

/// Returns the place of a position on the curve. Beyond 2^20 cells from the origin places repeat, so spheres that are far apart
/// in space may be close in memory.
fn curve(position: Vec3, cell: f32) -> u64 {
    // The cast saturates far from the origin, so the sum may overflow and must wrap.
    let [x, y, z] = position.to_array().map(|x| spread(((x / cell).floor() as i64).wrapping_add(1 << 20) as u64 & 0x1f_ffff));
    x | y << 1 | z << 2
}

/// Inserts two zeros after each of the low 21 bits.
pub(crate) fn spread(bits: u64) -> u64 {
    let mut x = bits;
    for (shift, mask) in [
        (32, 0x1f_0000_0000_ffff),
        (16, 0x1f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ] {
        x = (x | x << shift) & mask;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread() {
        for bit in 0..21 {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread(0x1f_ffff), 0x1249_2492_4924_9249);
    }

    #[test]
    fn positions_beyond_all_cells_are_ordered() {
        let places = [f32::MAX, f32::MIN, 1e30, 0.0].map(|x| Vec3::splat(x).extend(1.0));
        let mut order = spatial_order(&places, 1e-20);
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2, 3]);
    }

    #[test]
    fn eight_cells_of_a_block_are_consecutive() {
        let place = |k| Vec3::new((k % 4) as f32, (k / 4 % 4) as f32, (k / 16) as f32) + 0.5;
        let balls: Vec<Vec4> = (0..64).map(|k| place(k).extend(0.5)).collect();
        let order = spatial_order(&balls, 1.0);
        for block in order.chunks(8) {
            let corners: Vec<Vec3> = block.iter().map(|index| (balls[*index as usize].truncate() / 2.0).floor()).collect();
            assert!(corners.windows(2).all(|pair| pair[0] == pair[1]), "{corners:?}");
        }
        let back = inverse(&order);
        assert!(order.iter().enumerate().all(|(place, index)| back[*index as usize] == place as u32));
    }

    #[test]
    fn large_spheres_come_last() {
        let balls: Vec<Vec4> = [0.5, 40.0, 2.0, 2.1, 0.1, 9.0].map(|radius| Vec3::X.extend(radius)).to_vec();
        assert_eq!(spatial_order(&balls, 1.0), [0, 2, 4, 3, 5, 1]);
    }
}
