//! Invalid scenes through the real binary: exit code 2, and a message with file, line, key, value, range and help.

use std::path::Path;
use std::process::{Command, Output};

/// A valid scene; every case below changes one thing in it.
const RIGHT: &str = r#"title = "A right scene"

[bar]
length = "1 m"
area = "1 cm^2"
material = { name = "steel", density = "7800 kg/m^3", modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.1, "400 MPa"]] } }

[left]
kind = "velocity"
value = "-30 m/s"

[right]
kind = "free"

[effects]
hardening = "isotropic"

[solve]
until = "200 us"
cells = 1000

[record]
frames = 101
fields = ["stress", "velocity"]
gauges = { middle = "0.5 m" }
"#;

/// An invalid scene: `from` is replaced by `to`.
struct Case {
    from: &'static str,
    to: &'static str,
    /// Text of the line that must be shown; empty if the error is about a missing item.
    line: &'static str,
    key: &'static str,
    /// All texts that the message must contain: value, range, help.
    parts: &'static [&'static str],
}

const fn case(
    from: &'static str,
    to: &'static str,
    line: &'static str,
    key: &'static str,
    parts: &'static [&'static str],
) -> Case {
    Case { from, to, line, key, parts }
}

/// Returns a case with another right end.
const fn ball(to: &'static str, line: &'static str, key: &'static str, parts: &'static [&'static str]) -> Case {
    case("kind = \"free\"", to, line, key, parts)
}

/// Line of the material.
const MATERIAL: &str = r#"material = { name = "steel", density = "7800 kg/m^3", modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.1, "400 MPa"]] } }"#;

/// The table `[bar]`.
const UNIFORM: &str = r#"[bar]
length = "1 m"
area = "1 cm^2"
material = { name = "steel", density = "7800 kg/m^3", modulus = "200 GPa", beyond = "extend", curve = { table = [[0.001, "200 MPa"], [0.1, "400 MPa"]] } }
"#;

const CASES: &[Case] = &[
    // Unknown words: the message names the nearest one and the allowed ones.
    case(
        "length =",
        "lenght =",
        "lenght",
        "bar.lenght",
        &["unknown key `lenght`", "did you mean `length`?", "area, diameter"],
    ),
    case("[solve]", "[sovle]", "[sovle]", "sovle", &["unknown key `sovle`", "did you mean `solve`?"]),
    case(
        "cells = 1000",
        "cels = 1000",
        "cels",
        "solve.cels",
        &[
            "did you mean `cells`?",
            "until, method, tolerance, scheme, cells, cfl, audit-tolerance, front-tolerance, max-events",
        ],
    ),
    case(
        "\"free\"",
        "\"fre\"",
        "\"fre\"",
        "right.kind",
        &["unknown value `fre`", "did you mean `free`?", "\"absorbing\""],
    ),
    case(
        "\"isotropic\"",
        "\"isotopic\"",
        "isotopic",
        "effects.hardening",
        &["unknown value `isotopic`", "did you mean `isotropic`?"],
    ),
    case(
        "\"isotropic\"",
        "{ armstrong-frederick = { C = \"300 GPa\", gamma = 100 } }",
        "armstrong-frederick",
        "effects.hardening.armstrong-frederick",
        &["no elastic range is left", "C/gamma = 3 GPa", "less than the flow stress", "reduce C, or increase gamma"],
    ),
    case(
        "\"stress\", ",
        "\"stres\", ",
        "stres",
        "record.fields.0",
        &["unknown value `stres`", "did you mean `stress`?", "\"plastic_strain\""],
    ),
    case(
        "frames = 101",
        "precision = \"f16\"",
        "f16",
        "record.precision",
        &["unknown value `f16`", "\"f64\", \"f32\""],
    ),
    case("cells = 1000", "method = \"fdm\"", "fdm", "solve.method", &["unknown value `fdm`", "did you mean `fd`?"]),
    // Tapers.
    case(
        "\"1 cm^2\"",
        "[[0, \"1 cm^2\"], [\"90 cm\", \"2 cm^2\"]]",
        "area = ",
        "bar.area.1",
        &["the last row is at x = 900 mm", "x = 1 m, the segment's length", "give a row at both"],
    ),
    case(
        "\"1 cm^2\"",
        "[[\"1 cm\", \"1 cm^2\"], [\"1 m\", \"2 cm^2\"]]",
        "area = ",
        "bar.area.0",
        &["row 1 is not at the left end of the segment", "x increasing from 0"],
    ),
    case(
        "\"1 cm^2\"",
        "[[0, \"1 cm^2\"], [0.6, \"2 cm^2\"], [0.4, \"3 cm^2\"], [1, \"1 cm^2\"]]",
        "area = ",
        "bar.area.2",
        &["row 3 does not have a larger x than the row before it", "use two segments"],
    ),
    case(
        "\"1 cm^2\"",
        "[[0, \"1 cm^2\"], [1, \"0 cm^2\"]]",
        "area = ",
        "bar.area.1.area",
        &["0 cm^2 is out of range", "area > 0"],
    ),
    case("\"1 cm^2\"", "[[1, \"1 cm^2\"]]", "area = ", "bar.area.0", &["row 1 is not at"]),
    case("\"1 cm^2\"", "[]", "area = ", "bar.area.0", &["a taper needs a row at each end"]),
    case("\"1 cm^2\"", "[[0, \"1 cm^2\", 3]]", "area = ", "bar.area.0", &["a row has 3 entries", "[x, area]"]),
    case(
        "area = \"1 cm^2\"",
        "diameter = [[0, \"1 cm^2\"], [1, \"2 cm\"]]",
        "diameter = ",
        "bar.diameter.0.diameter",
        &["a length is expected", "diameter > 0"],
    ),
    case("\"1 cm^2\"", "true", "true", "bar.area", &["rows [x, size] of a taper"]),
    // Numbers out of range.
    case(
        "cells = 1000",
        "cfl = 1.5",
        "cfl",
        "solve.cfl",
        &["1.5 is out of range", "allowed: 0 < cfl <= 1", "help: set `cfl`"],
    ),
    case("cells = 1000", "cfl = 0", "cfl", "solve.cfl", &["0 is out of range", "allowed: 0 < cfl <= 1"]),
    case(
        "cells = 1000",
        "cells = 1",
        "cells",
        "solve.cells",
        &["1 is out of range", "allowed: 2 <= cells <= 10000000"],
    ),
    case(
        "cells = 1000",
        "cells = 1000.5",
        "cells",
        "solve.cells",
        &["1000.5 is not a whole number", "e.g. cells = 1001"],
    ),
    case(
        "\"200 us\"",
        "\"-200 us\"",
        "until",
        "solve.until",
        &["-200 us is out of range", "allowed: until > 0", "above zero"],
    ),
    case("\"1 m\"", "0", "length", "bar.length", &["0 is out of range", "allowed: length > 0"]),
    case(
        "\"isotropic\"",
        "{ mixed = 1.5 }",
        "mixed",
        "effects.hardening.mixed",
        &["1.5 is out of range", "allowed: 0 <= mixed <= 1"],
    ),
    case(
        "\"0.5 m\"",
        "\"1.5 m\"",
        "middle",
        "record.gauges.middle",
        &["1.5 m is outside the bar", "0 <= middle <= 1 m", "from the left end"],
    ),
    case(
        "frames = 101",
        "times = [0, \"300 us\"]",
        "times",
        "record.times.1",
        &["300 us is after the end", "<= 200 us", "increase solve.until"],
    ),
    case(
        "frames = 101",
        "frames = 5e6",
        "frames",
        "record.frames",
        &["5000000 frames of 1000 cells and 2 fields are 75 GiB", "at most 64 GiB"],
    ),
    case(
        "kind = \"free\"",
        "kind = \"wall\"\ngap = \"-1 mm\"",
        "gap",
        "right.gap",
        &["-1 mm is out of range", "allowed: gap >= 0"],
    ),
    case("\"200 us\"", "inf", "until", "solve.until", &["inf is not a finite number", "until > 0"]),
    case(
        "frames = 101",
        "every = 1e-17",
        "every",
        "record.every",
        &["frames", "at most 10000000 frames", "longer interval"],
    ),
    // Units.
    case(
        "\"-30 m/s\"",
        "\"-30 m\"",
        "value",
        "left.value",
        &["`-30 m` is a length, but a velocity is expected", "\"80 ft/s\"", "plain number is in m/s"],
    ),
    case("\"1 cm^2\"", "\"1 cm\"", "area", "bar.area", &["`1 cm` is a length, but an area is expected"]),
    case("\"200 us\"", "\"200 uss\"", "until", "solve.until", &["unknown unit `uss`; did you mean `us`?"]),
    case("\"1 m\"", "\"1\"", "length", "bar.length", &["`1` has no unit", "\"10 in\""]),
    case(
        "\"1 m\"",
        "true",
        "length",
        "bar.length",
        &["boolean `true`", "help: write a number, or a string with a unit"],
    ),
    // Keys that require or exclude each other.
    case("[right]\nkind = \"free\"\n", "", "", "right", &["`right` is missing", "both ends are required"]),
    case("until = \"200 us\"\n", "", "[solve]", "solve.until", &["`until` is missing", "add the end time"]),
    case("length = \"1 m\"\n", "", "[bar]", "bar.length", &["`length` is missing", "length = \"1 m\""]),
    case("kind = \"free\"", "", "[right]", "right.kind", &["`kind` is missing", "add `kind` to `[right]`"]),
    case("value = \"-30 m/s\"", "", "[left]", "left.value", &["`value` is missing", "history = "]),
    case(
        "value = \"-30 m/s\"",
        "value = 1\nhistory = [[0, 1]]",
        "history",
        "left.history",
        &["`value` and `history` are both given", "one of value, history, csv", "keep one"],
    ),
    case(
        "value = \"-30 m/s\"",
        "history = [[0, 1], [0]]",
        "history",
        "left.history.1",
        &["a row has 1 entries", "[time, value]"],
    ),
    case(
        "value = \"-30 m/s\"",
        "history = [[1, 1], [0, 1]]",
        "history",
        "left.history.1",
        &["row 2 is earlier than the row before it", "by time"],
    ),
    case(
        "value = \"-30 m/s\"",
        "csv = \"no-such.csv\"",
        "csv",
        "left.csv",
        &["no such file", "relative to the scene file"],
    ),
    case(
        "kind = \"free\"",
        "kind = \"free\"\nvalue = 1",
        "value = 1",
        "right.value",
        &["does not apply to an end of kind \"free\"", "kind alone"],
    ),
    case(
        "area = \"1 cm^2\"",
        "area = 1\ndiameter = 1",
        "diameter",
        "bar.diameter",
        &["both an area and a diameter", "not both"],
    ),
    case(
        "frames = 101",
        "frames = 101\nevery = \"1 us\"",
        "every",
        "record.every",
        &["`frames` and `every` are both given", "keep one"],
    ),
    case(
        "frames = 101",
        "times = [0, 0]",
        "times",
        "record.times.1",
        &["0 is not after the time before it", "in order"],
    ),
    case("\"stress\", ", "\"velocity\", ", "fields", "record.fields.1", &["`velocity` is given twice", "once"]),
    case(
        "hardening = \"isotropic\"\n\n[solve]\nuntil = \"200 us\"\ncells = 1000\n\n[record]\nframes = 101\nfields = [\"stress\"",
        "\n[solve]\nuntil = \"200 us\"\n\n[record]\nfields = [\"plastic_strain\"",
        "plastic_strain",
        "record.fields.0",
        &["`plastic_strain` is not available", "hardening = \"isotropic\""],
    ),
    case(
        "[left]",
        "[[bar.segment]]\nlength = 1\n[left]",
        "length = \"1 m\"",
        "bar.length",
        &["`length` of [bar] cannot be combined with [[bar.segment]]"],
    ),
    // Materials, by name and inline.
    case(MATERIAL, "material = \"copper-anealed\"", "material", "bar.material", &["copper-anealed", "copper-annealed"]),
    case(MATERIAL, "material = \"./none.toml\"", "material", "bar.material", &["none.toml", "no such file"]),
    case(
        "\"7800 kg/m^3\"",
        "\"-7800 kg/m^3\"",
        "density",
        "bar.material.density",
        &["-7800 kg/m^3 is out of range", "density > 0"],
    ),
    case(
        "modulus =",
        "modulsu =",
        "modulsu",
        "bar.material.modulsu",
        &["unknown key `modulsu`", "did you mean `modulus`?"],
    ),
    // Segments.
    case(
        UNIFORM,
        "[[bar.segment]]\nlength = 1\nmaterial = \"mild-steel\"\ngap = \"1 mm\"\n[[bar.segment]]\nlength = 1\nmaterial = \
         \"mild-steel\"\n",
        "\"1 mm\"",
        "bar.segment.0.gap",
        &["a bonded joint has no gap", "joint = \"contact\""],
    ),
    case(
        UNIFORM,
        "[[bar.segment]]\nlength = 1\nmaterial = \"mild-steel\"\narea = 1\n[[bar.segment]]\nlength = 1\nmaterial = \
         \"mild-steel\"\n",
        "[[bar.segment]]",
        "bar.segment.1.area",
        &["other segments have an area", "in every segment, or in none"],
    ),
    case(
        UNIFORM,
        "[[bar.segment]]\nlength = 1\nmaterial = \"mild-steel\"\nstress-concentration = 0.5\n",
        "stress-concentration",
        "bar.segment.0.stress-concentration",
        &["fracture is not simulated", "rupture"],
    ),
    case(
        UNIFORM,
        "[[bar.segment]]\nlength = 1\nmaterial = \"mild-steel\"\njoint = \"bonded\"\n",
        "joint",
        "bar.segment.0.joint",
        &["no next segment"],
    ),
    case(UNIFORM, "[bar]\nsegment = []\n", "[bar]", "bar.segment", &["the bar has no segment"]),
    // Bodies at the ends.
    case(
        "kind = \"free\"",
        "kind = \"striker\"\nvelocity = \"-5 m/s\"",
        "[right]",
        "right.mass",
        &["`mass` is missing", "mass = \"200 lb\""],
    ),
    case(
        "kind = \"free\"",
        "kind = \"striker\"\nmass = 0\nvelocity = -5",
        "mass",
        "right.mass",
        &["0 is out of range", "mass > 0"],
    ),
    case(
        "kind = \"free\"",
        "kind = \"spring\"\nstiffness = \"10 MPa\"",
        "stiffness",
        "right.stiffness",
        &["a stiffness", "kN/mm"],
    ),
    case(
        "kind = \"free\"",
        "kind = \"wall\"\nmass = 1",
        "mass",
        "right.mass",
        &["`mass` does not apply to an end of kind \"wall\"", "kind, gap"],
    ),
    // A ball.
    ball("kind = \"ball\"\nvelocity = -5", "[right]", "right.radius", &["`radius` is missing", "a length"]),
    ball("kind = \"ball\"\nvelocity = -5\nradius = 0", "radius", "right.radius", &["0 is out of range", "radius > 0"]),
    ball(
        "kind = \"ball\"\nvelocity = -5\nradius = 1\ndiameter = 2",
        "radius",
        "right.radius",
        &["`radius` and `diameter` are both given", "keep `radius` or `diameter`"],
    ),
    ball(
        "kind = \"ball\"\nvelocity = -5\nradius = 1",
        "[right]",
        "right.density",
        &["`density` is missing", "a density"],
    ),
    ball(
        "kind = \"ball\"\nvelocity = -5\nradius = 1\nmass = 1\ndensity = 7800",
        "density",
        "right.density",
        &["`density` and `mass` are both given"],
    ),
    ball("kind = \"ball\"\nvelocity = -5\nradius = 1\nmass = 1", "[right]", "right.modulus", &["`modulus` is missing"]),
    ball(
        "kind = \"ball\"\nvelocity = -5\nradius = 1\nmass = 1\nmodulus = 1e9\npoisson = 0.7",
        "poisson",
        "right.poisson",
        &["0.7 is out of range", "0 <= poisson <= 0.5"],
    ),
    ball(
        "kind = \"ball\"\nvelocity = -5\nradius = 1\nmass = 1\nmodulus = 1e9\nrigid = true",
        "modulus",
        "right.modulus",
        &["`modulus` and `rigid` are both given"],
    ),
    ball(
        "kind = \"ball\"\nvelocity = -5\nradius = 1\nmass = 1\nrigid = true",
        "[right]",
        "right.bar-poisson",
        &["`bar-poisson` is missing", "a plain number"],
    ),
    case(
        "cells = 1000",
        "cells = 1000\nviscosity = { linear = 0.1, quadratic = 1 }",
        "viscosity",
        "solve.viscosity",
        &["artificial viscosity is part of the scheme", "leapfrog adds", "only where shocks can form"],
    ),
    // Words for effects that are not supported: refused by name, with an alternative.
    // Keys of another method, and what front tracking does not support.
    case(
        "cells = 1000",
        "cells = 1000\nmethod = \"moc\"",
        "cells",
        "solve.cells",
        &["does not apply to method = \"moc\"", "front-tolerance, max-events", "method = \"fd\", which supports it"],
    ),
    case("cells = 1000", "method = \"moc\"\ncfl = 1", "cfl", "solve.cfl", &["does not apply to method = \"moc\""]),
    case(
        "cells = 1000",
        "scheme = \"leapfrog\"\nmethod = \"moc\"",
        "scheme",
        "solve.scheme",
        &["does not apply to method = \"moc\"", "method = \"fd\", which supports it"],
    ),
    case(
        "cells = 1000",
        "method = \"fd\"\nscheme = \"muscl\"\n[effects.rate]\nmodel = \"malvern\"\nk = 1e6",
        "\"muscl\"",
        "solve.scheme",
        &["does not simulate the effect `rate`", "\"leapfrog\"", "characteristic net"],
    ),
    case(
        "cells = 1000",
        "scheme = \"muscl\"\n[effects.damping]\nexternal = 300",
        "\"muscl\"",
        "solve.scheme",
        &["does not simulate the effect `damping`", "\"leapfrog\""],
    ),
    case(
        "cells = 1000",
        "front-tolerance = 1e-3",
        "front-tolerance",
        "solve.front-tolerance",
        &["does not apply to method = \"fd\"", "method = \"moc\", which supports it"],
    ),
    case(
        "cells = 1000",
        "method = \"fd\"\nmax-events = 1000",
        "max-events",
        "solve.max-events",
        &["does not apply to method = \"fd\"", "until, method, scheme, cells, cfl"],
    ),
    case(
        "cells = 1000",
        "method = \"moc\"\nfront-tolerance = 1",
        "front-tolerance",
        "solve.front-tolerance",
        &["1 is out of range", "allowed: 0 <= front-tolerance < 1"],
    ),
    case(
        "cells = 1000",
        "method = \"moc\"\nmax-events = 0",
        "max-events",
        "solve.max-events",
        &["0 is out of range", "1 <= max-events"],
    ),
    case("frames = 101", "paths = true", "paths", "record.paths", &["does not apply to method = \"fd\"", "\"moc\""]),
    case(
        "cells = 1000",
        "tolerance = 0.7",
        "tolerance",
        "solve.tolerance",
        &["0.7 is out of range", "0 < tolerance <= 0.5"],
    ),
    // The effect of heat.
    case(
        "hardening = \"isotropic\"",
        "heat = { fraction = 0.9 }",
        "heat",
        "effects.heat",
        &["`steel` does not have: specific-heat, reference-temperature, melting-temperature, m", "add them to"],
    ),
    case(
        "hardening = \"isotropic\"",
        "heat = { fraction = 1.5 }",
        "heat",
        "effects.heat.fraction",
        &["1.5 is out of range", "allowed: 0 <= fraction <= 1"],
    ),
    case(
        "hardening = \"isotropic\"",
        "heat = { fracton = 0.5 }",
        "fracton",
        "effects.heat.fracton",
        &["unknown", "fraction"],
    ),
    case(
        "fields = [\"stress\", \"velocity\"]",
        "fields = [\"stress\", \"temperature\"]",
        "temperature",
        "record.fields.1",
        &["is not available without adiabatic heating", "heat = { fraction = 0.9 }"],
    ),
    case(
        "cells = 1000",
        "audit-tolerance = 2.5",
        "2.5",
        "solve.audit-tolerance",
        &["out of range", "0 < audit-tolerance < 1"],
    ),
    // The effect of the strain rate.
    case(
        "hardening = \"isotropic\"",
        "rate = \"material\"",
        "\"material\"",
        "effects.rate",
        &["no material of the bar has rate constants", "[rate.johnson-cook]"],
    ),
    case(
        "hardening = \"isotropic\"",
        "rate = { model = \"malvren\", k = \"1e6 1/s\" }",
        "malvren",
        "effects.rate.model",
        &["unknown value `malvren`", "did you mean `malvern`?", "\"cowper-symonds\""],
    ),
    case(
        "hardening = \"isotropic\"",
        "rate = { model = \"malvern\", k = \"0 1/s\" }",
        "malvern",
        "effects.rate.k",
        &["0 1/s is out of range", "allowed: k > 0"],
    ),
    case(
        "hardening = \"isotropic\"",
        "rate = { model = \"malvern\", k = \"1 us\" }",
        "malvern",
        "effects.rate.k",
        &["1 us", "a rate"],
    ),
    case(
        "hardening = \"isotropic\"",
        "rate = { model = \"malvern\" }",
        "malvern",
        "effects.rate.k",
        &["`k` is missing", "k = \"1e6 1/s\""],
    ),
    case(
        "hardening = \"isotropic\"",
        "rate = { k = 1e6 }",
        "k = 1e6",
        "effects.rate.model",
        &["`model` is missing", "model = \"malvern\""],
    ),
    case(
        "hardening = \"isotropic\"",
        "rate = { model = \"malvern\", D = 40 }",
        "malvern",
        "effects.rate.D",
        &["`D` is not a constant of model = \"malvern\"", "allowed: k"],
    ),
    case(
        "cells = 1000",
        "method = \"fd\"\nmax-events = 1000\n[effects.rate]\nmodel = \"malvern\"\nk = 1e6",
        "1000",
        "solve.max-events",
        &["does not apply to a rate-dependent bar", "until, method, scheme, cells, cfl"],
    ),
    case(
        "cells = 1000",
        "front-tolerance = 0.1\n[effects.rate]\nmodel = \"malvern\"\nk = 1e6",
        "front-tolerance",
        "solve.front-tolerance",
        &["does not apply to a rate-dependent bar", "allowed: until, method, cells"],
    ),
    // Distributed forces.
    case(
        "hardening = \"isotropic\"",
        "damping = {}",
        "damping",
        "effects.damping",
        &["`damping` is empty", "internal, external, foundation", "external ="],
    ),
    case(
        "hardening = \"isotropic\"",
        "damping = { internal = \"-1 Pa*s\" }",
        "-1 Pa*s",
        "effects.damping.internal",
        &["is out of range", "internal >= 0"],
    ),
    case(
        "hardening = \"isotropic\"",
        "damping = { external = \"5 MPa\" }",
        "5 MPa",
        "effects.damping.external",
        &["is a stress", "a force per length and velocity is expected", "N*s/m^2"],
    ),
    case(
        "hardening = \"isotropic\"",
        "damping = { foundation = \"5 N/m\" }",
        "5 N/m",
        "effects.damping.foundation",
        &["is a stiffness", "N/m^2"],
    ),
    case(
        "hardening = \"isotropic\"",
        "damping = { inner = 1 }",
        "inner",
        "effects.damping.inner",
        &["unknown key `inner`"],
    ),
    case(
        "hardening = \"isotropic\"",
        "lateral-inertia = true",
        "lateral-inertia",
        "effects.lateral-inertia",
        &["needs Poisson's ratio, which `steel` does not have", "0 <= poisson <= 0.5", "poisson = 0.29"],
    ),
    case(
        "hardening = \"isotropic\"",
        "damping = { internal = 1 }\nrupture = { spall = \"1 GPa\" }",
        "rupture",
        "effects.rupture",
        &["`rupture` is not simulated together with `damping`", "method = \"fd\""],
    ),
    case(
        "hardening = \"isotropic\"\n\n[solve]",
        "damping = { internal = 1 }\n\n[solve]\nmethod = \"moc\"",
        "moc",
        "solve.method",
        &[
            "method = \"moc\" (front tracking) does not simulate the effect `damping`",
            "allowed: \"fd\"",
            "use method = \"fd\"",
        ],
    ),
    // Torsion.
    case(
        "area =",
        "mode = \"torsion\"\narea =",
        "area = ",
        "bar.area",
        &["an area does not define a section in torsion", "inner-diameter"],
    ),
    case(
        "area = \"1 cm^2\"",
        "mode = \"torsion\"\ndiameter = \"2 cm\"",
        "material = ",
        "bar.material",
        &["`steel` has a tension curve", "loading = \"shear\"", "von-mises"],
    ),
    case(
        "area = \"1 cm^2\"",
        "mode = \"torsion\"\ndiameter = \"2 cm\"\nshear = \"von-mises\"",
        "material = ",
        "bar.material",
        &["cannot be converted", "`poisson`"],
    ),
    case("area = \"1 cm^2\"", "mode = \"torsion\"", "", "bar.diameter", &["`diameter` is missing", "20 mm"]),
    case(
        "area = \"1 cm^2\"",
        "mode = \"torsion\"\ndiameter = [[0, 0.01], [1, 0.02]]",
        "diameter = ",
        "bar.diameter",
        &["a taper is not simulated in torsion", "inner-diameter"],
    ),
    case(
        "area = \"1 cm^2\"",
        "mode = \"torsion\"\ndiameter = \"2 cm\"\nwall = \"2 mm\"",
        "wall = ",
        "bar.wall",
        &["out of range", "0 < wall <= 0.001 m"],
    ),
    case(
        "area = \"1 cm^2\"",
        "mode = \"torsion\"\ndiameter = \"2 cm\"\nwall = \"1 mm\"\ninner-diameter = \"18 mm\"",
        "wall = ",
        "bar.wall",
        &["both an inner diameter and a wall"],
    ),
    case(
        "area = \"1 cm^2\"",
        "mode = \"torsion\"\ndiameter = \"2 cm\"\ninner-diameter = \"2 cm\"",
        "inner-diameter = ",
        "bar.inner-diameter",
        &["out of range"],
    ),
    case("area = \"1 cm^2\"", "wall = \"1 mm\"", "wall = ", "bar.wall", &["applies to a bar in torsion only"]),
    case("area = ", "shear = \"von-mises\"\narea = ", "shear = ", "bar.shear", &["does not apply to an axial bar"]),
    case(
        "modulus = \"200 GPa\", beyond",
        "loading = \"shear\", modulus = \"200 GPa\", beyond",
        "material = ",
        "bar.material",
        &["has a shear curve", "mode = \"torsion\""],
    ),
    case(
        "modulus = \"200 GPa\", beyond",
        "loading = \"shear\", sense = \"compression\", modulus = \"200 GPa\", beyond",
        "material = ",
        "bar.material.sense",
        &["applies in both senses"],
    ),
    case(
        "\"stress\", \"velocity\"",
        "\"stress\", \"torque\"",
        "fields = ",
        "record.fields.1",
        &["`torque` is available in torsion only"],
    ),
    case(
        "kind = \"velocity\"\nvalue = \"-30 m/s\"",
        "kind = \"torque\"\nvalue = \"5 N*m\"",
        "torque",
        "left.kind",
        &["a bar in torsion only"],
    ),
    // Values far outside of the feasible range, and values of another type.
    case(
        "until = \"200 us\"",
        "until = 1e12",
        "until = 1e12",
        "solve.until",
        &["the run would take 5.1e18 steps of 1000 cells", "at most 1e12 steps", "use a shorter time"],
    ),
    case(
        "density = \"7800 kg/m^3\"",
        "density = 1e-300",
        "density = 1e-300",
        "bar.material.density",
        &["1e-300", "beyond the range of a density", "1e-3 <= density <= 1e7 kg/m^3", "aerogels have 1 kg/m^3"],
    ),
    case("frames = 101", "frames = 99999999999999999999", "frames", "record.frames", &["out of range", "1 <= frames"]),
    case(
        "until = \"200 us\"",
        "until = 2020-01-01",
        "2020",
        "solve.until",
        &["date or time, expected a number", "help: write a number"],
    ),
    case("frames = 101", "times = [[0, 1]]", "times", "record.times.0", &["found a list, expected a number"]),
    case(
        "[[0.001, \"200 MPa\"], [0.1, \"400 MPa\"]]",
        "[]",
        "table = []",
        "bar.material.curve.table",
        &["at least one row with a strain above 0"],
    ),
    // Text that is not TOML.
    case("length = \"1 m\"", "length = 1 m", "length", "", &["help: "]),
    case("title = ", "title = \"twice\"\ntitle = ", "title", "title", &["duplicate key", "keep one of the two"]),
];

fn check(file: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_barwave")).arg("check").arg(file).output().expect("barwave starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn the_base_scene_is_right() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("right.toml");
    std::fs::write(&file, RIGHT).expect("written");
    let output = check(&file);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).trim_end().ends_with("right.toml: ok (scene)"));
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
}

