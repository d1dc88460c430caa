//! Former names of keys, which are still accepted.

/// Deprecated keys that are still accepted: table, old name, present name.
pub const DEPRECATED_KEYS: [(&str, &str, &str); 5] = [
    ("effects", "unloading", "hardening"),
    ("solve", "event-budget", "max-events"),
    ("bar.segment", "notch", "stress-concentration"),
    ("bar.segment", "joint-notch", "joint-stress-concentration"),
    ("specimen", "notch", "stress-concentration"),
];

/// Returns the present name of a key of a top-level table.
pub(super) fn present<'a>(table: &str, key: &'a str) -> &'a str {
    let renamed = DEPRECATED_KEYS.iter().find(|(of, old, _)| *of == table && *old == key);
    renamed.map_or(key, |(.., new)| new)
}

/// Returns the old name of a key, if it has one.
pub(super) fn old_name(name: &str) -> Option<&'static str> {
    DEPRECATED_KEYS.iter().find(|(.., new)| *new == name).map(|(_, old, _)| *old)
}

/// Returns whether `name` is a deprecated name in the table that contains the dotted key `key`.
pub(super) fn is_deprecated(key: &str, name: &str) -> bool {
    let mut parts: Vec<&str> = key.split('.').filter(|part| part.parse::<usize>().is_err()).collect();
    parts.pop();
    let table = parts.join(".");
    DEPRECATED_KEYS.iter().any(|(of, old, _)| *of == table && *old == name)
}
