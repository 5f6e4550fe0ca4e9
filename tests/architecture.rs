//! Checks that imports are acyclic: no file of a crate uses, directly or indirectly, a file that uses it.
//!
//! An arrow leads from a file to each other file that defines a name it uses, by `use` (including `pub use` of a
//! façade) or by a path in its code. `mod` alone is not an arrow, and tests are excluded. docs/architecture.md shows
//! the arrows between the top-level modules of the libraries.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};
use syn::{Item, ItemMod, ItemUse, UseTree, Visibility};

/// `a::b` of a crate; empty = its root.
type Module = Vec<String>;

/// The libraries, ordered from the bottom up.
const LIBRARIES: [&str; 5] = ["sim", "data", "fit", "scene", "study"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Names used by one file.
#[derive(Default)]
struct Taken {
    /// Imported names with the paths they stand for.
    uses: Vec<(String, Vec<String>)>,
    /// Other paths in the code.
    paths: Vec<Vec<String>>,
}

fn of_tests(item: &[syn::Attribute]) -> bool {
    item.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
    })
}

impl<'ast> Visit<'ast> for Taken {
    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        fn leaves(tree: &UseTree, before: &[String], found: &mut Vec<(String, Vec<String>)>) {
            let with = |name: &syn::Ident| [before, &[name.to_string()]].concat();
            match tree {
                UseTree::Path(path) => leaves(&path.tree, &with(&path.ident), found),
                UseTree::Name(name) if name.ident == "self" => {
                    found.push((before.last().cloned().unwrap_or_default(), before.to_vec()));
                }
                UseTree::Name(name) => found.push((name.ident.to_string(), with(&name.ident))),
                UseTree::Rename(name) => found.push((name.rename.to_string(), with(&name.ident))),
                UseTree::Glob(_) => found.push(("*".into(), before.to_vec())),
                UseTree::Group(group) => group.items.iter().for_each(|tree| leaves(tree, before, found)),
            }
        }
        leaves(&item.tree, &[], &mut self.uses);
    }

    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        if !of_tests(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_visibility(&mut self, _: &'ast Visibility) {}

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        if names.len() > 1 {
            self.paths.push(names);
        }
        visit::visit_path(self, path);
    }
}

/// Files of a crate by module.
fn files(src: &Path) -> BTreeMap<Module, Taken> {
    fn walk(folder: &Path, module: &Module, found: &mut BTreeMap<Module, Taken>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            if name == "tests" {
                continue;
            }
            let inner = || [&module[..], std::slice::from_ref(&name)].concat();
            if path.is_dir() {
                walk(&path, &inner(), found);
            } else if path.extension().is_some_and(|ending| ending == "rs") && name != "main" {
                let file = syn::parse_file(&std::fs::read_to_string(&path).unwrap()).unwrap();
                let mut taken = Taken::default();
                let items = file
                    .items
                    .iter()
                    .filter(|item| !matches!(item, Item::Mod(item) if item.content.is_none()));
                items.for_each(|item| taken.visit_item(item));
                found.insert(if name == "lib" { Vec::new() } else { inner() }, taken);
            }
        }
    }
    let mut found = BTreeMap::new();
    walk(src, &Vec::new(), &mut found);
    found
}

/// Resolves a path within a module to the crate root; `None` if it leads outside the crate.
fn absolute(files: &BTreeMap<Module, Taken>, module: &Module, path: &[String]) -> Option<Vec<String>> {
    match path[0].as_str() {
        "crate" => Some(path[1..].to_vec()),
        "self" => Some([module, &path[1..]].concat()),
        "super" => {
            let ups = path.iter().take_while(|name| *name == "super").count();
            Some([&module[..module.len().checked_sub(ups)?], &path[ups..]].concat())
        }
        first => {
            let child = [&module[..], &[first.to_string()]].concat();
            files.contains_key(&child).then(|| [module, path].concat())
        }
    }
}

