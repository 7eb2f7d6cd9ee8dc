use std::fs;

use crate::support::{json, run, sequence, stderr, succeed};

/// Rows of the trajectory that `identify` writes of a sequence, the header first.
fn trajectory(options: &str, csv: &str) -> Vec<Vec<String>> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("trajectory.csv");
    succeed(&format!("identify - --trajectory {} {options}", path.display()), csv);
    let text = fs::read_to_string(path).expect("the trajectory");
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn number(rows: &[Vec<String>], row: usize, column: &str) -> f64 {
    let position = rows[0].iter().position(|name| name == column).expect("a column");
    rows[row][position].parse().expect("a number")
}

#[test]
fn the_trajectory_has_one_row_per_object_and_frame_with_pose_and_motion() {
    let rows = trajectory("", &(sequence("") + "20,5.0,1,1\n"));
    let header = "object,frame,time,accepted,angle,angle_std,x,x_std,y,y_std,omega,omega_std,b1,b1_std,b2,b2_std,segment,\
                  v1,v1_std,v2,v2_std,reason,unstated,point_x,point_y,aliases";
    assert_eq!(rows[0].join(","), header);
    assert_eq!(rows.len(), 1 + 16);
    assert!(rows[..16].iter().all(|row| row.len() == rows[0].len()));
    // Nothing is known of the motion in the first frame, and nothing of a frame that is no outline.
    let all = "angle unknown; x unknown; y unknown; omega unknown; b1 unknown; b2 unknown; v1 unknown; v2 unknown";
    assert_eq!(rows[1].join(","), format!("0,0,0,true{},0,,,,,,{all},,,", ",".repeat(12)));
    let no_outline = rows[16].join(",");
    assert!(no_outline.starts_with(&format!("0,20,,false{},0,,,,,", ",".repeat(12))), "{no_outline}");
    assert!(no_outline.contains("frame 20") && no_outline.ends_with(&format!("{all},,,")), "{no_outline}");
    for row in 2..=15 {
        let (angle, std) = (number(&rows, row, "angle"), number(&rows, row, "angle_std"));
        let truth = std::f64::consts::FRAC_PI_2 * (row - 1) as f64 / 30.0;
        assert!(std > 0.0 && std < 0.05 && (angle - truth).abs() < 5.0 * std, "{row}: {angle} {truth} {std}");
    }
}

#[test]
fn a_smoothed_trajectory_begins_with_the_first_frame_and_holds_the_motion_that_is_printed() {
    let csv = sequence("");
    let (filtered, smoothed) = (trajectory("", &csv), trajectory("--smooth", &csv));
    let printed = json(&succeed("identify - --format json", &csv));
    for (name, scale) in [("omega", 1.0), ("b1", 1.0), ("b2", 1.0)] {
        let value = printed["objects"][0]["parameters"][name]["value"].as_f64().expect("a number") * scale;
        for row in 1..=15 {
            assert!((number(&smoothed, row, name) - value).abs() < 1e-9, "{name} in row {row}");
        }
    }
    let (angle, std) = (number(&smoothed, 1, "angle"), number(&smoothed, 1, "angle_std"));
    assert!(angle.abs() < 4.0 * std + 1e-3, "{angle} {std}");
    assert!(number(&smoothed, 2, "omega_std") < 0.2 * number(&filtered, 2, "omega_std"));
    assert!(number(&smoothed, 2, "angle_std") < number(&filtered, 2, "angle_std"));
}

#[test]
fn angles_go_on_beyond_half_a_turn_and_positions_are_told_in_space() {
    let csv = sequence("--omega 3 --seconds 2.5");
    let (image, space) = (trajectory("", &csv), trajectory("--scale 0.1", &csv));
    let last = image.len() - 1;
    assert!((number(&image, last, "angle") - 3.0 * (last - 1) as f64 / 30.0).abs() < 0.05);
    for column in ["x", "x_std", "y", "b1", "b2_std"] {
        let (image, space) = (number(&image, last, column), number(&space, last, column));
        assert!((10.0 * image - space).abs() < 1e-9 * space.abs(), "{column}");
    }
    assert_eq!(number(&image, last, "angle"), number(&space, last, "angle"));
}

