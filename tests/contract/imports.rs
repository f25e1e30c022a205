//! Use of names between the files of the library, from the syntax of all files. Tests are ignored.
//! A public re-export by itself does not count as a use: whoever names it uses the file that defines
//! the item, and so does the file of the re-export where it names the item itself.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use syn::visit::{self, Visit};
use syn::{Attribute, Item, ItemUse, UseTree, Visibility};

/// Path of a module from the crate's root, such as `["solver", "columns"]`, or of an item.
type ItemPath = Vec<String>;

/// Names that each file uses from each other file.
pub struct Imports(BTreeMap<ItemPath, BTreeMap<ItemPath, BTreeSet<String>>>);

impl Imports {
    /// Reads all files below `root`, the folder of `lib.rs`.
    pub fn read(root: &Path) -> Self {
        let mut modules = Modules::default();
        modules.read(root, &[]);
        let uses = |(name, module): (&ItemPath, &Module)| {
            let mut uses: BTreeMap<_, BTreeSet<_>> = BTreeMap::new();
            for path in &module.paths {
                if let Some(file) = modules.definer(name, path).filter(|file| file != name) {
                    uses.entry(file).or_default().extend(path.last().cloned());
                }
            }
            (name.clone(), uses)
        };
        Imports(modules.0.iter().map(uses).collect())
    }

    /// Groups of files with circular uses.
    pub fn circles(&self) -> BTreeSet<Vec<ItemPath>> {
        let reached: BTreeMap<_, _> =
            self.0.keys().map(|file| (file, self.reached(file))).collect();
        let group = |(file, seen): (&&ItemPath, &BTreeSet<&ItemPath>)| {
            let back = seen.iter().filter(|other| reached[*other].contains(*file));
            back.map(|other| (*other).clone()).collect::<Vec<_>>()
        };
        reached.iter().map(group).filter(|group| !group.is_empty()).collect()
    }

    /// Files that `file` uses, directly or indirectly.
    fn reached(&self, file: &ItemPath) -> BTreeSet<&ItemPath> {
        let mut seen = BTreeSet::new();
        let mut next: Vec<&ItemPath> = self.0[file].keys().collect();
        while let Some(at) = next.pop() {
            if seen.insert(at) {
                next.extend(self.0[at].keys());
            }
        }
        seen
    }

    /// Uses within a group of files, one line each: `file -> file: names`.
    pub fn ties(&self, group: &[ItemPath]) -> Vec<String> {
        let uses = group.iter().flat_map(|from| self.0[from].iter().map(move |tie| (from, tie)));
        let inside = uses.filter(|(_, (to, _))| group.contains(to));
        inside
            .map(|(from, (to, names))| {
                format!("{} -> {}: {names:?}", from.join("::"), to.join("::"))
            })
            .collect()
    }
}

/// One file.
#[derive(Default)]
struct Module {
    /// Names of the items that the file defines.
    defines: BTreeSet<String>,
    /// Public re-exports: name (`*` for all names of a module) and path.
    exports: Vec<(String, ItemPath)>,
    /// Paths that the file names.
    paths: BTreeSet<ItemPath>,
    /// First words of all paths outside of `use`.
    words: BTreeSet<String>,
}

impl Module {
    fn of(file: &syn::File) -> Self {
        let mut module = Module::default();
        module.visit_file(file);
        let exports = module.exports.iter().filter(|(name, _)| module.words.contains(name));
        module.paths.extend(exports.map(|(_, path)| path.clone()));
        module
    }
}

/// All files.
#[derive(Default)]
struct Modules(BTreeMap<ItemPath, Module>);

