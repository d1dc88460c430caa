//! Notes on deprecated keys, which are still accepted under their old names.

use toml::Value;

use super::overrides::Overrides;
use crate::input::DEPRECATED_KEYS;

/// Returns one note for each deprecated key in a scene's text or overrides.
pub(super) fn notes(text: &str, overrides: &[String]) -> Vec<String> {
    let mut keys = Overrides::new(overrides).map(|typed| typed.keys()).unwrap_or_default();
    if let Ok(table) = toml::from_str::<toml::Table>(text) {
        collect(&Value::Table(table), "", &mut keys);
    }
    let given = DEPRECATED_KEYS.iter().filter(|(table, old, _)| keys.contains(&format!("{table}.{old}")));
    given.map(|(table, old, new)| format!("the key `{old}` in [{table}] is deprecated; use `{new}`")).collect()
}

/// Collects all dotted keys, without the indices of lists.
fn collect(value: &Value, key: &str, keys: &mut Vec<String>) {
    match value {
        Value::Table(table) => {
            for (name, value) in table {
                let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                collect(value, &key, keys);
                keys.push(key);
            }
        }
        Value::Array(items) => items.iter().for_each(|item| collect(item, key, keys)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::notes;

    #[test]
    fn deprecated_keys_are_noted_wherever_they_are_given() {
        let text =
            "[record]\ngauges = { notch = 1 }\n[effects]\nunloading = \"isotropic\"\n[[bar.segment]]\nnotch = 2\n";
        let found = notes(text, &["solve.event-budget=5".to_owned()]);
        assert_eq!(
            found,
            [
                "the key `unloading` in [effects] is deprecated; use `hardening`",
                "the key `event-budget` in [solve] is deprecated; use `max-events`",
                "the key `notch` in [bar.segment] is deprecated; use `stress-concentration`",
            ]
        );
        assert!(notes("[effects]\nhardening = \"isotropic\"\n", &[]).is_empty());
    }
}
