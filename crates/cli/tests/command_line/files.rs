use std::fs;

use crate::support::{closing_its_pipe, file, freeform, run, sequence, stderr, stdout, succeed};

#[test]
fn the_trace_has_one_row_per_frame_with_the_columns_of_the_contract() {
    let folder = tempfile::tempdir().expect("a folder");
    let trace = folder.path().join("trace.csv");
    succeed(&format!("identify - --trace {}", trace.display()), &(sequence("") + "20,5.0,1,1\n"));
    let text = fs::read_to_string(trace).expect("the trace");
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let header = "object,frame,time,phase,accepted,omega,omega_std,b1,b1_std,b2,b2_std,v1,v1_std,v2,v2_std,reason,unstated,\
                  point_x,point_y";
    assert_eq!(rows[0], header.split(',').collect::<Vec<_>>());
    assert_eq!(rows.len(), 1 + 16);
    assert!(rows[..16].iter().all(|row| row.len() == rows[0].len()));
    assert_eq!(rows[1][..5], ["0", "0", "0", "acquiring", "true"]);
    assert_eq!(rows[15][3..5], ["tracking", "true"]);
    assert!(rows[15][5..15].iter().all(|number| number.parse::<f64>().is_ok_and(f64::is_finite)));
    assert_eq!(rows[15][15..17], ["", ""]);
    assert!(rows[15][17..].iter().all(|number| number.parse::<f64>().is_ok_and(f64::is_finite)));
    // The reason has commas of its own.
    assert_eq!(rows[16][..15], [&["0", "20", "", "", "false"][..], &[""; 10]].concat());
    let all = "omega unknown; b1 unknown; b2 unknown; v1 unknown; v2 unknown";
    assert!(rows[16][15].contains("frame 20") && rows[16].ends_with(&[all, "", ""]), "{:?}", rows[16]);
}

#[test]
fn the_trace_of_the_adaptive_method_leaves_standard_deviations_empty() {
    let folder = tempfile::tempdir().expect("a folder");
    let trace = folder.path().join("trace.csv");
    succeed(&format!("identify - --method adaptive --trace {}", trace.display()), &sequence(""));
    let text = fs::read_to_string(trace).expect("the trace");
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!((rows[1][3], rows[15][3]), ("start", "adapt"));
    assert!(rows[15][5].parse::<f64>().is_ok_and(f64::is_finite) && rows[15][6].is_empty());
}

#[test]
fn figures_and_report_hold_what_they_should_and_nothing_from_elsewhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (svg, report) = (path("p.svg"), path("r.html"));
    succeed(&format!("identify - --svg {svg} --report {report} --scale 0.1"), &sequence(""));
    let svg = fs::read_to_string(svg).expect("the figure");
    for text in ["omega (rad/s)", "time (s)", "true value", "identified", "95 % band"] {
        assert!(svg.contains(text), "{text}");
    }
    let report = fs::read_to_string(report).expect("the report");
    for text in ["<table>", "<svg", "--scale 0.1", "omega (rad/s)", "Camera scale", "prefers-color-scheme", "viewport"]
    {
        assert!(report.contains(text), "{text}");
    }
    for page in [&svg, &report] {
        assert!(!page.contains("NaN") && !page.contains("inf\""));
        let links = page.matches("http").count() - page.matches("http://www.w3.org/2000/svg").count();
        assert_eq!(links, 0, "no link to elsewhere");
    }
    let fit = path("f.svg");
    succeed(&format!("fit - --frame 1 --svg {fit}"), &sequence(""));
    let fit = fs::read_to_string(fit).expect("the figure");
    assert!(fit.contains("fitted curve") && fit.contains("related points"));
}

