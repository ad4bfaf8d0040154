use super::*;
use std::fs;

#[test]
fn a_folder_is_walked_in_order_and_gitignored_files_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::write(root.join(".gitignore"), "ignored.yaml\n").unwrap();
    fs::write(root.join("ignored.yaml"), "a: 1\n").unwrap();
    fs::write(root.join("b.yaml"), "a: 1\n").unwrap();
    fs::write(root.join("a.urdf"), "<robot name='a'/>").unwrap();
    fs::write(root.join("photo.png"), "x").unwrap();
    fs::write(root.join("tf.launch"), "<launch/>").unwrap();
    let inputs = discover(&[root.to_path_buf()]);
    let names: Vec<_> = inputs
        .files
        .iter()
        .map(|input| {
            (
                input.path.file_name().unwrap().to_str().unwrap().to_owned(),
                input.kind,
                input.required,
            )
        })
        .collect();
    assert_eq!(
        names,
        [
            ("a.urdf".to_owned(), SourceKind::Urdf, true),
            ("b.yaml".to_owned(), SourceKind::Yaml, true),
            ("tf.launch".to_owned(), SourceKind::Launch, true),
        ]
    );
    assert_eq!(inputs.skipped.get("png"), Some(&1));
}

#[test]
fn content_outranks_the_name() {
    let kind = |name: &str, head: &[u8]| recognise(Path::new(name), head);
    assert_eq!(kind("drive.bag", b"\x89MCAP0\r\n"), Some(SourceKind::Mcap));
    assert_eq!(kind("drive", b"#ROSBAG V2.0\n"), Some(SourceKind::Rosbag1));
    assert_eq!(kind("robot.urdf", b"<robot xmlns:xacro='x'>"), Some(SourceKind::Urdf));
    assert_eq!(
        kind("robot.urdf", b"<robot xmlns:xacro='x'><xacro:arm/>"),
        Some(SourceKind::Xacro)
    );
    assert_eq!(kind("model.xml", b"<robot name='x'>"), Some(SourceKind::Urdf));
    assert_eq!(kind("package.xml", b"<package>"), None);
    assert_eq!(kind("Robot.URDF", b"<robot name='x'>"), Some(SourceKind::Urdf));
}

#[test]
fn the_encoding_hides_no_content() {
    let text = "<launch>\n</launch>\n";
    let mut wide = vec![0xFF, 0xFE];
    wide.extend(text.encode_utf16().flat_map(u16::to_le_bytes));
    let marked = [b"\xEF\xBB\xBF".as_slice(), text.as_bytes()].concat();
    for head in [wide, marked] {
        assert_eq!(recognise(Path::new("a.xml"), &head), Some(SourceKind::Launch));
    }
    let matrix = [b"\xEF\xBB\xBF".as_slice(), b"1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"].concat();
    assert_eq!(recognise(Path::new("T_a_b.txt"), &matrix), Some(SourceKind::Text));
}

#[test]
fn a_path_that_does_not_exist_is_said() {
    let inputs = discover(&[PathBuf::from("no/such/robot.urdf")]);
    assert_eq!(inputs.files.len(), 1);
    assert!(inputs.files[0].refusal.as_deref().unwrap().contains("cannot be opened"));
}

#[cfg(unix)]
#[test]
fn names_that_are_no_utf_8_stay_apart() {
    use std::os::unix::ffi::OsStrExt;
    let shown = |bytes: &[u8]| display(Path::new(std::ffi::OsStr::from_bytes(bytes)));
    assert_eq!(shown(b"./car/\xffa.urdf"), "car/\\xffa.urdf");
    assert_ne!(shown(b"\xfe.urdf"), shown(b"\xff.urdf"));
    assert_eq!(shown(b"\\xff.urdf"), "\\\\xff.urdf");
    assert_eq!(shown("./fährt.urdf".as_bytes()), "fährt.urdf");
}
