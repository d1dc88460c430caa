//! Conversion of materials and curves made in a program to the tables of a material file.

use toml::{Table, Value};

use super::{Beyond, Curve, HeatConstants, Loading, Material, Provenance, Scatter, Sense, TestCurve};

impl Material {
    /// Returns the material as the table of a material file, which the key `material` of a scene accepts: numbers in SI, the curve as a table of
    /// rows. When it is read again, it has the same numbers, except that rows of the elastic line may be moved onto it by rounding, as those of any
    /// file. For a material made from a law, the table states the curve, not the law; for a heated material, it states the material before heating.
    ///
    /// ```
    /// use barwave::material::{Beyond, Curve, Material};
    /// use barwave::scene::Scene;
    ///
    /// let curve = Curve::new(&[(0.0015, 300e6), (0.05, 380e6)], Beyond::Extend)?;
    /// let steel = Material { poisson: Some(0.29), ..Material::from_curve("my steel", 7850.0, curve)? };
    /// let scene = Scene::builder()
    ///     .set("bar.length", 1.0)
    ///     .set("bar.material", steel.to_table())
    ///     .set("left.kind", "velocity")
    ///     .set("left.value", -20.0)
    ///     .set("right.kind", "free")
    ///     .set("solve.until", 1e-4)
    ///     .build()?;
    /// assert_eq!(scene.bar.segments[0].material.tension, steel.tension);
    /// # Ok::<(), barwave::error::Error>(())
    /// ```
    pub fn to_table(&self) -> Table {
        let (main, compression) = self.curves_of_file();
        // A shear curve has no sense.
        let one_sense = compression.is_none() && self.loading == Loading::Axial;
        let of_compression = one_sense && self.sense == Sense::Compression;
        table([
            ("name", text(&self.name)),
            ("description", text(&self.description)),
            ("density", Some(self.density.into())),
            ("modulus", Some(self.modulus.into())),
            ("loading", (self.loading == Loading::Shear).then(|| "shear".into())),
            ("sense", of_compression.then(|| self.sense.name().into())),
            ("poisson", self.poisson.map(Value::from)),
            ("curve", Some(main.into())),
            ("compression", compression.map(Value::from)),
            ("rate", some(self.rates_of_file())),
            ("heat", some(self.constants.heat.to_table())),
            ("band", self.scatter.as_ref().map(|scatter| scatter.to_table().into())),
            ("source", some(self.provenance.to_table())),
        ])
    }

    /// Returns the curves before heating, the main one first.
    fn curves_of_file(&self) -> (&Curve, Option<&Curve>) {
        let current = (&self.tension, self.compression.as_ref());
        let cold = self.heating.as_ref().and_then(|heating| heating.cold.split_first());
        cold.map_or(current, |(main, other)| (main, other.first()))
    }

    /// Returns the rate laws by their names, converted to the loading of the curve.
    fn rates_of_file(&self) -> Table {
        let laws = self.constants.rate.iter();
        laws.filter_map(|&law| self.shear_from_tension.map_or(law, |ratio| law.in_shear(ratio)).to_entry()).collect()
    }
}

impl Curve {
    /// Returns the curve as the table that the key `curve` of a material accepts, including the behaviour after its last row.
    pub fn to_table(&self) -> Table {
        let beyond = match self.beyond() {
            Beyond::Rupture => "rupture",
            Beyond::Extend => "extend",
            Beyond::Error => "error",
        };
        // The origin is omitted.
        let rows = self.strain().iter().zip(self.stress()).skip(1);
        table([("table", Some(list_of_pairs(rows))), ("beyond", Some(beyond.into()))])
    }
}

impl HeatConstants {
    fn to_table(self) -> Table {
        let number = |value: Option<f64>| value.map(Value::from);
        table([
            ("specific-heat", number(self.specific_heat)),
            ("fraction", number(self.fraction)),
            ("reference-temperature", number(self.reference_temperature)),
            ("melting-temperature", number(self.melting_temperature)),
            ("m", number(self.exponent)),
        ])
    }
}

impl Scatter {
    fn to_table(&self) -> Table {
        let deviation = list_of_pairs(self.deviation.iter().map(|(strain, stress)| (strain, stress)));
        let tests: Vec<Table> = self.tests.iter().map(TestCurve::to_table).collect();
        table([
            ("deviation", (!self.deviation.is_empty()).then_some(deviation)),
            ("test", (!tests.is_empty()).then(|| tests.into())),
        ])
    }
}

impl TestCurve {
    fn to_table(&self) -> Table {
        let of_test = table([("record", text(&self.record)), ("modulus", Some(self.modulus.into()))]);
        of_test.into_iter().chain(self.curve.to_table()).collect()
    }
}

