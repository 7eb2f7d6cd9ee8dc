//! What docs/paper.md, docs/motion-filter.md and docs/plane-in-space.md say of code and tests: every name in them is there. The layers that the
//! motion filter says it has.
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const DOCUMENTS: [&str; 3] = ["docs/paper.md", "docs/motion-filter.md", "docs/plane-in-space.md"];
/// Where paths without a crate are looked up.
const HOME: &str = "outline_filter";
/// The crate of the workspace's root.
const FACADE: &str = "freeform_motion";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All sources in a folder, or the one that it is.
fn files(path: &Path) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_owned()];
    }
    let entries = fs::read_dir(path).expect("a folder").map(|entry| entry.expect("an entry").path());
    let is_source =
        |path: &PathBuf| path.is_dir() && !path.ends_with("target") || path.extension().is_some_and(|e| e == "rs");
    entries.filter(is_source).flat_map(|path| files(&path)).collect()
}

/// The text of all sources in a folder, or of one.
fn sources(path: &Path) -> String {
    files(path).iter().map(|file| read(file)).collect()
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
    let of_crate = |name: &str| match name {
        FACADE => root().join("src"),
        _ => root().join("crates").join(name.replace('_', "-")).join("src"),
    };
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
    for path in [
        "belief::state::Belief",
        "belief::Belief::pose",
        "riccati::MotionModel::flow",
        "update::gate::Gate::verdict",
        "freeform_motion::tracker::continuous_angle::ContinuousAngle",
    ] {
        assert_eq!(missing(path), None);
    }
    for path in [
        "belief::arrowhead::Belief::nothing",
        "nowhere::Belief",
        "riccati::Motion::flow",
        "update::gate::Gates",
        "freeform_motion::tracker::continuous_angle::Gate",
    ] {
        assert!(missing(path).is_some(), "{path}");
    }
}

/// Numbers of equations in a cell of a table, `(3)`, `(31a), (4)` or `(3) to (6)`.
fn numbers(cell: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for part in cell.split('(').skip(1) {
        let Some((number, rest)) = part.split_once(')').filter(|(number, _)| is_number(number)) else { continue };
        found.push(number.to_owned());
        // The next one ends a range.
        if let ("to", Ok(first)) = (rest.trim(), number.parse::<usize>()) {
            let last = cell.rsplit_once('(').and_then(|(_, last)| last.trim().trim_end_matches(')').parse().ok());
            found.extend((first + 1..last.unwrap_or(first)).map(|between| between.to_string()));
        }
    }
    found
}

/// Whether it is a number of an equation: digits, with a letter behind them where it was added between two others.
fn is_number(text: &str) -> bool {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_lowercase());
    text.len() <= digits.len() + 1 && !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit())
}

/// The number of the equation on a line of a document, if there is one.
fn number_on(line: &str) -> Option<&str> {
    let number = line.strip_prefix("    ")?.trim_end().rsplit_once('(')?.1.strip_suffix(')')?;
    is_number(number).then_some(number)
}

#[test]
fn every_equation_of_the_derivation_is_numbered_in_order_and_leads_to_code_and_test() {
    let document = read(&root().join("docs/motion-filter.md"));
    let equations: Vec<&str> = document.lines().filter_map(number_on).collect();
    let plain: Vec<usize> = equations.iter().filter_map(|number| number.parse().ok()).collect();
    assert!(plain.len() > 50 && equations.len() > plain.len(), "{equations:?}");
    assert!(plain.iter().copied().eq(1..=plain.len()), "{plain:?}");
    let mut once = BTreeSet::new();
    let twice: Vec<_> = equations.iter().filter(|number| !once.insert(**number)).collect();
    assert!(twice.is_empty(), "defined twice: {twice:?}");
    let leads = |cell: &str, of: fn(&str) -> bool| cell.contains("the same") || quoted(cell).into_iter().any(of);
    let mut led = BTreeSet::new();
    for row in document.lines().filter(|line| line.starts_with("| (")) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').collect();
        assert!(cells.len() == 3 && leads(cells[1], is_code_path) && leads(cells[2], is_test), "{row}");
        led.extend(numbers(cells[0]));
    }
    let lost: Vec<_> = equations.iter().filter(|number| !led.contains(**number)).collect();
    assert!(lost.is_empty(), "no row for {lost:?}");
}

/// The layers of the motion filter, from top to bottom, as the table at the head of its crate says.
fn layers() -> Vec<String> {
    let head = read(&root().join("crates/outline-filter/src/lib.rs"));
    let named = head.lines().filter_map(|line| line.strip_prefix("//! | `")?.split_once('`'));
    named.map(|(layer, _)| layer.to_owned()).collect()
}

/// The modules of its own crate that a source names behind `crate::`, one by one or in braces; without its comments and its tests.
fn modules_used(source: &str) -> BTreeSet<String> {
    let code = source.split("\nmod tests {").next().unwrap_or(source);
    let code: String = code.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let mut used = BTreeSet::new();
    for after in code.split("crate::").skip(1) {
        let Some(group) = after.strip_prefix('{') else {
            used.insert(first_word(after));
            continue;
        };
        let (mut begins, mut depth) = (true, 1);
        for (at, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 1 => begins = true,
                _ if begins && !c.is_whitespace() => {
                    used.insert(first_word(&group[at..]));
                    begins = false;
                }
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
    }
    used
}

fn first_word(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

#[test]
fn modules_are_found_behind_the_crate_one_by_one_and_in_braces() {
    let source = "use crate::{\n  a::{B, c::D},\n  e::F,\n};\nuse crate::g;\n// crate::h\nmod tests {\nuse crate::i;";
    assert_eq!(modules_used(source).into_iter().collect::<Vec<_>>(), ["a", "e", "g"]);
}

#[test]
fn every_layer_of_the_motion_filter_uses_only_the_layers_below_it() {
    let layers = layers();
    assert!(layers.len() > 10, "{layers:?}");
    let mut wrong = Vec::new();
    for (height, layer) in layers.iter().enumerate() {
        let files = files(&root().join("crates/outline-filter/src").join(layer));
        assert!(!files.is_empty(), "{layer}");
        for file in files.iter().filter(|file| !file.to_string_lossy().ends_with("_tests.rs")) {
            let used = modules_used(&read(file));
            wrong.extend(
                layers[..height].iter().filter(|above| used.contains(*above)).map(|a| (file.clone(), a.clone())),
            );
        }
    }
    assert!(wrong.is_empty(), "layers above: {wrong:#?}");
}
