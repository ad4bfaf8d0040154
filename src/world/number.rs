//! Numbers that may be NaN or infinite, in JSON: finite ones as numbers, the others as `nan`, `inf`, `-inf`.
//!
//! Evidence is saved and judged again: a NaN that a robot published must come back as a NaN.

use std::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A number in this form.
struct Number(f64);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        serialize(&self.0, out)
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Reader).map(Self)
    }
}

struct Reader;

impl Visitor<'_> for Reader {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, or `nan`, `inf`, `-inf`")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<f64, E> {
        Ok(value)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<f64, E> {
        Ok(value as f64)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<f64, E> {
        Ok(value as f64)
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<f64, E> {
        match word {
            "nan" => Ok(f64::NAN),
            "inf" => Ok(f64::INFINITY),
            "-inf" => Ok(f64::NEG_INFINITY),
            other => Err(E::custom(format!("`{other}` is not a number"))),
        }
    }
}

/// Writes one number.
pub fn serialize<S: Serializer>(value: &f64, out: S) -> Result<S::Ok, S::Error> {
    if value.is_finite() {
        out.serialize_f64(*value)
    } else if value.is_nan() {
        out.serialize_str("nan")
    } else {
        out.serialize_str(if *value > 0.0 { "inf" } else { "-inf" })
    }
}

/// Reads one number.
pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Number::deserialize(from).map(|number| number.0)
}

/// Such a number, or none.
pub mod option {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Number;

    /// Writes it.
    #[allow(clippy::ref_option)] // as serde calls it
    pub fn serialize<S: Serializer>(value: &Option<f64>, out: S) -> Result<S::Ok, S::Error> {
        value.map(Number).serialize(out)
    }

    /// Reads it.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
        Ok(Option::<Number>::deserialize(from)?.map(|number| number.0))
    }
}

/// Lists of such numbers.
pub mod list {
    use serde::{Deserialize, Deserializer, Serializer};

    use super::Number;

    /// Writes a list.
    pub fn serialize<S: Serializer>(values: &[f64], out: S) -> Result<S::Ok, S::Error> {
        out.collect_seq(values.iter().map(|value| Number(*value)))
    }

    /// Reads a list.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        let numbers = Vec::<Number>::deserialize(from)?;
        Ok(numbers.into_iter().map(|number| number.0).collect())
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

/// Arrays of such numbers, or none.
pub mod option_array {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Number;

    /// Writes it.
    #[allow(clippy::ref_option)] // as serde calls it
    pub fn serialize<S: Serializer, const N: usize>(values: &Option<[f64; N]>, out: S) -> Result<S::Ok, S::Error> {
        values
            .map(|values| values.map(Number).into_iter().collect::<Vec<_>>())
            .serialize(out)
    }

    /// Reads it.
    pub fn deserialize<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<Option<[f64; N]>, D::Error> {
        let Some(numbers) = Option::<Vec<Number>>::deserialize(from)? else {
            return Ok(None);
        };
        let values: Vec<f64> = numbers.into_iter().map(|number| number.0).collect();
        let given = values.len();
        let array = values.try_into();
        array
            .map(Some)
            .map_err(|_| D::Error::custom(format!("{given} numbers, {N} needed")))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde::{Deserialize, Serialize};

    #[derive(Serialize, Deserialize)]
    struct All {
        #[serde(with = "super")]
        one: f64,
        #[serde(with = "super::option")]
        perhaps: Option<f64>,
        #[serde(with = "super::list")]
        list: Vec<f64>,
        #[serde(with = "super::array")]
        array: [f64; 3],
        #[serde(with = "super::option_array")]
        perhaps_array: Option<[f64; 2]>,
    }

    /// Bits, equal for all NaNs.
    fn bits(value: f64) -> u64 {
        if value.is_nan() {
            f64::NAN.to_bits()
        } else {
            value.to_bits()
        }
    }

    fn back(all: &All) -> Result<All, serde_json::Error> {
        serde_json::from_str(&serde_json::to_string(all)?)
    }

    proptest! {
        #[test]
        fn every_number_comes_back_bit_for_bit(words in proptest::array::uniform8(any::<u64>()), some: bool) {
            let [a, b, c, d, e, f, g, h] = words.map(f64::from_bits);
            let all = All { one: a, perhaps: some.then_some(b), list: vec![c, d], array: [e, f, -0.0],
                            perhaps_array: some.then_some([g, h]) };
            let again = back(&all).unwrap();
            prop_assert_eq!(bits(again.one), bits(a));
            prop_assert_eq!(again.perhaps.map(bits), all.perhaps.map(bits));
            prop_assert_eq!(again.list.iter().map(|v| bits(*v)).collect::<Vec<_>>(), [bits(c), bits(d)]);
            prop_assert_eq!(again.array.map(bits), all.array.map(bits));
            prop_assert_eq!(again.perhaps_array.map(|v| v.map(bits)), all.perhaps_array.map(|v| v.map(bits)));
        }
    }

    #[test]
    fn words_stand_for_what_json_has_no_number_for() {
        let all = All {
            one: f64::NAN,
            perhaps: Some(f64::INFINITY),
            list: vec![f64::NEG_INFINITY],
            array: [0.0; 3],
            perhaps_array: None,
        };
        let text = serde_json::to_string(&all).unwrap();
        assert!(
            text.starts_with(r#"{"one":"nan","perhaps":"inf","list":["-inf"],"#),
            "{text}"
        );
        assert!(serde_json::from_str::<All>(&text.replace("-inf", "many")).is_err());
        assert!(serde_json::from_str::<All>(&text.replace("[\"-inf\"]", "7")).is_err());
        assert!(serde_json::from_str::<All>(&text.replace("[0.0,0.0,0.0]", "[1,2]")).is_err());
        assert!(serde_json::from_str::<All>(&text.replace("[0.0,0.0,0.0]", "[1,-2,3.0]")).is_ok());
    }
}
