//! The generated pages: keys from `barwave schema`, commands from `--help`.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::process::Command;

use serde_json::{Map, Value};

pub fn barwave(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_barwave"))
        .args(arguments)
        .env_remove("COLUMNS")
        .output()
        .expect("the program starts");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// Names of the commands that a help text lists.
pub fn commands(help: &str) -> Vec<String> {
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    // Continuation lines are indented further.
    let names = listed.filter(|line| !line.starts_with("   ")).filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "help").map(str::to_owned).collect()
}

/// The help of every command.
pub fn command_pages() -> String {
    let mut text = String::new();
    let mut waiting: Vec<Vec<String>> = vec![Vec::new()];
    while let Some(path) = waiting.pop() {
        let arguments: Vec<&str> = path.iter().map(String::as_str).chain(["--help"]).collect();
        let help = barwave(&arguments);
        let name = ["barwave".to_owned()].iter().chain(&path).cloned().collect::<Vec<_>>().join(" ");
        let body: Vec<&str> = help.lines().map(str::trim_end).collect();
        let _ = write!(text, "## {name}\n\n```text\n{}\n```\n\n", body.join("\n").trim_end());
        let below = commands(&help).into_iter().map(|sub| [path.clone(), vec![sub]].concat());
        waiting.extend(below.collect::<Vec<_>>().into_iter().rev());
    }
    text.trim_end().to_owned() + "\n"
}

/// One section of a key reference: its heading and where it is in the schema: a definition, or the root.
pub struct Section {
    pub heading: &'static str,
    pub definition: &'static str,
}

/// Tables of keys of a schema.
pub struct Schema {
    schema: Value,
    /// Definitions that were needed for values, so that none is forgotten.
    named: BTreeSet<String>,
}

impl Schema {
    pub fn of(file: &str) -> Self {
        let schema = serde_json::from_str(&barwave(&["schema", file])).expect("JSON");
        Self { schema, named: BTreeSet::new() }
    }

    fn definition(&self, name: &str) -> Value {
        if name.is_empty() { self.schema.clone() } else { self.schema["$defs"][name].clone() }
    }