/// File that defines the target of a path, re-exports followed; `None` if it belongs to another crate.
fn definer(files: &BTreeMap<Module, Taken>, path: &[String], detours: usize) -> Option<Module> {
    if files.contains_key(path) {
        return Some(path.to_vec());
    }
    let depth = (0..path.len()).rev().find(|&depth| files.contains_key(&path[..depth]))?;
    let module = path[..depth].to_vec();
    let known = files[&module].uses.iter().find(|(name, _)| *name == path[depth]);
    match known.filter(|_| detours > 0) {
        None => Some(module),
        Some((_, meant)) => {
            let meant = absolute(files, &module, meant)?;
            definer(files, &[&meant[..], &path[depth + 1..]].concat(), detours - 1)
        }
    }
}

type Arrows = BTreeMap<Module, BTreeSet<Module>>;

fn arrows(files: &BTreeMap<Module, Taken>) -> Arrows {
    let of = |(module, taken): (&Module, &Taken)| {
        let paths = taken.uses.iter().map(|(_, path)| path).chain(&taken.paths);
        let leads = paths.filter_map(|path| definer(files, &absolute(files, module, path)?, 8));
        (module.clone(), leads.filter(|to| to != module).collect())
    };
    files.iter().map(of).collect()
}

/// All modules reachable from a module along arrows.
fn reached(arrows: &Arrows, from: &Module) -> BTreeSet<Module> {
    let mut reached = BTreeSet::new();
    let mut open = vec![from.clone()];
    while let Some(module) = open.pop() {
        for next in arrows.get(&module).into_iter().flatten() {
            if reached.insert(next.clone()) {
                open.push(next.clone());
            }
        }
    }
    reached
}

#[test]
fn no_file_uses_a_file_that_uses_it() {
    for name in LIBRARIES.into_iter().chain(["fit-cloth"]) {
        let arrows = arrows(&files(&root().join("crates").join(name).join("src")));
        let ringed = arrows.keys().filter(|module| reached(&arrows, module).contains(*module));
        let ringed: Vec<String> = ringed.map(|module| module.join("/")).collect();
        assert!(ringed.is_empty(), "{name}: each of these comes back to itself: {}", ringed.join(", "));
        assert!(arrows.values().map(BTreeSet::len).sum::<usize>() > 10, "{name}: arrows are found at all");
    }
}

/// One row per top-level module with the modules of its crate that it uses directly, omitting those reachable through
/// the others; modules without any in the first row.
fn drawing() -> String {
    let mut text = String::new();
    for name in LIBRARIES {
        let mut tops = Arrows::new();
        for (module, leads) in arrows(&files(&root().join("crates").join(name).join("src"))) {
            let top = |module: &Module| module.first().map(|first| vec![first.clone()]);
            let Some(from) = top(&module) else { continue };
            let others = leads.iter().filter_map(top).filter(|to| *to != from);
            tops.entry(from.clone()).or_default().extend(others);
        }
        let names =
            |modules: Vec<&Module>| modules.into_iter().flatten().cloned().collect::<Vec<_>>().join(", ");
        let lowest = tops.iter().filter(|(_, leads)| leads.is_empty()).map(|(module, _)| module).collect();
        text += &format!("{name}: {}\n", names(lowest));
        for (module, leads) in tops.iter().filter(|(_, leads)| !leads.is_empty()) {
            let through: BTreeSet<Module> = leads.iter().flat_map(|to| reached(&tops, to)).collect();
            let direct = leads.iter().filter(|to| !through.contains(*to)).collect();
            text += &format!("  {:<18} -> {}\n", module[0], names(direct));
        }
    }
    text
}

#[test]
fn the_architecture_is_as_it_is_drawn() {
    let drawn = std::fs::read_to_string(root().join("docs/architecture.md")).unwrap();
    let drawing = drawing();
    assert!(drawn.contains(&drawing), "docs/architecture.md should hold\n{drawing}");
}
