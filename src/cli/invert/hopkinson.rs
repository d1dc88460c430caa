//! `barwave invert hopkinson`.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::shared::{self, Outputs};
use crate::cli::critical::SenseArg;
use crate::cli::lines::Lines;
use crate::cli::options::OptionOf;
use crate::cli::result_file::is_result;
use crate::cli::{output, quantity};
use crate::error::{InputError, Result};
use crate::material::{Curve, Sense};
use crate::report;
use crate::study::invert::hopkinson::{
    ElasticBar, Knot, Moment, Options, Records, Reduced, Setup, Test, records_from_csv, reduce,
};
use crate::study::invert::{MaterialText, MeasuredKnot, SEED, against_knots, with_elastic_part};
use crate::units::{Dimension, System, format, in_units};

/// Options of `barwave invert hopkinson`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave invert hopkinson runs/out/split-hopkinson.h5 --plot test.png -o copper-dynamic.toml\n  \
    barwave invert hopkinson test.csv --bar-modulus \"200 GPa\" --bar-density \"7850 kg/m^3\" --bar-diameter 16mm \\\n      \
    --distances 1m,1m --specimen-length 4mm --specimen-diameter 10mm --density \"8960 kg/m^3\""
)]
pub(super) struct Args {
    /// Result file of a split-Hopkinson scene; or CSV with the time, the strain of the incident bar and that of the transmission bar
    /// (headers name units: `time_us,incident (ue),transmitted (ue)`).
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Gauges of the result file: incident, transmitted (default: the first on each bar).
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',')]
    gauges: Vec<String>,
    /// Modulus of the bars.
    #[arg(long, value_parser = quantity::positive(Dimension::Stress))]
    bar_modulus: Option<f64>,
    /// Density of the bars.
    #[arg(long, value_parser = quantity::positive(Dimension::Density))]
    bar_density: Option<f64>,
    /// Diameter of the bars.
    #[arg(long, value_parser = quantity::positive(Dimension::Length))]
    bar_diameter: Option<f64>,
    /// Distances of the gauges on the incident and on the transmission bar from the specimen.
    #[arg(long, value_name = "X,X", value_delimiter = ',', value_parser = quantity::positive(Dimension::Length))]
    distances: Vec<f64>,
    /// Length of the specimen.
    #[arg(long, value_parser = quantity::positive(Dimension::Length))]
    specimen_length: Option<f64>,
    /// Diameter of the specimen.
    #[arg(long, value_parser = quantity::positive(Dimension::Length))]
    specimen_diameter: Option<f64>,
    /// Density of the specimen, for the material file and, with --modulus, for its transit time (default: that of the result file).
    #[arg(long, value_parser = quantity::positive(Dimension::Density))]
    density: Option<f64>,
    /// Sense of the test, for records in which compression is positive (default: positive strains are tension).
    #[arg(long, value_enum)]
    sense: Option<SenseArg>,
    /// Elastic modulus of the specimen, for the elastic part of the material file and, with --density, for its transit time (default: that of the
    /// result file).
    #[arg(long, value_parser = quantity::positive(Dimension::Stress))]
    modulus: Option<f64>,
    /// Length of the reduction (default: that of the incident pulse).
    #[arg(long, value_parser = quantity::positive(Dimension::Time))]
    window: Option<f64>,
    /// Largest difference of the forces on the two faces, over their mean, that counts as equilibrium.
    #[arg(long, default_value_t = Options::EQUILIBRIUM, value_parser = quantity::positive(Dimension::None))]
    equilibrium: f64,
    /// Poisson's ratio of the bars, for the estimate of their dispersion.
    #[arg(long, default_value_t = Options::POISSON, value_parser = quantity::not_negative(Dimension::None))]
    poisson: f64,
    /// Seed of --noise.
    #[arg(long, default_value_t = SEED)]
    seed: u64,
    /// Add normally distributed noise to the records, with a standard deviation of this fraction of the largest strain of each record, e.g. "1 %".
    #[arg(long, value_name = "PART", value_parser = quantity::not_negative(Dimension::None))]
    noise: Option<f64>,
    #[command(flatten)]
    outputs: Outputs,
}

/// Library arguments that are set by command-line options.
pub(super) const OPTIONS: &[OptionOf<'static>] = &[
    ("incident.modulus", "--bar-modulus", ""),
    ("incident.density", "--bar-density", ""),
    ("incident.area", "--bar-diameter", ""),
    ("incident.distance", "--distances", ""),
    ("transmitted.distance", "--distances", ""),
    ("length", "--specimen-length", ""),
    ("area", "--specimen-diameter", ""),
    ("window", "--window", ""),
    ("equilibrium", "--equilibrium", ""),
    ("poisson", "--poisson", ""),
    ("speed", "--modulus", ""),
    ("gauges", "--gauges", "e.g. --gauges INCIDENT,TRANSMITTED"),
];

