//! `barwave invert residual-strain`.

use std::path::PathBuf;

use super::shared::{self, Outputs, Random, Waves};
use crate::cli::lines::Lines;
use crate::cli::options::OptionOf;
use crate::cli::quantity;
use crate::cli::result_file::is_result;
use crate::error::{InputError, Result};
use crate::material::Curve;
use crate::study::invert::residual::{Inverted, Options, Profile, State, Test, invert};
use crate::study::invert::{MaterialText, from_waves};
use crate::units::Dimension;

const TITLE: &str = "Curve from the strain along a wire";

/// Options of `barwave invert residual-strain`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  barwave invert residual-strain wire.h5 -o copper.toml\n  \
    barwave invert residual-strain wire.csv --velocity \"40 m/s\" --duration \"600 us\" --density \"8960 kg/m^3\" --modulus \
    \"115 GPa\"\n  \
    barwave invert residual-strain moving.csv --velocity \"40 m/s\" --time \"400 us\" ...    # the end still moves")]
pub(super) struct Args {
    /// Result file (its last frame, or that at --time), or CSV with the columns x (from the struck end) and strain.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Impact velocity (default: that of the result file).
    #[arg(long, value_parser = quantity::positive(Dimension::Velocity))]
    velocity: Option<f64>,
    /// Duration of the impact: FILE holds the plastic strain left after the end was released (default: that of the result file).
    #[arg(long, value_parser = quantity::positive(Dimension::Time), conflicts_with = "time")]
    duration: Option<f64>,
    /// Time since the impact: FILE holds the whole strain at this time, while the end still moves.
    #[arg(long, value_parser = quantity::positive(Dimension::Time))]
    time: Option<f64>,
    /// Mass per volume (default: that of the result file).
    #[arg(long, value_parser = quantity::positive(Dimension::Density))]
    density: Option<f64>,
    /// Elastic modulus (default: that of the result file).
    #[arg(long, value_parser = quantity::positive(Dimension::Stress))]
    modulus: Option<f64>,
    /// Length of the wire (default: that of the result file), for the reflected wave.
    #[arg(long, value_parser = quantity::positive(Dimension::Length))]
    length: Option<f64>,
    /// Yield stress; the impact velocity then checks the result (default: from the impact velocity).
    #[arg(long, value_parser = quantity::not_negative(Dimension::Stress))]
    yield_stress: Option<f64>,
    /// Standard error of the impact velocity.
    #[arg(long, default_value = "0 m/s", value_parser = quantity::not_negative(Dimension::Velocity))]
    velocity_error: f64,
    /// Standard error of the position of the struck end.
    #[arg(long, default_value = "0 mm", value_parser = quantity::not_negative(Dimension::Length))]
    position_error: f64,
    #[command(flatten)]
    random: Random,
    #[command(flatten)]
    outputs: Outputs,
}

/// Library arguments that are set by command-line options.
pub(super) const OPTIONS: &[OptionOf<'static>] = &[
    ("profile", "", ""),
    ("velocity", "--velocity", "--time uses the strain while the end moves"),
    ("time", "--time", ""),
    ("density", "--density", ""),
    ("modulus", "--modulus", ""),
    ("length", "--length", ""),
    ("yield_stress", "--yield-stress", ""),
    ("velocity_error", "--velocity-error", ""),
    ("position_error", "--position-error", ""),
    ("replicates", "--replicates", ""),
];

pub(super) fn run(args: &Args) -> Result<()> {
    args.outputs.check()?;
    let test = if is_result(&args.file) {
        Some(Test::from_result(&shared::result_of_bar(&args.file)?, args.time)?)
    } else {
        None
    };
    let profile = match &test {
        Some(test) => test.profile.clone(),
        None => Profile::from_csv(&args.file)?,
    };
    let profile = match args.random.noise {
        Some(part) => profile.with_noise(part, args.random.seed),
        None => profile,
    };
    let options = options(args, test.as_ref())?;
    let mut inverted = invert(&profile, &options).map_err(|error| shared::in_file(error, &args.file))?;
    if let Some(test) = &test {
        inverted.warnings.splice(0..0, test.notes.iter().cloned());
    }
    write(args, &options, &profile, &inverted, test.as_ref().and_then(|t| t.given.as_ref()))
}

