//! JSON parsing with errors that name line and key.

use super::schema::Schema;
use super::source::shown;
use crate::error::{Error, Result};
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeOwned, Deserializer, Error as _, MapAccess, Visitor};
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;
use std::path::Path;

/// Parses a JSON text.
///
/// # Errors
/// Invalid JSON; an unknown, missing or duplicate key; a value of another type. All with line and key.
pub fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let value = serde_path_to_error::deserialize(&mut deserializer)
        .map_err(|error| explain(path, &error.path().to_string(), error.inner()))?;
    // Trailing text is invalid too.
    deserializer.end().map_err(|error| explain(path, ".", &error))?;
    Ok(value)
}

/// Parses a JSON text after a check of the version in its `schema`; older versions are converted.
///
/// # Errors
/// As [`parse`]; a newer version, or another format.
pub fn parse_version<T: DeserializeOwned>(path: &Path, text: &str, schema: &Schema) -> Result<T> {
    let mut value: serde_json::Value = parse(path, text)?;
    let id = value["schema"].as_str().unwrap_or_default();
    match schema.version_of(id) {
        Some(version) if version == schema.version() => parse(path, text),
        Some(version) if version < schema.version() => {
            // Where nothing else changes, errors keep their lines.
            let current = text.replacen(id, &schema.id(), 1);
            schema.convert(version, &mut value);
            if parse::<serde_json::Value>(path, &current)? == value {
                return parse(path, &current);
            }
            serde_path_to_error::deserialize(value)
                .map_err(|error| explain(path, &error.path().to_string(), error.inner()))
        }
        _ => {
            let found = shown(&value["schema"].to_string());
            Err(Error::input(path, None, "schema", found, schema.expected(id)))
        }
    }
}

/// Splits the parser's message into field, found and expected.
fn explain(path: &Path, key: &str, error: &serde_json::Error) -> Error {
    let message = error.to_string();
    let message = message.rsplit_once(" at line ").map_or(&message[..], |(message, _)| message);
    // A dot stands for the whole file, a question mark for a place without a key.
    let key = if [".", "?"].contains(&key) { "" } else { key };
    let within = |name: &str| match key.strip_suffix(name) {
        Some(outer) if outer.is_empty() || outer.ends_with('.') => key.to_string(),
        _ if key.is_empty() => name.to_string(),
        _ => format!("{key}.{name}"),
    };
    let name = || message.split('`').nth(1).unwrap_or_default();
    let (key, found, expected) = if message.starts_with("missing field") {
        (within(name()), "nothing", "a value")
    } else if message.starts_with("duplicate field") {
        (within(name()), "it twice", "every key once")
    } else if message.starts_with("unknown field") {
        (
            within(name()),
            "an unknown key",
            message.split_once(", expected ").map_or("none", |(_, known)| known),
        )
    } else {
        let (found, expected) = message.split_once(", expected ").unwrap_or((message, "JSON"));
        // A file that does not start with a value is of another kind.
        let is_other = key.is_empty() && found == "expected value";
        let (found, expected) =
            if is_other { ("no JSON", "a JSON file, as material.json") } else { (found, expected) };
        let found = found.trim_start_matches("invalid type: ").trim_start_matches("invalid value: ");
        let key = if key.is_empty() { "JSON" } else { key };
        (key.to_string(), found, if expected == "f64" { "a number" } else { expected })
    };
    // A converted value has no lines.
    let line = Some(error.line()).filter(|line| *line > 0);
    Error::input(path, line, shown(&key), shown(found), expected.replace('`', ""))
}

/// A value that may be absent but not null.
///
/// # Errors
/// Null, or another type.
pub fn there<'de, D: Deserializer<'de>, T: DeserializeOwned>(
    deserializer: D,
) -> std::result::Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

/// A map with unique keys: by default the last duplicate would win silently.
///
/// # Errors
/// A duplicate key.
pub fn unique<'de, D, K, V>(deserializer: D) -> std::result::Result<BTreeMap<K, V>, D::Error>
where
    D: Deserializer<'de>,
    K: DeserializeOwned + Ord,
    V: DeserializeOwned,
{
    struct Unique<K, V>(PhantomData<(K, V)>);

    impl<'de, K: DeserializeOwned + Ord, V: DeserializeOwned> Visitor<'de> for Unique<K, V> {
        type Value = BTreeMap<K, V>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a map")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> std::result::Result<Self::Value, A::Error> {
            let mut map = BTreeMap::new();
            // Read as text first, so that errors below include the key in their path.
            while let Some(name) = entries.next_key::<String>()? {
                let key = K::deserialize(StrDeserializer::<A::Error>::new(&name))?;
                if map.contains_key(&key) {
                    return Err(A::Error::custom(format!("duplicate field `{name}`")));
                }
                map.insert(key, entries.next_value()?);
            }
            Ok(map)
        }
    }

    deserializer.deserialize_map(Unique(PhantomData))
}
