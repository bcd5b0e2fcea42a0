//! The name that was probably meant by one that does not exist.

/// Known name with the smallest edit distance from `name`, ignoring case.
///
/// Returns `None` if more than a third of the letters of `name` would have to change: of a name of
/// one or two letters none may.
pub(crate) fn nearest<'a>(name: &str, known: &'a [String]) -> Option<&'a str> {
    let wanted: Vec<char> = name.to_lowercase().chars().collect();
    known
        .iter()
        .map(|candidate| (edit_distance(&wanted, &candidate.to_lowercase().chars().collect::<Vec<_>>()), candidate))
        .filter(|&(distance, _)| distance <= wanted.len() / 3)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate.as_str())
}

/// Distance by Damerau and Levenshtein: the least number of insertions, deletions and substitutions
/// of a character and of exchanges of two neighbours.
fn edit_distance(from: &[char], to: &[char]) -> usize {
    let mut above = vec![0; to.len() + 1];
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (deleted, a) in from.iter().enumerate() {
        let mut below = vec![deleted + 1];
        for (inserted, b) in to.iter().enumerate() {
            let changed = row[inserted] + usize::from(a != b);
            let mut best = changed.min(below[inserted] + 1).min(row[inserted + 1] + 1);
            if let (Some(before), Some(other)) = (deleted.checked_sub(1), inserted.checked_sub(1))
                && from[before] == *b
                && to[other] == *a
            {
                best = best.min(above[other] + 1);
            }
            below.push(best);
        }
        above = std::mem::replace(&mut row, below);
    }
    row.last().copied().unwrap_or(from.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edit_distance_counts_insertions_deletions_substitutions_and_exchanges() {
        let distance = |a: &str, b: &str| edit_distance(&a.chars().collect::<Vec<_>>(), &b.chars().collect::<Vec<_>>());
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "bell"), 4);
        assert_eq!(distance("bell", ""), 4);
        assert_eq!(distance("bell", "bell"), 0);
        assert_eq!(distance("marimba", "marmba"), 1);
        assert_eq!((distance("yran", "yarn"), distance("string", "strnig"), distance("abc", "cab")), (1, 1, 2));
    }

    #[test]
    fn near_name_is_suggested_and_a_far_one_is_not() {
        let known = ["marimba".to_owned(), "bell".to_owned()];
        assert_eq!(nearest("Marinba", &known), Some("marimba"));
        assert_eq!(nearest("bel", &known), Some("bell"));
        assert_eq!(nearest("gong", &known), None);
    }

    #[test]
    fn name_of_which_half_differs_is_not_suggested() {
        for (name, known) in [("bowl", "bell"), ("b", "a"), ("ab", "ac"), ("cup", "mug"), ("drum", "bum")] {
            assert_eq!(nearest(name, &[known.to_owned()]), None, "{known:?} for {name:?}");
        }
        assert_eq!(nearest("Yran", &["yarn".to_owned()]), Some("yarn"));
        assert_eq!(nearest("B", &["b".to_owned()]), Some("b"));
    }
}