fn options(args: &Args, test: Option<&Test>) -> Result<Options> {
    let of = |typed: Option<f64>, own: fn(&Test) -> f64| typed.or(test.map(own));
    let time = of(args.duration.or(args.time.filter(|_| test.is_none())), |t| t.time).ok_or_else(|| {
        InputError::new("neither --duration nor --time is given")
            .key("--duration")
            .help("give --duration for the strain left after the impact, --time for the strain while the end moves")
    })?;
    Ok(Options {
        state: if args.time.is_some() { State::Loaded } else { State::Released },
        time,
        velocity: shared::needed(of(args.velocity, |t| t.velocity), "--velocity", "40 m/s")?,
        velocity_error: args.velocity_error,
        position_error: args.position_error,
        density: shared::needed(of(args.density, |t| t.density), "--density", "8960 kg/m^3")?,
        modulus: shared::needed(of(args.modulus, |t| t.modulus), "--modulus", "115 GPa")?,
        length: of(args.length, |t| t.length),
        yield_stress: args.yield_stress,
        replicates: args.random.replicates,
        seed: args.random.seed,
    })
}

fn write(args: &Args, options: &Options, profile: &Profile, inverted: &Inverted, given: Option<&Curve>) -> Result<()> {
    let outputs = &args.outputs;
    let file = args.file.display();
    let material = MaterialText {
        name: &outputs.name(),
        description: "Inverted from the strain along a wire after an impact",
        density: options.density,
        modulus: Some(options.modulus),
        sense: profile.sense.name(),
        measured: &std::format!("strain along a wire after an impact at {} m/s, {file}", options.velocity),
    };
    let mut knots = from_waves(&inverted.points, options.density, Some(options.modulus));
    if let Some(stress) = inverted.yield_stress {
        knots.insert(0, shared::knot(stress.value / options.modulus, stress));
        knots.dedup_by(|later, first| later.strain <= first.strain);
    }
    let (title, points) = (TITLE, &inverted.points);
    let waves = Waves { title, points, given, warnings: &inverted.warnings };
    outputs.write_waves(&waves, &material, &knots, inverted, lines(args, options, inverted))
}

fn lines(args: &Args, options: &Options, inverted: &Inverted) -> Lines {
    let show = |value, dimension| args.outputs.show(value, dimension);
    let mut lines = Lines::under(&std::format!("{TITLE}, {}", args.file.display()));
    let when = show(options.time, Dimension::Time);
    lines.add(
        "profile",
        match options.state {
            State::Loaded => std::format!("total strain {when} after the impact: c = x/t"),
            State::Released => std::format!("plastic strain after release at {when}: c = x/(t + x/c0)"),
        },
    );
    let integral = inverted.velocity_integral_m_s;
    lines.add("impact velocity", show(inverted.impact_velocity_m_s, Dimension::Velocity));
    lines.add(
        "integral of c",
        if inverted.yield_from_velocity {
            "equals the impact velocity, which gives the yield stress".to_owned()
        } else {
            let unit = args.outputs.units.of_columns(Dimension::Velocity);
            let [value, low, high] = [integral.value, integral.low, integral.high].map(|v| unit.of(v));
            std::format!("{value:.2} {v}, 95 %: {low:.2} to {high:.2} {v}", v = unit.symbol)
        },
    );
    if let Some(stress) = inverted.yield_stress {
        let [value, low, high] = [stress.value, stress.low, stress.high].map(|s| show(s, Dimension::Stress));
        lines.add("yield stress", std::format!("{value}, 95 %: {low} to {high}"));
    }
    lines
}
