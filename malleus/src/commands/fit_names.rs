//! Names for the results of recordings: no two are alike, and equal inputs give equal names.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Each input once, however often it is given, with the name that its table and its page take.
///
/// The name is the file's stem if no other input has that stem, capitals apart. Else as many names
/// of the folders above go before it as tell the inputs apart. If folders do not, the name keeps
/// the file's ending, and if that does not tell them apart either, it gets a number.
pub(super) fn of_inputs(inputs: &[PathBuf]) -> Vec<(PathBuf, String)> {
    let mut seen: Vec<PathBuf> = Vec::new();
    let mut once: Vec<&PathBuf> = Vec::new();
    for input in inputs {
        let whole = fs::canonicalize(input).unwrap_or_else(|_| input.clone());
        if !seen.contains(&whole) {
            seen.push(whole);
            once.push(input);
        }
    }
    let depth = seen.iter().map(|path| path.components().count()).max().unwrap_or(0);
    let mut names: Vec<String> = seen.iter().map(|path| name(path, 0, false)).collect();
    for (folders, ending) in (1..depth).map(|folders| (folders, false)).chain([(0, true), (depth, true)]) {
        let alike = count(&names);
        for (path, own) in seen.iter().zip(&mut names) {
            if alike.get(&own.to_lowercase()).is_some_and(|count| *count > 1) {
                *own = name(path, folders, ending);
            }
        }
    }
    let mut taken = BTreeMap::new();
    for own in &mut names {
        let wanted = own.clone();
        let mut number = 1;
        while taken.insert(own.to_lowercase(), ()).is_some() {
            number += 1;
            *own = format!("{wanted}-{number}");
        }
    }
    once.into_iter().cloned().zip(names).collect()
}

fn count(names: &[String]) -> BTreeMap<String, usize> {
    let mut count = BTreeMap::new();
    for name in names {
        *count.entry(name.to_lowercase()).or_insert(0) += 1;
    }
    count
}

/// File name of a path, with or without its ending, behind the names of the `folders` folders
/// above.
fn name(path: &Path, folders: usize, ending: bool) -> String {
    let file = if ending { path.file_name() } else { path.file_stem() };
    let mut parts: Vec<String> = path
        .ancestors()
        .skip(1)
        .filter_map(Path::file_name)
        .take(folders)
        .map(|folder| folder.to_string_lossy().into_owned())
        .collect();
    parts.reverse();
    parts.push(file.unwrap_or_default().to_string_lossy().into_owned());
    let name = parts.join("-");
    // The index of a report is called index.html.
    if name.eq_ignore_ascii_case("index") { "index-recording".to_owned() } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(inputs: &[&str]) -> Vec<String> {
        let inputs: Vec<PathBuf> = inputs.iter().map(PathBuf::from).collect();
        of_inputs(&inputs).into_iter().map(|(_, name)| name).collect()
    }

    #[test]
    fn name_of_an_input_is_its_stem_if_no_other_has_it() {
        assert_eq!(names(&["takes/mug.wav", "takes/bell.flac"]), ["mug", "bell"]);
    }

    #[test]
    fn inputs_of_one_stem_are_told_apart_by_their_folders() {
        assert_eq!(names(&["x/one/hit.wav", "x/two/hit.wav", "x/bell.wav"]), ["one-hit", "two-hit", "bell"]);
        assert_eq!(names(&["a/x/hit.wav", "b/x/HIT.wav"]), ["a-x-hit", "b-x-HIT"]);
    }

    #[test]
    fn inputs_that_differ_only_in_their_ending_keep_it() {
        assert_eq!(names(&["t/hit.wav", "t/hit.flac"]), ["hit.wav", "hit.flac"]);
    }

    #[test]
    fn no_two_names_are_alike() {
        let found = names(&["a-b/c.wav", "x/a-b-c.wav", "y/c.wav", "a/b-c.wav", "z/b-c.wav", "index.wav", "A-B/C.WAV"]);
        let mut lower: Vec<String> = found.iter().map(|name| name.to_lowercase()).collect();
        lower.sort();
        lower.dedup();
        assert_eq!(lower.len(), found.len(), "{found:?}");
        assert!(!lower.contains(&"index".to_owned()));
    }

    #[test]
    fn input_that_is_given_twice_is_named_once() {
        assert_eq!(names(&["takes/mug.wav", "takes/mug.wav"]), ["mug"]);
    }
}
