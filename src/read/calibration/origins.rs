//! Origins of local frames on the Earth: `datum: [48.1, 11.6, 0.0]`, `map_origin: {latitude: ..., longitude: ...}`.
//!
//! Owns how the table of formats is applied to a document. Must not know which origin a robot uses.

use crate::math::rotation::decimals_of;
use crate::source::{Place, SourceId};
use crate::tables::{OriginFormat, earth_origins};
use crate::world::{EarthOrigin, FrameId};

use super::document::Node;
use super::numbers;

/// All origins of a document, in its order. An origin that is switched off by another key, or belongs to a simulated receiver, does not count.
pub(super) fn collect(root: &Node, source: SourceId) -> Vec<EarthOrigin> {
    let mut found = Vec::new();
    let mut stack = vec![(root, String::new())];
    while let Some((node, path)) = stack.pop() {
        if is_pretended(&path) {
            continue;
        }
        for format in &earth_origins().formats {
            found.extend(of_format(format, node, &path, source));
        }
        for (key, value) in node.pairs().iter().filter(|(_, value)| value.text().is_none()) {
            let key = key.text().unwrap_or("?");
            let label = if path.is_empty() {
                key.to_owned()
            } else {
                format!("{path}/{key}")
            };
            stack.push((value, label));
        }
        let items = node.items().unwrap_or_default().iter().enumerate();
        let nested = items.filter(|(_, item)| item.text().is_none());
        stack.extend(nested.map(|(index, item)| (item, format!("{path}/{index}"))));
    }
    found.sort_by(|a: &EarthOrigin, b| (&a.place, &a.format).cmp(&(&b.place, &b.format)));
    found.dedup_by(|a, b| a.place == b.place);
    found
}

fn is_pretended(path: &str) -> bool {
    let last = path.rsplit('/').next().unwrap_or_default();
    let words = FrameId::new(last).tokens();
    words.iter().any(|word| earth_origins().pretended.contains(word))
}

/// What a format finds in a mapping.
fn of_format(format: &OriginFormat, node: &Node, path: &str, source: SourceId) -> Option<EarthOrigin> {
    let is_on = |key: &String| {
        node.get(key)
            .and_then(Node::text)
            .is_some_and(|text| text.eq_ignore_ascii_case("true"))
    };
    if !format.only_if.as_ref().is_none_or(is_on) {
        return None;
    }
    let named = format
        .projection
        .as_ref()
        .and_then(|key| node.get(key))
        .and_then(Node::text);
    let made = |position: Option<[f64; 2]>, altitude_m: Option<f64>, key: &str, place: &Node| EarthOrigin {
        format: format.format.clone(),
        label: [path, key]
            .iter()
            .filter(|part| !part.is_empty())
            .copied()
            .collect::<Vec<_>>()
            .join("/"),
        latitude_longitude_deg: position,
        altitude_m,
        decimals: position.map_or(0, |position| {
            position.iter().map(|v| decimals_of(*v)).min().unwrap_or(0)
        }),
        projection: named.map(str::to_owned),
        place: Place::text(source, place.span),
    };
    let Some(key) = &format.key else {
        let [latitude, longitude, altitude] = by_keys(format, node);
        let at = node.get(format.keys.first()?)?;
        return Some(made(Some([latitude?, longitude?]), altitude, "", at));
    };
    let Some(value) = node.get(key) else {
        let by = format.projection.as_ref()?;
        let at = node.get(by)?;
        return named.map(|_| made(None, None, by, at));
    };
    let chosen = match &format.chosen_by {
        Some(by) => choose(value, node.get(by).and_then(Node::text))?,
        None => value,
    };
    let [latitude, longitude, altitude] = if format.list.is_empty() {
        by_keys(format, chosen)
    } else {
        listed(format, chosen)
    };
    Some(made(Some([latitude?, longitude?]), altitude, key, chosen))
}

/// The one of a list that is named; the only one, where none is named.
fn choose<'n>(list: &'n Node, name: Option<&str>) -> Option<&'n Node> {
    let items = list.items()?;
    let mut named = items
        .iter()
        .filter(|item| item.get("name").and_then(Node::text) == name);
    named.next().or(match (items, name) {
        ([only], None) => Some(only),
        _ => None,
    })
}

