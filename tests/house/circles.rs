//! No circles of files: if two files use each other's items, neither can be understood, moved or tested alone.
//!
//! A file uses another if it names an item that the other defines, through any path and re-exports; a re-export itself is not a use. Uses of a
//! parent module do not count: a module and the folder of its name are one unit in several files. Tests do not count, nor do methods, which are
//! named without a path.

use crate::source::{File, Token, Word, after_group};
use std::collections::{BTreeMap, BTreeSet};

/// A path of names, or of modules from the crate's root.
type Path = Vec<String>;

/// Items that a source file defines and names.
struct Module {
    file: String,
    defines: BTreeSet<String>,
    /// Imports by `use`: the path, and the local name; `None` is a glob import.
    imports: Vec<(Path, Option<String>)>,
    /// Names outside `use`.
    names: BTreeSet<String>,
    /// Paths of more than one name outside `use`.
    paths: BTreeSet<Path>,
}

/// All modules, one per file, by their paths from the crate's root.
struct Modules(BTreeMap<Path, Module>);

/// Target of a path.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Place {
    Module(Path),
    /// An item, or what belongs to one, by the module that defines it.
    Item(Path),
}

/// The circles among the files of a crate, whose sources are in `folder`.
pub fn violations(files: &[File], folder: &str) -> Vec<String> {
    let uses = Modules::new(files, folder).uses();
    let circles = circles(&uses).into_iter().map(|circle| {
        let inside = uses.iter().filter(|((user, used), _)| {
            circle.contains(&user.as_str()) && circle.contains(&used.as_str())
        });
        let inside: Vec<_> = inside
            .map(|((user, used), name)| format!("\n    {user} uses `{name}` of {used}"))
            .collect();
        format!("a circle of {} files:{}", circle.len(), inside.concat())
    });
    circles.collect()
}

impl Modules {
    fn new(files: &[File], folder: &str) -> Self {
        let modules = files.iter().filter_map(|file| {
            let path = module_path(&file.path, folder)?;
            Some((path, Module::new(file)))
        });
        Self(modules.collect())
    }

    /// Which file uses which, with the first name by which it does.
    fn uses(&self) -> BTreeMap<(String, String), String> {
        let mut uses = BTreeMap::new();
        for (path, module) in &self.0 {
            for (place, name) in self.named_by(path, module) {
                let Place::Item(definer) = place else {
                    continue;
                };
                if definer == *path || path.starts_with(&definer) {
                    continue;
                }
                let pair = (module.file.clone(), self.0[&definer].file.clone());
                uses.entry(pair).or_insert(name);
            }
        }
        uses
    }

    /// Names in a module outside `use`, and their targets.
    fn named_by(&self, path: &Path, module: &Module) -> Vec<(Place, String)> {
        let mut named = Vec::new();
        for (import, name) in &module.imports {
            match name {
                Some(name) if module.names.contains(name) => {
                    named.extend(
                        self.resolve(path, import)
                            .map(|place| (place, name.clone())),
                    );
                }
                Some(_) => {}
                None => {
                    let Some(Place::Module(from)) = self.resolve(path, import) else {
                        continue;
                    };
                    named.extend(module.names.iter().filter_map(|name| {
                        let place = self.walk(&from, std::slice::from_ref(name), 0)?;
                        Some((place, name.clone()))
                    }));
                }
            }
        }
        for names in &module.paths {
            let place = self.resolve(path, names);
            named.extend(place.map(|place| (place, names.join("::"))));
        }
        named
    }

    /// Target of a path in this module.
    fn resolve(&self, module: &Path, names: &[String]) -> Option<Place> {
        self.resolve_within(module, names, 0)
    }

    fn resolve_within(&self, module: &Path, names: &[String], depth: usize) -> Option<Place> {
        // Circular imports are compile errors; this only ensures termination.
        if depth > 16 {
            return None;
        }
        let first = names.first()?;
        if first == "crate" {
            return self.walk(&Path::new(), &names[1..], depth);
        }
        let up = names.iter().take_while(|name| *name == "super").count();
        let rest = &names[up..];
        let rest = match rest.first() {
            Some(own) if own == "self" => &rest[1..],
            _ => rest,
        };
        let from = module.len().checked_sub(up)?;
        self.walk(&module[..from].to_vec(), rest, depth)
    }

