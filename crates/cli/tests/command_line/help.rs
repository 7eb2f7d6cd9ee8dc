use crate::support::{freeform, json, run, sequence, stderr, stdout, succeed};

#[test]
fn every_command_has_a_help_with_examples() {
    for command in ["demo", "simulate", "fit", "identify", "track", "outline", "recognise", "evaluate", "reproduce"] {
        let help = succeed(&format!("{command} --help"), "");
        assert!(help.contains(&format!("  freeform {command}")), "{help}");
        assert!(help.contains("Example"), "{help}");
    }
}

#[test]
fn patterns_of_pictures_that_follow_each_other_stand_in_quotes_so_that_no_shell_sorts_them() {
    let helps = ["--help", "identify --help", "track --help", "outline --help"].map(|wanted| succeed(wanted, ""));
    let examples: Vec<&str> =
        helps.iter().flat_map(|help| help.lines()).filter(|line| line.starts_with("  freeform ")).collect();
    let patterns: Vec<&str> =
        examples.iter().flat_map(|line| line.split(' ')).filter(|word| word.contains('*')).collect();
    assert!(patterns.len() > 2, "{examples:#?}");
    assert!(patterns.iter().all(|word| word.starts_with('\'') && word.ends_with('\'')), "{patterns:?}");
}

#[test]
fn the_help_reads_as_it_should() {
    insta::assert_snapshot!("help", succeed("--help", ""));
    insta::assert_snapshot!("help_evaluate", succeed("evaluate --help", ""));
    insta::assert_snapshot!("help_identify", succeed("identify --help", ""));
    insta::assert_snapshot!("help_simulate", succeed("simulate --help", ""));
    insta::assert_snapshot!("help_reproduce", succeed("reproduce --help", ""));
}

#[test]
fn a_mistyped_option_is_told_on_one_line_with_the_one_that_may_be_meant() {
    let output = run("identify outlines.csv --fps25", "");
    let expected = "freeform: unexpected argument '--fps25' found; tip: a similar argument exists: '--fps'\n";
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(2), expected));
}

#[test]
fn an_option_of_another_command_is_told_with_that_command() {
    let output = run("track outlines.csv --trajectory poses.csv", "");
    let expected = "freeform: unexpected argument '--trajectory' found; tip: it is an option of freeform identify\n";
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(2), expected));
}

#[test]
fn the_version_is_that_of_the_package() {
    assert_eq!(succeed("--version", ""), format!("freeform {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn no_command_at_all_is_wrong_usage() {
    let output = run("", "");
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(stdout(&output), "");
    assert!(stderr(&output).contains("Usage"));
}

#[test]
fn nothing_is_coloured_where_colour_is_not_wanted() {
    // As on a terminal, which the output of a test is not.
    let coloured = || {
        let mut command = freeform("--help");
        command.env("CLICOLOR_FORCE", "1");
        command
    };
    let is_coloured = |output| stdout(&output).contains('\u{1b}');
    assert!(is_coloured(coloured().env_remove("NO_COLOR").output().expect("the binary runs")));
    assert!(!is_coloured(coloured().env("NO_COLOR", "1").output().expect("the binary runs")));
}

#[test]
fn there_are_completions_for_the_shells() {
    for shell in ["bash", "zsh", "fish"] {
        assert!(succeed(&format!("completions {shell}"), "").contains("identify"), "{shell}");
    }
}

#[test]
fn the_manual_page_has_every_command() {
    let page = succeed("man", "");
    assert!(page.starts_with(".ie") || page.contains(".TH freeform"), "{page}");
    for command in ["DEMO", "SIMULATE", "FIT", "IDENTIFY", "TRACK", "OUTLINE"] {
        assert!(page.contains(&format!(".SH \"FREEFORM {command}\"")), "{command}");
    }
}

#[test]
fn the_table_fits_a_terminal_of_80_columns() {
    let csv = crate::support::sequence("--omega -1.2345678 --b -123.45678,0.00012345");
    let table = succeed("identify - --quiet --motion affine", &csv);
    assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
}

#[test]
fn the_help_of_track_names_every_field_of_its_lines() {
    let help = succeed("track --help", "");
    let listed = help.split("with the fields").nth(1).and_then(|rest| rest.split("The phases").next()).expect("a list");
    let line = json(succeed("track -", &sequence("")).lines().last().expect("a line"));
    for field in line.as_object().expect("an object").keys() {
        assert!(listed.contains(field.as_str()), "{field}");
    }
}
