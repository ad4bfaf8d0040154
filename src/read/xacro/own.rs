//! Expansion of one xacro file by this program itself, in a process that was started for it.
//!
//! Owns the bounds of that process and the expressions that are not evaluated as `xacro` does. If a file crashes this process (endless
//! recursion, too much memory), the calling process continues.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use xacro_rs::extensions::{CwdExtension, EnvExtension, ExtensionHandler, FindExtension, OptEnvExtension};
use xacro_rs::{XacroError, XacroProcessor};

use super::super::allowed::AllowedFolders;

/// How deep elements and macro calls may be nested.
const DEEPEST: usize = 1000;

/// Stack for that depth, bytes. Only the used part takes memory.
const STACK: usize = 1 << 29;

/// Addresses that this process may take on top of those that it has, bytes: half of them are its stack.
#[cfg(unix)]
const MEMORY: u64 = 1 << 30;

/// Expands `file` with `args` of the form `name:=value`; it and the files it names must be in the folders `allowed`, or anywhere if that is empty.
/// Relative paths start from the folder `from`. Limits the memory and the rights of the whole process, and changes its working directory: call
/// it in one of its own.
///
/// # Errors
///
/// Why there is no expansion, in lines as the `xacro` program writes them.
pub fn expand(file: &Path, args: &[String], allowed: &[PathBuf], from: Option<&Path>) -> Result<String, String> {
    if let Some(from) = from {
        std::env::set_current_dir(from).map_err(|error| format!("error: `{}`: {error}", from.display()))?;
    }
    // If the limit cannot be set, time and output are still bounded from outside.
    #[cfg(unix)]
    let _ = {
        let most = mapped() + MEMORY;
        nix::sys::resource::setrlimit(nix::sys::resource::Resource::RLIMIT_AS, most, most)
    };
    let bounds = (!allowed.is_empty()).then(|| Bounds {
        allowed: AllowedFolders::exactly(allowed),
        in_force: confined(allowed),
    });
    let args: HashMap<String, String> = args
        .iter()
        .filter_map(|arg| arg.split_once(":="))
        .map(|(name, value)| (name.to_owned(), value.to_owned()))
        .collect();
    std::thread::scope(|scope| {
        std::thread::Builder::new()
            .stack_size(STACK)
            .spawn_scoped(scope, || expand_here(file, args, bounds.as_ref()))
            .map_err(|error| format!("error: no thread could be started: {error}"))?
            .join()
            .unwrap_or_else(|_| Err("error: the expansion crashed".to_owned()))
    })
}

/// Addresses that this process has, bytes; where the system does not state it, as many as the allocator reserves.
#[cfg(unix)]
fn mapped() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let size = status
        .lines()
        .find_map(|line| line.strip_prefix("VmSize:")?.strip_suffix(" kB"));
    let kilobytes: Option<u64> = size.and_then(|size| size.trim().parse().ok());
    kilobytes.map_or(1 << 30, |kilobytes| kilobytes * 1024)
}

/// What may be read.
struct Bounds {
    allowed: AllowedFolders,
    /// Whether the system enforces it. If not, the files that were read are checked afterwards.
    in_force: bool,
}