/// A valid scene of the energy method.
const SPECIMEN: &str = r#"[specimen]
length = "10 in"
diameter = "0.5 in"
energy = "500 ft*lbf/in^3"

[striker]
mass = "200 lb"
velocity = "80 ft/s"
"#;

const SPECIMEN_CASES: &[Case] = &[
    case("length = \"10 in\"\n", "", "[specimen]", "specimen.length", &["`length` is missing", "a length"]),
    case("10 in", "10 lb", "length", "specimen.length", &["a length"]),
    case("diameter = \"0.5 in\"", "area = 0", "area", "specimen.area", &["0 is out of range", "area > 0"]),
    case("diameter", "area = 1\ndiameter", "diameter", "specimen.diameter", &["both an area and a diameter"]),
    case(
        "energy = \"500 ft*lbf/in^3\"\n",
        "",
        "[specimen]",
        "specimen.energy",
        &["`energy` is missing", "ft*lbf/in^3"],
    ),
    case(
        "energy =",
        "material = \"mild-steel\"\nenergy =",
        "energy",
        "specimen.energy",
        &["`energy` and `material` are both given", "not both"],
    ),
    case(
        "energy =",
        "stress-concentration = 2\nenergy \
                      =",
        "stress-concentration",
        "specimen.stress-concentration",
        &[
            "needs the stress-strain \
                                                                                      curve",
            "give `material`",
        ],
    ),
    case(
        "energy = \"500 ft*lbf/in^3\"",
        "material = \"mild-steel\"\nstress-concentration = 0.5",
        "stress-concentration",
        "specimen.stress-concentration",
        &["0.5 is out of range", "1 <= stress-concentration"],
    ),
    case(
        "energy = \"500 ft*lbf/in^3\"",
        "material = { density = 7800, modulus = 2e11, beyond = \"extend\", curve = { table = [[0.001, 2e8], [0.1, 4e8]] } }",
        "material",
        "specimen.material",
        &["has no fracture strain", "beyond = \"rupture\""],
    ),
    case("[striker]\nmass = \"200 lb\"\nvelocity = \"80 ft/s\"\n", "", "energy", "striker", &["`striker` is missing"]),
    case("80 ft/s", "-80 ft/s", "velocity", "striker.velocity", &["out of range", "velocity >= 0"]),
    case("mass = \"200 lb\"\n", "", "[striker]", "striker.mass", &["`mass` is missing"]),
    case("[striker]", "[bar]\nlength = 1\n[striker]", "[bar]", "bar", &["specimen", "striker"]),
];

