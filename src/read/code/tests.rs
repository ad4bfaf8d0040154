//! What is a product of transforms in code, and what is none.

use super::*;
use crate::source::{SourceId, SourceKind};

/// Each chain as `result = factor * factor`, frames as `target<-source`.
fn chains(path: &str, text: &str) -> Vec<String> {
    let mut source = Source::new(SourceId(0), path, SourceKind::Code);
    source.text = text.to_owned();
    let facts = read(&mut source);
    let shown = |(name, at): &(TransformName, Span)| {
        format!("{}<-{}[{}]", name.target, name.source, &source.text[at.start..at.end])
    };
    let of = |chain: &DeclaredChain| {
        let factors: Vec<String> = chain.factors.iter().map(shown).collect();
        let result = chain.result.as_ref().map_or("-".to_owned(), shown);
        format!("{result} = {}", factors.join(" * "))
    };
    facts.chains.iter().map(of).collect()
}

#[test]
fn products_and_their_results_are_found_in_three_languages() {
    let expected = ["map<-base[map_T_base] = map<-odom[map_T_odom] * odom<-base[odom_T_base]"];
    assert_eq!(
        chains(
            "a.cpp",
            "void f() { const Eigen::Isometry3d map_T_base = map_T_odom * odom_T_base; }"
        ),
        expected
    );
    assert_eq!(chains("a.py", "map_T_base = map_T_odom @ odom_T_base\n"), expected);
    assert_eq!(
        chains("a.rs", "fn f() { let map_T_base = map_T_odom * odom_T_base; }"),
        expected
    );
    assert_eq!(
        chains(
            "a.rs",
            "fn f() { let map_from_base = &map_from_odom * &odom_from_base; }"
        ),
        ["map<-base[map_from_base] = map<-odom[map_from_odom] * odom<-base[odom_from_base]"]
    );
}

#[test]
fn members_pointers_calls_and_indices_are_looked_through() {
    assert_eq!(
        chains(
            "a.hpp",
            "void f() { state_.T_WS = (*T_WC_[i]) * extrinsics->T_SC(c).inverse(); this->T_w_c_ = Sophus::SE3d(T_w_b_k.matrix().cast<double>() * m_T_b_c); }"
        ),
        [
            "W<-S[T_WS] = W<-C[T_WC_] * C<-S[extrinsics->T_SC(c).inverse()]",
            "w<-c[T_w_c_] = w<-b[T_w_b_k] * b<-c[m_T_b_c]",
        ]
    );
    assert_eq!(
        chains(
            "a.py",
            "x = f(np.dot(self.T_a_b, np.linalg.inv(T_c_b)))\nR_a_c = T_a_b[:3, :3] @ R_c_b.T\n"
        ),
        [
            "- = a<-b[self.T_a_b] * b<-c[np.linalg.inv(T_c_b)]",
            "a<-c[R_a_c] = a<-b[T_a_b] * b<-c[R_c_b.T]",
        ]
    );
    assert_eq!(
        chains("a.cpp", "auto aTc = aTb.compose(bTc); auto bTc2 = aTb.between(aTc);"),
        [
            "a<-c[aTc] = a<-b[aTb] * b<-c[bTc]",
            "b<-c2[bTc2] = b<-a[aTb] * a<-c[aTc]",
        ]
    );
}

#[test]
fn inverses_of_products_turn_them_round() {
    assert_eq!(
        chains("a.py", "T_c_a = (T_a_b @ T_b_c).inverse()\n"),
        ["c<-a[T_c_a] = c<-b[T_b_c] * b<-a[T_a_b]"]
    );
    assert_eq!(
        chains(
            "a.cpp",
            "auto T_b_a = T_a_b.inverse(); auto T_x = T_a_b.inverse(); x = T_a_b_inv * T_a_c;"
        ),
        [
            "b<-a[T_b_a] = b<-a[T_a_b.inverse()]",
            "- = b<-a[T_a_b_inv] * a<-c[T_a_c]"
        ]
    );
}

#[test]
fn points_and_numbers_end_a_product() {
    assert_eq!(
        chains(
            "a.cpp",
            "p_a = T_a_b * T_b_c * p_c; x = 2 * width * height; y = T_a_b(0, 3) * T_b_c(1, 3); T_a_b *= T_b_c;"
        ),
        ["- = a<-b[T_a_b] * b<-c[T_b_c]"]
    );
    assert_eq!(
        chains("a.py", "t_a_c = R_a_b @ t_b_c + t_a_b\nx = T_a_b[0, 3] * T_b_c[1, 3]\n"),
        Vec::<String>::new()
    );
}

#[test]
fn copies_and_names_with_to_say_nothing() {
    assert_eq!(
        chains(
            "a.py",
            "T_a_b = T_c_d\nT_WS_init = T_WS\ncam_to_map = odom_to_map @ cam_to_odom\n"
        ),
        Vec::<String>::new()
    );
    assert_eq!(chains("a.py", "T_a_b = T_b_a\n"), ["a<-b[T_a_b] = b<-a[T_b_a]"]);
}

#[test]
fn broken_code_and_deep_code_are_read_as_far_as_they_go() {
    assert_eq!(chains("a.cpp", "} ) void ((( x = T_a_b * T_b_c; \u{0}").len(), 1);
    let deep = format!("x = {}T_a_b @ T_b_c{}\n", "(".repeat(5000), ")".repeat(5000));
    let _ = chains("a.py", &deep);
    let long = format!("x = T_a_b{}\n", " @ T_a_b".repeat(5000));
    let _ = chains("a.py", &long);
}

/// Found by the fuzzer: the Rust grammar follows the ways in which this may go on without an end.
#[test]
fn a_text_whose_parse_has_no_end_is_given_up_with_its_place() {
    let text = "vo= S1ophus::SE3T_base_[->T_wc_ _= Sophus::\u{d3}E3d(T_w_b.matrix(\t.cast<double>()ase = map_); }\n";
    let mut source = Source::new(SourceId(0), "a.rs", SourceKind::Code);
    source.text = text.to_owned();
    let facts = read(&mut source);
    assert!(facts.chains.is_empty());
    assert_eq!(source.status, ReadStatus::Unreadable);
    let problem = &source.problems[0];
    assert!(
        problem.message.contains("too many syntax errors"),
        "{}",
        problem.message
    );
    assert!(
        problem
            .place
            .span()
            .is_some_and(|span| span.start > 0 && span.end <= text.len())
    );
}
