//! Names that would do something where they are shown.
use std::fs;

use crate::support::{file, run, sequence, stderr, stdout, succeed};

/// Colours, a title, a line break and a change of direction.
const NAME: &str = "a\u{1b}[31m\u{7}\u{202e}b\u{2028}c";

fn named(name: &str) -> String {
    let rows: String =
        sequence("").lines().skip(3).map(|line| format!("{line},\"{}\"\n", name.replace('"', "\"\""))).collect();
    format!("frame,time,x,y,object\n{rows}999,99,1,1,\"{name}\"\n")
}

fn is_plain(text: &str) -> bool {
    text.chars().all(|c| c == '\n' || !(c.is_control() || matches!(c, '\u{2028}'..='\u{202e}')))
}

#[test]
fn nothing_in_a_name_reaches_the_terminal_that_it_would_act_upon() {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = file(folder.path(), "o.csv", named(NAME));
    for command in ["identify", "fit", "identify --format json", "track", "recognise --known nowhere.csv"] {
        let output = run(&format!("{command} {csv}"), "");
        assert!(is_plain(&stderr(&output)), "{command}: {:?}", stderr(&output));
        let is_for_people = !command.contains("json") && command != "track";
        assert!(!is_for_people || is_plain(&stdout(&output)), "{command}: {:?}", stdout(&output));
    }
    assert!(stdout(&run(&format!("identify {csv}"), "")).contains(r"object a\u{1b}[31m\u{7}\u{202e}b\u{2028}c: rigid"));
    // The same in the name of a file that is not there.
    let mut command = crate::support::freeform("identify");
    let output = command.arg(format!("{NAME}\nfreeform: all is well")).output().expect("the binary runs");
    assert!(is_plain(&stderr(&output)) && stderr(&output).lines().count() == 1, "{:?}", stderr(&output));
}

#[test]
fn a_page_and_a_figure_show_a_name_and_stay_well_formed() {
    let folder = tempfile::tempdir().expect("a folder");
    let (svg, report) = (folder.path().join("p.svg"), folder.path().join("r.html"));
    let two = named(&format!("{NAME}\u{0}\u{fffe}<b>")) + &named("other")[22..];
    succeed(&format!("identify - --svg {} --report {}", svg.display(), report.display()), &two);
    for path in [svg, report] {
        let text = fs::read_to_string(path).expect("a file");
        assert!(is_plain(&text) && !text.contains(['\u{fffe}', '\0']));
        assert!(text.contains(r"\u{1b}[31m") && text.contains("&lt;b&gt;") && !text.contains("<b>"));
    }
}

#[test]
fn no_name_becomes_a_formula_in_tables_that_are_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let (trace, poses) = (folder.path().join("t.csv"), folder.path().join("p.csv"));
    for (name, cell) in [("=1+1", "'=1+1"), ("@SUM(A1)", "'@SUM(A1)"), ("+cmd", "'+cmd"), ("-1", "-1")] {
        let options = format!("--trace {} --trajectory {} --format csv", trace.display(), poses.display());
        let printed = succeed(&format!("identify - {options}"), &named(name));
        let files = [&trace, &poses].map(|path| fs::read_to_string(path).expect("a file"));
        for text in files.iter().chain(&[printed]) {
            assert!(text.lines().skip(1).all(|row| row.starts_with(&format!("{cell},"))), "{text}");
        }
    }
}

#[test]
fn the_command_in_the_head_of_a_file_stays_on_its_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let shape = file(folder.path(), "a\nb.csv", "x,y\n0,0\n2,0\n1,1\n");
    let mut command = crate::support::freeform("simulate --seconds 0.1 --shape");
    let csv = stdout(&command.arg(shape).output().expect("the binary runs"));
    assert!(csv.lines().next().is_some_and(|line| line.starts_with('#') && line.contains(r"a\nb.csv'")), "{csv}");
    assert!(csv.lines().nth(2).is_some_and(|line| line.starts_with("frame,")));
}
