//! The definitions that are available if a recording carries none: those of the standard packages, and those of `--msg-path`.
//!
//! Owns where definitions are looked for on disk.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::{Bundle, MAX_DEFINITION, StructSpelling, idl, msg, standard};

/// Bound on the entries of the folders that are searched.
const MAX_ENTRIES: usize = 200_000;
/// Bound on nested folders.
const MAX_DEPTH: usize = 24;

/// Definitions by the names of their types. The standard packages are always there; folders that were added come first.
#[derive(Clone, Debug, Default)]
pub struct Definitions {
    added: Bundle,
}

impl Definitions {
    /// The definitions of the standard packages.
    pub fn builtin() -> Self {
        Self::default()
    }

    /// Adds the definitions in a folder and below: `package/msg/Type.msg`, `package/Type.msg`, and `.idl` files; of two
    /// for one type the first one is used, `.msg` before `.idl`, in the order of the paths. Returns the number of files.
    /// A file with an error is reported with file and line if a recording needs its type.
    pub fn add_folder(&mut self, folder: &Path) -> Result<usize, String> {
        let shown = folder.display();
        let root = fs::canonicalize(folder).map_err(|error| format!("`{shown}` cannot be opened: {error}"))?;
        if !root.is_dir() {
            return Err(format!("`{shown}` is not a folder"));
        }
        let files = files(&root).map_err(|what| format!("`{shown}`: {what}"))?;
        for file in files.iter().filter(|file| has_ending(file, "msg")) {
            self.add_msg(file);
        }
        for file in files.iter().filter(|file| has_ending(file, "idl")) {
            self.add_idl(file);
        }
        if files.is_empty() {
            return Err(format!(
                "`{shown}` contains no message definition (package/msg/Type.msg)"
            ));
        }
        Ok(files.len())
    }

    fn add_msg(&mut self, file: &Path) {
        let (Some(package), Some(name)) = (package_of(file), file.file_stem().and_then(|stem| stem.to_str())) else {
            return;
        };
        let mut read = match text(file) {
            Ok(text) => msg::one(&package, (1..).zip(text.lines())),
            Err(what) => StructSpelling {
                fields: Vec::new(),
                fault: Some(what),
            },
        };
        read.fault = read.fault.map(|fault| format!("{}, {fault}", file.display()));
        self.added.types.entry(format!("{package}/{name}")).or_insert(read);
    }

    fn add_idl(&mut self, file: &Path) {
        let Ok(text) = text(file) else { return };
        let (bundle, _) = idl::bundle(&text);
        for (name, mut read) in bundle.types {
            read.fault = read.fault.map(|fault| format!("{}, {fault}", file.display()));
            self.added.types.entry(name).or_insert(read);
        }
        for (name, alias) in bundle.aliases {
            self.added.aliases.entry(name).or_insert(alias);
        }
    }

    /// Whether a folder that was added defines a type (`package/Type`).
    pub fn adds(&self, name: &str) -> bool {
        self.added.types.contains_key(name)
    }

    /// Whether a standard package defines a type (`package/Type`).
    pub fn is_standard(name: &str) -> bool {
        builtin().types.contains_key(name)
    }

    /// Where types are looked up, in this order.
    pub(super) fn bundles(&self) -> impl Iterator<Item = &Bundle> + use<'_> {
        [&self.added, builtin()].into_iter()
    }
}

/// The standard packages, read once.
fn builtin() -> &'static Bundle {
    static BUILTIN: OnceLock<Bundle> = OnceLock::new();
    BUILTIN.get_or_init(|| {
        let mut all = Bundle::default();
        for text in standard::PACKAGES {
            all.types.extend(msg::bundle("", text).types);
        }
        all.types.remove("");
        all
    })
}