#[test]
fn other_models_have_trajectories_too() {
    let csv = sequence("");
    for (options, pose) in [
        ("--motion similarity", "scale,scale_std,angle,angle_std,x,x_std,y,y_std,sigma,"),
        ("--motion affine", "m11,m11_std,m12,m12_std,m21,m21_std,m22,m22_std,x,x_std,y,y_std,a1,"),
    ] {
        let rows = trajectory(options, &csv);
        assert!(rows[0].join(",").contains(&format!("accepted,{pose}")), "{options}: {:?}", rows[0]);
        assert!(
            rows[15][4..rows[15].len() - 5].iter().all(|field| field.parse::<f64>().is_ok_and(f64::is_finite)),
            "{options}"
        );
    }
}

#[test]
fn every_object_is_smoothed_by_itself() {
    let one = sequence("--shape glider --omega -1 --b 0,1");
    let other = sequence("--shape bird");
    let rows =
        |csv: &str, name: &str| -> Vec<String> { csv.lines().skip(3).map(|line| format!("{line},{name}\n")).collect() };
    // Frame by frame: both objects in each.
    let (first, second) = (rows(&one, "a"), rows(&other, "b"));
    let mixed: String = first.chunks(120).zip(second.chunks(120)).flat_map(|(a, b)| [a.concat(), b.concat()]).collect();
    let both = trajectory("--smooth", &format!("frame,time,x,y,object\n{mixed}"));
    let alone = trajectory("--smooth", &one);
    let of_first: Vec<_> = both.iter().filter(|row| row[0] == "a").map(|row| row[1..].to_vec()).collect();
    assert_eq!(of_first, alone[1..].iter().map(|row| row[1..].to_vec()).collect::<Vec<_>>());
}

