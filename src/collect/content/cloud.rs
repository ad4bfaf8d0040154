//! Clouds of one topic.

mod sampling;

use std::cell::OnceCell;

use crate::read::messages::cloud::{Cloud, Column, Datatype};
use crate::read::messages::packets::RawScan;
use crate::read::packets::Unit;
use crate::source::MessageRef;
use crate::world::cloud::{
    CloudEvidence, CloudLayout, CloudPoint, CloudSample, MAX_LAYOUTS, PacketSensor, PointField, PointTimes,
};

use super::super::CloudOptions;
use super::super::point::{Point, PointOwner};
use super::super::thin::SampleBudget;
use super::slices::Slices;
use super::times::time_of;
pub(in crate::collect) use sampling::is_return;
use sampling::{MAX_RINGS, rings, strides};

/// A cloud that is kept.
struct KeptCloud {
    point: Point,
    sample: CloudContent,
}

/// What is kept of a cloud, without its place.
struct CloudContent {
    size: [u32; 2],
    rings: Option<u32>,
    returns: u64,
    looked_at: u64,
    points: Vec<CloudPoint>,
    times: Option<PointTimes>,
    farthest: f64,
}

/// The packets of a lidar that were to be decoded.
#[derive(Default)]
pub(in crate::collect) struct PacketCounts {
    pub(in crate::collect) looked_at: u64,
    /// How many of them were not decoded.
    pub(in crate::collect) refused: u64,
    /// The first message with one, and why.
    pub(in crate::collect) first: Option<(Point, String)>,
}

/// Takes in clouds in recording order.
pub(super) struct Clouds {
    share: SampleBudget,
    options: CloudOptions,
    count: u64,
    sensor: Option<PacketSensor>,
    /// What packets have told of the sensor so far.
    unit: Unit,
    pub(super) packets: PacketCounts,
    layouts: Vec<(Point, u64, Vec<PointField>, bool)>,
    others: u64,
    cut: u64,
    first_cut: Option<Point>,
    /// Every `stride`-th cloud, the stride doubled where there is no more room.
    kept: Vec<KeptCloud>,
    stride: u64,
    farthest: Option<(Point, f64)>,
    slices: Slices,
}

impl Clouds {
    pub(super) fn new(share: SampleBudget, options: CloudOptions) -> Self {
        Self {
            share,
            count: 0,
            sensor: None,
            unit: options.unit.clone(),
            packets: PacketCounts::default(),
            layouts: Vec::new(),
            others: 0,
            cut: 0,
            first_cut: None,
            kept: Vec::new(),
            stride: 1,
            farthest: None,
            slices: Slices::new(share.runs, options.has_optical),
            options,
        }
    }

    /// Clouds were left out here.
    pub(super) fn seam(&mut self) {
        self.slices.seam();
    }

    pub(super) fn push(&mut self, point: Point, cloud: &Cloud<'_>) {
        self.layout(point, cloud);
        if is_cut(cloud) {
            self.cut += 1;
            self.first_cut.get_or_insert(point);
        }
        self.sample(point, || Some(cloud));
    }

    /// Takes in packets, which are decoded only where points of the cloud are kept.
    pub(super) fn push_packets(&mut self, point: Point, scan: &RawScan<'_>) {
        let mut unit = std::mem::take(&mut self.unit);
        scan.describe(&mut unit);
        let decoded = OnceCell::new();
        let cloud = || decoded.get_or_init(|| scan.decode_with(point.stamp_ns.unwrap_or(0), &unit));
        self.sample(point, || cloud().as_ref().ok().map(|decoded| &decoded.cloud));
        self.unit = unit;
        let Some(decoded) = decoded.get() else { return };
        let (refused, reason) = match decoded {
            Ok(decoded) => {
                self.layout(point, &decoded.cloud);
                self.sensor.get_or_insert_with(|| PacketSensor {
                    maker: decoded.maker.to_owned(),
                    model: decoded.model.clone().into_owned(),
                });
                (decoded.refused, decoded.reason.clone())
            }
            Err(error) => (scan.packets(), Some(error.0.clone())),
        };
        self.packets.looked_at += scan.packets() as u64;
        self.packets.refused += refused as u64;
        if let Some(reason) = reason.filter(|_| refused > 0) {
            self.packets.first.get_or_insert((point, reason));
        }
    }