    fn walk(&self, from: &Path, names: &[String], depth: usize) -> Option<Place> {
        let Some((first, rest)) = names.split_first() else {
            return Some(Place::Module(from.clone()));
        };
        let child: Path = from.iter().chain([first]).cloned().collect();
        if self.0.contains_key(&child) {
            return self.walk(&child, rest, depth);
        }
        let module = self.0.get(from)?;
        if module.defines.contains(first) {
            return Some(Place::Item(from.clone()));
        }
        let by_name = |(_, name): &&(Path, Option<String>)| name.as_ref() == Some(first);
        if let Some((import, _)) = module.imports.iter().find(by_name) {
            // `use rand;` leads out of the crate, not to itself.
            let is_itself = import.as_slice() == std::slice::from_ref(first);
            let place = (!is_itself).then(|| self.resolve_within(from, import, depth + 1));
            return match place.flatten()? {
                Place::Module(path) => self.walk(&path, rest, depth + 1),
                item => Some(item),
            };
        }
        let globs = module.imports.iter().filter(|(_, name)| name.is_none());
        globs
            .filter_map(
                |(import, _)| match self.resolve_within(from, import, depth + 1)? {
                    Place::Module(path) if path != *from => self.walk(&path, names, depth + 1),
                    _ => None,
                },
            )
            .next()
    }
}

impl Module {
    fn new(file: &File) -> Self {
        let tokens: Vec<_> = file
            .tokens
            .iter()
            .filter(|token| !token.in_test)
            .cloned()
            .collect();
        let mut module = Self {
            file: file.path.clone(),
            defines: BTreeSet::new(),
            imports: Vec::new(),
            names: BTreeSet::new(),
            paths: BTreeSet::new(),
        };
        // Items are at the file's top level or in its inline modules, not in bodies.
        let mut bodies = 0;
        let mut i = 0;
        while i < tokens.len() {
            let token = &tokens[i];
            if token.is_name("use") {
                i = module.import(&tokens, i + 1, &mut Path::new());
                continue;
            }
            match &token.word {
                Word::Mark('{') => bodies += 1,
                Word::Mark('}') => bodies -= 1,
                Word::Name(word) => {
                    let next = tokens.get(i + 1).and_then(Token::name);
                    if bodies == token.inline_modules && DEFINING.contains(&word.as_str()) {
                        module.defines.extend(next.map(str::to_owned));
                    }
                    let path = path_at(&tokens, i);
                    let leads_out = usize::from(i >= 2 && is_path(&tokens, i - 2));
                    if path.len() > 1 && leads_out == 0 {
                        let supers = path.iter().take_while(|name| *name == "super").count();
                        // From an inline module the first ones refer to the file's own modules.
                        let own = supers.min(token.inline_modules);
                        module.paths.insert(path[own..].to_vec());
                    }
                    if leads_out == 0 {
                        module.names.insert(word.clone());
                    }
                }
                _ => {}
            }
            i += 1;
        }
        // `mod a;` names a file and defines nothing here; `mod a { … }` is found as its items.
        module
    }

    /// Parses the tree of a `use` from `i` on; returns its end.
    fn import(&mut self, tokens: &[Token], mut i: usize, path: &mut Path) -> usize {
        let depth = path.len();
        while let Some(token) = tokens.get(i) {
            match &token.word {
                Word::Mark('{') => {
                    let end = after_group(tokens, i);
                    i += 1;
                    while i + 1 < end {
                        i = self.import(tokens, i, path);
                        i += usize::from(tokens.get(i).is_some_and(|token| token.is_mark(',')));
                    }
                    path.truncate(depth);
                    return end;
                }
                Word::Mark('*') => {
                    self.imports.push((path.clone(), None));
                    path.truncate(depth);
                    return i + 1;
                }
                Word::Mark(':') => i += 1,
                Word::Name(alias) if alias == "as" => {
                    let name = tokens.get(i + 1).and_then(Token::name);
                    self.imports.push((path.clone(), name.map(str::to_owned)));
                    path.truncate(depth);
                    return i + 2;
                }
                Word::Name(name) => {
                    path.push(name.clone());
                    i += 1;
                    let goes_on = is_path(tokens, i);
                    let is_renamed = tokens.get(i).is_some_and(|token| token.is_name("as"));
                    if !goes_on && !is_renamed {
                        if path.last().is_some_and(|name| name == "self") {
                            path.pop();
                        }
                        self.imports.push((path.clone(), path.last().cloned()));
                        path.truncate(depth);
                        return i;
                    }
                }
                _ => return i,
            }
        }
        i
    }
}

/// Words before the name of an item.
const DEFINING: [&str; 9] = [
    "fn",
    "struct",
    "enum",
    "trait",
    "type",
    "const",
    "static",
    "union",
    "macro_rules",
];

/// The module of a source file; `None` for the program, and for files of tests.
fn module_path(file: &str, folder: &str) -> Option<Path> {
    let inside = file.strip_prefix(folder)?.strip_prefix('/')?;
    let inside = inside.strip_suffix(".rs")?;
    let mut path: Path = inside.split('/').map(str::to_owned).collect();
    if path
        .iter()
        .any(|name| name == "tests" || name.ends_with("_tests"))
        || inside == "main"
    {
        return None;
    }
    if path
        .last()
        .is_some_and(|name| name == "mod" || name == "lib")
    {
        path.pop();
    }
    Some(path)
}

fn is_path(tokens: &[Token], i: usize) -> bool {
    [i, i + 1]
        .iter()
        .all(|i| tokens.get(*i).is_some_and(|token| token.is_mark(':')))
}

