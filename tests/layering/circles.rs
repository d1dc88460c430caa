//! Circles of imports between the files and folders inside a folder.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use super::source::{Named, Source, paths, uses};

/// Who imports whom inside one folder, each with the places where.
type Imports = BTreeMap<String, BTreeMap<String, Vec<String>>>;

/// The modules of the library, with what each brings in by `use`.
struct Library {
    modules: BTreeMap<Vec<String>, Vec<Named>>,
}

impl Library {
    fn new(sources: &[Source]) -> Self {
        let modules = sources.iter().map(|source| (source.module.clone(), uses(&source.product()))).collect();
        Self { modules }
    }

    /// The module that a path ends in; what a module brings in from another one belongs to that one.
    fn module(&self, from: &[String], words: &[String], depth: usize) -> Vec<String> {
        let mut at = from.to_vec();
        for (k, word) in words.iter().enumerate() {
            match word.as_str() {
                "crate" => at.clear(),
                "self" => {}
                "super" => drop(at.pop()),
                word => {
                    let child: Vec<String> = at.iter().cloned().chain([word.to_owned()]).collect();
                    if self.modules.contains_key(&child) {
                        at = child;
                        continue;
                    }
                    let brought = self.modules.get(&at).and_then(|uses| uses.iter().find(|used| used.alias == word));
                    let Some(brought) = brought.filter(|_| depth < 8) else { return at };
                    let known = brought.words.first().is_some_and(|first| self.is_known(&at, first));
                    if !known {
                        return at;
                    }
                    let target = self.module(&at, &brought.words, depth + 1);
                    return self.module(&target, &words[k + 1..], depth + 1);
                }
            }
        }
        at
    }

    /// Whether a path that starts with this word in this module stays in the library.
    fn is_known(&self, module: &[String], first: &str) -> bool {
        let child: Vec<String> = module.iter().cloned().chain([first.to_owned()]).collect();
        ["crate", "super", "self"].contains(&first) || self.modules.contains_key(&child)
    }
}

/// Imports between the parts of each folder. A file that names its own folder (`mod.rs`) or what is in it is no import.
fn imports(sources: &[Source]) -> BTreeMap<String, Imports> {
    let library = Library::new(sources);
    let mut folders: BTreeMap<String, Imports> = BTreeMap::new();
    for source in sources {
        for named in paths(&source.product()) {
            let target = library.module(&source.module, &named.words, 0);
            let common = source.module.iter().zip(&target).take_while(|(a, b)| a == b).count();
            let (Some(from), Some(to)) = (source.module.get(common), target.get(common)) else { continue };
            let folder = folders.entry(source.module[..common].join("/")).or_default();
            let place = format!("{}:{}", source.file, named.line);
            let places = folder.entry(from.clone()).or_default().entry(to.clone()).or_default();
            if places.last() != Some(&place) {
                places.push(place);
            }
        }
    }
    folders
}

/// All that can be reached from a part.
fn reached<'a>(imports: &'a Imports, from: &'a str) -> BTreeSet<&'a str> {
    let (mut reached, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(part) = open.pop() {
        for next in imports.get(part).into_iter().flat_map(BTreeMap::keys) {
            if reached.insert(next.as_str()) {
                open.push(next);
            }
        }
    }
    reached
}

/// One paragraph a circle, with the imports that close it; none of folders that may have them.
pub fn circles(sources: &[Source], allowed: &[&str]) -> String {
    let mut found = String::new();
    for (folder, imports) in imports(sources).iter().filter(|(folder, _)| !allowed.contains(&folder.as_str())) {
        let mut reported = BTreeSet::new();
        for part in imports.keys() {
            let in_circle = |part: &str| reached(imports, part).contains(part);
            if reported.contains(part.as_str()) || !in_circle(part) {
                continue;
            }
            let from_here = reached(imports, part);
            let circle: BTreeSet<&str> =
                from_here.into_iter().filter(|other| reached(imports, other).contains(part.as_str())).collect();
            let _ = writeln!(found, "src/{folder}: a circle of {circle:?}");
            for (from, to, places) in inside(imports, &circle) {
                let _ = writeln!(found, "    {from} -> {to}: {}", places.join(", "));
            }
            reported.extend(circle);
        }
    }
    found
}

/// The imports between the parts of a circle.
fn inside<'a>(imports: &'a Imports, circle: &BTreeSet<&str>) -> Vec<(&'a str, &'a str, &'a [String])> {
    let of_circle = |part: &String| circle.contains(part.as_str());
    let rows = imports.iter().filter(|(from, _)| of_circle(from)).flat_map(|(from, targets)| {
        targets
            .iter()
            .filter(|(to, _)| of_circle(to))
            .map(move |(to, places)| (from.as_str(), to.as_str(), &places[..]))
    });
    rows.collect()
}