/// Valid scenes of the other impacts.
const SPHERES: &str = r#"[spheres]
mass = "3 kg"
restitution = 0.6

[striker]
mass = "2 kg"
velocity = "5 m/s"
"#;

const SPHERES_CASES: &[Case] = &[
    case("mass = \"3 kg\"", "mass = \"-3 kg\"", "mass", "spheres.mass", &["out of range", "mass > 0"]),
    case("0.6", "1.2", "restitution", "spheres.restitution", &["1.2 is out of range", "0 <= restitution <= 1"]),
    case("5 m/s", "5 kg", "velocity", "striker.velocity", &["a velocity"]),
    case("5 m/s", "-5 m/s", "velocity", "striker.velocity", &["does not catch up", "velocity > 0 m/s"]),
    case(
        "mass = \"2 kg\"",
        "radius = 1",
        "radius",
        "striker.radius",
        &["only masses and velocities are used", "give `mass`"],
    ),
    case("restitution", "restituton", "restituton", "spheres.restituton", &["did you mean `restitution`"]),
    case("restitution = 0.6", "velocity-after = 1", "velocity", "striker.velocity", &["is the result"]),
    case("[striker]\nmass = \"2 kg\"\nvelocity = \"5 m/s\"\n", "", "restitution", "striker", &["`striker` is missing"]),
];

