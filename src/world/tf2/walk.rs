//! Look-ups: from both frames up to their common ancestor, as in `walkToTopParent` and `getLatestCommonTime`.

use nalgebra::Isometry3;

use crate::world::frame::FrameId;

use super::errors::LookupError;
use super::history::Edge;
use super::{Buffer, Extrapolation, Factor, FrameIndex, Lookup, MAX_DEPTH};

/// An edge on the way up, with its child.
type Step = (FrameIndex, Edge);

impl Buffer {
    /// `target_from_source` at a stamp; zero requests the latest stamp that all moving edges on the way have.
    ///
    /// # Errors
    ///
    /// What tf2 would throw.
    pub fn lookup(&self, target: &str, source: &str, stamp_ns: i64) -> Result<Lookup, LookupError> {
        let (stamp_ns, up, down) = self.way(target, source, stamp_ns)?;
        let mut found = Lookup {
            target_from_source: Isometry3::identity(),
            stamp_ns,
            factors: Vec::with_capacity(up.len() + down.len()),
        };
        let steps = up
            .iter()
            .map(|step| (step, false))
            .chain(down.iter().rev().map(|step| (step, true)));
        for ((child, edge), is_forward) in steps {
            let factor = Factor {
                parent: self.name(edge.parent),
                child: self.name(*child),
                is_forward,
                parent_from_child: edge.parent_from_child,
                made_from: edge.made_from,
                tags: edge.tags,
            };
            found.target_from_source *= factor.value();
            found.factors.push(factor);
        }
        Ok(found)
    }

    /// Tags of the samples that a look-up uses, the older one of each pair: [`Buffer::lookup`] without its product.
    ///
    /// # Errors
    ///
    /// What tf2 would throw.
    pub fn rests_on(&self, target: &str, source: &str, stamp_ns: i64) -> Result<Vec<usize>, LookupError> {
        let (_, up, down) = self.way(target, source, stamp_ns)?;
        Ok(up.iter().chain(&down).map(|(_, edge)| edge.tags.0).collect())
    }

    /// Edges from a frame up to its top by the newest parents; as many as tf2 follows at most.
    pub fn depth(&self, frame: &FrameId) -> usize {
        let mut at = self.numbers.get(frame).copied();
        for depth in 0..MAX_DEPTH {
            match at.and_then(|frame| self.history(frame)?.latest()) {
                Some((_, parent)) => at = Some(parent),
                None => return depth,
            }
        }
        MAX_DEPTH
    }

    /// The stamp of the answer, and the steps from the target and from the source up to where they meet.
    fn way(&self, target: &str, source: &str, stamp_ns: i64) -> Result<(i64, Vec<Step>, Vec<Step>), LookupError> {
        if target == source {
            // Not even the name is checked.
            let known = self.numbers.get(&FrameId::new(target));
            let latest = known.and_then(|frame| self.history(*frame)?.latest());
            let stamp_ns = match latest {
                Some((latest, _)) if stamp_ns == 0 => latest,
                _ => stamp_ns,
            };
            return Ok((stamp_ns, Vec::new(), Vec::new()));
        }
        let target = self.known(target, true)?;
        let source = self.known(source, false)?;
        let stamp_ns = if stamp_ns == 0 {
            self.latest_common_ns(target, source)?
        } else {
            stamp_ns
        };
        let (up, down) = self.walk(target, source, stamp_ns)?;
        Ok((stamp_ns, up, down))
    }

    fn known(&self, frame: &str, is_target: bool) -> Result<FrameIndex, LookupError> {
        if frame.is_empty() || frame.starts_with('/') {
            return Err(LookupError::InvalidArgument {
                frame: frame.to_owned(),
                is_target,
            });
        }
        let unknown = || LookupError::Unknown {
            frame: frame.to_owned(),
            is_target,
        };
        self.numbers.get(&FrameId::new(frame)).copied().ok_or_else(unknown)
    }