#[test]
fn names_from_the_input_are_no_markup_in_the_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let report = folder.path().join("r.html");
    let rows: String = sequence("").lines().skip(3).map(|line| format!("{line},<b>x</b>\n")).collect();
    let csv = format!("frame,time,x,y,object\n{rows}");
    succeed(&format!("identify - --report {}", report.display()), &csv);
    let text = fs::read_to_string(report).expect("the report");
    assert!(text.contains("&lt;b&gt;x") && !text.contains("<b>x"));
}

#[test]
fn a_file_that_cannot_be_written_is_told_and_leaves_nothing_behind() {
    let folder = tempfile::tempdir().expect("a folder");
    for option in ["--trace", "--trajectory", "--svg", "--report"] {
        let output = run(&format!("identify - {option} {}/no/where", folder.path().display()), &sequence(""));
        assert_eq!(output.status.code(), Some(2), "{option}");
        assert_eq!(stderr(&output).lines().count(), 1, "{option}: {}", stderr(&output));
        assert!(stderr(&output).contains("/no/where: No such file"), "{option}: {}", stderr(&output));
    }
    let output = run(&format!("simulate --output {}", folder.path().display()), "");
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 0);
}

#[test]
fn a_run_that_fails_leaves_the_old_file_as_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let trace = file(folder.path(), "trace.csv", "old");
    let output = run(&format!("identify - --trace {trace}"), "frame,time,x,y\n0,0,1,1\n");
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(fs::read_to_string(&trace).expect("the file"), "old");
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1);
}

#[test]
fn the_input_is_not_overwritten_by_an_output() {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = sequence("");
    let input = file(folder.path(), "outlines.csv", &csv);
    for option in ["--trace", "--trajectory", "--svg", "--report"] {
        let output = run(&format!("identify {input} {option} {input}"), "");
        assert_eq!(output.status.code(), Some(2), "{option}");
    }
    assert_eq!(fs::read_to_string(&input).expect("the file"), csv);
}

#[test]
fn a_device_is_written_to_and_not_replaced() {
    assert!(!succeed("identify - --trace /dev/null --svg /dev/null", &sequence("")).is_empty());
    assert!(!fs::metadata("/dev/null").expect("the device").is_file());
}

#[test]
fn a_closed_pipe_is_no_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let input = file(folder.path(), "outlines.csv", sequence("--seconds 5"));
    for arguments in [vec!["simulate"], vec!["track", &input], vec!["fit", &input], vec!["completions", "bash"]] {
        let output = closing_its_pipe(&arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert_eq!(stderr(&output), "", "{arguments:?}");
    }
}

#[test]
fn the_demo_leaves_a_report_and_its_data() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = freeform("demo").current_dir(folder.path()).output().expect("the binary runs");
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("freeform-demo") && stdout(&output).contains("truth"));
    assert!(stdout(&output).contains("filter method") && stdout(&output).contains("adaptive method"));
    let report = fs::read_to_string(folder.path().join("freeform-demo/report.html")).expect("the report");
    assert!(report.contains("filter method") && report.contains("adaptive method"));
    for name in [
        "report.html",
        "outlines.csv",
        "curve.svg",
        "trace.csv",
        "parameters.svg",
        "trace-adaptive.csv",
        "parameters-adaptive.svg",
    ] {
        let length = fs::metadata(folder.path().join("freeform-demo").join(name)).expect(name).len();
        assert!(length > 1000, "{name}");
    }
}

#[test]
fn pictures_of_the_input_folder_are_not_overwritten() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = file(folder.path(), "000000.png", "a picture");
    let place = folder.path().display();
    for (arguments, reason) in [
        (format!("identify {place} --overlay {place}"), "draw elsewhere"),
        (format!("track {picture} --overlay {place}"), "draw elsewhere"),
        (format!("outline {place} --overlay {place}"), "draw elsewhere"),
        (format!("identify {place} --report {picture}"), "this is a file of the input"),
        (format!("outline {place} --output {picture}"), "this is a file of the input"),
    ] {
        let output = run(&arguments, "");
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(stderr(&output).contains(reason), "{arguments}: {}", stderr(&output));
        assert_eq!(fs::read_to_string(&picture).expect("the picture"), "a picture", "{arguments}");
    }
}

