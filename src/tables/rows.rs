//! Rows of a table: the user's own in front of those that come with the program.
//!
//! Owns their reading. A table of this program that cannot be read is a bug here: the tests read every one. At run time such a table is
//! empty.

use std::fmt;
use std::sync::{Arc, LazyLock};

use serde::Deserialize;
use serde::de::DeserializeOwned;

/// Conditions on a row beyond its types.
pub trait Row: DeserializeOwned {
    /// Its source; a user's row may omit it, and gets its own place.
    fn source_mut(&mut self) -> &mut String;

    /// The key that is wrong, and what it requires.
    fn fault(&self) -> Option<(&'static str, &'static str)> {
        None
    }
}

/// The rows of one table, the user's first.
pub struct Rows<T: 'static> {
    own: Vec<Arc<T>>,
    built_in: &'static LazyLock<Vec<Arc<T>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File<T> {
    rows: Vec<T>,
}

/// The rows of a table that comes with the program.
pub(super) fn built_in<T>(file: Result<File<T>, serde_json::Error>) -> Vec<Arc<T>> {
    let rows = file.map(|file| file.rows).unwrap_or_default();
    rows.into_iter().map(Arc::new).collect()
}

impl<T> Rows<T> {
    /// Those that come with the program.
    pub(super) fn of(built_in: &'static LazyLock<Vec<Arc<T>>>) -> Self {
        let own = Vec::new();
        Self { own, built_in }
    }
}

impl<T: Row> Rows<T> {
    /// Adds a row of the user's after those that were added before it.
    pub(super) fn add(&mut self, row: &serde_yaml::Value, origin: &str) -> Result<(), RowFault> {
        self.own.push(Arc::new(parsed(row, origin)?));
        Ok(())
    }
}

impl<T> Rows<T> {
    /// All of them; the first match counts.
    pub fn iter(&self) -> impl Iterator<Item = &Arc<T>> {
        self.own.iter().chain(self.built_in.iter())
    }

    /// Those of the user alone.
    pub fn own(&self) -> &[Arc<T>] {
        &self.own
    }
}

impl<T> Clone for Rows<T> {
    fn clone(&self) -> Self {
        Self {
            own: self.own.clone(),
            built_in: self.built_in,
        }
    }
}

impl<T: fmt::Debug> fmt::Debug for Rows<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

/// The fault of a row of the user's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RowFault {
    /// The keys from the row down to the fault; empty if it is the row itself.
    pub keys: Vec<String>,
    /// The message.
    pub message: String,
}

fn parsed<T: Row>(row: &serde_yaml::Value, origin: &str) -> Result<T, RowFault> {
    let mut typed: T = serde_yaml::from_value(row.clone()).map_err(|error| {
        let message = error.to_string();
        let is_missing = message.starts_with("missing field");
        RowFault {
            keys: if is_missing {
                Vec::new()
            } else {
                culprit::<T>(row, &message)
            },
            message,
        }
    })?;
    if let Some((key, message)) = typed.fault() {
        return Err(RowFault {
            keys: vec![key.to_owned()],
            message: message.to_owned(),
        });
    }
    let source = typed.source_mut();
    if source.is_empty() {
        origin.clone_into(source);
    }
    Ok(typed)
}

/// The key whose removal changes the error, and so on inside of it: errors of typed values have no place of their own.
fn culprit<T: Row>(row: &serde_yaml::Value, message: &str) -> Vec<String> {
    let mut keys: Vec<String> = Vec::new();
    loop {
        let Some(inner) = at(row, &keys).and_then(serde_yaml::Value::as_mapping) else {
            return keys;
        };
        let names: Vec<String> = inner.keys().filter_map(|key| Some(key.as_str()?.to_owned())).collect();
        let is_it = |name: &String| {
            let mut path = keys.clone();
            path.push(name.clone());
            let error = serde_yaml::from_value::<T>(without(row, &path)).err();
            error.is_none_or(|error| error.to_string() != message)
        };
        let Some(next) = names.into_iter().find(is_it) else {
            return keys;
        };
        keys.push(next);
    }
}

fn at<'v>(value: &'v serde_yaml::Value, keys: &[String]) -> Option<&'v serde_yaml::Value> {
    keys.iter().try_fold(value, |value, key| value.get(key.as_str()))
}

fn without(value: &serde_yaml::Value, path: &[String]) -> serde_yaml::Value {
    let mut copy = value.clone();
    if let Some((last, above)) = path.split_last() {
        let holder = above
            .iter()
            .try_fold(&mut copy, |value, key| value.get_mut(key.as_str()));
        if let Some(mapping) = holder.and_then(serde_yaml::Value::as_mapping_mut) {
            mapping.remove(last.as_str());
        }
    }
    copy
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Inner {
        unit_s: f64,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Sample {
        name: String,
        #[serde(default)]
        time: Option<Inner>,
        #[serde(default)]
        source: String,
    }

    impl Row for Sample {
        fn source_mut(&mut self) -> &mut String {
            &mut self.source
        }

        fn fault(&self) -> Option<(&'static str, &'static str)> {
            self.name.is_empty().then_some(("name", "a name is expected"))
        }
    }

    fn fault(text: &str) -> RowFault {
        parsed::<Sample>(&serde_yaml::from_str(text).unwrap(), "ours:1").unwrap_err()
    }

    #[test]
    fn the_users_rows_come_first_and_say_where_they_stand() {
        static ROWS: LazyLock<Vec<Arc<Sample>>> =
            LazyLock::new(|| built_in(serde_json::from_str(r#"{"rows": [{"name": "a", "source": "b"}]}"#)));
        let mut rows = Rows::of(&ROWS);
        rows.add(
            &serde_yaml::from_str("{name: c, time: {unit_s: 1.0}}").unwrap(),
            "ours:1",
        )
        .unwrap();
        let all: Vec<(&str, &str)> = rows
            .iter()
            .map(|row| (row.name.as_str(), row.source.as_str()))
            .collect();
        assert_eq!(all, [("c", "ours:1"), ("a", "b")]);
        assert!((rows.own()[0].time.as_ref().unwrap().unit_s - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_fault_says_the_key() {
        assert_eq!(fault("{name: a, nmae: b}").keys, ["nmae"]);
        assert_eq!(fault("{name: a, time: {unit_s: fast}}").keys, ["time", "unit_s"]);
        assert_eq!(fault("{name: a, time: {unit: 1}}").keys, ["time", "unit"]);
        assert_eq!(fault("{name: ''}").keys, ["name"]);
        let missing = fault("{time: {unit_s: 1.0}}");
        assert_eq!(
            (missing.keys.len(), missing.message.as_str()),
            (0, "missing field `name`")
        );
    }
}
