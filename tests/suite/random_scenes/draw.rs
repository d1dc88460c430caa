//! Draws random scenes: the whole scene language, in bars of centimetres to metres that may yield.

use super::spec::{Keys, Spec, Value, round};

/// Random number generator (`SplitMix64`): every bit of a scene follows from its seed.
pub struct Draw(u64);

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a number with a uniform distribution between the two, rounded to three digits.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        round(low + (high - low) * self.unit())
    }

    /// Returns a number with a uniform distribution of the logarithm, rounded to three digits.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        round(low * (high / low).powf(self.unit()))
    }

    fn one_in(&mut self, count: u64) -> bool {
        self.bits().is_multiple_of(count)
    }

    fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[(self.bits() % of.len() as u64) as usize]
    }

    fn signed(&mut self, low: f64, high: f64) -> f64 {
        self.pick(&[-1.0, 1.0]) * self.between(low, high)
    }
}

/// Properties that all parts of a scene share.
struct Frame {
    torsion: bool,
    area: bool,
    heat: bool,
    poisson: bool,
    /// Length of the whole bar, m.
    length: f64,
    /// Typical cross-section, m^2.
    size: f64,
}

pub fn scene(seed: u64) -> Spec {
    let mut draw = Draw::new(seed);
    let d = &mut draw;
    let torsion = d.one_in(10);
    let frame = Frame {
        torsion,
        area: torsion || !d.one_in(10),
        heat: d.one_in(5),
        poisson: d.one_in(2),
        length: d.decades(0.02, 3.0),
        size: d.decades(2e-5, 2e-3),
    };
    let count = d.pick(&[1, 1, 2, 2, 3, 4]);
    let segments: Vec<Keys> = (0..count).map(|_| segment(d, &frame, count)).collect();
    let joints = (1..count).map(|_| joint(d, &frame)).collect();
    let ends = [end(d, &frame), end(d, &frame)];
    let bar = if torsion { torsion_keys(d) } else { Keys::new() };
    // For wave speeds of about 4500 m/s.
    let transit = frame.length / 4500.0;
    let mut spec = Spec {
        bar,
        segments,
        joints,
        ends,
        effects: if d.one_in(40) { None } else { Some(effects(d, &frame)) },
        until: round(d.between(0.3, 3.0) * transit),
        cells: d.pick(&[20, 30, 47, 60, 80, 120]),
        cfl: if d.one_in(2) { 1.0 } else { d.between(0.3, 1.0) },
        front_tolerance: d.pick(&[1e-3, 1e-3, 1e-2, 1e-4]),
    };
    start(&mut Draw::new(!seed), &frame, &mut spec);
    spec
}

/// Adds an initial state to one bar in three: stresses, strains, velocities or temperatures, constant or as tables over x. It uses random numbers of
/// its own, so that the rest of the scene is unchanged.
fn start(d: &mut Draw, frame: &Frame, spec: &mut Spec) {
    if !d.one_in(3) {
        return;
    }
    let lengths: Vec<f64> = spec.segments.iter().map(length_of).collect();
    if spec.segments.len() > 1 && d.one_in(4) {
        let whole = lengths.iter().sum();
        let given: Keys = initial(d, frame, whole).into_iter().filter(|(_, value)| value.is_along()).collect();
        spec.segments.iter_mut().for_each(|keys| keys.retain(|(key, _)| given.iter().all(|(other, _)| other != key)));
        spec.bar.extend(given);
        return;
    }
    for (keys, length) in spec.segments.iter_mut().zip(lengths) {
        if d.one_in(2) {
            let given = initial(d, frame, length);
            keys.retain(|(key, _)| given.iter().all(|(other, _)| other != key));
            keys.extend(given);
        }
    }
}

fn length_of(keys: &Keys) -> f64 {
    let text = keys.iter().find_map(|(key, value)| match value {
        Value::Same(text) if *key == "length" => Some(text.as_str()),
        _ => None,
    });
    text.and_then(|text| text.parse().ok()).unwrap_or(1.0)
}