const HERTZ: &str = r#"[spheres]
radius = "10 mm"
material = "mild-steel"
poisson = 0.3

[striker]
diameter = "20 mm"
velocity = "1 m/s"
rigid = true
density = 7800
"#;

const HERTZ_CASES: &[Case] = &[
    case("material = \"mild-steel\"\n", "", "[spheres]", "spheres.material", &["`material` is missing", "mild-steel"]),
    case("mild-steel", "mild-stele", "material", "spheres.material", &["mild-steel"]),
    case(
        "poisson = 0.3",
        "poisson = 0.6",
        "poisson",
        "spheres.poisson",
        &["0.6 is out of range", "0 <= poisson <= 0.5"],
    ),
    case(
        "material = \"mild-steel\"\npoisson = 0.3\n",
        "material = { density = 7850, modulus = 2e11, curve = { table = [[0.001, 2e8], [0.1, 4e8]] }, beyond = \"extend\" }\n",
        "[spheres]",
        "spheres.poisson",
        &["`poisson` is missing"],
    ),
    case("poisson = 0.3", "poisson = 0.3\nhalf-space = true", "radius", "spheres.radius", &["has no `radius`"]),
    case(
        "material = \"mild-steel\"\npoisson = 0.3",
        "rigid = true\ndensity = 1000",
        "[striker]",
        "striker.rigid",
        &["both bodies are rigid"],
    ),
];