pub(super) fn run(args: &Args) -> Result<()> {
    args.outputs.check()?;
    let (setup, records, test) = if is_result(&args.file) {
        nothing_that_the_result_has(args)?;
        let test = Test::from_result(&shared::result_of_bar(&args.file)?, &args.gauges)?;
        (test.setup.clone(), test.records.clone(), Some(test))
    } else {
        (setup(args)?, records_from_csv(&args.file)?, None)
    };
    let records: Records = match args.noise {
        Some(part) => records.with_noise(part, args.seed),
        None => records,
    };
    let modulus = args.modulus.or(test.as_ref().map(|t| t.modulus));
    let density = args.density.or(test.as_ref().map(|t| t.density));
    let options = Options {
        window: args.window,
        limit: test.as_ref().map(|t| t.limit),
        equilibrium: args.equilibrium,
        poisson: args.poisson,
        speed: modulus.zip(density).map(|(modulus, density)| (modulus / density).sqrt()),
    };
    let mut reduced = reduce(&setup, &records, &options).map_err(|error| shared::in_file(error, &args.file))?;
    reduced.sense = args.sense.map_or(reduced.sense, Into::into);
    write(args, &mut reduced, test.as_ref())
}

/// Refuses options that describe the test of a CSV file, since a result file contains these values.
fn nothing_that_the_result_has(args: &Args) -> Result<()> {
    let given = [
        ("--bar-modulus", args.bar_modulus.is_some()),
        ("--bar-density", args.bar_density.is_some()),
        ("--bar-diameter", args.bar_diameter.is_some()),
        ("--distances", !args.distances.is_empty()),
        ("--specimen-length", args.specimen_length.is_some()),
        ("--specimen-diameter", args.specimen_diameter.is_some()),
        ("--sense", args.sense.is_some()),
    ];
    let keys: Vec<_> = given.into_iter().filter_map(|(key, set)| set.then_some(key)).collect();
    let Some(key) = keys.first() else { return Ok(()) };
    let message =
        std::format!("{} is a result file, which states bars, specimen and gauges itself", args.file.display());
    let help = std::format!("leave out {}, or give the records as CSV", keys.join(", "));
    Err(InputError::new(message).key(*key).allowed("with CSV files only").help(help).into())
}

/// Returns the sense of the test and how it was determined.
fn sense(args: &Args, reduced: &Reduced, test: Option<&Test>) -> String {
    let sense = reduced.sense.name();
    if test.is_some() {
        return sense.into();
    }
    if args.sense.is_some() {
        return std::format!("{sense} (by --sense)");
    }
    let (sign, other) = match reduced.sense {
        Sense::Tension => ("positive", "compression"),
        Sense::Compression => ("negative", "tension"),
    };
    std::format!("{sense}, since the incident pulse is {sign}; if {other} is {sign} in the records: --sense {other}")
}

fn setup(args: &Args) -> Result<Setup> {
    let circle = |diameter: f64| 0.25 * std::f64::consts::PI * diameter * diameter;
    let [first, second] = args.distances.as_slice() else {
        let message = match args.distances.len() {
            0 => "--distances is missing".to_owned(),
            1 => "only 1 gauge distance is given".to_owned(),
            count => std::format!("{count} gauge distances are given"),
        };
        return Err(InputError::new(message)
            .key("--distances")
            .allowed("2 distances from the specimen")
            .help("such as --distances 1m,1m: incident bar, transmission bar")
            .into());
    };
    let modulus = shared::needed(args.bar_modulus, "--bar-modulus", "200 GPa")?;
    let density = shared::needed(args.bar_density, "--bar-density", "7850 kg/m^3")?;
    let area = circle(shared::needed(args.bar_diameter, "--bar-diameter", "16 mm")?);
    let bar = |&distance: &f64| ElasticBar { modulus, density, area, distance };
    Ok(Setup {
        incident: bar(first),
        transmitted: bar(second),
        length: shared::needed(args.specimen_length, "--specimen-length", "4 mm")?,
        area: circle(shared::needed(args.specimen_diameter, "--specimen-diameter", "10 mm")?),
    })
}

