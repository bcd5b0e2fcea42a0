//! Every key in the tables of docs/kit-format.md occurs in the kits of this folder.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use toml::Value;

use crate::program::file;
use crate::text;

/// Adds the path of each key, such as `object.modes.gain_sine`, and of each word, such as
/// `striker.pulse="hertz"`.
fn collect(path: &str, value: &Value, found: &mut BTreeSet<String>) {
    match value {
        Value::Table(table) => {
            for (key, value) in table {
                let path = format!("{path}.{key}");
                collect(&path, value, found);
                found.insert(path);
            }
        }
        Value::Array(array) => array.iter().for_each(|value| collect(path, value, found)),
        Value::String(word) => {
            found.insert(format!("{path}=\"{word}\""));
        }
        _ => {}
    }
}

/// Parts of a text between backticks.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Path of the table that a heading of the page is about, such as `.object.residual`.
fn table_of(heading: &str) -> String {
    match heading {
        "The file" => String::new(),
        "Modes" => ".object.modes".to_owned(),
        _ => code(heading).next().map_or(String::new(), |name| format!(".{}", name.trim_matches(['[', ']']))),
    }
}

#[test]
fn every_key_of_the_page_occurs_in_a_kit_of_this_test() {
    let mut found = BTreeSet::new();
    for name in ["every_key.toml", "every_key_table.toml", "random.toml"] {
        collect("", &Value::Table(text::parse(&file(name))), &mut found);
    }
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/kit-format.md")).unwrap();
    let form = page.split("\n## ").find(|part| part.starts_with("Text form")).unwrap();
    let (mut table, mut keys) = (String::new(), 0);
    for line in form.lines() {
        if let Some(heading) = line.strip_prefix('#') {
            table = table_of(heading.trim_start_matches('#').trim());
        }
        let cells = line.split(" | ").collect::<Vec<_>>();
        if !line.starts_with("| `") || cells.len() < 4 || !line.ends_with('|') {
            continue;
        }
        let expected = |end: &str| found.iter().any(|path| path.starts_with(&table) && path.ends_with(end));
        for name in code(cells[0]) {
            let key = name.trim_matches(['[', ']']);
            keys += 1;
            assert!(
                expected(&format!(".{key}")) || expected(&format!(".{}", key.rsplit('.').next().unwrap())),
                "{table}.{key}"
            );
            for word in code(cells[1]).filter(|word| word.starts_with('"')) {
                assert!(expected(&format!(".{key}={word}")), "{table}.{key} = {word}");
            }
        }
    }
    assert!(keys >= 82, "only {keys} keys are found on the page");
}