const PLATE: &str = r#"[plate]
thickness = "10 mm"
material = "mild-steel"
poisson = 0.3

[striker]
radius = "5 mm"
velocity = "1 m/s"
material = "mild-steel"
poisson = 0.3
"#;

const PLATE_CASES: &[Case] = &[
    case("thickness = \"10 mm\"", "thickness = \"10 kg\"", "thickness", "plate.thickness", &["a length"]),
    case(
        "thickness = \"10 mm\"\nmaterial = \"mild-steel\"",
        "thickness = 0.01",
        "[plate]",
        "plate.material",
        &["`material` is missing"],
    ),
    case("poisson = 0.3", "poisson = 0.6", "poisson", "plate.poisson", &["0.6 is out of range"]),
    case("1 m/s", "0 m/s", "velocity", "striker.velocity", &["velocity > 0"]),
    case("[striker]", "[solve]\ntolerance = 1\n[striker]", "tolerance", "solve.tolerance", &["1 is out of range"]),
    case("[striker]", "[bar]\nlength = 1\n[striker]", "[bar]", "bar", &["unknown key `bar`"]),
];

const BEAM: &str = r#"[beam]
length = "15 cm"
width = "1 cm"
depth = "1 cm"
material = "mild-steel"
poisson = 0.3

[striker]
radius = "1 cm"
mass = "30 g"
velocity = "1 cm/s"
material = "mild-steel"
poisson = 0.3
"#;