    /// Keeps points of the cloud, where its turn has come.
    fn sample<'c>(&mut self, point: Point, cloud: impl Fn() -> Option<&'c Cloud<'c>>) {
        let index = self.count;
        self.count += 1;
        self.slices.push(point, &cloud, &self.options.time_fields);
        let [most, points] = self.share.clouds;
        if !index.is_multiple_of(self.stride) {
            return;
        }
        if self.kept.len() >= most {
            let mut number = 0;
            self.kept.retain(|_| {
                number += 1;
                number % 2 == 1
            });
            self.stride *= 2;
            if !index.is_multiple_of(self.stride) {
                return;
            }
        }
        let sample = cloud().and_then(|cloud| sampled(cloud, points, &self.options.time_fields));
        let Some(sample) = sample else {
            return;
        };
        if self.farthest.is_none_or(|(_, farthest)| sample.farthest > farthest) {
            self.farthest = Some((point, sample.farthest));
        }
        self.kept.push(KeptCloud { point, sample });
    }

    fn layout(&mut self, point: Point, cloud: &Cloud<'_>) {
        let is_it = |fields: &[PointField]| {
            fields.len() == cloud.fields.len()
                && fields.iter().zip(&cloud.fields).all(|(known, field)| {
                    known.name == field.name && known.count == field.count && known.datatype == word(field.datatype)
                })
        };
        let mut known = self.layouts.iter_mut();
        if let Some((_, count, ..)) =
            known.find(|(.., fields, is_bigendian)| *is_bigendian == cloud.is_bigendian && is_it(fields))
        {
            *count += 1;
        } else if self.layouts.len() < MAX_LAYOUTS {
            let fields = cloud.fields.iter().map(|field| PointField {
                name: field.name.clone().into_owned(),
                datatype: word(field.datatype),
                count: field.count,
            });
            self.layouts.push((point, 1, fields.collect(), cloud.is_bigendian));
        } else {
            self.others += 1;
        }
    }

    pub(super) fn finish(self, on: PointOwner<'_>) -> CloudEvidence {
        let layout = |(point, count, fields, is_bigendian): (Point, u64, Vec<PointField>, bool)| CloudLayout {
            at: point.on(on),
            count,
            fields,
            is_bigendian,
        };
        let sample = |kept: KeptCloud| {
            let at: MessageRef = kept.point.on(on);
            let CloudContent {
                size,
                rings,
                returns,
                looked_at,
                points,
                times,
                ..
            } = kept.sample;
            CloudSample {
                at,
                size,
                rings,
                returns,
                looked_at,
                points,
                times,
            }
        };
        CloudEvidence {
            count: self.count,
            packets: self.sensor,
            layouts: self.layouts.into_iter().map(layout).collect(),
            others: self.others,
            cut: self.cut,
            first_cut: self.first_cut.map(|point| point.on(on)),
            samples: self.kept.into_iter().map(sample).collect(),
            runs: self.slices.finish(),
            farthest: self.farthest.map(|(point, farthest)| (point.on(on), farthest)),
        }
    }
}

fn word(datatype: u8) -> String {
    Datatype::of(datatype).map_or_else(|| datatype.to_string(), |datatype| datatype.word().to_owned())
}

/// Whether the data end before the last point.
fn is_cut(cloud: &Cloud<'_>) -> bool {
    let last = cloud.height.checked_sub(1).zip(cloud.width.checked_sub(1));
    last.is_some_and(|(row, column)| cloud.point(row, column).is_none())
}