/// Returns the knots of the material, with an elastic part for the strains before equilibrium, and a sentence on this part.
fn knots(modulus: Option<f64>, reduced: &Reduced) -> (Vec<MeasuredKnot>, Option<String>) {
    let knot = |k: &Knot| MeasuredKnot {
        strain: k.strain,
        stress: k.stress,
        interval: [k.stress - k.half_width, k.stress + k.half_width],
    };
    let measured: Vec<_> = reduced.curve.iter().map(knot).collect();
    let Some(first) = measured.first().copied() else { return (measured, None) };
    let show = |stress| format(stress, Dimension::Stress, System::Si);
    let Some(modulus) = modulus else {
        let slope = show(first.stress / first.strain);
        let sentence = std::format!(
            "the material has no elastic part: its curve starts at strain {:.4}, and the slope up to there, {slope}, is its modulus; \
             give that of the specimen with --modulus",
            first.strain
        );
        return (measured, Some(sentence));
    };
    let whole = with_elastic_part(&measured, modulus);
    let sentence = |knee: &MeasuredKnot| {
        let part = std::format!("up to {} with a modulus of {}", show(knee.stress), show(modulus));
        if knee.strain < first.strain {
            return std::format!(
                "{part}, where the line of the first rows meets it: nothing is measured below strain {:.4}",
                first.strain
            );
        }
        std::format!("{part}, with which the measured stresses agree up to there within their intervals")
    };
    let sentence = whole.first().map(sentence);
    (whole, sentence)
}

/// Writes the material file. Fails if the specimen does not reach equilibrium.
fn write_material(args: &Args, reduced: &Reduced, test: Option<&Test>, knots: &[MeasuredKnot]) -> Result<()> {
    let outputs = &args.outputs;
    let rate = reduced.mean_rate.ok_or_else(|| {
        InputError::new("there is no curve to write: the specimen does not reach equilibrium")
            .key("-o")
            .help("see --equilibrium")
    })?;
    let material = MaterialText {
        name: &outputs.name(),
        description: "Split-Hopkinson test",
        density: shared::needed(args.density.or(test.map(|t| t.density)), "--density", "8960 kg/m^3")?,
        modulus: args.modulus.or(test.map(|t| t.modulus)),
        sense: reduced.sense.name(),
        measured: &std::format!("split-Hopkinson bar, mean strain rate {rate:.0} 1/s, {}", args.file.display()),
    };
    outputs.write_material(&material, knots)
}

fn write(args: &Args, reduced: &mut Reduced, test: Option<&Test>) -> Result<()> {
    let outputs = &args.outputs;
    let modulus = args.modulus.or(test.map(|t| t.modulus));
    let (knots, elastic) = knots(modulus, reduced);
    if outputs.output.is_some() {
        write_material(args, reduced, test, &knots)?;
        reduced.warnings.extend(elastic.clone().filter(|_| modulus.is_none()));
    }
    let elastic = elastic.filter(|_| outputs.output.is_some() && modulus.is_some());
    let reduced = &*reduced;
    let given = test.and_then(|t| t.given.as_ref());
    let title = "Split-Hopkinson reduction";
    outputs.write(
        title,
        || report::invert::hopkinson(title, reduced, given, outputs.units),
        || csv(&reduced.moments),
    )?;
    if outputs.json {
        return output::json(reduced);
    }
    output::note(&shared::warnings(&reduced.warnings, outputs.units));
    let mut lines = lines(args, reduced, test, given);
    if let Some(sentence) = elastic {
        lines.add("elastic part", in_units(&sentence, outputs.units));
    }
    lines.extend(outputs.written(&knots));
    output::text(&(lines.text() + &table(&reduced.moments, reduced.loading_until_s, outputs.units)))
}