fn initial(d: &mut Draw, frame: &Frame, length: f64) -> Keys {
    let mut keys = Keys::new();
    if d.one_in(2) {
        let (key, largest) = if frame.torsion || !d.one_in(4) {
            ("stress", d.decades(1e5, 5e8))
        } else {
            ("strain", d.decades(1e-5, 3e-3))
        };
        keys.push((key, along(d, length, [-largest, largest])));
    }
    if d.one_in(3) {
        let most = d.decades(1e-4, 2e-2);
        let plastic = along(d, length, [-most, most]);
        if d.one_in(3) {
            keys.push(("accumulated-plastic-strain", along(d, length, [most, round(2.0 * most)])));
        }
        keys.push(("plastic-strain", plastic));
    }
    if d.one_in(4) {
        let fastest = if frame.torsion { 30.0 / frame.size.sqrt() } else { 30.0 };
        keys.push((
            "velocity",
            match along(d, length, [-fastest, fastest]) {
                Value::Along(rows, length) => Value::SignedAlong(rows, length),
                _ => Value::Signed(d.signed(0.1 * fastest, fastest), ""),
            },
        ));
    }
    if frame.heat && d.one_in(4) {
        keys.push(("temperature", along(d, length, [293.0, 600.0])));
    }
    keys
}

/// Returns a constant, or a table with slopes or jumps, or one for parts of the length.
fn along(d: &mut Draw, length: f64, [low, high]: [f64; 2]) -> Value {
    let value = |d: &mut Draw| d.between(low, high);
    let shape = d.pick(&[0, 1, 1, 2, 3]);
    if shape == 0 {
        return Value::number(value(d));
    }
    let mut places: Vec<f64> = (0..d.pick(&[1, 2, 3])).map(|_| round(length * d.unit())).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let mut rows = Vec::new();
    if shape != 3 {
        rows.push((0.0, value(d)));
    }
    for x in places.into_iter().filter(|x| 0.0 < *x && *x < length) {
        if shape == 2 {
            let before = rows.last().map_or(0.0, |row: &(f64, f64)| row.1);
            rows.push((x, before));
        }
        rows.push((x, value(d)));
    }
    if shape != 3 || rows.is_empty() {
        let last = rows.last().map_or(0.0, |row| row.1);
        rows.push((length, if shape == 2 { last } else { value(d) }));
    }
    Value::Along(rows, length)
}

fn torsion_keys(d: &mut Draw) -> Keys {
    let mut keys = vec![("mode", Value::word("torsion"))];
    if d.one_in(4) {
        keys.push(("shear", Value::word("von-mises")));
    }
    keys
}

fn segment(d: &mut Draw, frame: &Frame, count: usize) -> Keys {
    let length = round(frame.length / count as f64 * if count == 1 { 1.0 } else { d.between(0.2, 1.5) });
    let mut keys = vec![("length", Value::number(length))];
    let size = round(frame.size * d.decades(0.3, 3.0));
    if frame.torsion {
        // One outer radius; tubes have different inner ones.
        let diameter = round(frame.size.sqrt());
        keys.push(("diameter", Value::number(diameter)));
        match d.pick(&[0, 1, 2]) {
            1 => keys.push(("inner-diameter", Value::number(round(diameter * d.between(0.2, 0.9))))),
            2 if count == 1 => keys.push(("wall", Value::number(round(0.03 * diameter)))),
            _ => {}
        }
    } else if frame.area {
        keys.push(section(d, size, length));
    }
    keys.push(("material", material(d, frame)));
    if d.one_in(3) {
        let fastest = if frame.torsion { 30.0 / frame.size.sqrt() } else { 40.0 };
        let velocity = d.signed(0.02 * fastest, fastest);
        keys.push(("velocity", Value::Signed(velocity, if frame.torsion { "rad/s" } else { "m/s" })));
    }
    if d.one_in(12) {
        keys.push(("stress-concentration", Value::number(d.between(1.0, 3.0))));
    }
    keys
}

fn section(d: &mut Draw, size: f64, length: f64) -> (&'static str, Value) {
    match d.pick(&[0, 0, 0, 1, 1, 2]) {
        0 => ("area", Value::unit(round(size * 1e6), "mm^2")),
        1 => ("diameter", Value::unit(round(1e3 * size.sqrt()), "mm")),
        _ => {
            let middle = if d.one_in(2) { vec![(0.5 * length, round(size * d.between(0.5, 2.0)))] } else { Vec::new() };
            let last = (length, round(size * d.between(0.5, 2.0)));
            let rows: Vec<_> = [(0.0, size)].into_iter().chain(middle).chain([last]).collect();
            ("area", Value::Along(rows, length))
        }
    }
}

fn joint(d: &mut Draw, frame: &Frame) -> Keys {
    let mut keys = Keys::new();
    if !frame.torsion && d.one_in(3) {
        keys.push(("joint", Value::word("contact")));
        if d.one_in(2) {
            keys.push(("gap", Value::unit(d.decades(1e-3, 1.0), "mm")));
        }
    } else if d.one_in(10) {
        keys.push(("joint-stress-concentration", Value::number(d.between(1.0, 3.0))));
    }
    keys
}

