//! The sources of crates and programs as `syn` reads them: from which files each file takes names, followed through
//! re-exports, and what users see.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use syn::visit::{self, Visit};
use syn::{Attribute, File, Item, Meta, UseTree, Visibility};

/// A module by its crate and its names: `signorini_qp::method::start`.
pub type Module = Vec<String>;

/// A source file that is not only for tests.
#[derive(Default)]
pub struct Source {
    /// Its path from the folder of the workspace.
    pub path: PathBuf,
    /// Its text without the lines of comments.
    pub code: String,
    /// The first names of its paths that lead out of these crates: other crates.
    pub foreign: BTreeSet<String>,
    /// The structures and variants with fields that it constructs, by the paths in the code.
    pub constructs: BTreeSet<String>,
    /// Whole paths that the file takes names by, without those that it re-exports to every user.
    imports: BTreeSet<Module>,
    /// Names that `use` declarations bring into the file, each with its whole path.
    names: BTreeMap<String, Module>,
    /// Those of them that every user of the module sees, and the public items and modules of the file.
    public: BTreeSet<String>,
}

/// Files by their modules.
pub struct Sources {
    pub files: BTreeMap<Module, Source>,
}

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The files with this ending below a folder, which may lie in the root of the workspace.
pub fn files_below(folder: impl AsRef<Path>, ending: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path());
    let below = |path: PathBuf| if path.is_dir() { files_below(path, ending) } else { vec![path] };
    let is_it = |path: &PathBuf| path.to_str().unwrap().ends_with(ending);
    entries.flat_map(below).filter(is_it).collect()
}

/// The crates that are published: their names in code, and their folders.
pub fn crates() -> Vec<(String, PathBuf)> {
    let entries = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path());
    let crates = entries.map(|path| (format!("signorini_{}", path.file_name().unwrap().to_str().unwrap()), path));
    let crates = crates.map(|(name, path)| (name, path.join("src")));
    crates.chain([("signorini".to_string(), root().join("src"))]).collect()
}

pub fn has(attributes: &[Attribute], name: &str) -> bool {
    attributes.iter().any(|attribute| attribute.path().is_ident(name))
}

pub fn is_hidden(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|one| one.path().is_ident("doc") && matches!(one.meta, Meta::List(_)))
}

pub fn is_for_tests(attributes: &[Attribute]) -> bool {
    let is_test =
        |one: &Attribute| one.path().is_ident("cfg") && one.parse_args::<syn::Path>().is_ok_and(|p| p.is_ident("test"));
    attributes.iter().any(is_test)
}

fn joined(module: &[String], name: impl ToString) -> Module {
    [module, &[name.to_string()]].concat()
}

impl Sources {
    /// Reads these crates. Fails on a file that no module declares: it would not be compiled.
    pub fn of(crates: &[(String, PathBuf)]) -> Sources {
        let mut read = BTreeMap::new();
        for (name, folder) in crates {
            for path in files_below(folder, ".rs") {
                let inside = path.strip_prefix(folder).unwrap().with_extension("");
                let mut module = vec![name.clone()];
                module.extend(inside.iter().map(|part| part.to_str().unwrap().to_string()));
                // What a program has beside its library is one call.
                let is_program = module[1..] == ["main"] && folder.join("lib.rs").exists();
                module.pop_if(|last| ["mod", "lib", "main"].contains(&last.as_str()));
                let text = fs::read_to_string(&path).unwrap();
                let file = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
                if !is_program {
                    read.insert(module, (path, text, file));
                }
            }
        }
        let (mut declared, mut of_tests) = (BTreeSet::new(), BTreeSet::new());
        for (module, (_, _, file)) in &read {
            for item in &file.items {
                let Item::Mod(one) = item else { continue };
                declared.insert(joined(module, &one.ident));
                of_tests.extend(is_for_tests(&one.attrs).then(|| joined(module, &one.ident)));
            }
        }
        let lost = read.iter().find(|(module, _)| module.len() > 1 && !declared.contains(*module));
        assert!(lost.is_none(), "no module declares {:?}", lost.map(|lost| &lost.1.0));
        read.retain(|module, _| !(1..=module.len()).any(|length| of_tests.contains(&module[..length])));
        let known: BTreeSet<Module> = read.keys().cloned().collect();
        let files = read.into_iter().map(|(module, (path, text, file))| {
            let source = Reader::read(&module, &known, &file);
            let code = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
            (module, Source { path: path.strip_prefix(root()).unwrap().into(), code, ..source })
        });
        Sources { files: files.collect() }
    }