#[test]
fn no_output_takes_the_place_of_a_picture_of_the_input_or_of_another_output() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = file(folder.path(), "frame-1.gif", "a picture");
    let other = file(folder.path(), "drawn.gif", "no picture of the pattern");
    let pattern = folder.path().join("frame-*.gif").display().to_string();
    let (input, file_of_input) = ("this is the input", "this is a file of the input");
    for (arguments, reason) in [
        (format!("identify {picture} --overlay {picture}"), input),
        (format!("outline {picture} --overlay {picture}"), input),
        (format!("track {picture} --overlay {picture}"), input),
        (format!("identify {pattern} --overlay {picture}"), file_of_input),
        (format!("outline {other} {pattern} --output {picture}"), file_of_input),
        (format!("fit {pattern} --svg {picture}"), file_of_input),
        (format!("outline {} --overlay {other}", folder.path().display()), file_of_input),
        (format!("outline {pattern} --overlay {other} --output {other}"), "given for two outputs"),
        (format!("identify {pattern} --overlay {other} --report {other}"), "given for two outputs"),
        // Not of the pattern: it may be drawn anew, and here is nothing to draw.
        (format!("outline {pattern} --overlay {other}"), "not a picture"),
    ] {
        let output = run(&arguments, "");
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(stderr(&output).contains(reason), "{arguments}: {}", stderr(&output));
        assert_eq!(fs::read_to_string(&picture).expect("the picture"), "a picture", "{arguments}");
        assert_eq!(fs::read_to_string(&other).expect("the other"), "no picture of the pattern", "{arguments}");
    }
}

#[test]
fn a_motion_that_changed_is_said_to_have_and_is_not_smoothed_as_if_it_were_constant() {
    let folder = tempfile::tempdir().expect("a folder");
    let still = sequence("--seconds 5 --omega 0 --b 0,0");
    let turned = |row: &str| -> String {
        let numbers: Vec<f64> = row.split(',').map(|number| number.parse().expect("a number")).collect();
        let [frame, time, x, y] = numbers[..] else { panic!("{row}") };
        let (sin, cos) = (0.5 * time + 0.5 * (1.5 * time).sin()).sin_cos();
        format!("{frame},{time},{},{}\n", cos * x - sin * y, sin * x + cos * y)
    };
    let rows = still.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    let changing = format!("frame,time,x,y\n{}", rows.map(turned).collect::<String>());
    let (plain, smooth) = (folder.path().join("plain.csv"), folder.path().join("smooth.csv"));
    let output = run(&format!("identify - --trajectory {}", plain.display()), &changing);
    assert!(stderr(&output).contains("the motion changed: the values"), "{}", stderr(&output));
    succeed(&format!("identify - --smooth --trajectory {}", smooth.display()), &changing);
    let read = |path| -> Vec<Vec<f64>> {
        let text = fs::read_to_string(path).expect("a trajectory");
        let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
        let columns = ["time", "omega", "omega_std"].map(|name| header.iter().position(|column| *column == name));
        let number = |row: &[&str], column: Option<usize>| row[column.expect("a column")].parse().unwrap_or(f64::NAN);
        let rows = text.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
        rows.map(|row| columns.map(|column| number(&row, column)).to_vec()).collect()
    };
    let (plain, smooth) = (read(plain), read(smooth));
    assert!(plain[50][1].is_finite() && plain[50] != smooth[50], "{:?}", plain[50]);
    let known = || smooth.iter().skip(15).filter(|row| row[1].is_finite());
    assert!(known().count() > 80, "{}", known().count());
    for row in known() {
        // Positive clockwise.
        let truth = -(0.5 + 0.75 * (1.5 * row[0]).cos());
        assert!((row[1] - truth).abs() < 5.0 * row[2], "{row:?} {truth}");
    }
}
