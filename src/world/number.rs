//! Numbers that may be NaN or infinite, in JSON: finite ones as numbers, the others as the words `nan`, `inf`, `-inf`.
//!
//! Evidence is saved and judged again: a NaN that a robot published must come back as a NaN.

use serde::{Deserialize, Deserializer, Serializer};

#[derive(Deserialize)]
#[serde(untagged)]
enum Written {
    Number(f64),
    Word(String),
}

/// The number as a word where JSON has no number for it.
fn word(value: f64) -> &'static str {
    if value.is_nan() {
        "nan"
    } else if value > 0.0 {
        "inf"
    } else {
        "-inf"
    }
}

fn value<E: serde::de::Error>(written: Written) -> Result<f64, E> {
    match written {
        Written::Number(value) => Ok(value),
        Written::Word(word) => match word.as_str() {
            "nan" => Ok(f64::NAN),
            "inf" => Ok(f64::INFINITY),
            "-inf" => Ok(f64::NEG_INFINITY),
            other => Err(E::custom(format!("`{other}` is no number"))),
        },
    }
}

/// Writes one number.
pub fn serialize<S: Serializer>(value: &f64, out: S) -> Result<S::Ok, S::Error> {
    if value.is_finite() {
        out.serialize_f64(*value)
    } else {
        out.serialize_str(word(*value))
    }
}

/// Reads one number.
pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    value(Written::deserialize(from)?)
}

/// Lists of such numbers.
pub mod list {
    use serde::ser::SerializeSeq;
    use serde::{Deserialize, Deserializer, Serializer};

    /// Writes a list.
    pub fn serialize<S: Serializer>(values: &[f64], out: S) -> Result<S::Ok, S::Error> {
        let mut list = out.serialize_seq(Some(values.len()))?;
        for value in values {
            if value.is_finite() {
                list.serialize_element(value)?;
            } else {
                list.serialize_element(super::word(*value))?;
            }
        }
        list.end()
    }

    /// Reads a list.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        let written = Vec::<super::Written>::deserialize(from)?;
        written.into_iter().map(super::value).collect()
    }
}

/// Arrays of such numbers.
pub mod array {
    use serde::{Deserializer, Serializer};

    /// Writes an array.
    pub fn serialize<S: Serializer, const N: usize>(values: &[f64; N], out: S) -> Result<S::Ok, S::Error> {
        super::list::serialize(values, out)
    }

    /// Reads an array of exactly `N`.
    pub fn deserialize<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<[f64; N], D::Error> {
        let values = super::list::deserialize(from)?;
        let given = values.len();
        values
            .try_into()
            .map_err(|_| serde::de::Error::custom(format!("{given} numbers, {N} needed")))
    }
}