impl Bounds {
    /// Why the content of a file may not be used.
    fn refusal(&self, path: &Path, text: &str) -> Option<String> {
        if !self.allowed.holds(path) {
            let path = path.display();
            return Some(format!(
                "error: `{path}` is outside of the checked folders\n{BY_PROGRAM}"
            ));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        if let Some(pattern) = patterns(text).find(|pattern| !self.allowed.holds(&folder.join(fixed_part(pattern)))) {
            return Some(format!(
                "error: `{pattern}` is outside of the checked folders\n{BY_PROGRAM}"
            ));
        }
        let is_loaded = !self.in_force && text.contains("load_yaml");
        is_loaded.then(|| format!("error: `load_yaml` may read any file here\n{BY_PROGRAM}"))
    }
}

/// How to expand a file that is refused here.
const BY_PROGRAM: &str = "help: check its folder too, or use --xacro run: the `xacro` program executes what the files say, and reads any file";

/// Removes the right of this process to open anything outside of these folders; returns whether that is enforced.
#[cfg(target_os = "linux")]
fn confined(folders: &[PathBuf]) -> bool {
    use landlock::{
        ABI, Access, AccessFs, Ruleset, RulesetAttr, RulesetCreatedAttr, RulesetStatus, path_beneath_rules,
    };
    let read = AccessFs::from_read(ABI::V1);
    let rules = Ruleset::default().handle_access(AccessFs::from_all(ABI::V1));
    let held = rules
        .and_then(Ruleset::create)
        .and_then(|rules| rules.add_rules(path_beneath_rules(folders, read)))
        .and_then(landlock::RulesetCreated::restrict_self);
    held.is_ok_and(|held| held.ruleset != RulesetStatus::NotEnforced)
}

/// Not implemented for other systems.
#[cfg(not(target_os = "linux"))]
fn confined(_: &[PathBuf]) -> bool {
    false
}

fn expand_here(file: &Path, args: HashMap<String, String>, bounds: Option<&Bounds>) -> Result<String, String> {
    // Packages installed here do not count, only those that the caller names.
    let extensions: [Box<dyn ExtensionHandler>; 4] = [
        Box::new(CwdExtension),
        Box::new(EnvExtension),
        Box::new(OptEnvExtension::new()),
        Box::new(FindExtension::with_search_paths(Vec::new())),
    ];
    let builder = XacroProcessor::builder()
        .with_args(args)
        .with_compat_all()
        .with_max_depth(DEEPEST)
        .with_ros_yaml_units()
        .clear_extensions();
    let processor = extensions
        .into_iter()
        .fold(builder, xacro_rs::XacroBuilder::with_extension)
        .build();
    let (text, included) = processor.run_with_deps(file).map_err(|error| {
        let said = words(&error, bounds);
        let is_refused = bounds.is_some() && said.contains("Permission denied");
        if is_refused {
            format!("{said}\n{BY_PROGRAM}")
        } else {
            said
        }
    })?;
    if let Some(name) = named_by_a_float(&text) {
        return Err(format!(
            "error: `{name}` contains a number that the `xacro` program may write without its decimal point\nwhen processing file: {}",
            file.display()
        ));
    }
    for path in included.iter().map(std::path::PathBuf::as_path).chain([file]) {
        let written = std::fs::read_to_string(path).unwrap_or_default();
        if let Some(refusal) = bounds.and_then(|bounds| bounds.refusal(path, &written)) {
            return Err(refusal);
        }
        if let Some(expression) = expressions(&written).find(|expression| is_evaluated_otherwise(expression)) {
            return Err(format!(
                "error: `${{{expression}}}` is evaluated by the `xacro` program only\nwhen processing file: {}",
                path.display()
            ));
        }
    }
    Ok(text)
}

/// The patterns of files that are included, as written. A pattern that matches only forbidden files matches nothing, without an error.
fn patterns(text: &str) -> impl Iterator<Item = &str> {
    let includes = text.split(":include").skip(1);
    let names = includes.filter_map(|rest| {
        let (_, value) = rest.split('>').next()?.split_once("filename")?;
        let value = value.trim_start().strip_prefix('=')?.trim_start();
        let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
        value.get(1..)?.split(quote).next()
    });
    names.filter(|name| name.contains(['*', '?', '[']) && !name.contains('$'))
}

/// The folder of a pattern, up to its first wildcard.
fn fixed_part(pattern: &str) -> &str {
    let fixed = pattern
        .find(['*', '?', '['])
        .and_then(|end| pattern.get(..end))
        .unwrap_or(pattern);
    fixed
        .rsplit_once('/')
        .map_or("", |(folder, _)| if folder.is_empty() { "/" } else { folder })
}

/// The content of `${...}`, in the order of the text.
fn expressions(text: &str) -> impl Iterator<Item = &str> {
    text.split("${")
        .skip(1)
        .map(|rest| rest.split('}').next().unwrap_or_default())
}

/// Whether an expression is one of the few with another value here than in Python: the remainder of a negative number, a minus before
/// a power, and `None`, which counts as zero here.
fn is_evaluated_otherwise(expression: &str) -> bool {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let powers = expression.match_indices("**").any(|(at, _)| {
        let before = expression.get(..at).unwrap_or_default().trim_end();
        let open = match before.strip_suffix(')') {
            Some(inner) => opening(inner),
            None => before,
        };
        let sign = open.trim_end_matches(|c| is_word(c) || c == '.').trim_end();
        sign.strip_suffix('-').is_some_and(|left| {
            let left = left.trim_end();
            left.is_empty() || left.ends_with(|c: char| !is_word(c) && !matches!(c, ')' | ']' | '\'' | '.'))
        })
    });
    powers || expression.contains('%') || expression.split(|c| !is_word(c)).any(|word| word == "None")
}

/// The first name of an expansion that contains a whole number with a decimal point (`lidar_3.0`): whole numbers of YAML files are floats here, and whole
/// in Python.
fn named_by_a_float(expanded: &str) -> Option<&str> {
    let values = ["name=\"", "link=\""]
        .into_iter()
        .flat_map(|key| expanded.split(key).skip(1));
    let mut names = values.filter_map(|rest| rest.split('"').next());
    names.find(|name| {
        let is_digit = |byte: Option<&u8>| byte.is_some_and(u8::is_ascii_digit);
        let mut points = name.match_indices(".0");
        points.any(|(at, _)| {
            let bytes = name.as_bytes();
            is_digit(at.checked_sub(1).and_then(|before| bytes.get(before))) && !is_digit(bytes.get(at + 2))
        })
    })
}

/// The text before the bracket that matches a closing one after `inner`.
fn opening(inner: &str) -> &str {
    let mut depth = 1_usize;
    for (at, c) in inner.char_indices().rev() {
        match c {
            ')' => depth += 1,
            '(' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return inner.get(..at).unwrap_or_default();
        }
    }
    ""
}

/// The error in the wording of the `xacro` program. Nothing is quoted of a file that may not be read.
fn words(error: &XacroError, bounds: Option<&Bounds>) -> String {
    let about = match error {
        XacroError::WithContext { context, .. } => context
            .include_stack
            .last()
            .or(context.file.as_ref())
            .map(PathBuf::as_path),
        XacroError::YamlParseError { path, .. } => Some(Path::new(path)),
        _ => None,
    };
    if let Some(refusal) = bounds.zip(about).and_then(|(bounds, file)| bounds.refusal(file, "")) {
        return refusal;
    }
    match error {
        XacroError::WithContext { source, .. } => {
            let file = about;
            let file = file.map_or_else(String::new, |file| {
                format!("\nwhen processing file: {}", file.display())
            });
            words(source, bounds) + &file
        }
        XacroError::UndefinedArgument { name } => format!("error: Undefined substitution argument {name}"),
        XacroError::InvalidExtension { reason, .. } if reason.starts_with("Package not found: ") => {
            format!("error: {}", reason.replace("Package not found:", "package"))
        }
        XacroError::UnimplementedFeature(said) => {
            let name = said
                .split_once('<')
                .and_then(|(_, rest)| rest.split('>').next())
                .unwrap_or_default();
            if matches!(name, "xacro:element" | "xacro:attribute") {
                format!("error: `<{name}>` is expanded by the `xacro` program only")
            } else {
                format!("error: unknown macro name: {name}")
            }
        }
        other => {
            let said = other.to_string();
            format!("error: {}", said.lines().next().unwrap_or_default())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_of_includes_are_known_with_their_folders() {
        let text = "<xacro:include filename=\"../a/*.xacro\"/><xacro:include ns='x' filename = 'b.xacro' /><xacro:include filename='/c[0].xacro'/>";
        let folders: Vec<_> = patterns(text).map(|pattern| (pattern, fixed_part(pattern))).collect();
        assert_eq!(folders, [("../a/*.xacro", "../a"), ("/c[0].xacro", "/")]);
    }

    #[test]
    fn names_that_hold_a_float_are_known() {
        for (text, name) in [
            ("<link name=\"lidar_3.0\"/>", Some("lidar_3.0")),
            ("<child link=\"a_12.0_b\"/>", Some("a_12.0_b")),
            ("<link name=\"v1.05\"/><origin xyz=\"3.0 0 0\"/>", None),
            ("<link name=\"base.0\"/><link name=\"lidar_3\"/>", None),
        ] {
            assert_eq!(named_by_a_float(text), name, "{text}");
        }
    }

    #[test]
    fn expressions_that_are_evaluated_otherwise_are_known() {
        for odd in ["-2**2", "a + (-b**2)", "-(a+b) ** 2", "i % 2", "x == None", "2*-a**2"] {
            assert!(is_evaluated_otherwise(odd), "{odd}");
        }
        for usual in [
            "a**2",
            "m*(a**2 - b**2)",
            "a-b**2",
            "-a*2",
            "(a) - (b)**2",
            "NoneSuch",
            "2 ** -1",
        ] {
            assert!(!is_evaluated_otherwise(usual), "{usual}");
        }
    }
}
