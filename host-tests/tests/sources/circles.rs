//! Circles of imports between the parts of a folder of modules, which the code calls a room.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use crate::fault::{self, Fault};
use crate::files;
use crate::modules::{self, Modules, Place};
use crate::paths;

/// Crates with their root files.
const ROOTS: [(&str, &str); 7] = [
    ("dsp-core", "dsp-core/src/lib.rs"),
    ("cable", "cable/src/lib.rs"),
    ("kit", "kit/src/lib.rs"),
    ("fit", "fit/src/lib.rs"),
    ("firmware", "firmware/src/lib.rs"),
    ("firmware", "firmware/src/bin/percussion.rs"),
    ("firmware", "firmware/src/bin/self_test/main.rs"),
];

/// Use of one part of a folder by another: file, line and path.
type Evidence = (String, usize, String);

/// Parts of a folder by name, with the parts that each uses. The file of the folder itself is a
/// part without a name.
type Graph = BTreeMap<String, BTreeMap<String, Evidence>>;

/// Uses of modules by modules, in all modules.
fn all_uses(modules: &Modules) -> Vec<(Place, Place, Evidence)> {
    let mut all = Vec::new();
    for (place, module) in modules {
        for (target, mention) in paths::uses(modules, place, module) {
            let evidence = (module.file.clone(), mention.line, mention.path.join("::"));
            all.push((place.clone(), target, evidence));
        }
    }
    all
}

/// Parts of a folder and their uses of each other. Modules below a part count as the part.
fn graph(room: &[String], uses: &[(Place, Place, Evidence)]) -> Graph {
    let part = |place: &Place| Some(place.strip_prefix(room)?.first().cloned().unwrap_or_default());
    let mut graph = Graph::new();
    for (from, to, evidence) in uses {
        if let (Some(from), Some(to)) = (part(from), part(to))
            && from != to
        {
            graph.entry(from).or_default().entry(to).or_insert_with(|| evidence.clone());
        }
    }
    graph
}

/// Shortest way from a part back to itself, as the parts on the way.
fn shortest_circle(graph: &Graph, start: &str) -> Option<Vec<String>> {
    let mut before: BTreeMap<&str, &str> = BTreeMap::new();
    let mut next = VecDeque::from([start]);
    while let Some(part) = next.pop_front() {
        for to in graph.get(part).into_iter().flat_map(BTreeMap::keys) {
            if to == start {
                let mut way = vec![part.to_owned()];
                while let Some(&earlier) = before.get(way[way.len() - 1].as_str()) {
                    way.push(earlier.to_owned());
                }
                way.reverse();
                return Some(way);
            }
            if !before.contains_key(to.as_str()) {
                before.insert(to, part);
                next.push_back(to);
            }
        }
    }
    None
}

/// Shortest circle through each part of a folder, each circle once.
fn circles(graph: &Graph) -> Vec<Vec<String>> {
    let mut known = BTreeSet::new();
    let found = graph.keys().filter_map(|part| shortest_circle(graph, part));
    found.filter(|circle| known.insert(circle.iter().cloned().collect::<BTreeSet<_>>())).collect()
}

fn fault(krate: &str, room: &[String], graph: &Graph, circle: &[String]) -> Fault {
    let name = |part: &String| {
        let whole: Vec<_> = room.iter().chain((!part.is_empty()).then_some(part)).map(String::as_str).collect();
        if whole.is_empty() { "the crate's root".to_owned() } else { whole.join("::") }
    };
    let next = |index: usize| &circle[(index + 1) % circle.len()];
    let steps: Vec<_> = (circle.iter().enumerate())
        .map(|(index, part)| {
            let (file, line, path) = &graph[part][next(index)];
            format!("{file}:{line}: {} uses {} ({path})", name(part), name(next(index)))
        })
        .collect();
    let told = "a circle of imports; move what both need to a module of its own, or to the one that is used";
    Fault { message: format!("{}: {told}\n    {}", krate, steps.join("\n    ")) }
}

#[test]
fn no_modules_import_each_other_in_a_circle() {
    let mut faults = Vec::new();
    for (krate, root) in ROOTS {
        let modules = modules::read(&files::repository(), root);
        assert!(!modules.is_empty(), "{root} has no modules");
        let uses = all_uses(&modules);
        for room in modules.keys() {
            let graph = graph(room, &uses);
            faults.extend(circles(&graph).iter().map(|circle| fault(krate, room, &graph, circle)));
        }
    }
    fault::check("circles of imports", &faults);
}

#[test]
fn circles_of_two_and_of_three_parts_are_found_and_each_once() {
    let uses = |from: &str, to: &str| {
        let place = |path: &str| path.split("::").map(str::to_owned).collect::<Place>();
        (place(from), place(to), (format!("{from}.rs"), 1, to.to_owned()))
    };
    let all = [uses("a", "b"), uses("b", "c::deep"), uses("c", "a"), uses("d::x", "e"), uses("e", "d"), uses("e", "f")];
    let found = circles(&graph(&[], &all));
    assert_eq!(found.len(), 2, "{found:?}");
    assert_eq!((found[0].len(), found[1].len()), (3, 2), "{found:?}");
    assert!(circles(&graph(&[], &all[..2])).is_empty());
}
