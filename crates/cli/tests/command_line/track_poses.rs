use std::fs;

use serde_json::Value;

use crate::support::{file, json, sequence, succeed};

/// The lines of a stream, and the rows of the trajectory that `identify` writes of the same outlines, each by the names of its columns.
fn both_ways(csv: &str, options: &str) -> (Vec<Value>, Vec<Vec<(String, String)>>) {
    let folder = tempfile::tempdir().expect("a folder");
    let (outlines, poses) = (file(folder.path(), "o.csv", csv), folder.path().join("poses.csv"));
    let lines = succeed(&format!("track {outlines} --quiet {options}"), "").lines().map(json).collect();
    succeed(&format!("identify {outlines} --quiet {options} --trajectory {}", poses.display()), "");
    let text = fs::read_to_string(poses).expect("the trajectory");
    // Reasons are in quotes, with commas of their own.
    let cells = |line: &str| -> Vec<String> {
        let parts = line.split('"').enumerate();
        let commas = parts.map(|(i, part)| if i % 2 == 0 { part.replace(',', "\n") } else { part.to_owned() });
        commas.collect::<String>().split('\n').map(str::to_owned).collect()
    };
    let mut rows = text.lines().map(cells);
    let header = rows.next().expect("a header");
    (lines, rows.map(|cells| header.iter().cloned().zip(cells).collect()).collect())
}

/// A glider, then a van in its place, for which it is given up.
fn glider_then_van() -> String {
    let van = sequence("--shape van --seconds 1.5");
    let later = van.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit())).map(|line| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        format!("{},{},{},{}\n", cells[0] + 30.0, cells[1] + 1.0, cells[2], cells[3])
    });
    sequence("--shape glider --omega 2 --seconds 1") + &later.collect::<String>()
}

#[test]
fn every_line_has_the_pose_and_the_segment_that_the_trajectory_has() {
    // It makes more than a whole turn.
    let turning = sequence("--omega 4 --seconds 2.5");
    let circle = succeed("simulate --shape circle --omega 2 --b 0.3,0 --seconds 0.4", "");
    let begun_anew = glider_then_van();
    for (csv, options, names, segments) in [
        (&turning, "", &["angle", "x", "y"][..], 1),
        (&turning, "--scale 0.1", &["angle", "x", "y"], 1),
        (&turning, "--motion affine", &["m11", "m12", "m21", "m22", "x", "y"], 1),
        (&circle, "", &["angle", "x", "y"], 1),
        (&begun_anew, "", &["angle", "x", "y"], 2),
    ] {
        let (lines, rows) = both_ways(csv, options);
        assert_eq!(lines.len(), rows.len());
        let (mut stated, mut last_segment) = (0, 0);
        for (line, row) in lines.iter().zip(&rows) {
            let cell = |name: &str| &row.iter().find(|(column, _)| column == name).expect("a column").1;
            assert_eq!(line["segment"].to_string(), *cell("segment"));
            last_segment = line["segment"].as_u64().expect("a number");
            for name in names {
                let number = &line["pose"][name];
                for (of, column) in [("value", (*name).to_owned()), ("std", format!("{name}_std"))] {
                    let of_table = cell(&column).parse::<f64>().ok();
                    let is_same = match (number[of].as_f64(), of_table) {
                        (Some(of_line), Some(of_table)) => (of_line - of_table).abs() <= 1e-12 * of_table.abs(),
                        (of_line, of_table) => of_line.is_none() && of_table.is_none(),
                    };
                    assert!(is_same, "{options} {column}: {} {line}", cell(&column));
                }
                // A reason stands where a value does not, and nowhere else.
                let reason = number["reason"].as_str().unwrap_or_default();
                let in_row = cell("unstated").split("; ").find_map(|each| each.strip_prefix(&format!("{name} ")));
                assert_eq!(reason, in_row.unwrap_or_default(), "{line}");
                assert_eq!(number["reason"], line["unstated"][name], "{line}");
                stated += usize::from(number["value"].is_f64());
            }
        }
        assert!(stated > lines.len(), "{stated} numbers of {} poses", lines.len());
        assert_eq!(last_segment + 1, segments, "{options}");
    }
}

#[test]
fn the_angle_of_a_stream_goes_on_beyond_half_a_turn_and_that_of_a_circle_is_null_with_the_reason() {
    let last = |csv: &str| json(succeed("track - --quiet", csv).lines().last().expect("a line"));
    let turning = last(&sequence("--omega 4 --seconds 2.5"));
    let angle = &turning["pose"]["angle"];
    let (value, deviation) =
        (angle["value"].as_f64().expect("an angle"), angle["std"].as_f64().expect("its deviation"));
    let truth = 4.0 * turning["time"].as_f64().expect("a time");
    assert!((value - truth).abs() < 5.0 * deviation && deviation < 0.05, "{value} +- {deviation}, truly {truth}");
    assert_eq!((&angle["unit"], &angle["reason"]), (&"rad".into(), &Value::Null));
    let circle = last(&succeed("simulate --shape circle --omega 2 --b 0.3,0 --seconds 0.4", ""));
    let angle = &circle["pose"]["angle"];
    assert_eq!(
        (&angle["value"], &angle["std"], &angle["reason"]),
        (&Value::Null, &Value::Null, &"unobservable".into())
    );
    assert!(circle["pose"]["x"]["value"].is_f64(), "{circle}");
}

#[test]
fn methods_without_poses_have_none_in_their_lines() {
    let lines = succeed("track - --quiet --method adaptive", &sequence(""));
    for line in lines.lines().map(json) {
        assert!(line["pose"].is_null() && line["unstated"]["angle"].is_null(), "{line}");
    }
}
