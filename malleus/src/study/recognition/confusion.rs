//! Confusion matrices, and how similar two of them are (scraping-rolling eq. 14).

use super::{GROUPS, MOTIONS};

/// Counts of what was heard for each motion that was played.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Confusion {
    /// Rows: motion that was played; columns: motion that was heard.
    counts: [[f64; MOTIONS]; MOTIONS],
}

impl Confusion {
    /// All motions told apart.
    pub fn perfect() -> Self {
        let mut all = Self::default();
        (0..MOTIONS).for_each(|motion| all.add(motion, motion));
        all
    }

    /// Counts one answer.
    pub fn add(&mut self, played: usize, heard: usize) {
        self.counts[played][heard] += 1.0;
    }

    /// Shares of the answers to each motion.
    pub fn shares(&self) -> [[f64; MOTIONS]; MOTIONS] {
        self.counts.map(|row| {
            let sum: f64 = row.iter().sum();
            row.map(|count| if sum > 0.0 { count / sum } else { 0.0 })
        })
    }

    /// Share of answers within the group of the motion that was played.
    pub fn groups_right(&self) -> f64 {
        self.share(|played, heard| GROUPS[played] == GROUPS[heard], |_, _| true)
    }

    /// Share of right answers among those that name the group of a pair: 0.5 for guesses.
    pub fn pairs_right(&self) -> f64 {
        let is_pair = |played: usize| GROUPS.iter().filter(|&&group| group == GROUPS[played]).count() == 2;
        self.share(|played, heard| played == heard, |played, heard| is_pair(played) && GROUPS[played] == GROUPS[heard])
    }

    fn share(&self, is_right: impl Fn(usize, usize) -> bool, counts: impl Fn(usize, usize) -> bool) -> f64 {
        let (mut right, mut all) = (0.0, 0.0);
        for (played, row) in self.counts.iter().enumerate() {
            for (heard, &count) in row.iter().enumerate() {
                all += if counts(played, heard) { count } else { 0.0 };
                right += if counts(played, heard) && is_right(played, heard) { count } else { 0.0 };
            }
        }
        if all > 0.0 { right / all } else { 0.0 }
    }

    /// Similarity to another matrix, `1 - |C - C_i|/|C|` with C the other one, both as shares
    /// (scraping-rolling eq. 14).
    pub fn similarity_to(&self, other: &Self) -> f64 {
        let (own, other) = (self.shares(), other.shares());
        let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
        let differences = &mut own.iter().flatten().zip(other.iter().flatten()).map(|(a, b)| a - b);
        1.0 - norm(differences) / norm(&mut other.iter().flatten().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guesses_within_pairs_leave_the_groups_right() {
        let mut guesses = Confusion::default();
        guesses.add(0, 0);
        for (played, heard) in [(1, 1), (1, 2), (2, 1), (2, 2), (3, 3), (3, 4), (4, 3), (4, 4)] {
            guesses.add(played, heard);
        }
        assert_eq!((guesses.groups_right(), guesses.pairs_right()), (1.0, 0.5));
        assert_eq!((Confusion::perfect().groups_right(), Confusion::perfect().pairs_right()), (1.0, 1.0));
        // Four rows of (1/2, 1/2) against (1, 0): a norm of sqrt(4 · 1/2), of sqrt(5).
        let expected = 1.0 - (2.0f64 / 5.0).sqrt();
        assert!((guesses.similarity_to(&Confusion::perfect()) - expected).abs() < 1e-12);
        assert_eq!(guesses.similarity_to(&guesses), 1.0);
    }
}