const BEAM_CASES: &[Case] = &[
    case("mass = \"30 g\"", "mass = \"-30 g\"", "mass", "striker.mass", &["out of range", "mass > 0"]),
    case(
        "radius = \"1 cm\"",
        "radius = \"10 cm\"",
        "radius",
        "striker.radius",
        &["longer than the beam", "smaller sphere"],
    ),
    case("1 cm/s", "1 km/s", "radius", "striker.radius", &["more than the depth of the beam"]),
    case("poisson = 0.3", "poisson = 0.6", "poisson", "beam.poisson", &["0.6 is out of range"]),
    case(
        "depth = \"1 cm\"\nmaterial = \"mild-steel\"",
        "depth = \"1 cm\"",
        "[beam]",
        "beam.material",
        &["`material` is missing"],
    ),
    case("length = \"15 cm\"", "length = \"15 s\"", "length", "beam.length", &["a length"]),
    case("width = \"1 cm\"\n", "", "[beam]", "beam.width", &["`width` is missing"]),
    case("width = \"1 cm\"", "diameter = \"1 cm\"", "depth", "beam.depth", &["given by its diameter", "not both"]),
    case(
        "width = \"1 cm\"",
        "area = \"1 cm^2\"\ninertia = \"0.26 cm^4\"",
        "inertia",
        "beam.inertia",
        &["no section of this area and depth", "inertia <= area*depth^2/4", "check the units"],
    ),
    case("poisson = 0.3", "poisson = 0.3\nat = \"20 cm\"", "at =", "beam.at", &["out of range", "0 < at < 0.15"]),
    case(
        "poisson = 0.3",
        "poisson = 0.3\naxial-force = \"1 MN\"",
        "axial",
        "beam.axial-force",
        &["buckles", "axial-force <"],
    ),
    case("[striker]", "[record]\ngauges = { a = 1 }\n[striker]", "gauges", "record.gauges.a", &["outside the beam"]),
    case("[striker]", "[solve]\nmodes = 0\n[striker]", "modes", "solve.modes", &["out of range", "1 <= modes"]),
];