    /// The steps from the target up to the common ancestor, and those from the source up to it.
    fn walk(
        &self,
        target: FrameIndex,
        source: FrameIndex,
        stamp_ns: i64,
    ) -> Result<(Vec<Step>, Vec<Step>), LookupError> {
        let failed = |child: FrameIndex, what: Extrapolation| LookupError::Extrapolation {
            child: self.name(child),
            what,
            target: self.name(target),
            source: self.name(source),
        };
        let mut from_source: Vec<Step> = Vec::new();
        let mut frame = source;
        let mut extrapolation = None;
        while let Some(history) = self.history(frame) {
            match history.at(stamp_ns) {
                // There may still be a way: the target may be on this side of the gap.
                Err(what) => {
                    extrapolation = Some((frame, what));
                    break;
                }
                Ok(_) if frame == target => return Ok((Vec::new(), from_source)),
                Ok(edge) => {
                    from_source.push((frame, edge));
                    frame = edge.parent;
                }
            }
            if from_source.len() > MAX_DEPTH {
                return Err(LookupError::Loop);
            }
        }
        let top = frame;
        let mut from_target: Vec<Step> = Vec::new();
        frame = target;
        while frame != top {
            let Some(history) = self.history(frame) else { break };
            let edge = history.at(stamp_ns).map_err(|what| failed(frame, what))?;
            if frame == source {
                return Ok((from_target, Vec::new()));
            }
            from_target.push((frame, edge));
            frame = edge.parent;
            if from_target.len() > MAX_DEPTH {
                return Err(LookupError::Loop);
            }
        }
        if frame != top {
            return Err(match extrapolation {
                Some((child, what)) => failed(child, what),
                None => self.not_connected(target, source),
            });
        }
        // Everything above the lowest common ancestor cancels.
        while let (Some((a, _)), Some((b, _))) = (from_target.last(), from_source.last()) {
            if a != b {
                break;
            }
            from_target.pop();
            from_source.pop();
        }
        Ok((from_target, from_source))
    }

    fn not_connected(&self, target: FrameIndex, source: FrameIndex) -> LookupError {
        LookupError::NotConnected {
            target: self.name(target),
            source: self.name(source),
        }
    }

    /// The latest stamp that every moving edge between two frames has, by the newest parent of each; zero where nothing
    /// moves.
    fn latest_common_ns(&self, target: FrameIndex, source: FrameIndex) -> Result<i64, LookupError> {
        let or_zero = |common: Option<i64>| common.unwrap_or(0);
        let from_source = match self.latest_up(source, target, |_| false)? {
            WalkEnd::Reached(common) => return Ok(or_zero(common)),
            WalkEnd::Top(steps) | WalkEnd::Met(steps) => steps,
        };
        let on_way = |parent: FrameIndex| from_source.iter().any(|(_, known)| *known == parent);
        let from_target = match self.latest_up(target, source, on_way)? {
            WalkEnd::Reached(common) => return Ok(or_zero(common)),
            WalkEnd::Met(steps) => steps,
            WalkEnd::Top(_) => return Err(self.not_connected(target, source)),
        };
        let meeting = from_target.last().map(|(_, parent)| *parent);
        let mut common = earliest(&from_target);
        for step in &from_source {
            common = earliest_of(common, earliest(std::slice::from_ref(step)));
            if Some(step.1) == meeting {
                break;
            }
        }
        Ok(or_zero(common))
    }

    /// Goes up by the newest parents until `goal`, or until a parent that `met` knows, or to the top.
    fn latest_up(
        &self,
        from: FrameIndex,
        goal: FrameIndex,
        met: impl Fn(FrameIndex) -> bool,
    ) -> Result<WalkEnd, LookupError> {
        let mut steps: Vec<(i64, FrameIndex)> = Vec::new();
        let mut frame = from;
        while let Some((stamp_ns, parent)) = self.history(frame).and_then(super::history::History::latest) {
            steps.push((stamp_ns, parent));
            if met(parent) {
                return Ok(WalkEnd::Met(steps));
            }
            if parent == goal {
                return Ok(WalkEnd::Reached(earliest(&steps)));
            }
            frame = parent;
            if steps.len() > MAX_DEPTH {
                return Err(LookupError::Loop);
            }
        }
        Ok(WalkEnd::Top(steps))
    }
}

/// How a walk up ended; steps are the newest stamp of a frame and its newest parent.
enum WalkEnd {
    /// At the other frame, with the earliest of the stamps.
    Reached(Option<i64>),
    /// At a parent that the other walk passed too.
    Met(Vec<(i64, FrameIndex)>),
    /// At a frame without a parent.
    Top(Vec<(i64, FrameIndex)>),
}

/// The earliest stamp that is not zero.
fn earliest(steps: &[(i64, FrameIndex)]) -> Option<i64> {
    steps.iter().map(|(stamp, _)| *stamp).filter(|stamp| *stamp != 0).min()
}

fn earliest_of(a: Option<i64>, b: Option<i64>) -> Option<i64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}
