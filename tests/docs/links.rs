//! Relative links and anchors.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::page::{Page, read, root};

/// Targets of `[text](target)` in the prose of a page; code spans are not links.
fn targets(page: &Page) -> Vec<String> {
    let mut found = Vec::new();
    for line in page.prose() {
        let visible: String = line.split('`').step_by(2).collect::<Vec<_>>().join("x");
        for rest in visible.split("](").skip(1) {
            found.extend(rest.split_once(')').map(|(target, _)| target.to_owned()));
        }
    }
    found
}

/// The anchor of a heading as GitHub and mdBook make it.
fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    heading.trim().to_lowercase().chars().filter(kept).map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn anchors(text: &str, path: &Path) -> Vec<String> {
    let page = Page { path: path.to_owned(), text: text.to_owned() };
    let headings = page.prose().into_iter().filter(|line| line.starts_with('#')).map(str::to_owned).collect::<Vec<_>>();
    headings.iter().map(|line| anchor(line.trim_start_matches('#'))).collect()
}

/// `a/b/../c` as `a/c`.
fn plain(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut plain, part| {
        if part.as_os_str() == ".." {
            plain.pop();
        } else {
            plain.push(part);
        }
        plain
    })
}

/// Links of a page that lead nowhere, one a line.
pub fn broken(page: &Page) -> String {
    let mut wrong = String::new();
    for target in targets(page) {
        if target.starts_with("http") {
            continue;
        }
        let (file, anchor) =
            target.split_once('#').map_or((target.as_str(), None), |(file, anchor)| (file, Some(anchor)));
        let path = match file {
            "" => page.path.clone(),
            _ => plain(&page.path.parent().unwrap_or(Path::new("")).join(file)),
        };
        let exists = root().join(&path).exists();
        let known = anchor.is_none_or(|a| exists && anchors(&read(&path), &path).iter().any(|known| known == a));
        if !exists || !known {
            let _ = writeln!(wrong, "{}: {target}", page.path.display());
        }
    }
    wrong
}

/// Pages that docs/SUMMARY.md does not list.
pub fn unlisted(pages: &[Page]) -> Vec<String> {
    let summary = pages.iter().find(|page| page.path == Path::new("docs/SUMMARY.md")).expect("the table of contents");
    let listed: Vec<PathBuf> = targets(summary).iter().map(|target| plain(&Path::new("docs").join(target))).collect();
    let missing =
        |page: &&Page| page.path.starts_with("docs") && page.path != summary.path && !listed.contains(&page.path);
    pages.iter().filter(missing).map(|page| page.path.display().to_string()).collect()
}