    /// The modules from which `module` takes names, without `module` itself.
    pub fn taken_from(&self, module: &Module) -> BTreeSet<Module> {
        let source = &self.files[module];
        let mut found: BTreeSet<Module> = source.imports.iter().map(|path| self.definition(path).0).collect();
        found.remove(module);
        found
    }

    /// The file that defines what a whole path names, and its name there.
    fn definition(&self, path: &[String]) -> (Module, Option<String>) {
        let mut length = path.len();
        while !self.files.contains_key(&path[..length]) {
            length -= 1;
        }
        let (module, rest) = path.split_at(length);
        match rest.first().and_then(|name| self.files[module].names.get(name)) {
            Some(origin) if origin != path => self.definition(&[origin.as_slice(), &rest[1..]].concat()),
            _ => (module.to_vec(), rest.first().cloned()),
        }
    }

    /// The file and the name of what `module` means by `name`.
    pub fn meant(&self, module: &Module, name: &str) -> (Module, Option<String>) {
        self.definition(&joined(module, name))
    }

    /// What users see: the files that define it, with its names there.
    pub fn exported(&self) -> BTreeSet<(Module, Option<String>)> {
        let mut next: Vec<Module> = self.files.keys().filter(|module| module.len() == 1).cloned().collect();
        let mut found = BTreeSet::new();
        while let Some(module) = next.pop() {
            for name in &self.files[&module].public {
                let inside = joined(&module, name);
                found.insert(self.definition(&inside));
                next.extend(self.files.contains_key(&inside).then_some(inside));
            }
        }
        found
    }

    pub fn circles(&self) -> BTreeSet<String> {
        circles(&self.files.keys().map(|module| (module.clone(), self.taken_from(module))).collect())
    }
}

/// The arrows that close a circle, of the files from which each file takes names.
pub fn circles(taken: &BTreeMap<Module, BTreeSet<Module>>) -> BTreeSet<String> {
    let mut circles = BTreeSet::new();
    for start in taken.keys() {
        // The files that this file reaches by imports; the file itself must not be among these.
        let (mut reached, mut next) = (BTreeSet::new(), vec![start]);
        while let Some(module) = next.pop() {
            for other in &taken[module] {
                if other == start {
                    circles.insert(format!("{} <- {}", start.join("/"), module.join("/")));
                }
                if reached.insert(other) {
                    next.push(other);
                }
            }
        }
    }
    circles
}

/// Walks over the code of one file.
struct Reader<'a> {
    module: &'a Module,
    known: &'a BTreeSet<Module>,
    source: Source,
    paths: Vec<Module>,
}

impl Reader<'_> {
    fn read(module: &Module, known: &BTreeSet<Module>, file: &File) -> Source {
        let mut reader = Reader { module, known, source: Source::default(), paths: Vec::new() };
        reader.visit_file(file);
        // A declaration may have brought in the first name of a path, also below it.
        for path in std::mem::take(&mut reader.paths) {
            let whole = match reader.source.names.get(&path[0]) {
                Some(origin) => Some([origin.as_slice(), &path[1..]].concat()),
                None => reader.whole(path),
            };
            reader.source.imports.extend(whole);
        }
        reader.source
    }

    /// The path from its crate, if that is one of these crates; else the name of the other crate is kept.
    fn whole(&mut self, path: Module) -> Option<Module> {
        let (here, path): (&[String], &[String]) = match path[0].as_str() {
            "crate" => (&self.module[..1], &path[1..]),
            "self" => (self.module, &path[1..]),
            "super" => {
                let up = path.iter().take_while(|name| *name == "super").count();
                (&self.module[..self.module.len() - up], &path[up..])
            }
            _ if self.known.contains(&joined(self.module, &path[0])) => (self.module, &path),
            _ if self.known.contains(&path[..1]) => (&[], &path),
            _ => {
                self.source.foreign.insert(path[0].clone());
                return None;
            }
        };
        Some([here, path].concat())
    }

    fn declare(&mut self, tree: &UseTree, before: Module, is_public: bool) {
        let (name, path) = match tree {
            UseTree::Path(path) => return self.declare(&path.tree, joined(&before, &path.ident), is_public),
            UseTree::Group(group) => {
                return group.items.iter().for_each(|tree| self.declare(tree, before.clone(), is_public));
            }
            UseTree::Name(name) if name.ident == "self" => (before.last().cloned(), before),
            UseTree::Name(name) => (Some(name.ident.to_string()), joined(&before, &name.ident)),
            UseTree::Rename(name) if name.ident == "self" => (Some(name.rename.to_string()), before),
            UseTree::Rename(name) => (Some(name.rename.to_string()), joined(&before, &name.ident)),
            UseTree::Glob(_) => {
                assert!(!is_public, "{:?} exports names that are not listed", self.module);
                (None, before)
            }
        };
        let Some(whole) = self.whole(path) else { return };
        self.source.names.extend(name.clone().map(|name| (name, whole.clone())));
        if is_public {
            self.source.public.extend(name);
        } else {
            self.source.imports.insert(whole);
        }
    }
}

