//! Which xacro files are robots and which are parts: decided by their elements, without expanding anything.

/// Elements of xacro itself; any other `xacro:` element calls a macro.
const BUILT_IN: &[&str] = &[
    "macro",
    "property",
    "include",
    "arg",
    "if",
    "unless",
    "insert_block",
    "element",
    "attribute",
];

/// Names (without folders) of the files that a xacro text includes.
pub fn includes(text: &str) -> Vec<String> {
    let mut names = Vec::new();
    for part in text.split("xacro:include").skip(1) {
        let tag = part.split('>').next().unwrap_or_default();
        let Some((_, value)) = tag.split_once("filename") else {
            continue;
        };
        let value = value.trim_start().trim_start_matches('=').trim_start();
        let Some(quote) = value.chars().next().filter(|c| matches!(c, '"' | '\'')) else {
            continue;
        };
        let path = value.trim_start_matches(quote).split(quote).next().unwrap_or_default();
        let name = path.rsplit(['/', ')', '}']).next().unwrap_or_default();
        if !name.is_empty() {
            names.push(name.to_owned());
        }
    }
    names
}

/// Whether expanding would change anything: an element of xacro, a macro call or an expression. The namespace alone changes
/// nothing.
pub fn needs_expansion(text: &str) -> bool {
    ["<xacro:", "${", "$("].iter().any(|sign| text.contains(sign))
}

/// Whether a xacro text only defines things for others: macros and properties, no links, joints or calls of its own.
///
/// A text that cannot be parsed is not a library: the reader then reports what is wrong with it.
pub fn is_library(text: &str) -> bool {
    let Ok(document) = roxmltree::Document::parse(text) else {
        return false;
    };
    let elements = || document.root_element().children().filter(roxmltree::Node::is_element);
    let defines = elements().any(|element| element.tag_name().name() == "macro");
    defines && elements().all(is_definition)
}

fn is_definition(element: roxmltree::Node<'_, '_>) -> bool {
    let name = element.tag_name().name();
    let is_xacro = element
        .tag_name()
        .namespace()
        .is_some_and(|space| space.contains("xacro"));
    let conditional = matches!(name, "if" | "unless");
    is_xacro && BUILT_IN.contains(&name) && !conditional
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn included_files_are_named_without_their_folders() {
        let text = r#"<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
            <xacro:include filename="$(find car_description)/urdf/wheel.xacro" />
            <xacro:include filename='inertia.xacro'/>
            <xacro:include filename="${part}.xacro"/>
        </robot>"#;
        assert_eq!(includes(text), ["wheel.xacro", "inertia.xacro", ".xacro"]);
    }

    #[test]
    fn a_namespace_without_use_needs_no_expansion() {
        let robot = |body: &str| format!(r#"<robot xmlns:xacro="http://www.ros.org/wiki/xacro">{body}</robot>"#);
        assert!(!needs_expansion(&robot("<link name='base_link'/>")));
        assert!(needs_expansion(&robot("<xacro:wheel/>")));
        assert!(needs_expansion(&robot("<link name='${prefix}base_link'/>")));
        assert!(needs_expansion(&robot("<link name='$(arg prefix)base_link'/>")));
    }

    #[test]
    fn a_library_only_defines() {
        let robot = |body: &str| format!(r#"<robot xmlns:xacro="http://www.ros.org/wiki/xacro">{body}</robot>"#);
        assert!(is_library(&robot(
            "<xacro:property name='r' value='1'/><xacro:macro name='wheel'/>"
        )));
        assert!(!is_library(&robot("<xacro:macro name='wheel'/><xacro:wheel/>")));
        assert!(!is_library(&robot(
            "<xacro:macro name='wheel'/><link name='base_link'/>"
        )));
        assert!(!is_library(&robot("<link name='base_link'/>")));
        assert!(!is_library("<robot"));
    }
}
