//! Modes of one frequency: pairs of squares and discs.

use shape::solve::{Solved, Wanted};

use crate::{DISC, frequencies, plate, solve_text};

/// Asserts that the modes come in groups of the given sizes, each within a share of one frequency.
pub(crate) fn assert_groups(name: &str, solved: &Solved, sizes: &[usize], share: f64) {
    let found = frequencies(solved);
    assert_eq!(found.len(), sizes.iter().sum::<usize>(), "{name}");
    let mut begin = 0;
    let mut worst = 0.0_f64;
    for size in sizes {
        let group = &found[begin..begin + size];
        worst = worst.max(group[size - 1] / group[0] - 1.0);
        let apart = found.get(begin + size).is_none_or(|next| next / group[size - 1] > 1.001);
        assert!(apart, "{name}: the group at mode {begin} of {found:?} is larger");
        begin += size;
    }
    println!("{name}: groups within {worst:.1e}");
    assert!(worst <= share, "{name}: {found:?}");
    assert_eq!(solved.counted - solved.rigid, found.len(), "{name}");
}

#[test]
fn squares_have_their_pairs_within_a_hundred_thousandth() {
    let square = "polygon_m = [[0, 0], [1, 0], [1, 1], [0, 1]]";
    for (edge, sizes) in [
        ("free", &[1, 1, 1, 2, 2, 1, 1, 1, 2, 1, 1, 2][..]),
        ("clamped", &[1, 2, 1, 1, 1, 2, 2, 1, 1, 1, 2]),
        ("hinged", &[1, 2, 1, 2, 2, 2, 1, 2]),
    ] {
        let text = plate(square, 0.005, edge);
        let solved = solve_text(&text, None, Wanted::Lowest(sizes.iter().sum()), 0.004).unwrap();
        assert_groups(&format!("{edge} square"), &solved, sizes, 1e-5);
    }
}

#[test]
fn discs_have_their_pairs_within_a_hundred_thousandth() {
    for (edge, sizes) in [("free", [2, 1, 2, 2]), ("clamped", [1, 2, 2, 1])] {
        let text = plate("outline = \"disc.svg\", unit_m = 1", 0.05, edge);
        let solved = solve_text(&text, Some(DISC), Wanted::Lowest(sizes.iter().sum()), 0.02).unwrap();
        assert_groups(&format!("{edge} disc"), &solved, &sizes, 1e-5);
    }
}