fn material(d: &mut Draw, frame: &Frame) -> Value {
    const LIBRARY: [&str; 6] =
        ["copper-annealed", "mild-steel", "aluminium-6061-t6", "copper-ofhc-jc", "steel-4340-jc", "aluminium-1100-o"];
    if !frame.torsion && d.one_in(6) {
        return Value::word(d.pick(&LIBRARY));
    }
    let modulus = d.pick(&[200e9, 70e9, 120e9, 3e9]);
    let limit = modulus * d.decades(3e-4, 5e-3);
    let mut text = format!(
        "{{ density = {}, modulus = \"{} GPa\", beyond = \"{}\"",
        d.between(1200.0, 9000.0),
        modulus / 1e9,
        d.pick(&["extend", "extend", "rupture", "error"]),
    );
    let shape = d.pick(&["elastic", "table", "table", "table", "table", "table", "formula", "formula"]);
    let formula = shape == "formula" && !frame.torsion;
    if formula && d.one_in(2) {
        text += ", measure = \"true\"";
        if d.one_in(2) {
            text += ", symmetry = \"true\"";
        }
    }
    if frame.torsion {
        text += ", loading = \"shear\"";
    }
    if frame.poisson {
        text += &format!(", poisson = {}", d.between(0.0, 0.5));
    }
    if frame.heat {
        let (heat, melting) = (d.between(300.0, 1000.0), d.between(600.0, 2000.0));
        text += &format!(
            ", heat = {{ specific-heat = {heat}, reference-temperature = 293, melting-temperature = {melting}, m = {} }}",
            d.between(0.5, 1.5)
        );
    }
    if d.one_in(5) {
        text += &format!(", rate = {{ {} }}", rate_of_material(d));
    }
    let curve = |d: &mut Draw| if formula { hardening_law(d, limit) } else { table(d, shape, modulus, limit) };
    text += &format!(", curve = {{ {} }}", curve(d));
    if !frame.torsion && !text.contains("symmetry") && d.one_in(8) {
        text += &format!(", compression = {{ {} }}", curve(d));
    }
    Value::Same(text + " }")
}

fn rate_of_material(d: &mut Draw) -> String {
    match d.pick(&[0, 1, 2]) {
        0 => format!("johnson-cook = {{ C = {}, reference = 1 }}", d.decades(1e-3, 0.1)),
        1 => format!("cowper-symonds = {{ D = {}, q = {} }}", d.decades(10.0, 1e5), d.between(1.0, 6.0)),
        _ => format!("malvern = {{ k = {} }}", d.decades(1e3, 1e8)),
    }
}

/// Returns a table of rows [strain, "stress MPa"] that starts with the modulus as slope.
fn table(d: &mut Draw, shape: &str, modulus: f64, limit: f64) -> String {
    let mut rows = vec![(limit / modulus, limit)];
    if shape != "elastic" {
        let count = d.pick(&[1, 2, 5, 9]);
        let mut slopes: Vec<f64> = match d.pick(&[0, 0, 1, 1, 2, 3, 4]) {
            // Decreasing slopes.
            0 => (0..count).map(|_| d.decades(1e-3, 0.9)).collect(),
            // Slopes in any order: S-shaped, lock-up.
            1 => (0..count).map(|_| d.between(0.0, 1.0)).collect(),
            // Perfectly plastic.
            2 => vec![0.0],
            // Softening.
            3 => (0..count).map(|_| d.between(-0.05, 0.1)).collect(),
            // With a level part inside.
            _ => vec![0.2, 0.0, 0.1],
        };
        if d.one_in(2) {
            slopes.sort_by(|a, b| b.total_cmp(a));
        }
        for slope in slopes {
            let (strain, stress) = rows[rows.len() - 1];
            let width = d.decades(0.3, 30.0) * limit / modulus;
            rows.push((strain + width, (stress + slope * modulus * width).max(0.0)));
        }
    }
    // Twelve digits: the first slope is the modulus to rounding, and none is steeper.
    let row = |(strain, stress): &(f64, f64)| format!("[{:.12e}, {:.12e}]", strain, stress * (1.0 - 1e-12));
    format!("table = [{}]", rows.iter().map(row).collect::<Vec<_>>().join(", "))
}