fn lines(args: &Args, reduced: &Reduced, test: Option<&Test>, given: Option<&Curve>) -> Lines {
    let show = |value, dimension| args.outputs.show(value, dimension);
    let mut lines = Lines::under(&std::format!("Split-Hopkinson reduction, {}", args.file.display()));
    let setup = &reduced.setup;
    let size = show(setup.length, Dimension::Length);
    let material = test.map_or("", |t| t.material.as_str());
    lines.add("specimen", std::format!("{material} {size} long, section {}", show(setup.area, Dimension::Area)).trim());
    lines.add("sense", sense(args, reduced, test));
    let shifts = [setup.incident, setup.transmitted].map(|bar| show(bar.distance / bar.c0(), Dimension::Time));
    lines.add(
        "gauge delays",
        std::format!(
            "{} incident, {} transmitted, at c0 = {}",
            shifts[0],
            shifts[1],
            show(setup.incident.c0(), Dimension::Velocity)
        ),
    );
    lines.add("window", std::format!("{} after arrival of the pulse", show(reduced.window_s, Dimension::Time)));
    let pair = |[a, b]: [f64; 2]| std::format!("{} incident, {} transmitted", shared::micro(a), shared::micro(b));
    lines.add("zero offsets", std::format!("{}, removed", pair(reduced.zero_offsets)));
    lines.add("noise", std::format!("{} before the pulses", pair(reduced.noise)));
    lines.add(
        "dispersion",
        std::format!("not corrected; spreads sharp fronts over {}", show(reduced.dispersion_s, Dimension::Time)),
    );
    if let (Some(time), Some(strain), Some(imbalance), Some(rate)) =
        (reduced.equilibrium_from_s, reduced.equilibrium_from_strain, reduced.imbalance, reduced.mean_rate)
    {
        let time = show(time, Dimension::Time);
        let until = match reduced.equilibrium_until_s {
            Some(until) => std::format!("to {}", show(until, Dimension::Time)),
            None => "on".into(),
        };
        lines.add(
            "equilibrium",
            std::format!(
                "from {time} (strain {strain:.4}) {until}; the faces differ by {:.1} % at most",
                100.0 * imbalance
            ),
        );
        let between = reduced.mean_rate_between_s.unwrap_or_default().map(|time| show(time, Dimension::Time));
        lines.add("mean strain rate", std::format!("{rate:.0} 1/s, from {} to {}", between[0], between[1]));
    }
    let loaded = reduced.moments.iter().take_while(|m| m.time_s <= reduced.loading_until_s).last();
    if let Some(last) = loaded.filter(|last| last.time_s < reduced.window_s) {
        let time = show(last.time_s, Dimension::Time);
        lines.add("loading", std::format!("until {time}, strain {:.4}; the table ends there", last.strain));
    }
    if let Some((deviation, strain)) = given.and_then(|curve| against_knots(curve, &reduced.curve)) {
        let what = match test {
            Some(test) if test.rate => "static curve, to which the rate law adds",
            _ => "simulated curve",
        };
        lines.add(
            "deviation",
            std::format!("at most {:+.1} % from the {what}, at strain {strain:.4}", 100.0 * deviation),
        );
    }
    lines
}

/// Approximate number of rows in the printed table, up to the end of the loading; CSV has all moments.
const ROWS: usize = 12;

fn table(moments: &[Moment], until: f64, units: System) -> String {
    let stress = units.of_columns(Dimension::Stress);
    let loaded = &moments[..moments.partition_point(|m| m.time_s <= until)];
    let every = (loaded.len() / ROWS).max(1);
    let rows: Vec<Vec<String>> = loaded
        .iter()
        .skip(every)
        .step_by(every)
        .map(|m| {
            let shown = |pa: f64| std::format!("{:.1}", stress.of(pa));
            vec![
                std::format!("{:.1}", 1e6 * m.time_s),
                std::format!("{:.4}", m.strain),
                std::format!("{:.0}", m.rate),
                shown(m.stress),
                std::format!("{:.4}", m.strain_one_wave),
                std::format!("{:.0}", m.rate_one_wave),
                shown(m.stress_one_wave),
                faces_differ(m),
            ]
        })
        .collect();
    let headings = [
        "t us",
        "strain",
        "rate 1/s",
        &std::format!("stress {}", stress.symbol),
        "strain (1w)",
        "rate (1w)",
        "stress (1w)",
        "faces differ %",
    ];
    output::table(&headings, &rows, 0, false)
}

/// Returns the difference of the forces on the two faces over their mean, percent; a dash if it is not finite.
fn faces_differ(m: &Moment) -> String {
    let difference =
        200.0 * (m.stress_incident_face - m.stress_one_wave) / (m.stress_incident_face + m.stress_one_wave);
    output::fixed(Some(difference).filter(|d| d.is_finite()), 1)
}

fn csv(moments: &[Moment]) -> String {
    let mut text = String::from(
        "time_s,strain,rate_1_s,stress_Pa,strain_one_wave,rate_one_wave_1_s,stress_one_wave_Pa,stress_incident_face_Pa,\
         incident,reflected,transmitted\n",
    );
    for m in moments {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{}",
            m.time_s,
            m.strain,
            m.rate,
            m.stress,
            m.strain_one_wave,
            m.rate_one_wave,
            m.stress_one_wave,
            m.stress_incident_face,
            m.incident,
            m.reflected,
            m.transmitted
        );
    }
    text
}
