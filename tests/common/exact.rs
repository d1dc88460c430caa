//! The exact bar cases of `tests/data/exact_bar_cases.json`, in units of rho = c0 = E = `sigma_y` = 1.
#![allow(dead_code, reason = "every test file takes what it needs")]

use std::sync::OnceLock;

use barwave::bar::{EndCondition, History};
use serde::Deserialize;

#[derive(Deserialize)]
struct Cases {
    wall: Vec<Case>,
    pulse: Vec<Case>,
    tension: Vec<Case>,
    hardening: Vec<Case>,
}

/// One case. Numbers are texts such as "-9/8", see [`number`].
#[derive(Deserialize)]
pub struct Case {
    pub name: String,
    #[serde(rename = "L")]
    pub length: String,
    pub r: String,
    #[serde(rename = "V0")]
    pub velocity: String,
    pub iso: bool,
    pub t_final: String,
    pub momentum: String,
    pub kinetic: String,
    pub elastic: String,
    pub ep_profile: Vec<[String; 3]>,
    pub left_history: Vec<[String; 3]>,
    pub right_history: Vec<[String; 3]>,
    pub state: Vec<[String; 4]>,
}

/// All cases of the file.
pub fn cases() -> &'static [Case] {
    static CASES: OnceLock<Vec<Case>> = OnceLock::new();
    CASES.get_or_init(|| {
        let file: Cases = serde_json::from_str(include_str!("../data/exact_bar_cases.json")).expect("valid file");
        [file.wall, file.pulse, file.tension, file.hardening].into_iter().flatten().collect()
    })
}

/// Parses a number such as "-9/8".
pub fn number(text: &str) -> f64 {
    let (n, d) = text.split_once('/').unwrap_or((text, "1"));
    n.parse::<f64>().expect("numerator") / d.parse::<f64>().expect("denominator")
}

pub fn numbers<const N: usize>(row: &[String; N]) -> [f64; N] {
    std::array::from_fn(|k| number(&row[k]))
}

/// Returns the conditions at both ends of a case, which its name states.
pub fn ends(case: &Case) -> [EndCondition; 2] {
    let (kind, rest) = case.name.split_once('_').expect("kind_...");
    let strength = |mark: char| number(&rest[rest.rfind(mark).expect("strength") + 1..]);
    match kind {
        "wall" => [EndCondition::Wall { gap: 0.0 }, EndCondition::Free],
        "stresspulse" => {
            let s = -strength('S');
            let rows = [(0.0, s), (1.0, s), (1.0, 0.0)];
            [EndCondition::Stress { history: History::new(&rows).expect("in order") }, EndCondition::Absorbing]
        }
        "velpulse" => {
            let history = History::constant(strength('V'));
            [EndCondition::Velocity { history, release: Some(1.0) }, EndCondition::Absorbing]
        }
        "tension" => {
            let far = if rest.starts_with("fixed") { EndCondition::Fixed } else { EndCondition::Free };
            let history = History::constant(-strength('V'));
            [EndCondition::Velocity { history, release: None }, far]
        }
        other => panic!("unknown case {other}"),
    }
}
