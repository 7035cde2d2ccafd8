//! The impulses of two collisions that no other collision influences, in closed form (docs/physics section 3.7).

/// Two collisions are at one place, for the sweeps, if `1 - G_kl^2 / (G_kk G_ll)` is at most this. The closed form would divide
/// by it.
const ONE_PLACE: f32 = 1e-3;

/// The impulses of two collisions. `coupling[k][l]` is what a unit impulse of collision l takes from the approach velocity of
/// collision k, and `wanted` is what their impulses have to take. `None` where both are at one place.
pub(super) fn impulses(coupling: [[f32; 2]; 2], wanted: [f32; 2]) -> Option<[f32; 2]> {
    let own = [coupling[0][0], coupling[1][1]];
    let of = |k: usize| {
        let (l, by) = (1 - k, coupling[k][1 - k]);
        let margin = own[k] * own[l] - by * by;
        if margin <= ONE_PLACE * own[k] * own[l] {
            None
        } else if own[l] * wanted[k] <= by * wanted[l] {
            // The other impulse alone takes enough.
            Some(0.0)
        } else if own[k] * wanted[l] <= by * wanted[k] {
            Some(wanted[k] / own[k])
        } else {
            Some((own[l] * wanted[k] - by * wanted[l]) / margin)
        }
    };
    Some([of(0)?, of(1)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Impulses take what is wanted where they act, and more where they do not.
    #[test]
    fn impulses_take_what_is_wanted() {
        let cases = [(0.2, 1.0, 1.0), (-0.5, 1.0, 2.0), (0.9, 1.0, 1.0), (0.9, 0.5, 1.0), (0.9, 1.0, 0.5), (0.0, 3.0, 0.1)];
        for (by, one, other) in cases {
            let coupling = [[1.0, by], [by, 1.5]];
            let j = impulses(coupling, [one, other]).unwrap();
            for (row, wanted, j_k) in [(coupling[0], one, j[0]), (coupling[1], other, j[1])] {
                let taken = row[0] * j[0] + row[1] * j[1];
                let is_right = if j_k > 0.0 { (taken - wanted).abs() < 1e-5 } else { j_k == 0.0 && taken >= wanted };
                assert!(is_right, "{by} {one} {other}: {j:?}");
            }
        }
        assert_eq!(impulses([[1.0, 1.0], [1.0, 1.0]], [1.0, 1.0]), None);
    }
}
