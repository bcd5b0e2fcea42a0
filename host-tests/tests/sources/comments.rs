//! Rules for comments: their first words and their widths.

use crate::fault::{self, Fault};
use crate::files;

/// Words with which no doc line may begin, because a doc line begins with a noun or a verb.
const FIRST_WORDS: [&str; 6] = ["What", "Whether", "The same", "Where", "How", "So many"];
const MOST_COLUMNS: usize = 100;

/// Forbidden words with which a doc line begins, if any.
fn first_words(line: &str) -> Option<&'static str> {
    let doc = line.trim_start().strip_prefix("///")?.trim_start();
    let begins = |words: &&str| doc.strip_prefix(*words).is_some_and(|rest| !rest.starts_with(char::is_alphanumeric));
    FIRST_WORDS.into_iter().find(begins)
}

/// Number of columns of a line that holds nothing but a comment, of Rust or of assembly.
fn comment_columns(line: &str) -> Option<usize> {
    let begins = line.trim_start();
    (begins.starts_with("//") || begins.starts_with('@')).then(|| line.chars().count())
}

#[test]
fn doc_lines_begin_with_a_noun_or_a_verb() {
    let mut faults = Vec::new();
    for source in files::all() {
        for (index, line) in source.text.lines().enumerate() {
            if let Some(words) = first_words(line) {
                let what = format!(
                    "a doc line begins with {words:?}; begin with a noun or a verb, for a flag \"True if ...\""
                );
                faults.push(Fault::at(&source, index + 1, &what));
            }
        }
    }
    fault::check("first words of doc lines", &faults);
}

#[test]
fn comment_lines_have_at_most_100_columns() {
    let mut faults = Vec::new();
    for source in files::all().into_iter().chain(files::assembly()) {
        for (index, line) in source.text.lines().enumerate() {
            if let Some(columns) = comment_columns(line).filter(|&columns| columns > MOST_COLUMNS) {
                let what = format!("a comment line of {columns} columns; break it at {MOST_COLUMNS}");
                faults.push(Fault::at(&source, index + 1, &what));
            }
        }
    }
    fault::check("columns of comment lines", &faults);
}

#[test]
fn first_words_are_found_at_word_boundaries_only() {
    assert_eq!(first_words("    /// What a block costs."), Some("What"));
    assert_eq!(first_words("/// So many frames."), Some("So many"));
    for fine in ["/// Whatever.", "/// However.", "//! What", "// What", "/// A place. Where", "let what = 1;"] {
        assert_eq!(first_words(fine), None, "{fine}");
    }
    assert_eq!(comment_columns("  // ä"), Some(6));
    assert_eq!(comment_columns("@ r0"), Some(4));
    assert_eq!(comment_columns("let a = 1; // b"), None);
}