    /// Sections with their tables; every object with keys has to be in one of them, or on a page of its own (`elsewhere`).
    pub fn tables_without(mut self, sections: &[Section], elsewhere: &[&str]) -> String {
        let mut text = String::new();
        for section in sections {
            let definition = self.definition(section.definition);
            if definition["anyOf"].is_array() {
                text += &self.kinds(section.heading, &definition);
                continue;
            }
            let properties = definition["properties"].as_object().unwrap_or_else(|| panic!("{}", section.definition));
            let required: Vec<&str> =
                definition["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
            let _ = write!(text, "## {}\n\n", section.heading);
            if !section.definition.is_empty() {
                let _ = write!(text, "{}\n\n", sentence(&definition));
            }
            text += "| key | value | meaning |\n|---|---|---|\n";
            for (key, property) in properties {
                let value = self.value(property);
                let mark = if required.contains(&key.as_str()) { " (required)" } else { "" };
                let _ = writeln!(text, "| `{key}`{mark} | {value} | {} |", self.meaning(property));
            }
            text += "\n";
        }
        let shown: BTreeSet<String> = sections.iter().map(|section| section.definition.to_owned()).collect();
        let missing = self.named.difference(&shown).filter(|name| !elsewhere.contains(&name.as_str()));
        let missing: Vec<&String> = missing.collect();
        assert!(missing.is_empty(), "no section for {missing:?}");
        text.trim_end().to_owned() + "\n"
    }

    /// A table with keys that depend on its `kind`.
    fn kinds(&mut self, heading: &str, definition: &Value) -> String {
        let mut text = format!("## {heading}\n\n{}\n\n", sentence(definition));
        text += "| kind | key | value | meaning |\n|---|---|---|---|\n";
        for kind in definition["anyOf"].as_array().into_iter().flatten() {
            let properties = kind["properties"].as_object().expect("keys");
            let word = properties["kind"]["const"].as_str().expect("a kind");
            let _ = writeln!(text, "| `\"{word}\"` | | | {} |", sentence(kind));
            let required: Vec<&str> =
                kind["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
            for (key, property) in properties.iter().filter(|(key, _)| *key != "kind") {
                let mark = if required.contains(&key.as_str()) { " (required)" } else { "" };
                let value = self.value(property);
                let _ = writeln!(text, "| | `{key}`{mark} | {value} | {} |", self.meaning(property));
            }
        }
        text + "\n"
    }

    /// What a key may be, in words.
    fn value(&mut self, property: &Value) -> String {
        if let Some(value) = property["x-value"].as_str() {
            return value.to_owned();
        }
        if let Some(reference) = property["$ref"].as_str() {
            let name = reference.trim_start_matches("#/$defs/").to_owned();
            if name == "Quantity" {
                return "quantity".to_owned();
            }
            let definition = self.definition(&name);
            if definition["properties"].is_object() {
                self.named.insert(name);
                return "table".to_owned();
            }
            if definition["anyOf"][0]["properties"]["kind"].is_object() {
                self.named.insert(name);
                return "table".to_owned();
            }
            return self.value(&definition);
        }
        if let Some(constant) = property["const"].as_str() {
            return format!("`\"{constant}\"`");
        }
        for choice in ["anyOf", "oneOf"] {
            if let Some(options) = property[choice].as_array() {
                let values: Vec<String> =
                    options.iter().filter(|option| option["type"] != "null").map(|option| self.value(option)).collect();
                return values.join(", ");
            }
        }
        if let Some(properties) = property["properties"].as_object() {
            let keys: Vec<String> = properties.keys().map(|key| format!("{key} = ...")).collect();
            return format!("`{{ {} }}`", keys.join(", "));
        }
        let kind = property["type"].as_array().and_then(|kinds| kinds[0].as_str()).or(property["type"].as_str());
        match kind {
            Some("array") => format!("array of: {}", self.value(&property["items"])),
            Some("object") => "table".to_owned(),
            Some("integer") => "integer".to_owned(),
            Some("number") => "number".to_owned(),
            Some(other) => other.to_owned(),
            None => "value".to_owned(),
        }
    }

    /// The description of a key, followed by those of its words.
    fn meaning(&self, property: &Value) -> String {
        let mut text = sentence(property);
        for option in self.options(property) {
            let (name, meaning) = (Self::name(&option), sentence(&option));
            if let (Some(name), false) = (name, meaning.is_empty()) {
                let value = option["properties"].as_object().and_then(|keys| keys.values().next()?["x-value"].as_str());
                let value = value.map(|value| format!(", {value}")).unwrap_or_default();
                let _ = write!(text, "<br>{name}{value}: {meaning}");
            }
        }
        text
    }

    fn name(option: &Value) -> Option<String> {
        let constant = option["const"].as_str().map(|constant| format!("`\"{constant}\"`"));
        let keys = |properties: &Map<String, Value>| {
            format!("`{{ {} }}`", properties.keys().map(|k| format!("{k} = ...")).collect::<Vec<_>>().join(", "))
        };
        constant.or_else(|| option["properties"].as_object().filter(|keys| keys.len() == 1).map(keys))
    }

    /// Words and small tables that a key may be.
    fn options(&self, property: &Value) -> Vec<Value> {
        if let Some(reference) = property["$ref"].as_str() {
            let definition = self.definition(reference.trim_start_matches("#/$defs/"));
            let table =
                definition["properties"].is_object() || definition["anyOf"][0]["properties"]["kind"].is_object();
            return if table { Vec::new() } else { self.options(&definition) };
        }
        let lists = ["anyOf", "oneOf"].into_iter().filter_map(|choice| property[choice].as_array()).flatten();
        lists
            .flat_map(|option| if Self::name(option).is_some() { vec![option.clone()] } else { self.options(option) })
            .collect()
    }
}

/// A description on one line of a table; what the value may be has a column of its own.
fn sentence(value: &Value) -> String {
    let text = value["description"].as_str().unwrap_or_default();
    let value = format!("Value: {}.", value["x-value"].as_str().unwrap_or_default());
    text.strip_suffix(&value).unwrap_or(text).trim().replace('\n', " ").replace('|', "\\|")
}