impl Provenance {
    /// The origin of the table is not one of its keys.
    fn to_table(&self) -> Table {
        table([
            ("citation", text(&self.citation)),
            ("measured", text(&self.measured)),
            ("confidence", text(&self.confidence)),
        ])
    }
}

impl From<&Material> for Value {
    /// Converts by [`Material::to_table`].
    fn from(material: &Material) -> Self {
        Self::Table(material.to_table())
    }
}

impl From<&Curve> for Value {
    /// Converts by [`Curve::to_table`].
    fn from(curve: &Curve) -> Self {
        Self::Table(curve.to_table())
    }
}

/// Returns a table of the entries that have a value.
fn table<const N: usize>(entries: [(&str, Option<Value>); N]) -> Table {
    entries.into_iter().filter_map(|(key, value)| Some((key.to_owned(), value?))).collect()
}

fn text(text: &str) -> Option<Value> {
    (!text.is_empty()).then(|| text.into())
}

fn some(table: Table) -> Option<Value> {
    (!table.is_empty()).then_some(Value::Table(table))
}

fn list_of_pairs<'a>(rows: impl Iterator<Item = (&'a f64, &'a f64)>) -> Value {
    rows.map(|(&strain, &stress)| vec![strain, stress]).collect::<Vec<_>>().into()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::input::Document;
    use crate::material::{file, library};

    /// The material of a file with this table.
    fn read(material: &Material) -> Material {
        let document = Document::new("made.toml", material.to_table().to_string());
        file::parse(&document, "made", Path::new(""), "made.toml")
            .unwrap_or_else(|e| panic!("{}: {e:?}", material.name))
    }

    fn assert_same(again: &Material, material: &Material) {
        let name = &material.name;
        assert_eq!((&again.name, &again.description, again.loading), (name, &material.description, material.loading));
        assert_eq!((again.sense, again.density), (material.sense, material.density), "{name}");
        assert_eq!((again.modulus, again.poisson), (material.modulus, material.poisson), "{name}");
        assert_eq!(again.tension, material.tension, "{name}");
        assert_eq!(again.compression, material.compression, "{name}");
        assert_eq!(again.constants.rate, material.constants.rate, "{name}");
        assert_eq!(again.constants.heat, material.constants.heat, "{name}");
        assert_eq!(again.scatter, material.scatter, "{name}");
        assert_eq!(again.provenance.citation, material.provenance.citation, "{name}");
    }

    fn in_library(name: &str) -> Material {
        library::find(name, Path::new("")).expect("a material")
    }

    #[test]
    fn every_material_of_the_library_is_read_back_with_the_same_numbers() {
        for name in library::names() {
            let material = in_library(name);
            assert_same(&read(&material), &material);
        }
    }

    #[test]
    fn a_compression_curve_and_the_scatter_of_tests_are_read_back() {
        let rows = |scale: f64| [(0.001, 200e6), (0.1 * scale, 400e6 * scale), (0.2 * scale, 380e6 * scale)];
        let curve = |scale: f64, beyond| Curve::new(&rows(scale), beyond).expect("a curve");
        let test = |record: &str, scale: f64| TestCurve {
            record: record.into(),
            modulus: 200e9,
            density: None,
            curve: curve(scale, Beyond::Error),
        };
        let made = Material {
            compression: Some(curve(1.1, Beyond::Extend)),
            scatter: Some(Box::new(Scatter {
                deviation: vec![(0.01, 1e6), (0.1, 3e6)],
                tests: vec![test("a", 1.0), test("b", 0.9)],
            })),
            ..Material::from_curve("made", 7850.0, curve(1.0, Beyond::Rupture)).expect("a material")
        };
        assert_same(&read(&made), &made);
        let one_sense = Material { sense: Sense::Compression, compression: None, ..made };
        assert_same(&read(&one_sense), &one_sense);
    }

    #[test]
    fn a_heated_material_is_stated_cold_and_a_curve_in_shear_with_the_rates_of_shear() {
        let steel = in_library("steel-4340-jc");
        let heated = steel.heated(None).expect("all constants are there");
        assert_ne!(heated.tension, steel.tension);
        assert_same(&read(&heated), &steel);
        let shear = Material { poisson: Some(0.3), ..steel }.in_shear().expect("all is there");
        let (ratio, again) = (shear.shear_from_tension.expect("it is converted"), read(&shear));
        assert_eq!((&again.tension, again.modulus), (&shear.tension, shear.modulus));
        let rates = shear.constants.rate.iter().map(|law| law.in_shear(ratio)).collect::<Vec<_>>();
        assert!(!rates.is_empty() && again.constants.rate == rates, "{rates:?}");
    }
}
