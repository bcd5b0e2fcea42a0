//! Resolution of paths to modules. Re-exports are followed to the module that defines the item.

use crate::modules::{Mention, Module, Modules, Place};

/// Target of a path.
#[derive(Debug, PartialEq)]
pub(crate) enum End {
    /// Module that defines the item.
    Item(Place),
    Module(Place),
}

/// Maximum number of names and re-exports that are followed before a path is given up.
const MOST_STEPS: usize = 32;

/// Follows a path that stands in a module. Gives `None` if it leads out of the crate, or to a name
/// of the prelude.
pub(crate) fn follow(modules: &Modules, from: &[String], path: &[String]) -> Option<End> {
    resolve(modules, from, path, MOST_STEPS)
}

fn resolve(modules: &Modules, from: &[String], path: &[String], steps: usize) -> Option<End> {
    let (first, mut rest) = path.split_first()?;
    let mut here = match first.as_str() {
        "crate" => Vec::new(),
        "self" => from.to_vec(),
        "super" => parent(from)?,
        _ => return walk(modules, from, path, steps),
    };
    while let Some(after) = rest.strip_prefix(&["super".to_owned()][..]) {
        (here, rest) = (parent(&here)?, after);
    }
    // No item shows what a macro makes. It counts as the module in which it is looked for.
    Some(walk(modules, &here, rest, steps).unwrap_or(End::Item(here)))
}

fn parent(place: &[String]) -> Option<Place> {
    Some(place.split_last()?.1.to_vec())
}

/// Follows names from a module downwards.
fn walk(modules: &Modules, here: &[String], path: &[String], steps: usize) -> Option<End> {
    let Some((name, rest)) = path.split_first() else { return Some(End::Module(here.to_vec())) };
    let steps = steps.checked_sub(1)?;
    let child = [here, std::slice::from_ref(name)].concat();
    if modules.contains_key(&child) {
        return walk(modules, &child, rest, steps).or(Some(End::Item(child)));
    }
    let module = modules.get(here)?;
    if module.items.contains(name) {
        return Some(End::Item(here.to_vec()));
    }
    if let Some(import) = module.imports.iter().find(|import| import.name == *name) {
        // `use libm;` names a crate, to which no path of this crate leads.
        let is_itself = import.from.path.len() == 1 && import.from.path[0] == *name;
        let whole = [import.from.path.as_slice(), rest].concat();
        return if is_itself { None } else { resolve(modules, here, &whole, steps) };
    }
    let globs = module.imports.iter().filter(|import| import.name == "*");
    globs.into_iter().find_map(|glob| match resolve(modules, here, &glob.from.path, steps)? {
        End::Module(place) if place != here => walk(modules, &place, path, steps),
        _ => None,
    })
}

/// Modules whose items a module uses, each with the first place of use.
///
/// A re-export alone is no use. A module that is imported as a whole counts where one of its items
/// is named.
pub(crate) fn uses(modules: &Modules, place: &[String], module: &Module) -> Vec<(Place, Mention)> {
    let imports = module.imports.iter().filter(|import| !import.is_public).map(|import| &import.from);
    let mut found: Vec<(Place, Mention)> = Vec::new();
    for mention in imports.chain(&module.mentions) {
        if let Some(End::Item(target)) = follow(modules, place, &mention.path)
            && target != place
            && !found.iter().any(|(known, _)| *known == target)
        {
            found.push((target, mention.clone()));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::modules::Import;

    fn words(path: &str) -> Vec<String> {
        path.split("::").filter(|word| !word.is_empty()).map(str::to_owned).collect()
    }

    fn module(items: &[&str], imports: &[(&str, &str)]) -> Module {
        let import = |&(name, path): &(&str, &str)| {
            let from = Mention { path: words(path), line: 1 };
            Import { name: name.to_owned(), from, is_public: true }
        };
        Module {
            items: items.iter().map(|&item| item.to_owned()).collect(),
            imports: imports.iter().map(import).collect(),
            ..Module::default()
        }
    }

    #[test]
    fn paths_are_followed_through_re_exports_to_the_module_that_defines_the_item() {
        let modules: Modules = BTreeMap::from([
            (words(""), module(&["Rate"], &[])),
            (words("room"), module(&["Error"], &[("Line", "line::Line"), ("*", "mix")])),
            (words("room::line"), module(&["Line"], &[])),
            (words("room::mix"), module(&["turn"], &[])),
        ]);
        let from = words("room::line");
        let end = |path: &str| follow(&modules, &from, &words(path));
        assert_eq!(end("crate::room::Line::new"), Some(End::Item(words("room::line"))));
        assert_eq!(end("super::turn"), Some(End::Item(words("room::mix"))));
        assert_eq!(end("super::Error"), Some(End::Item(words("room"))));
        assert_eq!(end("super::super::Rate"), Some(End::Item(words(""))));
        assert_eq!(end("super::mix"), Some(End::Module(words("room::mix"))));
        assert_eq!(end("core::fmt"), None);
    }
}
