//! The coordinate reference system of a LAS file: keys of GeoTIFF, or well-known text (WKT 1 and 2). Sources: OGC 19-008r4 (GeoTIFF 1.1),
//! OGC 01-009 and 18-010r7 (WKT). Nothing is looked up: what is known is what the file writes.

use crate::world::point_file::{CrsKind, StatedCrs};

use super::Record;

const GEO_KEYS: u16 = 34_735;
const WKT: u16 = 2112;

/// Metres in a foot, and in a foot of the US survey.
const FOOT: f64 = 0.3048;
const US_FOOT: f64 = 1200.0 / 3937.0;

/// The text counts before the keys, as LAS 1.4 says.
pub(super) fn stated(records: &[Record]) -> Option<StatedCrs> {
    let of = |id: u16| {
        records
            .iter()
            .find(|record| record.user == "LASF_Projection" && record.id == id)
    };
    let text = of(WKT).and_then(|record| of_text(&String::from_utf8_lossy(&record.data)));
    text.or_else(|| of_keys(&of(GEO_KEYS)?.data))
}

fn of_keys(data: &[u8]) -> Option<StatedCrs> {
    let numbers: Vec<u16> = data
        .chunks_exact(2)
        .filter_map(<[u8]>::first_chunk)
        .map(|two| u16::from_le_bytes(*two))
        .collect();
    // Of a key: its number, where its value is (0: here), how many, the value. Below 1 and from 32767 on, it is undefined or the user's own.
    let key = |wanted: u16| {
        let keys = numbers.get(4..)?.chunks_exact(4);
        let mut found = keys.filter_map(|key| match key {
            [id, 0, _, value] if *id == wanted => Some(*value),
            _ => None,
        });
        found.next().filter(|value| (1..32_767).contains(value))
    };
    let (projected, geographic) = (key(3072), key(2048));
    let kind = match (key(1024), projected, geographic) {
        (Some(1), ..) | (None, Some(_), _) => CrsKind::Projected,
        (Some(2), ..) | (None, None, Some(_)) => CrsKind::Geographic,
        (Some(3), ..) => CrsKind::Geocentric,
        _ => return None,
    };
    let epsg = if kind == CrsKind::Projected {
        projected
    } else {
        geographic
    }
    .map(u32::from);
    let unit_m = match key(3076) {
        Some(9001) => Some(1.0),
        Some(9002) => Some(FOOT),
        Some(9003) => Some(US_FOOT),
        _ => None,
    };
    Some(StatedCrs {
        name: epsg.map_or_else(|| "a system without a code".to_owned(), |epsg| format!("EPSG:{epsg}")),
        epsg,
        kind,
        unit_m,
        by: "GeoTIFF".to_owned(),
    })
}

/// `KEYWORD["name", child[...], 3, ...]`.
#[derive(Default)]
struct Node {
    word: String,
    /// Texts and numbers, in order.
    values: Vec<String>,
    children: Vec<Node>,
}

impl Node {
    /// Most brackets within each other.
    const DEPTH: usize = 12;

    fn parse(rest: &mut &str, depth: usize) -> Option<Self> {
        let open = rest.find(['[', '('])?;
        let (word, behind) = rest.split_at(open);
        let mut node = Self {
            word: word.trim().to_uppercase(),
            ..Self::default()
        };
        *rest = behind.get(1..)?;
        loop {
            *rest = rest.trim_start_matches(|c: char| c == ',' || c.is_whitespace());
            if let Some(behind) = rest.strip_prefix([']', ')']) {
                *rest = behind;
                return Some(node);
            }
            if let Some(behind) = rest.strip_prefix('"') {
                let end = behind.find('"')?;
                node.values.push(behind.get(..end)?.to_owned());
                *rest = behind.get(end + 1..)?;
                continue;
            }
            let end = rest.find(['[', '(', ',', ']', ')'])?;
            let (value, behind) = rest.split_at(end);
            if behind.starts_with(['[', '(']) {
                if depth >= Self::DEPTH {
                    return None;
                }
                node.children.push(Self::parse(rest, depth + 1)?);
            } else {
                node.values.push(value.trim().to_owned());
                *rest = behind;
            }
        }
    }