#[test]
fn poses_of_an_object_whose_motion_changes_are_smoothed_as_well_as_those_of_others() {
    let constant = sequence("--seconds 6 --points 60");
    let stopping = sequence("--dynamics stop-and-go --shape bird --seconds 6 --points 60");
    let rows = |csv: &str, name: &str| -> Vec<String> {
        csv.lines()
            .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
            .map(|line| format!("{line},{name}\n"))
            .collect()
    };
    let (first, second) = (rows(&constant, "a"), rows(&stopping, "b"));
    let mixed: String = first.chunks(60).zip(second.chunks(60)).flat_map(|(a, b)| [a.concat(), b.concat()]).collect();
    let csv = format!("frame,time,x,y,object\n{mixed}");
    let (filtered, smoothed) = (trajectory("--quiet", &csv), trajectory("--quiet --smooth", &csv));
    for name in ["a", "b"] {
        let rows =
            |table: &[Vec<String>]| table.iter().filter(|row| row[0] == name).take(50).cloned().collect::<Vec<_>>();
        assert_ne!(rows(&filtered), rows(&smoothed), "{name}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let output = run(&format!("identify - --smooth --trajectory {}/t.csv", folder.path().display()), &csv);
    assert!(output.status.success() && !stderr(&output).contains("smooth"), "{}", stderr(&output));
}

#[test]
fn what_cannot_be_had_is_wrong_usage() {
    for (options, reason) in
        [("--method adaptive --trajectory t.csv", "the adaptive method gives no poses"), ("--smooth", "--trajectory")]
    {
        let output = run(&format!("identify - {options}"), &sequence(""));
        assert_eq!(output.status.code(), Some(2), "{options}");
        assert!(stderr(&output).contains(reason), "{}", stderr(&output));
    }
}

/// Rows of a table that `identify` writes, cells by the names of their columns.
fn cells_of(option: &str, options: &str, csv: &str) -> Vec<Vec<(String, String)>> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("table.csv");
    succeed(&format!("identify - --quiet {option} {} {options}", path.display()), csv);
    let text = fs::read_to_string(path).expect("a table");
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    lines.map(|cells| header.iter().cloned().zip(cells).collect()).collect()
}

#[test]
fn every_value_that_is_empty_in_an_accepted_frame_has_a_reason_beside_it() {
    let circle = succeed("simulate --shape circle --dynamics velocity --omega 2 --velocity 10,0 --seconds 0.4", "");
    for (option, options) in
        [("--trace", ""), ("--trajectory", ""), ("--trajectory", "--smooth"), ("--trace", "--motion affine")]
    {
        for csv in [&circle, &sequence("")] {
            let rows = cells_of(option, options, csv);
            let mut words = std::collections::BTreeSet::new();
            for (number, row) in rows.iter().enumerate() {
                let cell = |name: &str| row.iter().find(|(column, _)| column == name).map_or("", |(_, cell)| cell);
                assert_eq!((cell("accepted"), cell("reason")), ("true", ""), "{number}");
                let given: Vec<_> = cell("unstated").split("; ").filter_map(|reason| reason.split_once(' ')).collect();
                let values =
                    row.iter().filter(|(name, _)| row.iter().any(|(other, _)| *other == format!("{name}_std")));
                let empty: Vec<_> = values.filter(|(_, cell)| cell.is_empty()).map(|(name, _)| name.as_str()).collect();
                assert_eq!(
                    given.iter().map(|(name, _)| *name).collect::<Vec<_>>(),
                    empty,
                    "{option} {options} {number}"
                );
                words.extend(given.iter().map(|(_, word)| (*word).to_owned()));
            }
            let is_hidden = csv == &circle;
            assert_eq!(words.contains("unobservable"), is_hidden, "{option} {options}: {words:?}");
        }
    }
    // The lines of a stream say the same, also where all parameters are null.
    let lines: Vec<_> = succeed("track -", &circle).lines().map(json).collect();
    assert!(lines[0]["parameters"].is_null() && lines[0]["velocity"].is_null());
    for name in ["omega", "b1", "b2", "velocity"] {
        assert_eq!(lines[0]["unstated"][name], "unknown", "{name}");
    }
    let last = lines.last().expect("lines");
    assert_eq!(last["unstated"]["omega"], "unobservable");
    assert!(last["unstated"]["velocity"].is_null());
}

#[test]
fn the_velocity_of_the_middle_is_in_the_tables_as_in_json() {
    let csv = sequence("");
    let result = json(&succeed("identify - --json", &csv));
    let velocity = &result["objects"][0]["velocity"];
    for option in ["--trace", "--trajectory"] {
        let rows = cells_of(option, "", &csv);
        let cell = |name: &str| {
            let row = rows.last().expect("rows");
            row.iter().find(|(column, _)| column == name).expect("a column").1.parse::<f64>().expect("a number")
        };
        for (i, name) in ["v1", "v2"].into_iter().enumerate() {
            let [value, deviation] = ["value", "std"].map(|of| velocity[of][i].as_f64().expect("a number"));
            assert!(
                (cell(name) - value).abs() < 1e-9 && (cell(&format!("{name}_std")) - deviation).abs() < 1e-9,
                "{option} {name}"
            );
        }
        for (i, name) in ["point_x", "point_y"].into_iter().enumerate() {
            let point = velocity["point"][i].as_f64().expect("a number");
            assert!((cell(name) - point).abs() < 1e-9, "{option} {name}");
        }
    }
}

#[test]
fn the_trajectory_has_the_other_rates_of_a_symmetric_outline_in_every_row_that_states_one() {
    let csv = sequence("--shape square --omega 2");
    for options in ["", "--smooth"] {
        let rows = trajectory(options, &csv);
        assert!(rows[3..].iter().all(|row| row.last().is_some_and(|cell| !cell.is_empty())), "{options}");
        let aliases: Vec<f64> = rows
            .last()
            .and_then(|row| row.last())
            .expect("a cell")
            .split("; ")
            .map(|alias| alias.parse().expect("a number"))
            .collect();
        let whole = json(&succeed("identify - --json", &csv));
        let listed = whole["objects"][0]["parameters"]["omega"]["aliases"].as_array().expect("a list").clone();
        assert!(aliases.len() >= 2 && aliases.len() == listed.len(), "{aliases:?} {listed:?}");
        for (alias, listed) in aliases.iter().zip(listed) {
            assert!((alias - listed.as_f64().expect("a number")).abs() < 1e-3, "{alias} {listed}");
        }
    }
    let rows = trajectory("", &sequence(""));
    assert!(rows[1..].iter().all(|row| row.last().is_some_and(String::is_empty)));
}