impl Modules {
    fn read(&mut self, folder: &Path, module: &[String]) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let stem = path.file_stem().unwrap().to_str().unwrap();
            if stem.contains("tests") || ["checks", "main"].contains(&stem) {
                continue;
            }
            let name =
                if ["mod", "lib"].contains(&stem) { module.into() } else { child(module, stem) };
            if path.is_dir() {
                self.read(&path, &name);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                self.0.insert(name, Module::of(&syn::parse_file(&text).unwrap()));
            }
        }
    }

    /// The file that defines the item at `path`, as named in the file `from`; `None` if `path` does
    /// not belong to the library.
    fn definer(&self, from: &[String], path: &[String]) -> Option<ItemPath> {
        let is_module = |at: &[String], name: &String| self.0.contains_key(&child(at, name));
        let mut rest = path;
        let mut at = match path.first()?.as_str() {
            "crate" => Vec::new(),
            "self" | "super" => from.to_vec(),
            _ if is_module(from, &path[0]) => from.to_vec(),
            _ => return None,
        };
        while let Some(word @ ("crate" | "self" | "super")) = rest.first().map(String::as_str) {
            if word == "super" {
                at.pop();
            }
            rest = &rest[1..];
        }
        while let Some(name) = rest.first().filter(|name| is_module(&at, name)) {
            at.push(name.clone());
            rest = &rest[1..];
        }
        let (module, Some(name)) = (self.0.get(&at)?, rest.first()) else { return Some(at) };
        if module.defines.contains(name) {
            return Some(at);
        }
        let exports = module.exports.iter();
        let named = exports.clone().filter(|(export, _)| export == name);
        let mut named = named.filter_map(|(_, path)| self.definer(&at, path));
        let of_all = exports.filter(|(export, _)| export == "*");
        let mut of_all = of_all.filter_map(|(_, path)| self.definer(&at, &child(path, name)));
        let found =
            named.next().or_else(|| of_all.find(|file| self.0[file].defines.contains(name)));
        Some(found.unwrap_or(at))
    }
}

fn child(path: &[String], name: &str) -> ItemPath {
    path.iter().cloned().chain([name.to_string()]).collect()
}

/// The items that a `use` names after `prefix`: name in this file (`*` for all) and path.
fn used(tree: &UseTree, prefix: &[String]) -> Vec<(String, ItemPath)> {
    match tree {
        UseTree::Path(tree) => used(&tree.tree, &child(prefix, &tree.ident.to_string())),
        UseTree::Group(group) => group.items.iter().flat_map(|tree| used(tree, prefix)).collect(),
        UseTree::Name(tree) if tree.ident == "self" => {
            vec![(prefix.last().cloned().unwrap_or_default(), prefix.into())]
        }
        UseTree::Name(tree) => {
            vec![(tree.ident.to_string(), child(prefix, &tree.ident.to_string()))]
        }
        UseTree::Rename(tree) => {
            vec![(tree.rename.to_string(), child(prefix, &tree.ident.to_string()))]
        }
        UseTree::Glob(_) => vec![("*".into(), prefix.into())],
    }
}

fn is_test(attributes: &[Attribute]) -> bool {
    let lists = attributes.iter().filter_map(|attribute| attribute.meta.require_list().ok());
    lists.into_iter().any(|list| list.path.is_ident("cfg") && list.tokens.to_string() == "test")
}

impl<'ast> Visit<'ast> for Module {
    fn visit_item(&mut self, item: &'ast Item) {
        let (name, attributes) = match item {
            Item::Const(item) => (Some(&item.ident), &item.attrs),
            Item::Enum(item) => (Some(&item.ident), &item.attrs),
            Item::Fn(item) => (Some(&item.sig.ident), &item.attrs),
            Item::Macro(item) => (item.ident.as_ref(), &item.attrs),
            Item::Static(item) => (Some(&item.ident), &item.attrs),
            Item::Struct(item) => (Some(&item.ident), &item.attrs),
            Item::Trait(item) => (Some(&item.ident), &item.attrs),
            Item::Type(item) => (Some(&item.ident), &item.attrs),
            Item::Impl(item) => (None, &item.attrs),
            Item::Mod(item) => (None, &item.attrs),
            Item::Use(item) => (None, &item.attrs),
            _ => return,
        };
        if !is_test(attributes) {
            self.defines.extend(name.map(ToString::to_string));
            visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        match item.vis {
            Visibility::Inherited => {
                self.paths.extend(used(&item.tree, &[]).into_iter().map(|u| u.1))
            }
            _ => self.exports.extend(used(&item.tree, &[])),
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: ItemPath = path.segments.iter().map(|part| part.ident.to_string()).collect();
        self.words.insert(names[0].clone());
        if names.len() > 1 {
            self.paths.insert(names);
        }
        visit::visit_path(self, path);
    }
}
