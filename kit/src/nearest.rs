//! The name that was probably meant by one that does not exist.

/// Known name with the smallest edit distance from `name`, ignoring case.
///
/// Returns `None` if more than a third of the letters of `name`, rounded up, would have to change.
pub(crate) fn nearest<'a>(name: &str, known: &'a [String]) -> Option<&'a str> {
    let wanted: Vec<char> = name.to_lowercase().chars().collect();
    known
        .iter()
        .map(|candidate| (edit_distance(&wanted, &candidate.to_lowercase().chars().collect::<Vec<_>>()), candidate))
        .filter(|&(distance, _)| distance <= wanted.len().div_ceil(3))
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate.as_str())
}

/// Levenshtein distance: the least number of insertions, deletions and substitutions of a
/// character.
fn edit_distance(from: &[char], to: &[char]) -> usize {
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (deleted, a) in from.iter().enumerate() {
        let mut diagonal = deleted;
        let mut left = deleted + 1;
        for (b, above) in to.iter().zip(row.iter_mut().skip(1)) {
            let best = (diagonal + usize::from(a != b)).min(left + 1).min(*above + 1);
            diagonal = *above;
            *above = best;
            left = best;
        }
        if let Some(first) = row.first_mut() {
            *first = deleted + 1;
        }
    }
    row.last().copied().unwrap_or(from.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edit_distance_counts_insertions_deletions_and_substitutions() {
        let distance = |a: &str, b: &str| edit_distance(&a.chars().collect::<Vec<_>>(), &b.chars().collect::<Vec<_>>());
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "bell"), 4);
        assert_eq!(distance("bell", ""), 4);
        assert_eq!(distance("bell", "bell"), 0);
        assert_eq!(distance("marimba", "marmba"), 1);
    }

    #[test]
    fn near_name_is_suggested_and_a_far_one_is_not() {
        let known = ["marimba".to_owned(), "bell".to_owned()];
        assert_eq!(nearest("Marinba", &known), Some("marimba"));
        assert_eq!(nearest("bel", &known), Some("bell"));
        assert_eq!(nearest("gong", &known), None);
    }
}
