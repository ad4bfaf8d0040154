//! Detections of one topic's radar.

use crate::read::messages::cloud::Cloud;
use crate::read::messages::radar::{Columns, Echo, Form, Radar, Speed, Speeds};
use crate::world::radar::{RUN_SWEEPS, RadarEvidence, RadarForm, RadarSweep, SWEEP_ECHOES, SpeedForm};

use super::super::point::{Point, PointOwner};
use super::super::thin::SampleBudget;
use super::runs::Runs;

/// Detections that come one a message belong to one scan as long as they are not farther apart than this, nanoseconds: a scan
/// lasts 50 ms and more.
const SCAN_NS: i64 = 40_000_000;
/// Detections of a scan that comes one by one, at most.
const MOST: usize = 1024;

/// Takes in detections in recording order.
pub(super) struct Radars {
    first: Point,
    /// The frame of the detections, the name of their speeds, and what these are.
    layout: Option<(RadarForm, String, SpeedForm)>,
    count: u64,
    looked_at: u64,
    broken: u64,
    sideways: u64,
    runs: Runs<RadarSweep>,
    /// The scan whose detections come one by one, with the number of the last.
    open: Option<(Point, Option<u64>, Vec<Echo>)>,
}

impl Radars {
    pub(super) fn new(share: SampleBudget, first: Point) -> Self {
        Self {
            first,
            layout: None,
            count: 0,
            looked_at: 0,
            broken: 0,
            sideways: 0,
            runs: Runs::new(share.runs, RUN_SWEEPS),
            open: None,
        }
    }

    /// Messages were left out here; an unfinished scan is cut, and dropped.
    pub(super) fn seam(&mut self) {
        self.open = None;
        self.runs.seam();
    }

    pub(super) fn push(&mut self, point: Point, radar: &Radar) {
        let form = match radar.form {
            Form::Scan => RadarForm::Scan,
            Form::Tracks => RadarForm::Tracks,
            Form::Single(_) => RadarForm::Single,
            Form::Cloud => RadarForm::Cloud,
        };
        self.set_layout(form, &radar.field, radar.speeds);
        match radar.form {
            Form::Single(id) => self.single(point, id, &radar.echoes),
            _ => self.sweep(point, radar.total, &radar.echoes),
        }
    }

    /// Takes in the points of a cloud.
    pub(super) fn cloud(&mut self, point: Point, cloud: &Cloud<'_>, columns: &Columns) {
        self.set_layout(RadarForm::Cloud, &columns.field, columns.speeds);
        let total = cloud.points();
        let every = total.div_ceil(SWEEP_ECHOES as u64).max(1);
        let mut echoes = Vec::new();
        let mut number = 0;
        while number < total {
            let width = u64::from(cloud.width);
            let place = number.checked_div(width).zip(number.checked_rem(width));
            let cell = place.and_then(|(row, column)| Some((u32::try_from(row).ok()?, u32::try_from(column).ok()?)));
            let bytes = cell.and_then(|(row, column)| cloud.point(row, column));
            // Behind the end of the data there is no other point.
            let Some(echo) = bytes.and_then(|bytes| columns.echo(bytes)) else {
                break;
            };
            echoes.push(echo);
            number += every;
        }
        self.sweep(point, u32::try_from(total).unwrap_or(u32::MAX), &echoes);
    }

    fn set_layout(&mut self, form: RadarForm, field: &str, speeds: Speeds) {
        self.layout.get_or_insert_with(|| {
            let speeds = match speeds {
                Speeds::Radial => SpeedForm::Radial,
                Speeds::Plain => SpeedForm::Plain,
                Speeds::Components => SpeedForm::Components,
            };
            (form, field.to_owned(), speeds)
        });
    }

    /// Takes in one detection of a scan: the next scan begins where its number does not grow, or it is late.
    fn single(&mut self, point: Point, id: Option<u64>, echoes: &[Echo]) {
        let is_of_it = |open: &(Point, Option<u64>, Vec<Echo>)| {
            let grows = id.zip(open.1).is_none_or(|(id, last)| id > last);
            // By number alone where there are numbers: some drivers stamp each detection as it is sent.
            let apart_ns = point.log_ns.saturating_sub(open.0.log_ns);
            grows && (0..=SCAN_NS).contains(&apart_ns) && open.2.len() < MOST
        };
        if let Some(open) = self.open.as_mut().filter(|open| is_of_it(open)) {
            open.1 = id;
            open.2.extend(echoes);
            return;
        }
        self.close();
        self.open = Some((point, id, echoes.to_vec()));
    }

    /// Ends the scan whose detections came one by one.
    fn close(&mut self) {
        if let Some((point, _, echoes)) = self.open.take() {
            self.sweep(point, u32::try_from(echoes.len()).unwrap_or(u32::MAX), &echoes);
        }
    }