#[test]
fn every_wrong_impact_does_so_too() {
    for (right, cases) in [(SPHERES, SPHERES_CASES), (HERTZ, HERTZ_CASES), (PLATE, PLATE_CASES), (BEAM, BEAM_CASES)] {
        all_wrong(right, cases);
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("right.toml");
        std::fs::write(&file, right).expect("written");
        let output = check(&file);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
}

#[test]
fn every_wrong_scene_says_what_is_wrong_and_where() {
    all_wrong(RIGHT, CASES);
}

#[test]
fn every_wrong_specimen_does_so_too() {
    all_wrong(SPECIMEN, SPECIMEN_CASES);
}

fn all_wrong(right: &str, cases: &[Case]) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (i, case) in cases.iter().enumerate() {
        assert_eq!(right.matches(case.from).count().min(1), 1, "case {i}: `{}` is not in the scene", case.from);
        let text = right.replacen(case.from, case.to, 1);
        let file = folder.path().join(format!("wrong-{i}.toml"));
        std::fs::write(&file, &text).expect("written");
        let output = check(&file);
        let shown = stderr(&output);
        let told = format!("case {i}, `{}` -> `{}`:\n{shown}", case.from, case.to);
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(output.stdout.is_empty(), "{told}");
        assert!(shown.contains("\nhelp: ") && !shown.contains('\u{1b}'), "{told}");
        let key = if case.key.is_empty() { "error: ".to_owned() } else { format!("error: `{}`: ", case.key) };
        assert!(shown.starts_with(&key), "expected {key}\n{told}");
        let place = shown.lines().find_map(|l| l.trim_start().strip_prefix("--> ")).expect(&told);
        let mut place = place.rsplitn(3, ':');
        let line: usize = place.nth(1).and_then(|n| n.parse().ok()).expect(&told);
        assert!(place.next().is_some_and(|f| f.ends_with(&format!("wrong-{i}.toml"))), "{told}");
        let at = text.lines().nth(line - 1).unwrap_or_default();
        assert!(at.contains(case.line), "line {line} is `{at}`\n{told}");
        for part in case.parts {
            assert!(shown.contains(part), "expected `{part}`\n{told}");
        }
    }
}

#[test]
fn every_file_is_checked_and_every_error_shown() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        let file = folder.path().join(name);
        std::fs::write(&file, text).expect("written");
        file
    };
    let files = [
        write("a.toml", &RIGHT.replace("1000", "1")),
        write("b.toml", RIGHT),
        write("c.toml", "hello = 1\n"),
        folder.path().join("missing.toml"),
    ];
    let output = Command::new(env!("CARGO_BIN_EXE_barwave")).arg("check").args(&files).output().expect("starts");
    assert_eq!(output.status.code(), Some(2));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), stderr(&output));
    assert_eq!(out.lines().count(), 1, "{out}");
    assert!(out.contains("b.toml: ok"), "{out}");
    assert_eq!(err.matches("error: ").count(), 3, "{err}");
    assert_eq!(err.matches("help: ").count(), 3, "{err}");
    assert!(err.contains("is neither a scene nor a material") && err.contains("no such file"), "{err}");
}

#[test]
fn new_writes_a_right_scene_and_never_overwrites() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let new = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_barwave"));
        command.current_dir(folder.path()).args(["new", "first"]).output().expect("barwave starts")
    };
    assert_eq!(new().status.code(), Some(0));
    let file = folder.path().join("first.toml");
    let before = std::fs::read_to_string(&file).expect("written");
    assert_eq!(check(&file).status.code(), Some(0), "{}", stderr(&check(&file)));
    let again = new();
    assert_eq!(again.status.code(), Some(2));
    assert!(stderr(&again).contains("exists already") && stderr(&again).contains("help: "));
    assert_eq!(std::fs::read_to_string(&file).expect("still there"), before);
}

#[test]
fn the_scenes_of_this_project_are_right() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs");
    let entries = std::fs::read_dir(folder).expect("runs/ is there");
    let scenes: Vec<_> =
        entries.filter_map(|e| Some(e.ok()?.path())).filter(|p| p.extension().is_some_and(|e| e == "toml")).collect();
    assert!(scenes.len() >= 7, "{scenes:?}");
    for scene in scenes {
        let output = check(&scene);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
}