/// Latitude, longitude and altitude under the keys of a format.
fn by_keys(format: &OriginFormat, node: &Node) -> [Option<f64>; 3] {
    [0, 1, 2].map(|index| number(node.get(format.keys.get(index)?)?))
}

/// The same, out of a list.
fn listed(format: &OriginFormat, node: &Node) -> [Option<f64>; 3] {
    ["latitude", "longitude", "altitude"].map(|word| {
        let at = format.list.iter().position(|what| what == word)?;
        number(node.items().filter(|items| items.len() == format.list.len())?.get(at)?)
    })
}

fn number(node: &Node) -> Option<f64> {
    numbers::number(node.text()?).filter(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use crate::read::calibration::read_yaml;
    use crate::source::{LineIndex, Source, SourceId, SourceKind};

    /// Format, label, position, altitude, projection and line of each.
    fn origins(text: &str) -> Vec<String> {
        let mut source = Source::new(SourceId(0), "origin.yaml", SourceKind::Yaml);
        text.clone_into(&mut source.text);
        let facts = read_yaml(&mut source, crate::tables::Tables::default().dialects());
        let text = |origin: &crate::world::EarthOrigin| {
            let line = LineIndex::new(text)
                .locate(text, origin.place.span().unwrap().start)
                .line;
            let position = origin
                .latitude_longitude_deg
                .map_or(String::new(), |[a, b]| format!("{a},{b}"));
            let altitude = origin.altitude_m.map_or(String::new(), |m| format!(",{m}"));
            let projection = origin.projection.as_deref().unwrap_or("-");
            format!(
                "{} {} {position}{altitude} {projection} {line}",
                origin.format, origin.label
            )
        };
        facts.origins.iter().map(text).collect()
    }

    #[test]
    fn formats_are_read_with_their_places() {
        assert_eq!(
            origins(
                "navsat_transform:\n  ros__parameters:\n    wait_for_datum: true\n    datum: [55.944904, -3.186693, 0.1]\n"
            ),
            ["robot_localization navsat_transform/ros__parameters/datum 55.944904,-3.186693 - 4"]
        );
        assert_eq!(
            origins(
                "projector_type: LocalCartesianUTM\nmap_origin:\n  latitude: 35.6762\n  longitude: 139.6503\n  altitude: 3.0\n"
            ),
            ["autoware map_origin 35.6762,139.6503 LocalCartesianUTM 3"]
        );
        assert_eq!(
            origins("projector_type: MGRS\nmgrs_grid: 54SUE\n"),
            ["autoware projector_type  MGRS 1"]
        );
        assert_eq!(
            origins("a: {origin_latitude: 48.1, origin_longitude: 11.2, origin_altitude: 500}\n"),
            ["origin_latitude a 48.1,11.2,500 - 1"]
        );
    }

    #[test]
    fn the_named_one_of_several_is_taken() {
        let of = |name: &str| {
            origins(&format!(
                "local_xy_origin: {name}\nlocal_xy_origins:\n- {{name: a, latitude: 1.5, longitude: 2.5, altitude: 3}}\n- {{name: b, latitude: 4.5, longitude: 5.5, altitude: 6}}\n"
            ))
        };
        assert_eq!(of("b"), ["swri local_xy_origins 4.5,5.5,6 - 4"]);
        assert!(of("auto").is_empty());
    }

    #[test]
    fn what_is_switched_off_or_pretended_is_no_origin() {
        assert!(origins("wait_for_datum: false\ndatum: [55.9, -3.1, 0.0]\n").is_empty());
        assert!(origins("datum: [55.9, -3.1, 0.0]\n").is_empty());
        assert!(origins("fake_gps:\n  geo_origin: {lat: 47.3, lon: 8.5, alt: 408.0}\n").is_empty());
        assert!(origins("map_origin: {latitude: .nan, longitude: 1.0}\n").is_empty());
        assert!(origins("datum: [1, 2]\nwait_for_datum: true\nlocal_xy_origins: 7\n").is_empty());
    }
}
