//! The hashes of the files of an input.

use maud::{Markup, html};

use crate::source::{FileHash, Source};

use super::words::plain;

/// The hash of each file, with its name if it differs from that of the source.
pub(super) fn hashes(source: &Source) -> Markup {
    let is_it = |hash: &FileHash| source.path.rsplit('/').next() == Some(&hash.name);
    let row = |hash: &FileHash| {
        html! { @match &hash.sha256 { Some(digest) => code { (plain(digest)) }, None => "can no longer be read" } }
    };
    match source.hashes.as_slice() {
        [] => html! { "–" },
        [only] if is_it(only) => row(only),
        files => html! {
            dl class="files" { @for hash in files { div { dt { (plain(&hash.name)) } dd { (row(hash)) } } } }
        },
    }
}
