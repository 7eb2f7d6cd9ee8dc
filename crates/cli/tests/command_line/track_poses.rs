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

/// Asks that lines and rows have the same poses and segments, with the same reasons; how many of the numbers are stated.
fn agree(lines: &[Value], rows: &[Vec<(String, String)>], names: &[&str]) -> usize {
    assert_eq!(lines.len(), rows.len());
    let mut stated = 0;
    for (line, row) in lines.iter().zip(rows) {
        let cell = |name: &str| &row.iter().find(|(column, _)| column == name).expect("a column").1;
        assert_eq!(line["segment"].to_string(), *cell("segment"));
        for name in names {
            let number = &line["pose"][name];
            for (of, column) in [("value", (*name).to_owned()), ("std", format!("{name}_std"))] {
                let of_table = cell(&column).parse::<f64>().ok();
                let is_same = match (number[of].as_f64(), of_table) {
                    (Some(of_line), Some(of_table)) => (of_line - of_table).abs() <= 1e-12 * of_table.abs(),
                    (of_line, of_table) => of_line.is_none() && of_table.is_none(),
                };
                assert!(is_same, "{column}: {} {line}", cell(&column));
            }
            // A reason stands where a value does not, and nowhere else.
            let reason = number["reason"].as_str().unwrap_or_default();
            let in_row = cell("unstated").split("; ").find_map(|each| each.strip_prefix(&format!("{name} ")));
            assert_eq!(reason, in_row.unwrap_or_default(), "{line}");
            assert_eq!(number["reason"], line["unstated"][name], "{line}");
            stated += usize::from(number["value"].is_f64());
        }
    }
    stated
}

/// The rows of a sequence, so many frames and seconds later.
fn later(csv: &str, frames: f64, seconds: f64) -> String {
    let rows = csv.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit())).map(|line| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        format!("{},{},{},{}\n", cells[0] + frames, cells[1] + seconds, cells[2], cells[3])
    });
    rows.collect()
}

/// A glider, then a van in its place, for which it is given up.
fn glider_then_van() -> String {
    let van = sequence("--shape van --seconds 1.5");
    sequence("--shape glider --omega 2 --seconds 1") + &later(&van, 30.0, 1.0)
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
        let stated = agree(&lines, &rows, names);
        assert!(stated > lines.len(), "{stated} numbers of {} poses", lines.len());
        let last_segment = lines.last().expect("lines")["segment"].as_u64().expect("a number");
        assert_eq!(last_segment + 1, segments, "{options}");
    }
}

#[test]
fn an_angle_that_may_be_whole_turns_off_is_in_neither_and_the_place_is() {
    // By 170 degrees from frame to frame, or by 190 the other way round.
    let (lines, rows) = both_ways(&sequence("--omega 29.7 --fps 10 --seconds 2"), "");
    assert_eq!(agree(&lines, &rows, &["angle", "x", "y"]), 2 * (lines.len() - 1));
    for line in &lines[1..] {
        assert_eq!(line["pose"]["angle"]["reason"], "ambiguous", "{line}");
        assert_eq!(line["ambiguity"]["parameters"][0], "omega", "{line}");
    }
}

#[test]
fn frames_that_are_rejected_before_the_first_one_used_have_no_pose_and_count_for_nothing() {
    let later = later(&sequence(""), 2.0, 0.1);
    let csv = "frame,time,x,y\n0,0,1,1\n1,0.05,1,1\n1,0.05,2,1\n".to_owned() + &later;
    let (lines, rows) = both_ways(&csv, "");
    assert!(agree(&lines, &rows, &["angle", "x", "y"]) > lines.len());
    for line in &lines[..2] {
        assert!(line["accepted"] == false && line["reason"].is_string(), "{line}");
        assert_eq!((&line["pose"]["x"]["value"], &line["pose"]["x"]["reason"]), (&Value::Null, &"unknown".into()));
    }
    // The angle is that since the first frame that was used, in the one segment there is.
    let alone = both_ways(&("frame,time,x,y\n".to_owned() + &later), "").0;
    let poses = |lines: &[Value]| lines.iter().map(|line| line["pose"].clone()).collect::<Vec<_>>();
    assert_eq!(poses(&lines[2..]), poses(&alone));
    assert!(lines.iter().all(|line| line["segment"] == 0), "{lines:?}");
}

#[test]
fn the_last_line_of_an_object_that_has_left_has_no_pose_and_its_name_begins_anew() {
    // A body that is seen for as long as another is waited for, turned by 0.1 rad from frame to frame.
    let body = |object: &str, frame: u32, turns: u32| {
        let (sin, cos) = (0.1 * f64::from(turns)).sin_cos();
        let corners = [[-0.5, -0.3], [0.5, -0.3], [0.5, 0.1], [0.1, 0.3], [-0.5, 0.3]].into_iter();
        let row = move |[x, y]: [f64; 2]| {
            format!("{object},{frame},{},{},{}\n", f64::from(frame) / 20.0, cos * x + sin * y, cos * y - sin * x)
        };
        let between =
            |[a, b]: [[f64; 2]; 2]| (0..5).map(move |i| [0, 1].map(|k| a[k] + f64::from(i) / 5.0 * (b[k] - a[k])));
        let next = corners.clone().cycle().skip(1);
        corners.zip(next).flat_map(move |(a, b)| between([a, b])).map(row).collect::<String>()
    };
    let rows = (0..1030).map(|frame| {
        let left = if !(10..1020).contains(&frame) { body("left", frame, frame) } else { String::new() };
        left + &body("stays", frame, 0)
    });
    let csv = "object,frame,time,x,y\n".to_owned() + &rows.collect::<String>();
    let lines: Vec<Value> = succeed("track - --quiet", &csv).lines().map(json).collect();
    let of_left: Vec<&Value> = lines.iter().filter(|line| line["object"] == "left").collect();
    let closed = of_left.iter().position(|line| line["phase"] == "closed").expect("a closing line");
    assert_eq!((closed, of_left.len()), (10, 21));
    let (last, line) = (of_left[closed - 1], of_left[closed]);
    assert_eq!((&line["frame"], &line["time"], &line["accepted"]), (&last["frame"], &last["time"], &false.into()));
    assert!(line["segment"].is_null() && line["parameters"]["omega"]["value"].is_f64(), "{line}");
    for name in ["angle", "x", "y"] {
        let number = &line["pose"][name];
        let told = (&number["value"], &number["std"], &number["reason"], &line["unstated"][name]);
        assert_eq!(told, (&Value::Null, &Value::Null, &"unknown".into(), &"unknown".into()), "{line}");
    }
    // It is another object by the same name: its angle is that since it came.
    for (turns, line) in (1..10).zip(&of_left[closed + 2..]) {
        let [angle, std] = ["value", "std"].map(|of| line["pose"]["angle"][of].as_f64().expect("an angle"));
        assert!((angle - 0.1 * f64::from(turns)).abs() < 4.0 * std + 1e-3 && std < 0.05, "{turns}: {angle} {std}");
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
