//! What docs/paper.md, docs/motion-filter.md and docs/plane-in-space.md say of code and tests: every name in them is there.
use std::fs;
use std::path::{Path, PathBuf};

const DOCUMENTS: [&str; 3] = ["docs/paper.md", "docs/motion-filter.md", "docs/plane-in-space.md"];
/// Where paths without a crate are looked up.
const HOME: &str = "outline_filter";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The text of all sources in a folder, or of one.
fn sources(path: &Path) -> String {
    if path.is_file() {
        return read(path);
    }
    let entries = fs::read_dir(path).expect("a folder").map(|entry| entry.expect("an entry").path());
    let is_source =
        |path: &PathBuf| path.is_dir() && !path.ends_with("target") || path.extension().is_some_and(|e| e == "rs");
    entries.filter(is_source).map(|path| sources(&path)).collect()
}

/// What stands between backquotes.
fn quoted(document: &str) -> Vec<&str> {
    document.split('`').skip(1).step_by(2).collect()
}

fn is_word(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || c == '_')
}

/// A sentence of words joined by underscores, as names of tests are.
fn is_test(name: &str) -> bool {
    is_word(name) && name.matches('_').count() > 3
}

/// A path of modules and items, as `riccati::MotionModel::flow`.
fn is_code_path(name: &str) -> bool {
    name.contains("::") && name.split("::").all(is_word)
}

/// Whether a text declares an item, or a variant, field or method of one.
fn declares(text: &str, item: &str) -> bool {
    const KEYWORDS: [&str; 9] = ["fn", "struct", "enum", "const", "static", "type", "trait", "mod", "impl"];
    let is_declared_by = |line: &str| {
        let words: Vec<&str> =
            line.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect();
        let by_keyword = words.iter().position(|word| KEYWORDS.contains(word)).is_some_and(|at| {
            let of_impl = words[at] == "impl" && words[at..].contains(&item);
            of_impl || words.iter().position(|word| *word == item).is_some_and(|found| found > at)
        });
        let visible = line.trim_start().trim_start_matches("pub ");
        let bare =
            visible.split_once(") ").filter(|(pub_in, _)| pub_in.starts_with("pub(")).map_or(visible, |(_, rest)| rest);
        let is_entry = bare
            .strip_prefix(item)
            .is_some_and(|rest| matches!(rest.chars().next(), None | Some(',' | ':' | '(' | ' ')));
        by_keyword || is_entry
    };
    text.lines().filter(|line| !line.trim_start().starts_with("//")).any(is_declared_by)
}

/// What of a path is not there.
fn missing(path: &str) -> Option<String> {
    let mut parts = path.split("::").peekable();
    let of_crate = |name: &str| root().join("crates").join(name.replace('_', "-")).join("src");
    let mut place = match parts.peek().map(|name| of_crate(name)).filter(|folder| folder.is_dir()) {
        Some(folder) => {
            parts.next();
            folder
        }
        None => of_crate(HOME),
    };
    while let Some(module) = parts.peek() {
        let (folder, file) = (place.join(module), place.join(format!("{module}.rs")));
        let Some(next) = [file, folder].into_iter().find(|next| next.exists()) else { break };
        place = next;
        parts.next();
    }
    let text = sources(&place);
    parts.find(|item| !declares(&text, item)).map(|item| format!("{item} of {path} in {}", place.display()))
}

fn names(of: fn(&str) -> bool) -> Vec<String> {
    let documents = DOCUMENTS.map(|document| read(&root().join(document)));
    let lists = documents.iter().map(|text| quoted(text).into_iter().filter(|name| of(name)).map(str::to_owned));
    let lists: Vec<Vec<String>> = lists.map(Iterator::collect).collect();
    for (list, document) in lists.iter().zip(DOCUMENTS) {
        assert!(list.len() > 15, "{document}: {list:?}");
    }
    lists.concat()
}

#[test]
fn every_test_that_the_documents_name_exists() {
    let code: String = ["crates", "tests", "src"].iter().map(|folder| sources(&root().join(folder))).collect();
    let missing: Vec<_> = names(is_test).into_iter().filter(|name| !code.contains(&format!("fn {name}("))).collect();
    assert!(missing.is_empty(), "no tests {missing:#?}");
}

#[test]
fn every_code_path_that_the_documents_name_exists() {
    let missing: Vec<_> = names(is_code_path).iter().filter_map(|path| missing(path)).collect();
    assert!(missing.is_empty(), "no {missing:#?}");
}

#[test]
fn a_code_path_that_is_not_there_is_noticed() {
    for path in
        ["belief::state::Belief", "belief::Belief::pose", "riccati::MotionModel::flow", "update::gate::Gate::verdict"]
    {
        assert_eq!(missing(path), None);
    }
    for path in
        ["belief::arrowhead::Belief::nothing", "nowhere::Belief", "riccati::Motion::flow", "update::gate::Gates"]
    {
        assert!(missing(path).is_some(), "{path}");
    }
}

/// Numbers of equations in a cell of a table, `(3)`, `(3), (4)` or `(3) to (6)`.
fn numbers(cell: &str) -> Vec<usize> {
    let mut found: Vec<usize> = Vec::new();
    for part in cell.split('(').skip(1) {
        let Some((number, rest)) = part.split_once(')') else { continue };
        let Ok(number) = number.parse() else { continue };
        found.push(number);
        // The next one ends a range.
        if rest.trim() == "to" {
            let last = cell.rsplit_once('(').and_then(|(_, last)| last.trim().trim_end_matches(')').parse().ok());
            found.extend(number + 1..last.unwrap_or(number));
        }
    }
    found
}

#[test]
fn every_equation_of_the_derivation_is_numbered_in_order_and_leads_to_code_and_test() {
    let document = read(&root().join("docs/motion-filter.md"));
    let number = |line: &str| line.strip_prefix("    ")?.trim_end().rsplit_once('(')?.1.strip_suffix(')')?.parse().ok();
    let equations: Vec<usize> = document.lines().filter_map(number).collect();
    assert!(equations.len() > 50, "{}", equations.len());
    assert!(equations.iter().copied().eq(1..=equations.len()), "{equations:?}");
    let leads = |cell: &str, of: fn(&str) -> bool| cell.contains("the same") || quoted(cell).into_iter().any(of);
    let mut led = Vec::new();
    for row in document.lines().filter(|line| line.starts_with("| (")) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').collect();
        assert!(cells.len() == 3 && leads(cells[1], is_code_path) && leads(cells[2], is_test), "{row}");
        led.extend(numbers(cells[0]));
    }
    let lost: Vec<_> = equations.iter().filter(|number| !led.contains(number)).collect();
    assert!(lost.is_empty(), "no row for {lost:?}");
}
