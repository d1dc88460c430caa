//! Conversion of a material file to a checked [`Material`].

use std::path::Path;

use super::branch::{Branch, Given};
use super::keys::Keys;
use super::raw::{Confidence, RawMaterial, RawSource};
use super::{Loading, Material, Measure, Provenance, Sense, constants, scatter};
use crate::error::Result;
use crate::input::Document;

/// Reads one material file. A file without the key `name` is named by its file stem.
///
/// # Errors
/// An [`InputError`](crate::error::InputError) with file, line, key, value and allowed values.
pub fn read(path: &Path) -> Result<Material> {
    of_document(&Document::read(path)?, path)
}

/// Reads a material from standard input.
///
/// # Errors
/// As for [`read`].
pub fn read_stdin() -> Result<Material> {
    of_document(&Document::read_scene(Path::new("-"))?, Path::new("stdin.toml"))
}

/// Reads a material from the text of a file.
///
/// # Errors
/// As for [`read`].
pub fn of_document(document: &Document, path: &Path) -> Result<Material> {
    let base = path.parent().unwrap_or(Path::new(""));
    let stem = path.file_stem().map_or_else(|| "material".to_owned(), |s| s.to_string_lossy().into_owned());
    parse(document, &stem, base, &path.display().to_string())
}

/// Reads a material from a document; `stem` is its name if the document has none, `origin` its provenance.
pub(super) fn parse(document: &Document, stem: &str, base: &Path, origin: &str) -> Result<Material> {
    let raw: RawMaterial = document.parse()?;
    let named = raw.name.is_some();
    let mut material = resolve(raw, document, "", base)?;
    if !named {
        stem.clone_into(&mut material.name);
    }
    origin.clone_into(&mut material.provenance.origin);
    Ok(material)
}

/// Checks a material that is given in `doc` under `key_prefix` (empty for a file of its own, "bar.material" in a scene). CSV files are relative to
/// `base_dir`.
///
/// # Errors
/// An [`InputError`](crate::error::InputError) with file, line, key, value and allowed values.
pub fn resolve(raw: RawMaterial, doc: &Document, key_prefix: &str, base_dir: &Path) -> Result<Material> {
    let keys = Keys { doc, prefix: key_prefix, base_dir };
    let modulus = keys.si(&raw.modulus)?;
    let given = Given::read("curve", &raw, &raw.curve, keys)?;
    let loading = raw.loading.as_ref().map_or(Loading::Axial, |l| *l.get_ref());
    if loading == Loading::Shear {
        no_senses_in_shear(&raw, &given, keys)?;
    }
    let sense = given.sense;
    let main = given.branch(sense, modulus, keys)?;
    let compression = compression(&raw, &given, modulus, keys)?;
    let steepest = compression.iter().map(|c| c.curve.steepest()).fold(main.curve.steepest(), f64::max);
    let errors = [main.error, compression.as_ref().map_or(main.error, |c| c.error)];
    let constants = constants::resolve(&raw, given.describe(), keys)?;
    let scatter = raw.band.map(|band| scatter::resolve(band, main.curve.beyond(), keys)).transpose()?;
    Ok(Material {
        density: keys.si(&raw.density)?,
        modulus: modulus.unwrap_or(steepest),
        loading,
        sense,
        poisson: keys.si(&raw.poisson)?,
        table_error: errors[0].max(errors[1]),
        branch_errors: errors,
        shear_from_tension: None,
        constants,
        heating: None,
        scatter: scatter.map(Box::new),
        tension: main.curve,
        compression: compression.map(|c| c.curve),
        provenance: provenance(raw.source),
        name: raw.name.unwrap_or_else(|| "inline".into()),
        description: raw.description.unwrap_or_default(),
    })
}

/// Rejects keys of senses and true measures in a shear curve: it is the same in both senses, and is always in engineering measure.
fn no_senses_in_shear(raw: &RawMaterial, main: &Given<'_>, keys: Keys<'_>) -> Result<()> {
    let curve = raw.curve.get_ref();
    let (key, span, why) = if let Some(compression) = &raw.compression {
        ("compression", compression.span(), "a shear curve applies in both senses and has no compression branch")
    } else if let Some(symmetry) = &raw.symmetry {
        ("symmetry", symmetry.span(), "a shear curve applies in both senses")
    } else if let Some(sense) = raw.sense.as_ref().or(curve.sense.as_ref()) {
        ("sense", sense.span(), "a shear curve applies in both senses")
    } else if let (Measure::True, Some(measure)) = (main.measure, raw.measure.as_ref().or(curve.measure.as_ref())) {
        ("measure", measure.span(), "a shear curve is in engineering shear strain")
    } else {
        return Ok(());
    };
    Err(keys.error(span, key, why).help(format!("remove `{key}`, or remove loading = \"shear\"")).into())
}

/// Returns the compression branch: its own curve, or the same true curve converted to compression; `None` if there is neither.
fn compression(raw: &RawMaterial, main: &Given<'_>, modulus: Option<f64>, keys: Keys<'_>) -> Result<Option<Branch>> {
    let symmetry = raw.symmetry.as_ref();
    let refuse = |span, key: &str, message: &str, help: &str| Err(keys.error(span, key, message).help(help).into());
    if let Some(curve) = &raw.compression {
        if main.sense == Sense::Compression {
            return refuse(
                curve.span(),
                "compression",
                "`[curve]` is already the compression curve",
                "remove one of them",
            );
        }
        if let Some(symmetry) = symmetry {
            return refuse(symmetry.span(), "symmetry", "`[compression]` is given as well", "remove one of the two");
        }
        let given = Given::read("compression", raw, curve, keys)?;
        return given.branch(Sense::Compression, modulus, keys).map(Some);
    }
    let Some(symmetry) = symmetry.filter(|s| *s.get_ref() == Measure::True) else { return Ok(None) };
    if main.measure != Measure::True {
        return refuse(
            symmetry.span(),
            "symmetry",
            "the curve is not in true measures",
            "set measure = \"true\" if the table \
                                                                                         has true stress and true strain",
        );
    }
    if main.sense == Sense::Compression {
        let help = "remove `symmetry`: the engineering curve then applies in tension, too";
        return refuse(symmetry.span(), "symmetry", "the curve was measured in compression", help);
    }
    main.branch(Sense::Compression, modulus, keys).map(Some)
}

fn provenance(source: Option<RawSource>) -> Provenance {
    let source = source.unwrap_or_default();
    let confidence = source.confidence.map_or("", |c| match c {
        Confidence::Measured => "measured",
        Confidence::Fitted => "fitted",
        Confidence::Handbook => "handbook",
    });
    Provenance {
        citation: source.citation.unwrap_or_default(),
        measured: source.measured.unwrap_or_default(),
        confidence: confidence.into(),
        origin: "inline".into(),
    }
}
