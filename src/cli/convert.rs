//! `frames-lint convert`.

use std::io::Read;

use crate::convert::{self, ConvertRequest};
use crate::engine;
use crate::files::Outputs;
use crate::report::{Style, terminal};
use crate::tables::Tables;

use crate::visible::clean;

use super::args::Convert;
use super::{Answer, Failure, Surroundings, paths, save};

/// Writes the converted transforms; the chains that lead to them go to standard error.
pub(super) fn run(asked: Convert, stdin: &mut dyn Read, surroundings: Surroundings) -> Result<Answer, Failure> {
    let run = engine::read(&engine::Options {
        config: asked.config,
        outputs: Outputs {
            files: asked.output.iter().cloned().collect(),
            force: asked.force,
            ..Outputs::default()
        },
        ..asked
            .input
            .reading
            .options(paths(asked.input.paths, stdin)?, surroundings)
    })?;
    let mut frames = asked.frames.into_iter();
    let wish = ConvertRequest {
        to: asked.to,
        frames: frames.next().zip(frames.next()),
        key: asked.key,
        is: asked.is,
    };
    let own = run.worlds.first().map_or_else(
        || Tables::default().into(),
        |world| std::sync::Arc::clone(&world.tables),
    );
    let style = Style {
        color: false,
        ..surroundings.style
    };
    let unread = terminal::render_unread(&run, style);
    let converted =
        convert::convert(&run, own.dialects(), &wish).map_err(|why| Failure::Usage(format!("{unread}{why}")))?;
    let mut answer = Answer {
        err: unread + &clean(&converted.notes),
        code: run.exit_code_of_reading(),
        ..Answer::default()
    };
    let Some(file) = asked.output else {
        answer.out = converted.text;
        return Ok(answer);
    };
    let is_feather = file
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("feather"));
    let bytes = if is_feather && converted.is_table {
        convert::feather_from_csv(&converted.text).map_err(Failure::Ours)?
    } else {
        converted.text.into_bytes()
    };
    save(&file, bytes)?;
    Ok(answer)
}
