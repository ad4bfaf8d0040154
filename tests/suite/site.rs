//! The documentation site that `docs/build` made: every link leads somewhere, every rule has its page, and a real browser shows it without a
//! network, on a desk and on a phone.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use frames_lint::page::url;
use frames_lint::rules::RULES;
use serde_json::{Value, json};

use crate::support::at_hand::left_out;
use crate::support::browser::Browser;
use crate::support::files;
use crate::support::page::Page;

/// The folder of the site, where it was built.
#[track_caller]
fn site() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/docs/book");
    if folder.join("index.html").is_file() {
        return Some(folder);
    }
    left_out("the documentation site was not built (`docs/build`)");
    None
}

/// Pages by their paths.
fn pages(site: &Path) -> BTreeMap<PathBuf, Page> {
    let page = |path: PathBuf| {
        let page = Page::parse(&fs::read_to_string(&path).unwrap());
        (path, page)
    };
    files(&site.canonicalize().unwrap(), ".html")
        .into_iter()
        .map(page)
        .collect()
}

#[test]
fn no_link_is_dead_and_nothing_is_loaded_from_elsewhere() {
    let Some(site) = site() else { return };
    let pages = pages(&site);
    let anchors: BTreeMap<&Path, BTreeSet<String>> = pages
        .iter()
        .map(|(path, page)| (path.as_path(), page.attributes("[id]", "id").into_iter().collect()))
        .collect();
    let mut dead = Vec::new();
    // The page of all pages has the anchors of all; the page for what is not found stands anywhere.
    let whole = |path: &Path| path.ends_with("print.html") || path.ends_with("404.html") || path.ends_with("toc.html");
    for (path, page) in pages.iter().filter(|(path, _)| !whole(path)) {
        let mut report = |what: String| dead.push(format!("{}: {what}", path.display()));
        // A path of the page as the file system has it.
        let there = |link: &str| path.with_file_name("").join(link).canonicalize().ok();
        for loaded in ["img", "script", "iframe"]
            .map(|tag| page.attributes(tag, "src"))
            .concat()
        {
            if loaded.contains("//") || !there(&loaded).is_some_and(|file| file.is_file()) {
                report(format!("loads {loaded}"));
            }
        }
        for style in page.attributes("link", "href") {
            if style.contains("//") {
                report(format!("loads {style}"));
            }
        }
        for link in page.attributes("a[href]", "href") {
            if link.starts_with("https://") {
                continue;
            }
            let (to, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if to.is_empty() { Some(path.clone()) } else { there(to) };
            let is_there = target.is_some_and(|target| match anchors.get(target.as_path()) {
                Some(ids) => anchor.is_empty() || ids.contains(anchor),
                None => target.is_file(),
            });
            if !is_there {
                report(link.clone());
            }
        }
    }
    assert!(dead.is_empty(), "{}", dead.join("\n"));
    assert!(pages.len() > RULES.len() + 20, "{}", pages.len());
}

#[test]
fn every_rule_has_a_page_where_its_url_leads() {
    let Some(site) = site() else { return };
    for page in RULES.iter().map(|entry| entry.page) {
        let below = url(page.code);
        let below = below
            .strip_prefix("https://frames-lint.github.io/frames-lint/")
            .unwrap();
        let text = fs::read_to_string(site.join(below)).unwrap();
        assert!(text.contains(page.name) && text.contains("How to fix"), "{}", page.code);
    }
}

/// Pictures without a size.
const EMPTY: &str = "[...document.images].filter(i => !(i.complete && i.naturalWidth > 0)).map(i => i.src)";
/// Whether the page itself scrolls to the side.
const SCROLLS: &str = "document.documentElement.scrollWidth > innerWidth + 1";
/// Titles that the search finds.
const SEARCH: &str = "(async () => {
  document.getElementById('mdbook-search-toggle').click();
  const bar = document.getElementById('mdbook-searchbar');
  for (let tries = 0; tries < 100; tries++) {
    bar.value = 'quaternion jpl';
    bar.dispatchEvent(new Event('input', {bubbles: true}));
    bar.dispatchEvent(new KeyboardEvent('keyup', {key: 'l', bubbles: true}));
    await new Promise(done => setTimeout(done, 100));
    const found = [...document.querySelectorAll('#mdbook-searchresults li a')].map(a => a.textContent);
    if (found.length) return found;
  }
  return [];
})()";

#[test]
fn a_real_browser_shows_the_site_and_its_search_finds_rules() {
    let Some(site) = site() else { return };
    let Some(mut browser) = Browser::start() else { return };
    let names = [
        "index.html",
        "first-check.html",
        "conventions/rotations.html",
        "conventions/world.html",
        "configuration.html",
        "rules.html",
        "rules/cross02.html",
    ];
    for name in names {
        let mut page = browser.open(&site.join(name));
        // Files of the site are loaded, and pictures in its style; everything else is a complaint.
        let is_other = |event: &String| {
            let event: Value = serde_json::from_str(event).unwrap();
            let url = event["params"]["request"]["url"].as_str().unwrap_or("http:");
            event["method"] != "Network.requestWillBeSent" || url.starts_with("http")
        };
        let complaints: Vec<String> = page.complaints().into_iter().filter(is_other).collect();
        assert_eq!(complaints, Vec::<String>::new(), "{name}");
        for width in [390, 1280] {
            page.width(width);
            assert_eq!(page.eval(SCROLLS), json!(false), "{name} at {width}");
        }
        assert_eq!(page.eval(EMPTY), json!([]), "{name}");
        assert!(
            page.eval("document.querySelector('main').innerText.length").as_i64() > Some(300),
            "{name}"
        );
    }
    let found = browser.open(&site.join("index.html")).eval(SEARCH);
    let titles: Vec<&str> = found.as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(
        titles.iter().any(|title| title.contains("jpl-provenance")),
        "{titles:?}"
    );
}
