//! `frames-lint tree`.

use std::io::Read;

use crate::engine;
use crate::report::{Style, terminal, tree};
use crate::run::EXIT_FINDINGS;

use super::args::{Tree, TreeFormat};
use super::{Answer, Failure, Surroundings, paths};

/// Draws the trees, shows them at a timestamp, or shows a chain; a chain that tf2 would refuse gives exit code 1.
pub(super) fn run(tree: Tree, stdin: &mut dyn Read, surroundings: Surroundings) -> Result<Answer, Failure> {
    let is_of_a_moment = tree.at.is_some() || !tree.chain.is_empty();
    if is_of_a_moment && !matches!(tree.format, TreeFormat::Text) {
        return Err(Failure::Usage("--at and --chain support only --format text".to_owned()));
    }
    let mut extent = tree.input.reading.extent();
    // Between two windows there is nothing to interpolate.
    extent.full |= is_of_a_moment && extent.windows.is_none();
    let run = engine::read(&engine::Options {
        extent,
        ..tree
            .input
            .reading
            .options(paths(tree.input.paths, stdin)?, surroundings)
    })?;
    // The drawing may be piped into a tool: problems of inputs go to standard error.
    let style = Style {
        color: false,
        ..surroundings.style
    };
    let mut err = terminal::render_unread(&run, style);
    let mut code = run.exit_code_of_reading();
    let out = match (tree.chain.as_slice(), tree.at) {
        ([target, source], at_ns) => match tree::chain::render(&run, target, source, at_ns, surroundings.style) {
            Ok(chain) => chain,
            Err(failure) => {
                err.push_str(&failure);
                code = code.max(EXIT_FINDINGS);
                String::new()
            }
        },
        (_, Some(at_ns)) => tree::moment::render(&run, at_ns, surroundings.style),
        (_, None) => match tree.format {
            TreeFormat::Text => tree::text::render(&run, surroundings.style),
            TreeFormat::Dot => tree::dot::render(&run),
            TreeFormat::Mermaid => tree::mermaid::render(&run),
            TreeFormat::Svg => tree::svg::render(&run),
        },
    };
    Ok(Answer {
        out,
        err,
        code,
        ..Answer::default()
    })
}
