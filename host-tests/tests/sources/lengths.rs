//! Rules for lengths: of files, of argument lists, and of the names of tests.

use crate::fault::{self, Fault};
use crate::files;

const MOST_LINES: usize = 400;
const MOST_CHARACTERS: usize = 80;

/// Names of tests with their lines, counted from 1. Lines are searched, not syntax, because tests
/// stand in macros of proptest as well.
fn tests(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut is_test = false;
    for (index, line) in text.lines().map(str::trim).enumerate() {
        if line.ends_with("#[test]") {
            is_test = true;
        } else if let Some(rest) = line.strip_prefix("fn ").filter(|_| is_test) {
            is_test = false;
            found.push((index + 1, rest.split(['(', '<']).next().unwrap_or(rest)));
        }
    }
    found
}

#[test]
fn rust_files_have_at_most_400_lines() {
    let mut faults = Vec::new();
    for source in files::all() {
        let lines = source.text.lines().count();
        if lines > MOST_LINES {
            let what = format!("{lines} lines, {MOST_LINES} are allowed; give a part of it a file of its own");
            faults.push(Fault::at(&source, lines, &what));
        }
    }
    fault::check("lines of files", &faults);
}

#[test]
fn no_lint_of_many_arguments_is_allowed_anywhere() {
    // The word is put together here, or this file would break its own rule.
    let lint = ["too_many", "arguments"].join("_");
    let mut faults = Vec::new();
    for source in files::all() {
        for (index, _) in source.text.lines().enumerate().filter(|(_, line)| line.contains(&lint)) {
            let what = "the lint of many arguments is switched off; join arguments that belong together in a struct";
            faults.push(Fault::at(&source, index + 1, what));
        }
    }
    fault::check("many arguments", &faults);
}

#[test]
fn names_of_tests_have_at_most_80_characters() {
    let mut faults = Vec::new();
    for source in files::all() {
        for (line, name) in tests(&source.text) {
            let characters = name.chars().count();
            if characters > MOST_CHARACTERS {
                let what = format!("{name} has {characters} characters, {MOST_CHARACTERS} are allowed; shorten it");
                faults.push(Fault::at(&source, line, &what));
            }
        }
    }
    fault::check("names of tests", &faults);
}

#[test]
fn tests_are_found_behind_other_attributes_and_in_macros() {
    let text = "#[test]\n#[ignore]\nfn one() {}\nfn no() {}\nproptest! {\n    #[test]\n    fn two(x in 0..1) {}\n}";
    assert_eq!(tests(text), [(3, "one"), (7, "two")]);
}
