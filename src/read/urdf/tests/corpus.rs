//! The reader over real files, where they are available.

use std::path::{Path, PathBuf};

use super::{UrdfResult, read_text, read_xacro};
use crate::read::at_hand::corpus;
use crate::read::text::decode;
use crate::source::ReadStatus;
use crate::world::Spelling;
use crate::world::robot::ConsumerOpinion;

fn files(format: &str) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders: Vec<PathBuf> = corpus().map(|corpus| corpus.join(format)).into_iter().collect();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

fn each(format: &str, reader: fn(&str) -> UrdfResult, mut look: impl FnMut(&Path, &UrdfResult)) {
    for path in files(format) {
        let bytes = std::fs::read(&path).unwrap();
        let (text, _) = decode(bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        look(&path, &reader(&text));
    }
}

#[test]
fn every_real_urdf_gives_a_robot_with_the_numbers_a_consumer_reads() {
    let (mut meant, mut refused) = (0, 0);
    each("urdf", read_text, |path, read| {
        let name = path.display();
        assert_eq!(read.facts.robots.len(), 1, "{name}: {:?}", read.source.problems);
        assert!(read.source.status != ReadStatus::Unreadable, "{name}");
        assert!(
            read.source
                .problems
                .iter()
                .all(|problem| problem.place.span().is_some()),
            "{name}"
        );
        meant += usize::from(!read.meant().is_empty());
        match &read.robot().consumer {
            ConsumerOpinion::Loads(joints) => {
                let mut claims: Vec<_> = read.facts.claims.iter().collect();
                claims.sort_by_key(|claim| (&claim.label, claim.target(), claim.source_frame()));
                assert_eq!(claims.len(), joints.len(), "{name}");
                for (claim, joint) in claims.iter().zip(joints) {
                    let Spelling::Rpy { xyz, rpy } = claim.spelling else {
                        panic!("{name}")
                    };
                    assert_eq!((&claim.label, xyz, rpy), (&joint.name, joint.xyz, joint.rpy), "{name}");
                }
            }
            ConsumerOpinion::Refuses(_) => refused += 1,
            ConsumerOpinion::NotAsked(_) => assert!(read.robot().fragment.is_some(), "{name}"),
        }
    });
    // Two real files have `<axis xzy=...>`; sixteen hold what a consumer refuses in truth. More would be our noise.
    assert!(meant <= 2 && refused <= 16, "{meant} {refused}");
}

#[test]
fn every_real_xacro_is_read_as_far_as_it_is_written_out() {
    each("xacro", read_xacro, |path, read| {
        let name = path.display();
        assert_eq!(read.facts.robots.len(), 1, "{name}: {:?}", read.source.problems);
        assert!(
            read.robot().fragment.is_some() && read.robot().malformed.is_empty(),
            "{name}"
        );
        assert!(read.meant().is_empty(), "{name}: {:?}", read.meant());
        assert!(read.facts.claims.iter().all(|claim| claim.pose.is_some()), "{name}");
    });
}
