//! Conversion: transforms that were read, written in another dialect or form, with the chain that leads to them.
//!
//! Owns the request and the answer. `links` finds chains, `kinds` maps the frames of one dialect to those of another, `write` fills the
//! templates, `forms` has the forms that belong to no dialect. Reads no files and judges nothing.

mod feather;
mod forms;
mod kinds;
mod links;
mod write;

use std::fmt::Write;

use nalgebra::Isometry3;

use crate::run::Run;
use crate::source::Confidence;
use crate::tables::{Dialect, Rows, writings};

use kinds::Assignment;
use links::{Link, Links};

pub use feather::from_csv as feather_from_csv;

/// The requested conversion.
#[derive(Clone, Debug, Default)]
pub struct ConvertRequest {
    /// The dialect or form.
    pub to: String,
    /// `(target, source)` of the transform; without it all that were read.
    pub frames: Option<(String, String)>,
    /// The key of the dialect to write, or of the statement to convert.
    pub key: Option<String>,
    /// `(target, source)`: the frames of a statement that names none.
    pub is: Option<(String, String)>,
}

/// The answer.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Conversion {
    /// The file.
    pub text: String,
    /// How each transform came about, and what was left out.
    pub notes: String,
    /// Whether the dialect's files are binary: the text is their table.
    pub is_table: bool,
}

/// Every word that `to` may be.
pub fn targets() -> Vec<&'static str> {
    let dialects = writings().iter().map(|writing| writing.dialect.as_str());
    forms::FORMS.iter().copied().chain(dialects).collect()
}

/// One transform that is written.
struct Item {
    target: String,
    source: String,
    target_from_source: Isometry3<f64>,
    /// The chain in words.
    chain: String,
}

/// Converts what a run has read.
///
/// # Errors
///
/// Where nothing matches the wish, or more than one thing does; in words for the user.
pub fn convert(run: &Run, dialects: &Rows<Dialect>, wish: &ConvertRequest) -> Result<Conversion, String> {
    let links = Links::of(run, wish)?;
    let asked = match &wish.frames {
        Some((target, source)) => Some(chained(&links, target, source)?),
        None => None,
    };
    if forms::FORMS.contains(&wish.to.as_str()) {
        let items = match asked {
            Some(item) => vec![item],
            None => links.all.iter().map(stated).collect(),
        };
        return Ok(Conversion {
            text: forms::write(&wish.to, &items),
            notes: items
                .iter()
                .fold(String::new(), |notes, item| notes + &item.chain + "\n"),
            is_table: false,
        });
    }
    let writing = writings()
        .iter()
        .find(|writing| writing.dialect == wish.to)
        .ok_or_else(|| {
            format!(
                "`{}` is not a dialect that can be written: use one of {}",
                wish.to,
                targets().join(", ")
            )
        })?;
    let casts = match &asked {
        Some(item) => vec![kinds::cast_one(
            writing,
            dialects,
            &item.target,
            &item.source,
            wish.key.as_deref(),
            kinds::Camera::first_of(&links),
        )?],
        None => kinds::cast_all(writing, dialects, &links, wish.key.as_deref()),
    };
    if casts.is_empty() {
        return Err(format!(
            "no transform matches `{}` by the names of its frames ({}): choose one with --frames TARGET SOURCE",
            writing.dialect,
            links.frames().join(", ")
        ));
    }
    if writing.join.is_none() && casts.len() > 1 {
        let list: Vec<String> = casts
            .iter()
            .map(|cast| format!("{} {}", cast.target, cast.source))
            .collect();
        return Err(format!(
            "a file of `{}` holds one transform, and {} match: choose one with --frames: {}",
            writing.dialect,
            casts.len(),
            list.join("; ")
        ));
    }
    let mut notes = String::new();
    let mut texts = Vec::new();
    for cast in &casts {
        let item = chained(&links, &cast.target, &cast.source)?;
        texts.push(write::item(cast, &item.target_from_source)?);
        notes.push_str(&item.chain);
        let _ = write!(notes, "\n  written as `{}`: {}", cast.label(), cast.meaning());
        if let Some(name) = &cast.transform.named {
            let _ = write!(notes, "; the file must be named {name}");
        }
        if let Some(doubt) = &cast.doubt {
            let _ = write!(notes, "\n  in doubt: {doubt}");
        }
        notes.push('\n');
    }
    for frame in links.frames() {
        if !casts.iter().any(|cast| cast.target == frame || cast.source == frame) {
            let _ = writeln!(notes, "left out: `{frame}` matches no key there");
        }
    }
    Ok(Conversion {
        text: write::file(writing, &texts),
        notes,
        is_table: writing.ending == "csv",
    })
}

/// A link as it was stated.
fn stated(link: &Link) -> Item {
    Item {
        target: link.target.clone(),
        source: link.source.clone(),
        target_from_source: link.pose,
        chain: format!("{}_from_{} {}", link.target, link.source, origin(link)),
    }
}

/// `target_from_source` over the links, with the chain in words.
fn chained(links: &Links, target: &str, source: &str) -> Result<Item, String> {
    let Some(steps) = links.chain(target, source) else {
        let why = if links.frames().iter().any(|frame| frame == target || frame == source) {
            "no chain of transforms leads from one to the other"
        } else {
            "none of the inputs names either frame"
        };
        return Err(format!(
            "`{target}` from `{source}` cannot be computed: {why}; known frames are {}",
            links.frames().join(", ")
        ));
    };
    let mut target_from_source = Isometry3::identity();
    let mut factors = Vec::new();
    let mut origins = String::new();
    for (link, is_forward) in steps {
        let name = format!("{}_from_{}", link.target, link.source);
        target_from_source *= if is_forward { link.pose } else { link.pose.inverse() };
        factors.push(if is_forward {
            name.clone()
        } else {
            format!("inverse({name})")
        });
        let _ = write!(origins, "\n  {name} {}", origin(link));
    }
    let product = if factors.is_empty() {
        "identity".to_owned()
    } else {
        factors.join(" * ")
    };
    Ok(Item {
        target: target.to_owned(),
        source: source.to_owned(),
        target_from_source,
        chain: format!("{target}_from_{source} = {product}{origins}"),
    })
}

fn origin(link: &Link) -> String {
    let doubt = if link.reading == Confidence::Hint {
        "; its frames and direction are a guess"
    } else {
        ""
    };
    format!("is `{}` of {}{doubt}", link.label, link.place)
}

impl Assignment<'_> {
    /// The key with its numbers.
    fn label(&self) -> String {
        let number = self.number.to_string();
        self.transform.key.replacen('#', &number, 1)
    }

    /// The transform under it, in words.
    fn meaning(&self) -> String {
        let turned = if self.is_turned { ", inverted" } else { "" };
        format!("`{}` from `{}`{turned}", self.target, self.source)
    }
}
