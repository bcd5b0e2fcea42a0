//! Section "Text form" of docs/kit-format.md: files, numbers and names.

use std::fs;
use std::path::Path;

use toml::{Table, Value};

/// Tables of a kit; those of included files come first.
pub(crate) struct Kit {
    pub(crate) objects: Vec<Table>,
    pub(crate) strikers: Vec<Table>,
    pub(crate) pads: Vec<Table>,
}

pub(crate) fn parse(path: &Path) -> Table {
    fs::read_to_string(path).unwrap().parse().unwrap()
}

pub(crate) fn read(path: &Path) -> Kit {
    let root = parse(path);
    let mut kit = Kit { objects: Vec::new(), strikers: Vec::new(), pads: tables(&root, "pad") };
    let included = root.get("include").and_then(Value::as_array).into_iter().flatten();
    let folder = path.parent().unwrap();
    let files = included.map(|file| parse(&folder.join(file.as_str().unwrap()))).collect::<Vec<_>>();
    for file in files.iter().chain([&root]) {
        kit.objects.extend(tables(file, "object"));
        kit.strikers.extend(tables(file, "striker"));
    }
    kit
}

impl Kit {
    pub(crate) fn object(&self, name: &str) -> &Table {
        self.objects.iter().find(|object| word(object, "name", "") == name).unwrap()
    }

    pub(crate) fn striker(&self, name: &str) -> &Table {
        self.strikers.iter().find(|striker| word(striker, "name", "") == name).unwrap()
    }
}

/// Value as a number, rounded to a 32-bit float.
pub(crate) fn float(value: &Value) -> f64 {
    f64::from(value.as_float().unwrap_or_else(|| value.as_integer().unwrap() as f64) as f32)
}

pub(crate) fn number(table: &Table, key: &str, default: f64) -> f64 {
    table.get(key).map_or(default, float)
}

/// Value as an array of numbers; a single number is an array of one.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().map_or_else(|| vec![float(value)], |array| array.iter().map(float).collect())
}

pub(crate) fn word<'a>(table: &'a Table, key: &str, default: &'a str) -> &'a str {
    table.get(key).map_or(default, |value| value.as_str().unwrap())
}

/// Tables of an array; empty if the key is missing.
pub(crate) fn tables(table: &Table, key: &str) -> Vec<Table> {
    let array = table.get(key).and_then(Value::as_array).into_iter().flatten();
    array.map(|value| value.as_table().unwrap().clone()).collect()
}
