//! Modules of a crate, as `syn` reads them: the items that each defines, its imports and its paths.

use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use proc_macro2::{Span, TokenStream, TokenTree};
use syn::visit::Visit;
use syn::{Attribute, Item, UseTree};

/// Place of a module below its crate's root, name by name.
pub(crate) type Place = Vec<String>;

/// Path that stands in the sources, with its line.
#[derive(Clone, Debug)]
pub(crate) struct Mention {
    pub(crate) path: Vec<String>,
    pub(crate) line: usize,
}

/// Import by `use` of one name, or of all names of a module (`name` is `*`).
#[derive(Clone, Debug)]
pub(crate) struct Import {
    pub(crate) name: String,
    pub(crate) from: Mention,
    /// True if other modules may take the name from here.
    pub(crate) is_public: bool,
}

/// Module of a crate.
#[derive(Debug, Default)]
pub(crate) struct Module {
    /// File of the module, from the repository's folder.
    pub(crate) file: String,
    /// Names of the module's items, modules left out.
    pub(crate) items: HashSet<String>,
    pub(crate) imports: Vec<Import>,
    /// Paths in the module's items, macros included.
    pub(crate) mentions: Vec<Mention>,
}

/// Modules by their places. The root's place is empty.
pub(crate) type Modules = BTreeMap<Place, Module>;

/// Reads a crate from its root file. Modules for tests are left out.
pub(crate) fn read(repository: &Path, root: &str) -> Modules {
    let mut modules = Modules::new();
    let folder = Path::new(root).parent().unwrap_or(Path::new("")).to_owned();
    let file = parse(repository, Path::new(root));
    add(&mut modules, &Reader { repository, file: root.to_owned(), folder }, Vec::new(), &file.items);
    modules
}

struct Reader<'a> {
    repository: &'a Path,
    file: String,
    /// Folder in which the files of child modules lie.
    folder: PathBuf,
}

fn parse(repository: &Path, file: &Path) -> syn::File {
    let text = fs::read_to_string(repository.join(file)).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

fn add(modules: &mut Modules, reader: &Reader<'_>, place: Place, items: &[Item]) {
    let mut module = Module { file: reader.file.clone(), ..Module::default() };
    for item in items.iter().filter(|item| !is_for_tests(attributes(item))) {
        match item {
            Item::Mod(child) => {
                let name = child.ident.to_string();
                let place = [place.clone(), vec![name.clone()]].concat();
                if let Some((_, items)) = &child.content {
                    let folder = reader.folder.join(&name);
                    add(modules, &Reader { folder, file: reader.file.clone(), ..*reader }, place, items);
                } else {
                    let (file, folder) = file_of(reader, &name);
                    let parsed = parse(reader.repository, &file);
                    let file = file.to_string_lossy().into_owned();
                    add(modules, &Reader { file, folder, ..*reader }, place, &parsed.items);
                }
            }
            Item::Use(import) => {
                let is_public = !matches!(import.vis, syn::Visibility::Inherited);
                flatten(&import.tree, &mut Vec::new(), is_public, &mut module.imports);
            }
            _ => {
                module.items.extend(name_of(item));
                Mentions(&mut module.mentions).visit_item(item);
            }
        }
    }
    modules.insert(place, module);
}

/// File of a child module, and the folder of that module's children.
fn file_of(reader: &Reader<'_>, name: &str) -> (PathBuf, PathBuf) {
    let folder = reader.folder.join(name);
    let beside = reader.folder.join(format!("{name}.rs"));
    if reader.repository.join(&beside).is_file() { (beside, folder) } else { (folder.join("mod.rs"), folder) }
}

/// True for `#[cfg(test)]` and for conditions that hold in tests alone.
fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        syn::Meta::List(list) if list.path.is_ident("cfg") => {
            let mut words = list.tokens.clone().into_iter();
            let first = words.next().map(|token| token.to_string());
            match first.as_deref() {
                Some("test") => true,
                Some("all") => list.tokens.to_string().contains("test") && !list.tokens.to_string().contains("not"),
                _ => false,
            }
        }
        _ => false,
    })
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

fn name_of(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Macro(item) => item.ident.as_ref()?,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        _ => return None,
    };
    Some(name.to_string())
}

fn flatten(tree: &UseTree, before: &mut Vec<String>, is_public: bool, found: &mut Vec<Import>) {
    let mut add = |name: String, last: Option<String>, span: Span| {
        let path = before.iter().cloned().chain(last).collect();
        found.push(Import { name, from: Mention { path, line: span.start().line }, is_public });
    };
    match tree {
        UseTree::Path(path) => {
            before.push(path.ident.to_string());
            flatten(&path.tree, before, is_public, found);
            before.pop();
        }
        UseTree::Group(group) => group.items.iter().for_each(|tree| flatten(tree, before, is_public, found)),
        UseTree::Glob(glob) => add("*".to_owned(), None, glob.star_token.spans[0]),
        UseTree::Name(name) if name.ident == "self" => {
            add(before.last().cloned().unwrap_or_default(), None, name.ident.span());
        }
        UseTree::Name(name) => add(name.ident.to_string(), Some(name.ident.to_string()), name.ident.span()),
        UseTree::Rename(rename) => {
            let last = (rename.ident != "self").then(|| rename.ident.to_string());
            add(rename.rename.to_string(), last, rename.rename.span());
        }
    }
}

/// Collects the paths in an item.
struct Mentions<'a>(&'a mut Vec<Mention>);

impl<'ast> Visit<'ast> for Mentions<'_> {
    fn visit_path(&mut self, path: &'ast syn::Path) {
        let line = path.segments.first().map_or(0, |segment| segment.ident.span().start().line);
        let path_of = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        self.0.push(Mention { path: path_of, line });
        syn::visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, found: &'ast syn::Macro) {
        self.visit_path(&found.path);
        tokens(found.tokens.clone(), self.0);
    }

    fn visit_item_use(&mut self, import: &'ast syn::ItemUse) {
        // The path of a `use` inside a function counts as a mentioned path.
        let mut imports = Vec::new();
        flatten(&import.tree, &mut Vec::new(), false, &mut imports);
        self.0.extend(imports.into_iter().map(|import| import.from));
    }

    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_visibility(&mut self, _: &'ast syn::Visibility) {}
}

/// Collects the paths in the tokens of a macro: names joined by `::`.
fn tokens(stream: TokenStream, found: &mut Vec<Mention>) {
    let mut path = Mention { path: Vec::new(), line: 0 };
    let mut colons = 0;
    for token in stream {
        match token {
            TokenTree::Ident(ident) => {
                if colons != 2 || path.path.is_empty() {
                    found.push(std::mem::replace(
                        &mut path,
                        Mention { path: Vec::new(), line: ident.span().start().line },
                    ));
                }
                path.path.push(ident.to_string());
                colons = 0;
            }
            TokenTree::Punct(punct) if punct.as_char() == ':' && !path.path.is_empty() => colons += 1,
            other => {
                found.push(std::mem::replace(&mut path, Mention { path: Vec::new(), line: 0 }));
                colons = 0;
                if let TokenTree::Group(group) = other {
                    tokens(group.stream(), found);
                }
            }
        }
    }
    found.push(path);
    found.retain(|mention| !mention.path.is_empty());
}