impl<'a> Visit<'a> for Reader<'_> {
    fn visit_item(&mut self, item: &'a Item) {
        let (visibility, name) = match item {
            Item::Const(one) => (&one.vis, &one.ident),
            Item::Enum(one) => (&one.vis, &one.ident),
            Item::Fn(one) => (&one.vis, &one.sig.ident),
            Item::Mod(one) if is_hidden(&one.attrs) => return visit::visit_item(self, item),
            Item::Mod(one) => (&one.vis, &one.ident),
            Item::Struct(one) => (&one.vis, &one.ident),
            Item::Trait(one) => (&one.vis, &one.ident),
            Item::Type(one) => (&one.vis, &one.ident),
            _ => return visit::visit_item(self, item),
        };
        if matches!(visibility, Visibility::Public(_)) {
            self.source.public.insert(name.to_string());
        }
        visit::visit_item(self, item);
    }

    fn visit_item_mod(&mut self, one: &'a syn::ItemMod) {
        let is_read = one.content.is_none() || is_for_tests(&one.attrs);
        assert!(is_read, "{:?} has a module inside its file, which is not read", self.module);
    }

    fn visit_item_use(&mut self, one: &'a syn::ItemUse) {
        self.declare(&one.tree, Module::new(), matches!(one.vis, Visibility::Public(_)) && !is_hidden(&one.attrs));
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        let names: Module = path.segments.iter().map(|part| part.ident.to_string()).collect();
        if names.len() > 1 {
            self.paths.push(names);
        }
        visit::visit_path(self, path);
    }

    fn visit_expr_struct(&mut self, one: &'a syn::ExprStruct) {
        let names: Vec<String> = one.path.segments.iter().map(|part| part.ident.to_string()).collect();
        self.source.constructs.insert(names.join("::"));
        visit::visit_expr_struct(self, one);
    }

    // What a macro is given has no other form than words.
    fn visit_macro(&mut self, one: &'a syn::Macro) {
        let text = one.tokens.to_string().replace(" ::", "::").replace(":: ", "::");
        let words =
            text.split(|c: char| !c.is_alphanumeric() && c != '_' && c != ':').filter(|word| word.contains("::"));
        self.paths.extend(words.map(|word| word.split("::").map(str::to_string).collect()));
        visit::visit_macro(self, one);
    }

    // The scope of `pub(in ..)` takes no names, and documentation is no code.
    fn visit_visibility(&mut self, _: &'a Visibility) {}
    fn visit_attribute(&mut self, _: &'a Attribute) {}
}

#[test]
fn declarations_paths_and_macros_are_read_and_tests_are_not() {
    let module = |path: &str| path.split("::").map(str::to_string).collect::<Module>();
    let known = ["a", "a::b", "a::b::c", "a::d", "e"].map(module).into();
    let file = syn::parse_file(
        r#"
        use crate::d::{self, x::Y as Z};
        pub use super::G;
        #[doc(hidden)]
        pub mod t;
        pub(in crate::scope) fn f<'a>(h: &'a c::H<crate::I>) -> faer::J { e::k(Z::l, json!({"m": [self::n::o("p")]})) }
        fn r() -> S { S::T { u: 1 } }
        #[cfg(test)]
        mod tests { use crate::v; }
        "#,
    );
    let source = Reader::read(&module("a::b"), &known, &file.unwrap());
    let imports = ["a::d", "a::d::x::Y", "a::b::c::H", "a::I", "e::k", "a::d::x::Y::l", "a::b::n::o"];
    assert_eq!(source.imports, imports.map(module).into());
    assert_eq!(
        source.names,
        [("d", "a::d"), ("Z", "a::d::x::Y"), ("G", "a::G")].map(|(n, p)| (n.into(), module(p))).into()
    );
    assert_eq!(source.public, ["G".to_string()].into());
    assert_eq!(source.foreign, ["S", "faer"].map(str::to_string).into());
    assert_eq!(source.constructs, ["S::T".to_string()].into());
}