fn hardening_law(d: &mut Draw, limit: f64) -> String {
    let mega = |stress: f64| format!("\"{} MPa\"", round(stress / 1e6));
    let (limit, n) = (limit.max(1e6), d.between(0.05, 0.6));
    match d.pick(&[0, 1, 2, 3, 4, 5]) {
        0 => format!("formula = \"hollomon\", K = {}, n = {n}", mega(4.0 * limit)),
        1 => format!("formula = \"ludwik\", yield = {}, K = {}, n = {n}", mega(limit), mega(2.0 * limit)),
        2 => format!("formula = \"swift\", K = {}, prestrain = 0.002, n = {n}", mega(3.0 * limit)),
        3 => {
            let strain = d.decades(0.005, 0.2);
            format!(
                "formula = \"voce\", yield = {}, saturation = {}, strain = {strain}",
                mega(limit),
                mega(3.0 * limit)
            )
        }
        4 => format!("formula = \"ramberg-osgood\", yield = {}, n = {}", mega(limit), d.between(3.0, 20.0)),
        _ => format!("formula = \"johnson-cook\", A = {}, B = {}, n = {n}", mega(limit), mega(2.0 * limit)),
    }
}

fn end(d: &mut Draw, frame: &Frame) -> Keys {
    let axial = [
        "velocity",
        "velocity",
        "velocity",
        "stress",
        "stress",
        "free",
        "fixed",
        "absorbing",
        "dashpot",
        "wall",
        "wall",
        "striker",
        "striker",
        "ball",
        "spring",
    ];
    let twisted =
        ["velocity", "velocity", "stress", "torque", "free", "fixed", "absorbing", "dashpot", "striker", "spring"];
    let kind = if frame.torsion { d.pick(&twisted) } else { d.pick(&axial) };
    let mut keys = vec![("kind", Value::word(kind))];
    // In torsion, R^2 converts masses to moments of inertia, and so on.
    let (arm, fastest) = if frame.torsion { (0.25 * frame.size, 30.0 / frame.size.sqrt()) } else { (1.0, 40.0) };
    let impedance = frame.size * 3e7;
    match kind {
        "velocity" => {
            keys.push(history(d, frame, fastest, true));
            if d.one_in(6) {
                keys.push(("release", Value::number(round(frame.length / 4500.0 * d.between(0.05, 2.0)))));
            }
        }
        "stress" => keys.push(history(d, frame, 6e8, false)),
        "torque" => keys.push(history(d, frame, 3e7 * frame.size.powf(1.5), false)),
        "dashpot" => keys.push(("coefficient", Value::number(round(arm * impedance * d.decades(0.1, 10.0))))),
        "wall" if d.one_in(2) => keys.push(("gap", Value::unit(d.decades(1e-3, 1.0), "mm"))),
        "striker" => {
            let mass = round(arm * frame.size * 6000.0 * frame.length * d.decades(0.03, 10.0));
            keys.push(if frame.torsion { ("inertia", Value::number(mass)) } else { ("mass", Value::number(mass)) });
            keys.push(("velocity", Value::Signed(d.signed(0.02 * fastest, fastest), "")));
        }
        "spring" => {
            let stiffness = arm * frame.size * 1e11 / frame.length * d.decades(0.01, 100.0);
            keys.push(("stiffness", Value::number(round(stiffness))));
        }
        "ball" => ball(d, &mut keys),
        _ => {}
    }
    keys
}

fn ball(d: &mut Draw, keys: &mut Keys) {
    keys.push(("radius", Value::unit(d.between(3.0, 30.0), "mm")));
    keys.push(("velocity", Value::Signed(d.signed(0.5, 40.0), "m/s")));
    keys.push(("density", Value::unit(7.8, "g/cm^3")));
    keys.push(("bar-poisson", Value::number(0.3)));
    if d.one_in(2) {
        keys.push(("rigid", Value::Same("true".to_owned())));
    } else {
        keys.push(("modulus", Value::unit(200.0, "GPa")));
        keys.push(("poisson", Value::number(0.3)));
    }
}

