//! Lookup of materials by name: files beside the scene, a user folder, and the built-in library.
//!
//! A name with a path separator or ending in `.toml` is a path. Any other name is looked up as `NAME.toml` in
//! `materials/` beside the scene (or in the working folder), then in the folder that `BARWAVE_MATERIALS` names,
//! then in the library that is part of the program.

use std::path::{Path, PathBuf};

use wildmatch::WildMatch;

use super::{Material, file};
use crate::error::{InputError, Result};
use crate::input::{Document, nearest};
use crate::text_file;

/// Environment variable that names a folder with material files.
pub const FOLDER_VARIABLE: &str = "BARWAVE_MATERIALS";

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        /// Names and texts of the built-in material files, sorted by name.
        const BUILT_IN: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../materials/", $name, ".toml")))),*];
    };
}

built_in![
    "aluminium-1100-o",
    "aluminium-2024-t3",
    "aluminium-2024-t3-b",
    "aluminium-2024-t3-jc",
    "aluminium-2024-t351-jc",
    "aluminium-5052-o",
    "aluminium-6061-o",
    "aluminium-6061-t6",
    "aluminium-6061-t6-jc",
    "aluminium-7039-jc",
    "aluminium-7075-o",
    "brass-cartridge-jc",
    "brass-naval-annealed",
    "brass-naval-annealed-b",
    "copper-annealed",
    "copper-annealed-voce",
    "copper-ofhc-epic-jc",
    "copper-ofhc-jc",
    "copper-ofhc-taylor-jc",
    "iron-armco-jc",
    "iron-carpenter-jc",
    "magnesium-az31b-annealed",
    "mild-steel",
    "nickel-200-jc",
    "steel-1006-jc",
    "steel-304-annealed",
    "steel-304l-jc",
    "steel-4340-jc",
    "steel-4340-tempered-315c",
    "steel-s7-jc",
    "titanium-6al-4v-b-jc",
    "titanium-6al-4v-jc",
];

/// Alternative names of built-in materials.
const ALIASES: &[(&str, &str)] = &[("steel-low-carbon-annealed", "mild-steel")];

/// Returns the names of the built-in materials, sorted.
pub fn names() -> impl Iterator<Item = &'static str> {
    BUILT_IN.iter().map(|(name, _)| *name)
}

/// Returns the exact text of a built-in material file.
pub fn built_in_text(name: &str) -> Option<&'static str> {
    let name = ALIASES.iter().find(|(alias, _)| *alias == name).map_or(name, |(_, target)| target);
    BUILT_IN.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// Returns the folders that are searched for material files, in order.
pub fn folders(base_dir: &Path) -> Vec<PathBuf> {
    std::iter::once(base_dir.join("materials")).chain(user_folder()).collect()
}

/// Returns the folder of the user's materials.
pub fn user_folder() -> Option<PathBuf> {
    let named = || std::env::var_os(FOLDER_VARIABLE).filter(|v| !v.is_empty()).map(PathBuf::from);
    text_file::of_store(|files| files.materials.as_ref().map(PathBuf::from)).unwrap_or_else(named)
}

/// Returns the material with this name or path; paths and `materials/` are relative to `base_dir` (the folder of the scene).
///
/// # Errors
/// The name is unknown (the error suggests the nearest known one), the file is missing, or its contents are invalid.
pub fn find(name_or_path: &str, base_dir: &Path) -> Result<Material> {
    if is_path(name_or_path) {
        return file::read(&base_dir.join(name_or_path));
    }
    let files = folders(base_dir).into_iter().map(|folder| folder.join(format!("{name_or_path}.toml")));
    if let Some(path) = files.into_iter().find(|path| text_file::is_file(path)) {
        return file::read(&path);
    }
    match built_in_text(name_or_path) {
        Some(text) => {
            let document = Document::new(format!("built-in {name_or_path}.toml"), text);
            file::parse(&document, name_or_path, base_dir, "built-in")
        }
        None => Err(unknown(name_or_path, base_dir).into()),
    }
}

/// Returns the names of the materials in the user's folders, in the order in which they are searched.
pub fn user_names(base_dir: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for folder in folders(base_dir) {
        let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        let toml = files.filter(|path| path.extension().is_some_and(|e| e == "toml"));
        let mut found: Vec<_> = toml.filter_map(|p| Some(p.file_stem()?.to_string_lossy().into_owned())).collect();
        found.sort();
        names.extend(found.into_iter().filter(|name| !names.contains(name)).collect::<Vec<_>>());
    }
    names
}

/// Returns the names of the materials that match a pattern, in which `*` stands for any characters and `?` for one: first the built-in ones, then
/// those in the user's folders.
///
/// # Errors
/// No name matches the pattern.
pub fn matching(pattern: &str, base_dir: &Path) -> Result<Vec<String>> {
    let wild = WildMatch::new(pattern);
    let mut found: Vec<String> = names().map(str::to_owned).collect();
    found.extend(user_names(base_dir).into_iter().filter(|name| built_in_text(name).is_none()));
    found.retain(|name| wild.matches(name));
    if found.is_empty() {
        let error = InputError::new(format!("no material matches `{pattern}`")).key("material");
        return Err(error.help("`material::library::names` lists them").into());
    }
    Ok(found)
}

fn is_path(name: &str) -> bool {
    let is_toml = Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    is_toml || name.contains('/') || name.contains(std::path::MAIN_SEPARATOR)
}

fn unknown(name: &str, base_dir: &Path) -> InputError {
    let error = InputError::new(format!("unknown material `{name}`")).key("material");
    let path = base_dir.join(name);
    if text_file::is_hdf5(&path) {
        return error.help("this is an HDF5 file; `barwave report` and `barwave compare` read result files");
    }
    if text_file::is_file(&path) {
        let help = format!(
            "a material file ends in .toml; of the record of a test, `barwave materials import \"{name}\" --density ...` makes one"
        );
        return error.help(help);
    }
    let user = user_names(base_dir);
    let mut known: Vec<&str> = names().chain(ALIASES.iter().map(|(alias, _)| *alias)).collect();
    known.extend(user.iter().map(String::as_str));
    let help = match nearest(name, known) {
        Some(near) => format!("did you mean `{near}`? `material::library::names` lists them"),
        None => "`material::library::names` lists them; a path to a material file ends in .toml".into(),
    };
    error.help(help)
}
