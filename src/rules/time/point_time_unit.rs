//! TIME06: the unit of the times of points.

mod laser;

use crate::analysis::lidar::Clouds;
use crate::math::stats::median;
use crate::rules::prelude::*;
use crate::tables::CloudDriver;

pub(crate) struct PointTimeUnit;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    min_clouds: usize,
    min_agreement: f64,
    min_scan_share: f64,
    max_scan_share: f64,
}

impl Rule for PointTimeUnit {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "unit of the times of the points", out);
        for clouds in Clouds::published(world).filter(|clouds| clouds.timed().next().is_some()) {
            judge_clouds(&clouds, limits, out);
        }
        for scans in Clouds::lasers(world) {
            laser::judge_times(&scans, [limits.min_scan_share, limits.max_scan_share], out);
        }
    }
}

fn judge_clouds(clouds: &Clouds, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("unit of the times of the points");
    let little = |why: String, out: &mut Judge| out.too_little(&subject, why);
    let Some(period_s) = clouds.period_s() else {
        let why = "the scan period is unknown: the stamps of the clouds do not advance";
        return little(why.to_owned(), out);
    };
    let timed: Vec<_> = clouds.timed().filter(|(_, times)| times.distinct > 2).collect();
    if timed.len() < limits.min_clouds {
        let why = format!(
            "{} clouds have points with different times; {} are needed",
            timed.len(),
            limits.min_clouds
        );
        return little(why, out);
    }
    let spans: Vec<f64> = timed
        .iter()
        .map(|(_, times)| times.quantiles[1] - times.quantiles[0])
        .collect();
    let span = median(&spans).unwrap_or(f64::NAN);
    let units: Vec<f64> = timed
        .iter()
        .filter_map(|(_, times)| Some(clouds.unit(times)?.0))
        .collect();
    let field = &timed.first().map_or_else(String::new, |(_, times)| times.field.clone());
    let counted = |unit_s: f64| units.iter().filter(|unit| (*unit / unit_s - 1.0).abs() < 0.5).count();
    let most = units.iter().copied().max_by_key(|unit_s| counted(*unit_s));
    let Some(unit_s) = most.filter(|unit_s| counted(*unit_s) as f64 >= limits.min_agreement * timed.len() as f64)
    else {
        let why = format!(
            "`{field}` spans {span} in a cloud, which is no scan of {period_s:.3} s in seconds, milli-, micro- or nanoseconds"
        );
        return little(why, out);
    };
    let word = Clouds::unit_word(unit_s);
    let what = format!("span of `{field}` in a cloud, read as {word}");
    let measured = [
        Measured::new(what, span * unit_s, "s").samples(timed.len() as u64),
        Measured::new("scan period", period_s, "s"),
    ];
    let Some((expected_s, by)) = expected(clouds, field) else {
        let why = format!(
            "`{field}` is in {word} by its span, but no known driver has these fields: the right unit is unknown"
        );
        return out.missing(subject, why);
    };
    if (expected_s / unit_s - 1.0).abs() < 0.5 {
        return out.pass(subject, measured);
    }
    let message = format!(
        "`{}`: `{field}` is in {word}, but {by} {}",
        clouds.topic.topic,
        Clouds::unit_word(expected_s)
    );
    let finding = Finding::error(subject, message, clouds.place())
        .likely()
        .relation("unit")
        .detail(format!(
            "`{field}` spans {span} in a cloud: only as {word} does that match the scan period of {period_s:.3} s."
        ))
        .help(format!(
            "publish `{field}` in {}, or set the unit of the consumer to {word} (`timestamp_unit` of FAST-LIO, `time_unit` of others)",
            Clouds::unit_word(expected_s)
        ));
    out.fail(finding.measured(measured));
}

/// The unit that the field should be in, seconds, and the words that say why.
fn expected(clouds: &Clouds, field: &str) -> Option<(f64, String)> {
    let of_driver = |driver: &CloudDriver| {
        let time = driver.time.as_ref().filter(|time| time.field == field)?;
        Some((time.unit_s, format!("the driver ({}) uses", driver.name)))
    };
    if let Some(known) = clouds.driver.and_then(of_driver) {
        return Some(known);
    }
    let by_name = match field {
        "t_us" => 1e-6,
        _ => return None,
    };
    Some((by_name, "its name means".to_owned()))
}
