//! Copies of a recording without one of its parts: how much an estimate varies from drive to drive, by its variation between them.
//!
//! The drive is cut into equal parts of time, and each copy leaves out one (the delete-a-group jackknife, Kott 2001). Unlike with
//! bootstrapped parts no part is there twice, so no row follows one that it did not follow, and most of the evidence that a rule needs
//! stays.

use crate::world::World;
use crate::world::bag::BagEvidence;
use crate::world::content::ContentEvidence;

/// The number of parts.
const PARTS: i64 = 6;
/// The shortest part, seconds: rows closer to each other are not independent.
const MIN_PART_S: f64 = 5.0;

/// A world without each of the parts of its recordings; none if no recording is long enough.
pub(super) fn without_parts(world: &World) -> Vec<World> {
    let spans = world.bags.iter().filter_map(span_ns);
    let longest_s = spans.map(|(start, end)| (end - start) as f64 / 1e9).fold(0.0, f64::max);
    if longest_s < PARTS as f64 * MIN_PART_S {
        return Vec::new();
    }
    (0..PARTS).map(|part| without(world, part)).collect()
}

/// The standard deviation of an estimate, by its values without each part.
pub(super) fn deviation(whole: f64, without_parts: &[f64]) -> f64 {
    let squares: f64 = without_parts.iter().map(|value| (value - whole).powi(2)).sum();
    let count = without_parts.len() as f64;
    ((PARTS as f64 - 1.0) * squares / count).sqrt()
}

/// Earliest and latest log time, nanoseconds.
fn span_ns(bag: &BagEvidence) -> Option<(i64, i64)> {
    bag.start_ns.zip(bag.end_ns).filter(|(start, end)| start < end)
}

fn without(world: &World, part: i64) -> World {
    let mut world = world.clone();
    for bag in &mut world.bags {
        let Some((start_ns, end_ns)) = span_ns(bag) else {
            continue;
        };
        let part_ns = (end_ns - start_ns) / PARTS + 1;
        let is_kept = |log_ns: i64| (log_ns - start_ns) / part_ns != part;
        thin(bag, &is_kept);
    }
    world.forget();
    world
}

/// Keeps the rows of motion, clouds, scans of a radar, stamps and transforms with these log times.
fn thin(bag: &mut BagEvidence, is_kept: &dyn Fn(i64) -> bool) {
    for topic in bag.topics.values_mut() {
        topic.stamps.samples.retain(|(_, log_ns)| is_kept(*log_ns));
        topic.contents_mut().for_each(|content| thin_content(content, is_kept));
    }
    for edge in &mut bag.tf {
        if let Some(motion) = &mut edge.motion {
            split(&mut motion.stretches, |row| is_kept(row.log_ns));
            edge.samples.retain(|sample| is_kept(sample.at.log_ns));
        }
    }
}

fn thin_content(content: &mut ContentEvidence, is_kept: &dyn Fn(i64) -> bool) {
    macro_rules! split_each {
        ($($series:ident),*) => {
            $(if let Some(series) = &mut content.motion.$series {
                split(&mut series.stretches, |row| is_kept(row.log_ns));
            })*
        };
    }
    split_each!(inertial, poses, twists, fixes, orientations, vectors, nmea);
    if let Some(odometry) = &mut content.odometry {
        odometry.samples.retain(|sample| is_kept(sample.at.log_ns));
    }
    let lasers = content.lasers.iter_mut().map(|laser| &mut laser.projected);
    for clouds in content.clouds.iter_mut().chain(lasers) {
        clouds.samples.retain(|sample| is_kept(sample.at.log_ns));
        split(&mut clouds.runs, |slice| is_kept(slice.log_ns));
    }
    if let Some(radar) = &mut content.radar {
        split(&mut radar.runs, |sweep| is_kept(sweep.log_ns));
    }
}

/// Keeps some rows of each run; a run ends where one is left out.
fn split<T>(runs: &mut Vec<Vec<T>>, is_kept: impl Fn(&T) -> bool) {
    let mut kept: Vec<Vec<T>> = Vec::new();
    for run in runs.drain(..) {
        let mut is_open = false;
        for row in run {
            if !is_kept(&row) {
                is_open = false;
                continue;
            }
            match kept.last_mut().filter(|_| is_open) {
                Some(last) => last.push(row),
                None => kept.push(vec![row]),
            }
            is_open = true;
        }
    }
    *runs = kept;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For the mean of parts the jackknife is the usual estimate of the variance of a mean, exactly.
    #[test]
    fn the_deviation_of_a_mean_is_exact() {
        let parts = [3.0, 5.0, 8.0, 1.0, 2.0, 5.0];
        let mean = 4.0;
        let without: Vec<f64> = parts.iter().map(|part| (6.0 * mean - part) / 5.0).collect();
        // By hand: the squares of the deviations from the mean sum up to 1 + 1 + 16 + 9 + 4 + 1 = 32; over 6 * 5.
        assert!((deviation(mean, &without).powi(2) - 32.0 / 30.0).abs() < 1e-12);
    }

    #[test]
    fn a_run_ends_where_a_row_is_left_out() {
        let mut runs = vec![vec![1, 2, 9, 3], vec![9], vec![4, 5]];
        split(&mut runs, |row| *row < 9);
        assert_eq!(runs, [vec![1, 2], vec![3], vec![4, 5]]);
    }
}