/// The definition files of a folder, sorted. Symbolic links to folders are not followed: they may form a cycle.
fn files(root: &Path) -> Result<Vec<PathBuf>, String> {
    let mut found = Vec::new();
    let mut entries = 0;
    let mut folders = vec![(root.to_path_buf(), 0)];
    while let Some((folder, depth)) = folders.pop() {
        // A folder that cannot be listed is skipped; the root was opened before.
        let Ok(listed) = fs::read_dir(&folder) else { continue };
        for entry in listed.flatten() {
            entries += 1;
            if entries > MAX_ENTRIES {
                return Err(format!("more than {MAX_ENTRIES} files; give a smaller folder"));
            }
            let path = entry.path();
            let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
            let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
            if is_folder && !is_hidden && depth < MAX_DEPTH {
                folders.push((path, depth + 1));
            } else if !is_folder && (has_ending(&path, "msg") || has_ending(&path, "idl")) {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|found| found == ending)
}

/// The package of a `.msg` file: the folder around `msg`, or around the file. If that folder has a `package.xml`, its
/// name is used: a checkout may have any name.
fn package_of(file: &Path) -> Option<String> {
    let parent = file.parent()?;
    let folder = if parent.file_name().is_some_and(|name| name == "msg") {
        parent.parent()?
    } else {
        parent
    };
    let named = text(&folder.join("package.xml")).ok().and_then(|manifest| {
        let manifest = roxmltree::Document::parse(&manifest).ok()?;
        let names = manifest
            .root_element()
            .children()
            .filter(|node| node.has_tag_name("name"));
        names
            .filter_map(|node| node.text())
            .map(str::trim)
            .next()
            .map(str::to_owned)
    });
    named.or_else(|| Some(folder.file_name()?.to_str()?.to_owned()))
}

fn text(file: &Path) -> Result<String, String> {
    let cannot = |error: std::io::Error| format!("cannot be read: {error}");
    let meta = fs::metadata(file).map_err(cannot)?;
    if !meta.is_file() || meta.len() > MAX_DEFINITION as u64 {
        return Err("cannot be read: it is not a file, or too large for a definition".to_owned());
    }
    fs::read_to_string(file).map_err(cannot)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::messages::definition::Schema;

    fn write(root: &Path, path: &str, text: &str) {
        let path = root.join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    fn fields(name: &str, definitions: &Definitions) -> Option<String> {
        let schema = Schema::link(name, None, definitions)?;
        let root = schema.root()?;
        let names: Vec<&str> = root.fields.iter().map(|field| field.name.as_str()).collect();
        Some(format!(
            "{} {}",
            names.join(","),
            root.fault.as_deref().unwrap_or_default()
        ))
    }

    #[test]
    fn every_way_a_package_lies_in_a_folder_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        write(root, "src/gps_driver/msg/Fix.msg", "std_msgs/Header header\nOther o\n");
        write(root, "flat_msgs/Other.msg", "int8 x\n");
        write(
            root,
            "checkout-of-imu/package.xml",
            "<package><name> imu_msgs </name></package>",
        );
        write(root, "checkout-of-imu/msg/Raw.msg", "int8 raw\n");
        write(
            root,
            "both/msg/Two.idl",
            "module both { module msg { struct Two { long idl; }; }; };",
        );
        write(root, "both/msg/Two.msg", "int32 text\n");
        write(
            root,
            "idl/msg/Only.idl",
            "module idl { module msg { struct Only { long a; }; }; };",
        );
        write(root, "sensor_msgs/msg/Imu.msg", "int8 mine\n");
        write(root, ".git/hidden/msg/A.msg", "int8 x\n");
        write(root, "broken/msg/A.msg", "int8 x\n\nint9\n");
        let mut definitions = Definitions::builtin();
        assert_eq!(definitions.add_folder(root), Ok(8));
        assert_eq!(fields("gps_driver/msg/Fix", &definitions).unwrap(), "header,o ");
        assert_eq!(fields("flat_msgs/Other", &definitions).unwrap(), "x ");
        assert_eq!(fields("imu_msgs/msg/Raw", &definitions).unwrap(), "raw ");
        assert_eq!(fields("both/Two", &definitions).unwrap(), "text ");
        assert_eq!(fields("idl/Only", &definitions).unwrap(), "a ");
        assert_eq!(fields("sensor_msgs/Imu", &definitions).unwrap(), "mine ");
        assert_eq!(fields("hidden/A", &definitions), None);
        let broken = fields("broken/A", &definitions).unwrap();
        assert!(broken.starts_with("x /"), "{broken}");
        assert!(
            broken.ends_with("broken/msg/A.msg, line 3: `int9` is not a field"),
            "{broken}"
        );

        // The package's own folder, and the folder of its messages.
        for inside in ["src/gps_driver", "src/gps_driver/msg"] {
            let mut definitions = Definitions::builtin();
            assert_eq!(definitions.add_folder(&root.join(inside)), Ok(1));
            assert!(definitions.adds("gps_driver/Fix"), "{inside}");
        }
    }

    #[test]
    fn a_folder_without_definitions_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mut definitions = Definitions::builtin();
        let refused = |definitions: &mut Definitions, path: &Path| definitions.add_folder(path).unwrap_err();
        assert!(refused(&mut definitions, folder.path()).contains("contains no message definition"));
        assert!(refused(&mut definitions, &folder.path().join("none")).contains("cannot be opened"));
        write(folder.path(), "A.msg", "int8 x\n");
        assert!(refused(&mut definitions, &folder.path().join("A.msg")).ends_with("is not a folder"));
    }
}