#[test]
fn schema_man_pages_and_completions_are_written() {
    let run = |args: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_barwave")).args(args).output().expect("barwave starts");
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", stderr(&output));
        String::from_utf8(output.stdout).expect("UTF-8")
    };
    for kind in ["scene", "specimen", "spheres", "plate", "beam", "material", "sweep"] {
        let schema: serde_json::Value = serde_json::from_str(&run(&["schema", kind])).expect("JSON");
        assert!(schema["properties"].is_object(), "{schema}");
        assert_eq!(schema["additionalProperties"], false);
    }
    assert!(run(&["man"]).contains(".TH barwave"));
    assert!(run(&["completions", "bash"]).contains("_barwave"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    run(&["man", "--output", folder.path().to_str().expect("UTF-8")]);
    assert!(folder.path().join("barwave-check.1").exists());
}

/// Annealed copper is the same in tension and compression in true stress only: there are two engineering curves.
#[test]
fn kinematic_hardening_needs_one_curve() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("two.toml");
    let text = RIGHT.replace(MATERIAL, "material = \"copper-annealed\"").replace("isotropic", "kinematic");
    std::fs::write(&file, text).expect("written");
    let output = check(&file);
    let shown = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{shown}");
    assert!(shown.starts_with("error: `effects.hardening`: kinematic hardening needs one curve"), "{shown}");
    assert!(shown.contains("help: use hardening = \"isotropic\""), "{shown}");
}

/// Effects on the whole section require a section, and a joint that opens has no shared node.
#[test]
fn torsion_and_tapers_refuse_what_they_do_not_go_with() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("wrong.toml");
    let shear = MATERIAL.replace("modulus =", "loading = \"shear\", modulus =");
    let twisted = RIGHT
        .replace(MATERIAL, &shear)
        .replace("area = \"1 cm^2\"", "mode = \"torsion\"\ndiameter = \"2 cm\"")
        .replace("\"-30 m/s\"", "\"-3000 rad/s\"");
    let tapered = RIGHT.replace("\"1 cm^2\"", "[[0, \"1 cm^2\"], [1, \"2 cm^2\"]]");
    let steep = RIGHT.replace("\"1 cm^2\"", "[[0, \"1 mm^2\"], [1, \"1 m^2\"]]");
    for (text, from, to, parts) in [
        (&twisted, "", "", &[][..]),
        (&tapered, "", "", &[]),
        (&twisted, "-3000 rad/s", "-30 m/s", &["an angular velocity is expected", "rad/s"]),
        (&twisted, "\"free\"", "\"wall\"", &["is not available in torsion", "torque, free"]),
        (&twisted, "\"free\"", "\"striker\"\nmass = 1", &["`mass` does not apply to", "inertia"]),
        (&twisted, "\"free\"", "\"striker\"", &["`inertia` is missing", "kg*m^2"]),
        (&twisted, "\"free\"", "\"spring\"\nstiffness = \"3 N/m\"", &["torsional stiffness is expected"]),
        (&twisted, "\"free\"", "\"dashpot\"\ncoefficient = 3\ngap = 1", &["`gap` does not apply", "kind, coefficient"]),
        (&twisted, "\"free\"", "\"torque\"\nvalue = \"3 N\"", &["a torque is expected", "N*m"]),
        (
            &twisted,
            "hardening = \"isotropic\"",
            "rupture = { spall = 1e9 }",
            &["`rupture` is not simulated in torsion"],
        ),
        (
            &twisted,
            "hardening = \"isotropic\"",
            "damping = { internal = 1 }",
            &["`damping` is not simulated in torsion"],
        ),
        (&tapered, "hardening = \"isotropic\"", "damping = { internal = 1 }", &["with a taper (segment 1)"]),
        (&tapered, "cells = 1000", "method = \"moc\"", &[]),
        (&steep, "cells = 1000", "method = \"moc\"", &["discretizes the taper", "at most 2000", "method = \"fd\""]),
    ] {
        let wrong = if from.is_empty() { text.clone() } else { text.replacen(from, to, 1) };
        std::fs::write(&file, &wrong).expect("written");
        let output = check(&file);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.success(), parts.is_empty(), "{from} -> {to}: {message}");
        for part in parts {
            assert!(message.contains(part), "expected `{part}`:\n{message}");
        }
    }
}

#[test]
fn what_acts_along_the_bar_needs_a_section_and_bonded_joints() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("wrong.toml");
    let without_area = RIGHT.replace("area = \"1 cm^2\"\n", "");
    let poisson = without_area.replace("density =", "poisson = 0.3, density =");
    let segment = format!("[[bar.segment]]\nlength = 1\narea = 1\n{MATERIAL}\n");
    let parting = RIGHT.replace(UNIFORM, "").replace("area = \"1 cm^2\"\n", "").replace(MATERIAL, "");
    let parting = parting + &segment.replace("area", "joint = \"contact\"\narea") + &segment;
    for (text, effect, start) in [
        (
            &without_area,
            "damping = { external = 100 }",
            "error: `effects.damping.external`: `external` is a force per length",
        ),
        (&without_area, "damping = { foundation = 100 }", "error: `effects.damping.foundation`: "),
        (
            &poisson,
            "lateral-inertia = true",
            "error: `effects.lateral-inertia`: lateral inertia needs the cross-section",
        ),
        (
            &parting,
            "damping = { internal = 100 }",
            "error: `effects.damping`: `damping` is not simulated in a bar with contact joints",
        ),
    ] {
        std::fs::write(&file, text.replace("hardening = \"isotropic\"", effect)).expect("written");
        let output = check(&file);
        let shown = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{shown}");
        assert!(shown.starts_with(start) && shown.contains("\nhelp: "), "{shown}");
    }
    // Without a section internal damping is allowed, and without a joint that opens the bar is valid.
    std::fs::write(&file, without_area.replace("hardening = \"isotropic\"", "damping = { internal = 100 }"))
        .expect("written");
    assert_eq!(check(&file).status.code(), Some(0), "{}", stderr(&check(&file)));
}
