//! Files of points that a block describes in YAML: a street with walls, in the format of the file's ending. The defaults make a healthy one.

use std::io::Cursor;
use std::path::Path;

use serde::Deserialize;

/// The points and how they are written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PointsRecipe {
    /// `ascii`, `binary` or `binary_compressed` of a PCD; `ascii`, `binary_little_endian` or `binary_big_endian` of a PLY.
    pub data: String,
    /// Whether numbers are float64.
    pub double: bool,
    /// How many points.
    pub points: usize,
    /// Length and width, metres.
    pub size: [f64; 2],
    /// Height of the walls, metres.
    pub height: f64,
    /// The direction that the ground faces: `z`, `-z`, `y`.
    pub up: String,
    /// Where the points begin.
    pub at: [f64; 3],
    /// Added to `at` and to the size: degrees in a metre.
    pub unit: f64,
    /// Of LAS: the scale.
    pub scale: f64,
    /// Of LAS: the offset; `at` without it.
    pub offset: Option<[f64; 3]>,
    /// Of LAS: added to the stated bounds.
    pub bounds_off: f64,
    /// Of LAS: the code of a projected system, of a geographic one, and of the unit.
    pub projected: Option<u16>,
    pub geographic: Option<u16>,
    pub linear_unit: Option<u16>,
    /// Of LAS: a system as well-known text.
    pub wkt: Option<String>,
    /// Of LAS: a point format from 6 on, in version 1.4.
    pub layered: bool,
}

impl Default for PointsRecipe {
    fn default() -> Self {
        Self {
            data: "binary".to_owned(),
            double: false,
            points: 2000,
            size: [40.0, 20.0],
            height: 12.0,
            up: "z".to_owned(),
            at: [0.0; 3],
            unit: 1.0,
            scale: 0.001,
            offset: None,
            bounds_off: 0.0,
            projected: None,
            geographic: None,
            linear_unit: None,
            wkt: None,
            layered: false,
        }
    }
}

impl PointsRecipe {
    pub fn parse(text: &str) -> Self {
        serde_yaml::from_str(text).unwrap_or_else(|error| panic!("the cloud does not parse: {error}\n{text}"))
    }

    /// Writes the file.
    pub fn write(&self, path: &Path) {
        let ending = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        std::fs::write(path, self.bytes(&ending)).expect("the cloud is written");
    }

    pub fn bytes(&self, ending: &str) -> Vec<u8> {
        match ending {
            "pcd" => self.pcd(),
            "ply" => self.ply(),
            "las" => self.las(false),
            "laz" => self.las(true),
            other => panic!("no cloud is written as {other}"),
        }
    }

    /// Half of the points on the ground, half on walls.
    pub fn xyz(&self) -> Vec<[f64; 3]> {
        let mut rng = fastrand::Rng::with_seed(7);
        let [length, width] = self.size;
        let of = |index| {
            let (x, y) = (rng.f64() * length, rng.f64() * width);
            let height = if index % 2 == 0 {
                0.02 * rng.f64()
            } else {
                self.height * rng.f64()
            };
            let [x, y, z] = match self.up.as_str() {
                "z" => [x, y, height],
                "-z" => [x, width - y, self.height - height],
                "y" => [y, height, x],
                other => panic!("no street is {other} up"),
            };
            let [a, b, c] = self.at;
            [a + x * self.unit, b + y * self.unit, c + z]
        };
        (0..self.points).map(of).collect()
    }

    #[allow(clippy::cast_possible_truncation)] // as most programs write them
    fn numbers(&self, point: [f64; 3], is_big: bool) -> Vec<u8> {
        let number = |value: f64| match (self.double, is_big) {
            (true, true) => value.to_be_bytes().to_vec(),
            (true, false) => value.to_le_bytes().to_vec(),
            (false, true) => (value as f32).to_be_bytes().to_vec(),
            (false, false) => (value as f32).to_le_bytes().to_vec(),
        };
        point.into_iter().flat_map(number).collect()
    }

    /// A line for each point, with this behind its coordinates.
    fn lines(&self, rest: &str) -> String {
        let lines = self.xyz().into_iter().map(|[x, y, z]| format!("{x} {y} {z}{rest}\n"));
        lines.collect::<Vec<_>>().concat()
    }

    fn pcd(&self) -> Vec<u8> {
        let (size, count) = (if self.double { 8 } else { 4 }, self.points);
        let head = format!(
            "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity\nSIZE {size} {size} {size} 4\nTYPE F F F F\n\
             COUNT 1 1 1 1\nWIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA {}\n",
            self.data
        );
        let points = self.xyz();
        let with_intensity = |point: &[f64; 3]| [self.numbers(*point, false), vec![0; 4]].concat();
        let data = match self.data.as_str() {
            "ascii" => self.lines(" 0").into_bytes(),
            "binary" => points.iter().flat_map(with_intensity).collect(),
            "binary_compressed" => {
                let all: Vec<u8> = points.iter().flat_map(with_intensity).collect();
                let stride = 3 * size + 4;
                let mut columns = Vec::new();
                for (at, bytes) in [(0, size), (size, size), (2 * size, size), (3 * size, 4)] {
                    columns.extend(all.chunks(stride).flat_map(|point| point[at..at + bytes].to_vec()));
                }
                // Runs of bytes as they are: any LZF reader takes them.
                let packed: Vec<u8> = columns
                    .chunks(32)
                    .flat_map(|run| [&[u8::try_from(run.len() - 1).unwrap()], run].concat())
                    .collect();
                let sizes = [packed.len(), columns.len()].map(|size| u32::try_from(size).unwrap().to_le_bytes());
                [sizes.concat(), packed].concat()
            }
            other => other.as_bytes().to_vec(),
        };
        [head.into_bytes(), data].concat()
    }