    fn sweep(&mut self, point: Point, total: u32, echoes: &[Echo]) {
        self.count += 1;
        let mut kept = Vec::new();
        let every = echoes.len().div_ceil(SWEEP_ECHOES).max(1);
        for echo in echoes.iter().step_by(every) {
            self.looked_at += 1;
            if matches!(echo.speed, Speed::Components([_, y, _]) if y != 0.0) {
                self.sideways += 1;
            }
            match along(echo) {
                Some(known) => kept.push(known),
                None => self.broken += 1,
            }
        }
        self.runs.push(|| RadarSweep {
            stamp_ns: point.stamp_ns.filter(|stamp| *stamp != 0),
            log_ns: point.log_ns,
            total,
            echoes: kept,
        });
    }

    /// `None` where nothing came.
    pub(super) fn finish(mut self, on: PointOwner<'_>) -> Option<RadarEvidence> {
        self.close();
        let (form, field, speeds) = self.layout?;
        Some(RadarEvidence {
            count: self.count,
            first: self.first.on(on),
            form,
            field,
            speeds,
            looked_at: self.looked_at,
            broken: self.broken,
            sideways: self.sideways,
            runs: self.runs.finish(1),
        })
    }
}

/// A detection with its speed along the line of sight; `None` where a number is not finite, or it is at the origin.
fn along(echo: &Echo) -> Option<[f64; 4]> {
    let [x, y, z] = echo.place;
    let range = (x * x + y * y + z * z).sqrt();
    let speed = match echo.speed {
        Speed::Radial(speed) => speed,
        Speed::Components([vx, vy, vz]) => (vx * x + vy * y + vz * z) / range,
    };
    (range.is_finite() && range > 0.0 && speed.is_finite()).then_some([x, y, z, speed])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn at(index: u64, log_ms: i64) -> Point {
        Point {
            index,
            stamp_ns: Some(1 + log_ms * 1_000_000),
            log_ns: log_ms * 1_000_000,
            transform: None,
        }
    }

    fn echo(place: [f64; 3], speed: Speed) -> Echo {
        Echo { place, speed }
    }

    fn radar(form: Form, echoes: &[Echo]) -> Radar {
        Radar {
            form,
            field: "doppler".into(),
            speeds: Speeds::Radial,
            total: u32::try_from(echoes.len()).unwrap(),
            echoes: echoes.to_vec(),
        }
    }

    fn evidence(radars: Radars) -> RadarEvidence {
        radars.finish("/radar".into()).unwrap()
    }

    #[test]
    fn components_count_along_the_line_of_sight_and_what_is_no_number_is_counted() {
        let mut radars = Radars::new(SampleBudget::of(0), at(0, 0));
        let echoes = [
            echo([3.0, 4.0, 0.0], Speed::Components([-5.0, 10.0, 0.0])),
            echo([3.0, 4.0, 0.0], Speed::Radial(f64::NAN)),
            echo([0.0; 3], Speed::Radial(1.0)),
            echo([f64::INFINITY, 0.0, 0.0], Speed::Radial(1.0)),
            echo([1e308, 1e308, 0.0], Speed::Radial(1.0)),
        ];
        radars.push(at(0, 0), &radar(Form::Scan, &echoes));
        let seen = evidence(radars);
        assert_eq!((seen.count, seen.looked_at, seen.broken, seen.sideways), (1, 5, 4, 1));
        assert_eq!(seen.runs[0][0].echoes, [[3.0, 4.0, 0.0, 5.0]]);
    }

    #[test]
    fn detections_that_come_one_by_one_are_put_together_by_number_and_time() {
        let mut radars = Radars::new(SampleBudget::of(0), at(0, 0));
        let one = echo([5.0, 0.0, 0.0], Speed::Radial(-1.0));
        let ids = [(0, 0), (1, 1), (2, 2), (0, 50), (1, 51), (2, 200), (3, 201), (3, 202)];
        for (index, (id, ms)) in ids.into_iter().enumerate() {
            radars.push(at(index as u64, ms), &radar(Form::Single(Some(id)), &[one]));
        }
        let seen = evidence(radars);
        let sizes: Vec<usize> = seen.runs.iter().flatten().map(|sweep| sweep.echoes.len()).collect();
        assert_eq!(sizes, [3, 2, 2, 1]);
        // A seam drops the scan that is cut by it.
        let mut radars = Radars::new(SampleBudget::of(0), at(0, 0));
        radars.push(at(0, 0), &radar(Form::Single(None), &[one]));
        radars.seam();
        radars.push(at(9, 900), &radar(Form::Single(None), &[one]));
        assert_eq!(evidence(radars).count, 1);
    }

    #[test]
    fn large_scans_are_thinned_evenly() {
        let mut radars = Radars::new(SampleBudget::of(0), at(0, 0));
        let echoes: Vec<Echo> = (1..=1000)
            .map(|x| echo([f64::from(x), 0.0, 0.0], Speed::Radial(0.0)))
            .collect();
        radars.push(at(0, 0), &radar(Form::Scan, &echoes));
        let seen = evidence(radars);
        let kept = &seen.runs[0][0].echoes;
        assert!((100..=SWEEP_ECHOES).contains(&kept.len()), "{}", kept.len());
        assert_eq!((kept[0][0], seen.runs[0][0].total), (1.0, 1000));
    }
}