/// What is kept of a cloud; `None` where its points have no coordinates.
fn sampled(cloud: &Cloud<'_>, most: usize, time_fields: &[String]) -> Option<CloudContent> {
    let axes: [Column; 3] = [cloud.column("x")?, cloud.column("y")?, cloud.column("z")?];
    let time = time_of(cloud, time_fields);
    let (row_step, column_step) = strides(cloud, most);
    let (mut points, mut times) = (Vec::new(), Vec::new());
    let (mut looked_at, mut farthest) = (0, 0.0_f64);
    let rows = (0..cloud.rows()).step_by(usize::try_from(row_step).unwrap_or(usize::MAX));
    for row in rows {
        let columns = (0..cloud.width).step_by(usize::try_from(column_step).unwrap_or(usize::MAX));
        for column in columns {
            let Some(bytes) = cloud.point(row, column) else { break };
            looked_at += 1;
            let [Some(x), Some(y), Some(z)] = axes.map(|axis| axis.of(bytes)) else {
                break;
            };
            let xyz = [x, y, z];
            if !is_return(xyz) {
                continue;
            }
            farthest = xyz.iter().fold(farthest, |most, value| most.max(value.abs()));
            let time = time.and_then(|(_, column)| column.of(bytes)).unwrap_or(f64::NAN);
            times.push(time);
            points.push(CloudPoint {
                xyz,
                cell: [row, column],
                time,
            });
        }
    }
    let times = time.and_then(|(name, _)| {
        let field = PointTimes {
            field: name.to_owned(),
            datatype: word(cloud.field(name)?.datatype),
            timebase_ns: cloud.timebase_ns,
            range: [f64::NAN; 2],
            quantiles: [f64::NAN; 2],
            distinct: 0,
        };
        field.of(times)
    });
    Some(CloudContent {
        size: [cloud.height, cloud.width],
        // Some drivers write a row for each firing.
        rings: rings(cloud, axes).or_else(|| {
            let is_ring = (2..=cloud.width.min(MAX_RINGS)).contains(&cloud.height);
            is_ring.then_some(cloud.height)
        }),
        returns: points.len() as u64,
        looked_at,
        points,
        times,
        farthest,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::indexing_slicing)]
    use super::*;
    use crate::read::messages::cloud::Field;
    use std::time::{Duration, Instant};

    /// x, y, z and a time in float32, one behind the other.
    pub(super) fn cloud(size: [u32; 2], data: &[u8]) -> Cloud<'_> {
        let field = |(index, name): (u32, &'static str)| Field {
            name: name.into(),
            offset: 4 * index,
            datatype: 7,
            count: 1,
        };
        Cloud {
            height: size[0],
            width: size[1],
            fields: [(0, "x"), (1, "y"), (2, "z"), (3, "time")].map(field).into(),
            is_bigendian: false,
            point_step: 16,
            row_step: size[1].saturating_mul(16),
            data: data.into(),
            timebase_ns: None,
        }
    }

    fn bytes(points: &[[f32; 4]]) -> Vec<u8> {
        points.iter().flatten().flat_map(|value| value.to_le_bytes()).collect()
    }

    fn at(index: u64) -> Point {
        Point {
            index,
            stamp_ns: None,
            log_ns: i64::try_from(index).unwrap(),
            transform: None,
        }
    }

    fn evidence<'c>(clouds: impl IntoIterator<Item = Cloud<'c>>) -> CloudEvidence {
        let mut taken = Clouds::new(SampleBudget::of(0), CloudOptions::default());
        for (index, cloud) in (0..).zip(clouds) {
            taken.push(at(index), &cloud);
        }
        taken.finish(PointOwner::from("/points"))
    }

    #[test]
    fn returns_times_and_the_farthest_coordinate_are_those_of_finite_points() {
        let nan = f32::NAN;
        let data = bytes(&[
            [1.0, 2.0, 3.0, 0.0],
            [0.0, 0.0, 0.0, 0.5],
            [nan, 1.0, 1.0, 0.5],
            [-9.0, 0.0, 1.0, nan],
            [1.0, f32::INFINITY, 1.0, 0.5],
            [4.0, 5.0, 6.0, 0.1],
        ]);
        let found = evidence([cloud([2, 3], &data)]);
        let sample = &found.samples[0];
        assert_eq!((sample.size, sample.returns, sample.looked_at), ([2, 3], 3, 6));
        let cells: Vec<[u32; 2]> = sample.points.iter().map(|point| point.cell).collect();
        assert_eq!(cells, [[0, 0], [1, 0], [1, 2]]);
        let times = sample.times.as_ref().unwrap();
        assert_eq!(
            (times.field.as_str(), times.datatype.as_str(), times.distinct),
            ("time", "float32", 2)
        );
        assert!((times.range[1] - 0.1).abs() < 1e-6 && times.range[0].abs() < 1e-12);
        assert_eq!(found.farthest.map(|(_, farthest)| farthest), Some(9.0));
    }

    #[test]
    fn each_ring_is_counted_however_the_points_are_ordered() {
        for [rings, columns] in [[16, 256], [65, 512], [128, 1024], [128, 2048]] {
            let point = |ring: u32| [1.0, 2.0, 3.0, ring as f32];
            let by_rings = || (0..rings).flat_map(|ring| (0..columns).map(move |_| point(ring)));
            let by_firings = || (0..columns).flat_map(|_| (0..rings).map(point));
            for (size, points) in [
                ([rings, columns], by_rings().collect::<Vec<_>>()),
                ([columns, rings], by_firings().collect()),
                ([1, rings * columns], by_rings().collect()),
                ([1, rings * columns], by_firings().collect()),
            ] {
                let data = bytes(&points);
                let mut cloud = cloud(size, &data);
                cloud.fields[3].name = "ring".into();
                assert_eq!(evidence([cloud]).samples[0].rings, Some(rings), "{size:?}");
            }
        }
    }

    #[test]
    fn numbers_in_the_other_order_are_the_same_numbers() {
        let points = [[1.0, 2.0, 3.0, 0.25], [4.0, -5.0, 6.0, 0.5]];
        let little = bytes(&points);
        let big: Vec<u8> = points.iter().flatten().flat_map(|value| value.to_be_bytes()).collect();
        let mut turned = cloud([1, 2], &big);
        turned.is_bigendian = true;
        let (a, b) = (evidence([cloud([1, 2], &little)]), evidence([turned]));
        assert_eq!(a.samples, b.samples);
        assert!(b.layouts[0].is_bigendian);
    }

    #[test]
    fn what_lies_is_counted_and_ends_at_once() {
        let started = Instant::now();
        let data = bytes(&[[1.0, 2.0, 3.0, 0.0]; 5]);
        let most = u32::MAX;
        let with = |size, point_step, row_step| Cloud {
            point_step,
            row_step,
            ..cloud(size, &data)
        };
        let mut unknown = cloud([1, 5], &data);
        unknown.fields[0].datatype = 77;
        let lies = [
            with([most, most], 16, 0),
            with([most, most], 0, 0),
            with([most, 1], 16, 1),
            with([most, 0], 16, 16),
            with([0, most], 16, 16),
            with([3, 2], 16, 32),
            with([1, 5], 3, 15),
            unknown,
        ];
        let count = lies.len() as u64;
        let found = evidence(lies);
        assert!(started.elapsed() < Duration::from_secs(5));
        assert_eq!(found.count, count);
        // No points at all are not cut; points of three bytes hold no coordinates.
        assert_eq!((found.cut, found.first_cut.unwrap().index), (4, 0));
        let returns: Vec<u64> = found.samples.iter().map(|sample| sample.returns).collect();
        assert!(returns.iter().all(|returns| *returns <= 5), "{returns:?}");
        assert_eq!(returns[5], 5);
        assert_eq!(found.layouts.len(), 2);
        assert_eq!(found.layouts[1].fields[0].datatype, "77");
    }

    #[test]
    fn of_many_clouds_and_layouts_a_bounded_number_is_kept_the_first_among_them() {
        let data = bytes(&[[1.0, 2.0, 3.0, 0.0]]);
        let found = evidence((0..1000).map(|_| cloud([1, 1], &data)));
        let kept: Vec<u64> = found.samples.iter().map(|sample| sample.at.index).collect();
        assert!((10..=20).contains(&kept.len()) && kept[0] == 0, "{kept:?}");
        assert!(kept.windows(2).all(|pair| pair[1] - pair[0] == kept[1]), "{kept:?}");

        let named = (0..10).map(|number| {
            let mut cloud = cloud([1, 1], &data);
            cloud.fields[3].name = format!("field{number}").into();
            cloud
        });
        let found = evidence(named);
        assert_eq!((found.layouts.len(), found.others), (MAX_LAYOUTS, 6));
    }

    #[test]
    fn times_stand_in_the_users_fields_first() {
        use crate::read::messages::cloud::Field;
        let field = |(index, name): (u32, &'static str)| Field {
            name: name.into(),
            offset: 4 * index,
            datatype: 7,
            count: 1,
        };
        let fields = (0..).zip(["x", "y", "z", "t", "dt"]).map(field).collect();
        let data: Vec<u8> = [1.0_f32, 2.0, 3.0, 4.0, 5.0].map(f32::to_le_bytes).concat();
        let cloud = Cloud {
            height: 1,
            width: 1,
            fields,
            is_bigendian: false,
            point_step: 20,
            row_step: 20,
            data: data.as_slice().into(),
            timebase_ns: None,
        };
        let times = |own: &[String]| {
            let times = sampled(&cloud, 10, own).and_then(|sample| sample.times);
            times.map(|times| (times.field, times.range[0]))
        };
        assert_eq!(times(&[]), Some(("t".to_owned(), 4.0)));
        assert_eq!(times(&["dt".to_owned()]), Some(("dt".to_owned(), 5.0)));
    }
}