    fn ply(&self) -> Vec<u8> {
        let data = if self.data == "binary" {
            "binary_little_endian"
        } else {
            &self.data
        };
        let kind = if self.double { "double" } else { "float" };
        let head = format!(
            "ply\nformat {data} 1.0\ncomment a street\nelement vertex {}\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\nend_header\n",
            self.points
        );
        let points = if data == "ascii" {
            self.lines("").into_bytes()
        } else {
            let is_big = data == "binary_big_endian";
            self.xyz()
                .into_iter()
                .flat_map(|point| self.numbers(point, is_big))
                .collect()
        };
        [head.into_bytes(), points].concat()
    }

    fn las(&self, is_packed: bool) -> Vec<u8> {
        let points = self.xyz();
        let offset = self.offset.unwrap_or(self.at);
        #[allow(clippy::cast_possible_truncation)] // cut to the range, as a careless writer does
        let whole = |value: f64, offset: f64| ((value - offset) / self.scale).round() as i32;
        let size: u16 = if self.layered { 30 } else { 20 };
        let mut data = Vec::new();
        for point in &points {
            let record: Vec<u8> = point
                .iter()
                .zip(offset)
                .flat_map(|(v, o)| whole(*v, o).to_le_bytes())
                .collect();
            data.extend(
                record
                    .iter()
                    .copied()
                    .chain(std::iter::repeat(0))
                    .take(usize::from(size)),
            );
        }
        let mut records = Vec::new();
        let mut record = |user: &str, id: u16, data: &[u8]| {
            let user = user.bytes().chain(std::iter::repeat(0)).take(16);
            records.extend([0, 0].into_iter().chain(user).chain(id.to_le_bytes()));
            records.extend(u16::try_from(data.len()).unwrap().to_le_bytes());
            records.extend([0; 32]);
            records.extend(data);
        };
        let mut count = 0;
        let mut keys: Vec<[u16; 4]> = Vec::new();
        let kind = if self.projected.is_some() { 1 } else { 2 };
        if self.projected.or(self.geographic).is_some() {
            keys.push([1024, 0, 1, kind]);
        }
        keys.extend(self.geographic.map(|code| [2048, 0, 1, code]));
        keys.extend(self.projected.map(|code| [3072, 0, 1, code]));
        keys.extend(self.linear_unit.map(|code| [3076, 0, 1, code]));
        if !keys.is_empty() {
            let head = [[1, 1, 0, u16::try_from(keys.len()).unwrap()]];
            let bytes: Vec<u8> = head
                .iter()
                .chain(&keys)
                .flatten()
                .flat_map(|key| key.to_le_bytes())
                .collect();
            record("LASF_Projection", 34_735, &bytes);
            count += 1;
        }
        if let Some(text) = &self.wkt {
            record("LASF_Projection", 2112, text.as_bytes());
            count += 1;
        }
        let format = if self.layered { 6 } else { 0 };
        let items = laz::LazItemRecordBuilder::default_for_point_format_id(format, 0).unwrap();
        let layout = laz::LazVlr::from_laz_items(items);
        if is_packed {
            let mut bytes = Vec::new();
            layout.write_to(&mut bytes).unwrap();
            record("laszip encoded", 22_204, &bytes);
            count += 1;
        }
        let header_size: u16 = if self.layered { 375 } else { 227 };
        let mut head = vec![0; usize::from(header_size)];
        let mut put = |at: usize, bytes: &[u8]| head[at..at + bytes.len()].copy_from_slice(bytes);
        let stated = u32::try_from(points.len()).unwrap();
        put(0, b"LASF");
        put(24, &[1, if self.layered { 4 } else { 2 }]);
        put(94, &header_size.to_le_bytes());
        put(
            96,
            &(u32::from(header_size) + u32::try_from(records.len()).unwrap()).to_le_bytes(),
        );
        put(100, &u32::to_le_bytes(count));
        put(104, &[format | if is_packed { 0x80 } else { 0 }]);
        put(105, &size.to_le_bytes());
        if self.layered {
            put(247, &u64::from(stated).to_le_bytes());
        } else {
            put(107, &stated.to_le_bytes());
        }
        for axis in 0..3 {
            let values = points.iter().map(|point| point[axis]);
            let (least, most) = values.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
            put(131 + 8 * axis, &self.scale.to_le_bytes());
            put(155 + 8 * axis, &offset[axis].to_le_bytes());
            put(179 + 16 * axis, &(most + self.bounds_off).to_le_bytes());
            put(187 + 16 * axis, &(least + self.bounds_off).to_le_bytes());
        }
        let mut file = [head, records].concat();
        if is_packed {
            let start = file.len() as u64;
            let mut cursor = Cursor::new(file);
            cursor.set_position(start);
            let mut packed = laz::LasZipCompressor::new(&mut cursor, layout).unwrap();
            packed.compress_many(&data).and_then(|()| packed.done()).unwrap();
            drop(packed);
            return cursor.into_inner();
        }
        file.extend(data);
        file
    }
}