/// Returns the history of an end: constant, a ramp, a pulse, or rows with jumps.
fn history(d: &mut Draw, frame: &Frame, largest: f64, signed: bool) -> (&'static str, Value) {
    let transit = frame.length / 4500.0;
    let value = |d: &mut Draw| d.signed(0.01 * largest, largest);
    let same = |rows: Vec<(f64, f64)>| {
        if signed {
            return Value::SignedRows(rows);
        }
        let rows: Vec<String> = rows.iter().map(|(t, v)| format!("[{t:e}, {v}]")).collect();
        Value::Same(format!("[{}]", rows.join(", ")))
    };
    let time = |d: &mut Draw| round(transit * d.decades(0.02, 2.0));
    match d.pick(&[0, 0, 1, 2, 3]) {
        0 => {
            let constant = value(d);
            ("value", if signed { Value::Signed(constant, "") } else { Value::number(constant) })
        }
        1 => {
            let rows = vec![(0.0, 0.0), (time(d), value(d))];
            ("history", same(rows))
        }
        2 => {
            let (top, rise) = (value(d), time(d));
            ("history", same(vec![(0.0, 0.0), (rise, top), (round(2.0 * rise), top), (round(3.0 * rise), 0.0)]))
        }
        _ => {
            let mut times: Vec<f64> = (0..3).map(|_| time(d)).collect();
            times.sort_by(f64::total_cmp);
            times.dedup();
            let mut rows = vec![(0.0, value(d))];
            for time in times {
                if d.one_in(2) {
                    rows.push((time, rows[rows.len() - 1].1));
                }
                rows.push((time, value(d)));
            }
            ("history", same(rows))
        }
    }
}

fn effects(d: &mut Draw, frame: &Frame) -> Keys {
    let mut keys = Keys::new();
    let hardening = d.pick(&["", "isotropic", "isotropic", "kinematic", "mixed", "armstrong-frederick"]);
    match hardening {
        "" => {}
        "mixed" => keys.push(("hardening", Value::Same(format!("{{ mixed = {} }}", d.between(0.0, 1.0))))),
        "armstrong-frederick" => {
            let (limit, gamma) = (d.decades(1e6, 1e9), d.decades(10.0, 1e4));
            let rule = format!("{{ armstrong-frederick = {{ C = {}, gamma = {gamma} }} }}", limit * gamma);
            keys.push(("hardening", Value::Same(rule)));
        }
        word => keys.push(("hardening", Value::word(word))),
    }
    if d.one_in(5) {
        keys.push(("rate", Value::Same(rate(d))));
    }
    if frame.heat && d.one_in(2) {
        keys.push(("heat", Value::Same(d.pick(&["{}", "{ fraction = 0.5 }", "{ fraction = 1 }"]).to_owned())));
    }
    if d.one_in(8) {
        let rupture = match d.pick(&[0, 1, 2]) {
            0 => "\"critical-strain\"".to_owned(),
            1 => format!("{{ energy = {} }}", d.decades(1e4, 1e8)),
            _ => format!("{{ spall = \"{} MPa\" }}", d.decades(20.0, 1000.0)),
        };
        keys.push(("rupture", Value::Same(rupture)));
    }
    if d.one_in(8) {
        keys.push(("damping", Value::Same(damping(d, frame))));
    }
    if d.one_in(15) {
        keys.push(("lateral-inertia", Value::Same("true".to_owned())));
    }
    keys
}

fn rate(d: &mut Draw) -> String {
    match d.pick(&[0, 1, 2, 3, 4]) {
        0 => "\"material\"".to_owned(),
        1 => format!("{{ model = \"malvern\", k = {} }}", d.decades(1e3, 1e8)),
        2 => format!("{{ model = \"cowper-symonds\", D = {}, q = {} }}", d.decades(10.0, 1e5), d.between(1.0, 6.0)),
        3 => format!("{{ model = \"johnson-cook\", C = {}, reference = \"1 1/s\" }}", d.decades(1e-3, 0.1)),
        _ => "{ model = \"zerilli-armstrong\", C1 = \"1 GPa\", C3 = 0.007, C4 = 0.0004, reference = 1e-3 }".to_owned(),
    }
}

fn damping(d: &mut Draw, frame: &Frame) -> String {
    // Relative to a bar of this length and an impedance of 40 MPa s/m.
    let drag = frame.size * 3e7 / frame.length;
    let parts = [
        format!("internal = {}", round(200e9 * frame.length / 4500.0 * d.decades(1e-4, 0.1))),
        format!("external = {}", round(drag * d.decades(0.01, 10.0))),
        format!("foundation = {}", round(drag * 4500.0 / frame.length * d.decades(0.01, 30.0))),
        format!("friction = {}", round(drag * d.decades(0.01, 10.0))),
    ];
    let first = (d.bits() % 4) as usize;
    let second = (d.bits() % 4) as usize;
    if first == second {
        format!("{{ {} }}", parts[first])
    } else {
        format!("{{ {}, {} }}", parts[first], parts[second])
    }
}
