//! Reports: verdicts, worlds and pages become words. Reads no file and judges nothing.

pub mod assure;
mod assured;
mod contract;
pub mod diff;
pub mod explain;
mod fingerprint;
mod fitness;
mod github;
mod gitlab;
mod html;
pub mod init;
pub mod json;
pub mod json_lines;
mod junit;
mod markdown;
mod place;
#[cfg(feature = "rerun")]
pub mod rerun;
pub mod rules_table;
#[cfg(test)]
mod samples;
mod sarif;
mod smallest;
mod style;
pub mod terminal;
mod text;
pub mod tree;

use crate::run::Run;

pub use style::Style;
pub use text::plural;

/// The formats of reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// For people, with source lines.
    Human,
    /// For people and editors, a line for each finding.
    Concise,
    /// One document, described by `schema/frames-lint-1.json`.
    Json,
    /// The same document, one line for each input, outcome and finding.
    JsonLines,
    /// SARIF 2.1.0.
    Sarif,
    /// Workflow commands of GitHub Actions.
    Github,
    /// Code quality report of GitLab.
    Gitlab,
    /// JUnit XML: a test case for each check.
    Junit,
    /// For comments and job summaries.
    Markdown,
    /// One page with everything, to be signed by the person who accepts or rejects a dataset.
    Html,
}

/// How a run was called, so that it can be repeated.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Call {
    /// The command line, the program first.
    pub command: Vec<String>,
    /// Further settings of the run, by name.
    pub settings: Vec<(&'static str, String)>,
    /// The date of the run (UTC), which decides which waivers are valid.
    pub day: Option<String>,
}

/// Why there is no report: a bug.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReportError(pub String);

impl std::fmt::Display for ReportError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl From<serde_json::Error> for ReportError {
    fn from(error: serde_json::Error) -> Self {
        Self(error.to_string())
    }
}

/// The report of a run.
pub fn render(run: &Run, format: Format, options: &terminal::Options, call: &Call) -> Result<String, ReportError> {
    let fail_on = options.fail_on;
    Ok(match format {
        Format::Human => terminal::render(run, options),
        Format::Concise => terminal::render_concise(run, options),
        Format::Json => json::render(run, fail_on)?,
        Format::JsonLines => json_lines::render(run, fail_on)?,
        Format::Sarif => sarif::render(run, fail_on)?,
        Format::Github => github::render(run, fail_on),
        Format::Gitlab => gitlab::render(run, fail_on)?,
        Format::Junit => junit::render(run, fail_on)?,
        Format::Markdown => markdown::render(run, fail_on),
        Format::Html => html::render(run, fail_on, call),
    })
}