    fn child(&self, words: &[&str]) -> Option<&Self> {
        self.children.iter().find(|child| words.contains(&child.word.as_str()))
    }

    fn kind(&self) -> CrsKind {
        match self.word.as_str() {
            "PROJCS" | "PROJCRS" | "PROJECTEDCRS" => CrsKind::Projected,
            "GEOGCS" | "GEOGCRS" | "GEOGRAPHICCRS" => CrsKind::Geographic,
            "GEOCCS" => CrsKind::Geocentric,
            _ => CrsKind::Other,
        }
    }

    /// The system of x and y: of a compound one, its first part; of a bound one, its source.
    fn horizontal(&self) -> &Self {
        let inner = self.children.iter().map(Self::horizontal);
        let mut known = inner.filter(|child| child.kind() != CrsKind::Other);
        if self.kind() == CrsKind::Other {
            known.next().unwrap_or(self)
        } else {
            self
        }
    }
}

fn of_text(text: &str) -> Option<StatedCrs> {
    let mut rest = text.trim_matches(['\0', ' ', '\n', '\r']);
    let root = Node::parse(&mut rest, 0)?;
    let node = root.horizontal();
    let code = node.child(&["AUTHORITY", "ID"]).filter(|code| {
        let authority = code.values.first();
        authority.is_some_and(|authority| authority.eq_ignore_ascii_case("EPSG"))
    });
    let unit = ["LENGTHUNIT", "UNIT"];
    let in_axis = || node.child(&["AXIS"]).and_then(|axis| axis.child(&unit));
    let unit = node.child(&unit).or_else(in_axis);
    let kind = node.kind();
    let unit_m = unit.and_then(|unit| unit.values.get(1)?.parse().ok());
    Some(StatedCrs {
        name: node.values.first().cloned().unwrap_or_default(),
        epsg: code.and_then(|code| code.values.get(1)?.parse().ok()),
        kind,
        unit_m: unit_m.filter(|unit: &f64| kind != CrsKind::Geographic && unit.is_finite() && *unit > 0.0),
        by: "WKT".to_owned(),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn both_texts_name_the_system_of_x_and_y() {
        let first = r#"COMPD_CS["a + b",PROJCS["WGS 84 / UTM zone 32N",GEOGCS["WGS 84",UNIT["degree",0.0174],AUTHORITY["EPSG","4326"]],
            PROJECTION["Transverse_Mercator"],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AUTHORITY["EPSG","32632"]],VERT_CS["b"]]"#;
        let crs = of_text(first).unwrap();
        assert_eq!(
            (crs.name.as_str(), crs.utm(), crs.unit_m),
            ("WGS 84 / UTM zone 32N", Some((32, true)), Some(1.0))
        );
        let second = r#"PROJCRS["NAD83 / Ohio North (ftUS)",BASEGEOGCRS["NAD83",ID["EPSG",4269]],CS[Cartesian,2],
            AXIS["x",east,LENGTHUNIT["US survey foot",0.304800609601219]],ID["EPSG",3734]]"#;
        let crs = of_text(second).unwrap();
        assert_eq!((crs.epsg, crs.kind), (Some(3734), CrsKind::Projected));
        assert!((crs.unit_m.unwrap() - US_FOOT).abs() < 1e-12);
        assert_eq!(
            of_text(r#"GEOGCS["WGS 84",UNIT["degree",0.0174]]"#).unwrap().unit_m,
            None
        );
        assert!(of_text("GEOGCS[\"a").is_none() && of_text(&"A[".repeat(1000)).is_none());
    }

    #[test]
    fn keys_name_a_code_and_a_unit() {
        let keys = [1_u16, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 2249, 3076, 0, 1, 9003];
        let bytes: Vec<u8> = keys.iter().flat_map(|key| key.to_le_bytes()).collect();
        let crs = of_keys(&bytes).unwrap();
        assert_eq!(
            (crs.epsg, crs.kind, crs.unit_m),
            (Some(2249), CrsKind::Projected, Some(US_FOOT))
        );
        assert!(of_keys(&[]).is_none());
    }
}