/// The names that are joined by `::` from here on.
fn path_at(tokens: &[Token], mut i: usize) -> Path {
    let mut path = Path::new();
    while let Some(name) = tokens.get(i).and_then(Token::name) {
        path.push(name.to_owned());
        if !is_path(tokens, i + 1) {
            break;
        }
        i += 3;
    }
    path
}

/// Files that all lead to each other, each circle in the order of its names.
fn circles(uses: &BTreeMap<(String, String), String>) -> Vec<Vec<&str>> {
    let mut used: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (user, file) in uses.keys() {
        used.entry(user).or_default().push(file);
    }
    let reach: BTreeMap<&str, BTreeSet<&str>> = used
        .keys()
        .map(|file| (*file, reached(file, &used)))
        .collect();
    let mut circles = BTreeSet::new();
    for (file, reached) in &reach {
        let comes_back = |other: &&&str| reach.get(**other).is_some_and(|back| back.contains(file));
        let circle: Vec<&str> = reached.iter().filter(comes_back).copied().collect();
        if circle.len() > 1 {
            circles.insert(circle);
        }
    }
    circles.into_iter().collect()
}

/// All that a file leads to.
fn reached<'a>(file: &str, used: &BTreeMap<&'a str, Vec<&'a str>>) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut open: Vec<&str> = used.get(file).cloned().unwrap_or_default();
    while let Some(next) = open.pop() {
        if reached.insert(next) {
            open.extend(used.get(next).into_iter().flatten());
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let files: Vec<_> = files
            .iter()
            .map(|(path, text)| File::new(path, text))
            .collect();
        let uses = Modules::new(&files, "src").uses();
        let owned = |circle: Vec<&str>| circle.into_iter().map(str::to_owned).collect();
        circles(&uses).into_iter().map(owned).collect()
    }

    const LIB: (&str, &str) = ("src/lib.rs", "pub mod a; pub mod b; pub use a::A;");

    #[test]
    fn files_that_use_each_other_are_a_circle() {
        let a = "use crate::b::B; pub struct A(B);";
        for b in [
            "use crate::a::A; pub struct B(A);",
            "use super::a::{self, A as Other}; pub struct B(Other);",
            "pub struct B; fn f() -> crate::a::A {}",
            "use crate::A; pub struct B(A);",
            "use crate::*; pub struct B(A);",
            "use crate::a; pub struct B(a::A);",
            "use crate::a::*; pub enum B { A(A) }",
            "pub struct B; mod inner { fn f(a: super::super::a::A) {} }",
        ] {
            let found = found(&[LIB, ("src/a.rs", a), ("src/b.rs", b)]);
            assert_eq!(found, [["src/a.rs", "src/b.rs"]], "{b}");
        }
    }

    #[test]
    fn what_is_handed_on_or_of_tests_or_one_way_is_none() {
        let a = "use crate::b::B; pub struct A(B);";
        for b in [
            "pub struct B;",
            "pub use crate::a::A; pub struct B;",
            "pub struct B; #[cfg(test)] mod tests { use crate::a::A; fn f(a: A) {} }",
            "pub struct B; // crate::a::A\nfn f() { self.a; }",
            "use std::a::A; pub struct B(A);",
            "pub struct B; struct A; fn f(a: A) {}",
        ] {
            let found = found(&[LIB, ("src/a.rs", a), ("src/b.rs", b)]);
            assert!(found.is_empty(), "{b}: {found:?}");
        }
    }

    #[test]
    fn a_module_and_its_parts_are_one_thing() {
        let whole = (
            "src/a.rs",
            "mod one; mod two; use one::One; pub struct A(One);",
        );
        let part = |uses| ("src/a/one.rs", uses);
        let two = ("src/a/two.rs", "use super::one::One; pub struct Two(One);");
        let of_whole = part("use super::A; pub struct One(A);");
        assert!(found(&[LIB, whole, of_whole, two]).is_empty());
        let of_two = part("use super::two::Two; pub struct One(Two);");
        assert_eq!(
            found(&[LIB, whole, of_two, two]),
            [["src/a/one.rs", "src/a/two.rs"]]
        );
        // From outside it is an ordinary file.
        let of_b = part("use crate::b::B; pub struct One(B);");
        let b = ("src/b.rs", "use crate::a::A; pub struct B(A);");
        assert_eq!(
            found(&[LIB, whole, of_b, b]),
            [["src/a.rs", "src/a/one.rs", "src/b.rs"]]
        );
    }

    #[test]
    fn longer_circles_are_found_once() {
        let files = [
            ("src/a.rs", "use crate::b::B; pub struct A(B);"),
            ("src/b.rs", "use crate::c::C; pub struct B(C);"),
            ("src/c.rs", "use crate::a::A; pub struct C(A);"),
            ("src/d.rs", "use crate::a::A; pub struct D(A);"),
        ];
        assert_eq!(found(&files), [["src/a.rs", "src/b.rs", "src/c.rs"]]);
    }
}
