//! How pictures are traced where no option says it, and what holes and edges tell.
use image::{GrayImage, Luma};

use crate::pears::pears;
use crate::support::{json, run, stderr, stdout, succeed};

#[test]
fn without_options_the_way_of_tracing_is_found_printed_and_gives_the_same_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = folder.path().to_str().expect("UTF-8");
    for (scene, seed, expected) in
        [("accelerating-l", 0, "--dark"), ("gear", 1, "--light"), ("belt", 1, "--objects all")]
    {
        let frames = format!("{base}/{scene}");
        succeed(&format!("simulate --pictures {frames} --scene {scene} --seed {seed} --seconds 0.5"), "");
        let chosen = run(&format!("outline {frames} --fps 30"), "");
        let errors = stderr(&chosen);
        let note = errors.lines().find_map(|line| line.strip_prefix("freeform: note: traced with ")).expect("a note");
        let options = note.split(" (").next().expect("options");
        assert!(options.contains(expected), "{scene}: {note}");
        let again = run(&format!("outline {frames} --fps 30 {options}"), "");
        // What the choice warns of stands in the last column, which tables of all objects always have.
        let outlines = |table: String| {
            let has_warnings = table.lines().next().is_some_and(|header| header.ends_with(",warning"));
            let outline =
                |line: &str| if has_warnings { line.rsplit_once(',').expect("a column").0 } else { line }.to_owned();
            table.lines().map(outline).collect::<Vec<_>>()
        };
        assert!(outlines(stdout(&again)) == outlines(stdout(&chosen)) && stderr(&again).is_empty(), "{scene}: {note}");
    }
}

#[test]
fn a_body_that_its_motion_blurs_is_measured_by_its_light_where_grey_values_are_those_of_a_camera() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = folder.path().to_str().expect("UTF-8");
    let simulated = |gamma: f64| {
        let frames = format!("{base}/{gamma}");
        let scene = format!("--scene accelerating-l --seed 2 --seconds 2 --exposure 0.025 --gamma {gamma}");
        succeed(&format!("simulate --pictures {frames} {scene}"), "");
        frames
    };
    let [measuring, camera] = [1.0, 2.2].map(simulated);
    let identified = |frames: &str, options: &str| {
        let output = run(&format!("identify {frames} --fps 30 --json {options}"), "");
        let document: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
        let omega = document["objects"][0]["parameters"]["omega"].clone();
        (stderr(&output), omega["value"].as_f64().expect("a value"), omega["std"].as_f64().expect("a deviation"))
    };
    let truth = std::fs::read_to_string(format!("{camera}/truth.csv")).expect("the truth");
    let last = truth.lines().last().and_then(|row| row.split(',').nth(6)?.parse::<f64>().ok()).expect("omega");
    let (told, value, deviation) = identified(&camera, "");
    assert!(told.contains("--transfer srgb (chosen"), "{told}");
    assert!(!told.contains("wrong_family"), "{told}");
    assert!((value - last).abs() < 4.0 * deviation, "{value} +- {deviation}, {last}");
    // What is given is obeyed.
    let (told, _, of_grey_values) = identified(&camera, "--transfer linear");
    assert!(!told.contains("--transfer"), "{told}");
    assert!(deviation < 0.3 * of_grey_values, "{deviation} {of_grey_values}");
    for options in ["--channel saturation --light", "--ring dark"] {
        let refused = run(&format!("identify {camera} --fps 30 --transfer srgb {options}"), "");
        assert_eq!(refused.status.code(), Some(2), "{options}");
        assert!(stderr(&refused).contains("--transfer"), "{options}: {}", stderr(&refused));
    }
    let (told, value, deviation) = identified(&measuring, "");
    assert!(!told.contains("--transfer"), "{told}");
    assert!((value - last).abs() < 4.0 * deviation, "{value} +- {deviation}, {last}");
}

#[test]
fn where_the_largest_of_several_objects_is_followed_it_is_said_how_all_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let is_in = |x: u32, y: u32, [cx, cy, radius]: [f64; 3]| (f64::from(x) - cx).hypot(f64::from(y) - cy) < radius;
    for frame in 0..12_u32 {
        let shift = 4.0 * f64::from(frame);
        let value = |x, y| {
            let light = is_in(x, y, [60.0 + shift, 80.0, 30.0]) || is_in(x, y, [240.0 - shift, 180.0, 15.0]);
            Luma([if light { 180 } else { 60 } + ((x * 7 + y * 13 + frame) % 5) as u8])
        };
        GrayImage::from_fn(320, 240, value).save(folder.path().join(format!("{frame:02}.png"))).expect("a picture");
    }
    let frames = folder.path().to_str().expect("UTF-8");
    let told = |options: &str| stderr(&run(&format!("identify {frames} --fps 30 {options}"), ""));
    let note = "another object, of 25 % of its area, is not followed: --objects all does";
    assert!(told("").contains(note), "{}", told(""));
    for options in ["--objects all", "--objects largest"] {
        assert!(!told(options).contains("is not followed"), "{options}: {}", told(options));
    }
}

#[test]
fn an_assumed_rate_and_a_choice_without_conviction_are_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, _) = pears(folder.path(), "frames", 4);
    let told = stderr(&run(&format!("outline {frames} --light"), ""));
    assert!(told.contains("30 frames/s assumed") && told.contains("--fps"), "{told}");
    let noise = folder.path().join("noise");
    std::fs::create_dir(&noise).expect("a folder");
    for frame in 0..6_u32 {
        let value = |x: u32, y: u32| ((x * 7919 + y * 104_729 + (x * y + frame * 77) * (frame + 3)) % 61) as u8;
        GrayImage::from_fn(160, 120, |x, y| Luma([60 + value(x, y)]))
            .save(noise.join(format!("{frame}.png")))
            .expect("a picture");
    }
    let output = run(&format!("identify {} --fps 30", noise.display()), "");
    let told = stderr(&output);
    assert!(output.status.code() == Some(1) || told.contains("beyond doubt"), "{told}");
}

/// The true angular velocities of two objects in the last of some simulated pictures.
fn true_omegas(frames: &str) -> [f64; 2] {
    let truth = std::fs::read_to_string(format!("{frames}/truth.csv")).expect("the truth");
    let mut last = truth.lines().rev().map(|line| line.split(',').nth(6).and_then(|omega| omega.parse().ok()));
    let [second, first] = [(); 2].map(|()| last.next().flatten().expect("a number"));
    [first, second]
}

#[test]
fn nothing_moves_beside_a_gear_that_turns_about_a_middle_that_hardly_moves() {
    let folder = tempfile::tempdir().expect("a folder");
    for seed in [3, 4, 7] {
        let frames = format!("{}/{seed}", folder.path().to_str().expect("UTF-8"));
        succeed(&format!("simulate --pictures {frames} --seed {seed} --seconds 1"), "");
        let document = json(&succeed(&format!("identify {frames} --fps 30 --quiet --json"), ""));
        assert!(document["warnings"].is_null(), "{seed}: {}", document["warnings"]);
    }
}

#[test]
fn where_each_body_is_first_seen_whole_tells_which_object_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = format!("{}/belt", folder.path().to_str().expect("UTF-8"));
    succeed(&format!("simulate --pictures {frames} --scene belt --seed 3 --seconds 1"), "");
    let truth = std::fs::read_to_string(format!("{frames}/truth.csv")).expect("the truth");
    let mut rows =
        truth.lines().skip_while(|line| line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let header = rows.next().expect("a header");
    assert_eq!(header[header.len() - 3..], ["first_frame", "first_x", "first_y"]);
    // The last row of each body.
    let mut first_seen: Vec<Vec<f64>> = Vec::new();
    let rows: Vec<Vec<&str>> = rows.collect();
    let last = rows[rows.len() - 1][0];
    for row in rows.iter().filter(|row| row[0] == last) {
        let cells: Option<Vec<f64>> = row[row.len() - 3..].iter().map(|cell| cell.parse().ok()).collect();
        first_seen.extend(cells);
    }
    assert!(first_seen.len() > 3 && first_seen.iter().any(|first| first[0] > 0.0), "{first_seen:?}");
    let table = succeed(&format!("outline {frames} --fps 30 --objects all --light --quiet"), "");
    let mut objects = Vec::new();
    for first in &first_seen {
        let mut places: std::collections::BTreeMap<&str, Vec<[f64; 2]>> = std::collections::BTreeMap::new();
        for line in table.lines().skip_while(|line| !line.starts_with(char::is_numeric)) {
            let cells: Vec<&str> = line.split(',').collect();
            if cells[0].parse() == Ok(first[0]) {
                places.entry(cells[4]).or_default().push([2, 3].map(|k| cells[k].parse().expect("a number")));
            }
        }
        let is_near = |points: &&Vec<[f64; 2]>| {
            let middle = [0, 1].map(|k| points.iter().map(|point| point[k]).sum::<f64>() / points.len() as f64);
            (middle[0] - first[1]).hypot(middle[1] - first[2]) < 15.0
        };
        let near: Vec<&str> = places.iter().filter(|(_, points)| is_near(points)).map(|(name, _)| *name).collect();
        assert_eq!(near.len(), 1, "{first:?}");
        objects.extend(near);
    }
    objects.sort_unstable();
    objects.dedup();
    assert_eq!(objects.len(), first_seen.len(), "each body is an object of its own");
}

#[test]
fn discs_that_roll_tell_their_turn_by_their_holes_and_not_without_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = folder.path().to_str().expect("UTF-8");
    for (scene, has_holes) in [("marked-discs", true), ("discs", false)] {
        let frames = format!("{base}/{scene}");
        succeed(&format!("simulate --pictures {frames} --scene {scene} --seed 1 --seconds 1"), "");
        let document = json(&succeed(&format!("identify {frames} --fps 30 --quiet --json"), ""));
        for (object, truth) in document["objects"].as_array().expect("objects").iter().zip(true_omegas(&frames)) {
            let omega = &object["parameters"]["omega"]["value"];
            match omega.as_f64() {
                Some(omega) => assert!(has_holes && (omega / truth - 1.0).abs() < 0.01, "{scene}: {omega} {truth}"),
                None => assert!(!has_holes, "{scene}: {object}"),
            }
        }
        assert_eq!(document["objects"].as_array().map(Vec::len), Some(2), "{scene}");
    }
}

/// The median of these pictures shows the discs where they are most of the time, which spoils one side of their edges: the score of both ways is the
/// same to a part in a thousand.
#[test]
fn of_two_ways_that_do_as_well_the_one_whose_contours_are_known_better_is_taken() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = format!("{}/frames", folder.path().to_str().expect("UTF-8"));
    succeed(&format!("simulate --pictures {frames} --scene marked-discs --seed 2"), "");
    let document = json(&succeed(&format!("identify {frames} --fps 30 --quiet --json"), ""));
    assert_eq!(document["objects"].as_array().map(Vec::len), Some(2));
    for (object, truth) in document["objects"].as_array().expect("objects").iter().zip(true_omegas(&frames)) {
        let omega = |field: &str| object["parameters"]["omega"][field].as_f64().expect("a number");
        // By the other way 0.0055 and 0.0998.
        assert!(omega("std") < 0.003 && (omega("value") - truth).abs() < 4.0 * omega("std"), "{object}: {truth}");
    }
}

#[test]
fn deviations_of_points_are_written_where_they_are_asked_for_and_weigh_the_points_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, _) = pears(folder.path(), "frames", 6);
    let plain = succeed(&format!("outline {frames} --fps 30 --quiet"), "");
    let with_deviations = succeed(&format!("outline {frames} --fps 30 --quiet --deviations"), "");
    let rows =
        |text: &str| -> Vec<String> { text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect() };
    let (plain_rows, rows) = (rows(&plain), rows(&with_deviations));
    assert!(rows[0].ends_with(",deviation") && !plain_rows[0].contains("deviation"), "{}", rows[0]);
    assert_eq!(rows.len(), plain_rows.len());
    for (row, plain) in rows[1..].iter().zip(&plain_rows[1..]) {
        let (point, deviation) = row.rsplit_once(',').expect("columns");
        assert_eq!(point, plain);
        assert!(deviation.parse::<f64>().is_ok_and(|deviation| deviation > 0.0), "{row}");
    }
    let identified = |outlines: &str| json(&succeed("identify - --json --quiet", outlines))["objects"].clone();
    assert_ne!(identified(&with_deviations)[0]["parameters"]["omega"], identified(&plain)[0]["parameters"]["omega"]);
    // Parquet has the same, to the last bit.
    let parquet = folder.path().join("a.parquet").display().to_string();
    succeed(&format!("outline {frames} --quiet --deviations --output {parquet}"), "");
    let from_parquet = json(&succeed(&format!("identify {parquet} --json --quiet"), ""));
    assert_eq!(from_parquet["objects"], identified(&with_deviations));
}

#[test]
fn bars_at_the_sides_of_pictures_are_no_bodies_and_are_named_as_margins() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().join("frames");
    std::fs::create_dir(&frames).expect("a folder");
    for frame in 0..12_u32 {
        let value = |x: u32, y: u32| match y {
            20..90 if (f64::from(x) - 30.0 - 5.0 * f64::from(frame)).hypot(f64::from(y) - 50.0) < 15.0 => 20,
            20..90 => 120 + ((x * 31 + y * 17 + frame * 7) % 5) as u8,
            _ => 0,
        };
        let picture = GrayImage::from_fn(160, 120, |x, y| Luma([value(x, y)]));
        picture.save(frames.join(format!("{frame:02}.png"))).expect("a picture");
    }
    let output = run(&format!("identify {} --fps 30 --json", frames.display()), "");
    assert!(stderr(&output).contains("--dark --margins 0,22,0,32 ("), "{}", stderr(&output));
    let document = json(&stdout(&output));
    assert_eq!(document["objects"].as_array().map(Vec::len), Some(1), "{document}");
    let velocity = &document["objects"][0]["velocity"];
    let [vx, y] = [&velocity["value"][0], &velocity["point"][1]].map(|value| value.as_f64().expect("a number"));
    // In the coordinates of the whole picture.
    assert!((vx - 150.0).abs() < 1.0 && (y - 69.5).abs() < 0.5, "{velocity}");
    assert!(document.get("warnings").is_none(), "{document}");
    let refused = run(&format!("outline {} --margins 0,22,0", frames.display()), "");
    assert!(stderr(&refused).contains("four numbers of pixels such as 0,60,0,60"), "{}", stderr(&refused));
}

#[test]
fn changes_beside_what_rests_are_warned_of_by_a_code() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().join("frames");
    std::fs::create_dir(&frames).expect("a folder");
    for frame in 0..12_u32 {
        let is_speck =
            |x: u32, y: u32| frame % 2 == 0 && x.abs_diff(20 + 7 * (frame * 5 % 9)) < 6 && y.abs_diff(100 - frame) < 6;
        let value =
            |x: u32, y: u32| if (60..100).contains(&x) && (20..60).contains(&y) || is_speck(x, y) { 180 } else { 60 };
        let noise = |x: u32, y: u32| ((x * 31 + y * 17 + frame * 7) % 5) as u8;
        let picture = GrayImage::from_fn(160, 120, |x, y| Luma([value(x, y) + noise(x, y)]));
        picture.save(frames.join(format!("{frame:02}.png"))).expect("a picture");
    }
    let output = run(&format!("identify {} --fps 30 --json", frames.display()), "");
    assert!(
        stderr(&output)
            .contains("warning[moves_beside_rest]: what is traced rests, and something else changes in 6 of 12"),
        "{}",
        stderr(&output)
    );
    assert_eq!(json(&stdout(&output))["warnings"][0]["code"], "moves_beside_rest");
}

#[test]
fn a_motion_between_two_frames_alone_is_warned_of_where_the_way_of_tracing_is_in_doubt() {
    for (shown, is_warned) in [(2, true), (12, false)] {
        let folder = tempfile::tempdir().expect("a folder");
        for frame in 0..12_u32 {
            let place = 60 + 3 * frame;
            let is_seen = frame.abs_diff(5) < shown && frame >= 5;
            let is_light = |x: u32, y: u32| {
                let (x, y) = (x.wrapping_sub(place), y.wrapping_sub(50));
                is_seen && x < 18 && y < 24 && (x < 7 || y < 6)
            };
            let noise = |x: u32, y: u32| ((x * 31 + y * 17 + frame * 7) % 5) as u8;
            let value = |x: u32, y: u32| noise(x, y) + if is_light(x, y) { 180 } else { 60 };
            let picture = GrayImage::from_fn(160, 120, |x, y| Luma([value(x, y)]));
            picture.save(folder.path().join(format!("{frame:02}.png"))).expect("a picture");
        }
        let document = json(&succeed(&format!("identify {} --fps 30 --quiet --json", folder.path().display()), ""));
        let object = &document["objects"][0];
        let codes = |of: &serde_json::Value| -> Vec<String> {
            let warnings = of["warnings"].as_array().cloned().unwrap_or_default();
            warnings.iter().filter_map(|warning| warning["code"].as_str().map(str::to_owned)).collect()
        };
        assert!(object["velocity"]["value"][0].is_number(), "{document}");
        assert_eq!(codes(&document).contains(&"tracing_doubtful".to_owned()), is_warned, "{document}");
        assert_eq!(codes(object).contains(&"of_two_frames".to_owned()), is_warned, "{document}");
        let tracked = run(&format!("track {} --fps 30", folder.path().display()), "");
        let warning = "object 0: its motion is that between two frames";
        assert_eq!(stderr(&tracked).matches(warning).count(), usize::from(is_warned), "{}", stderr(&tracked));
    }
}

#[test]
fn of_an_object_that_is_seen_in_two_of_more_pictures_it_is_said_that_no_third_tells_its_motion() {
    let folder = tempfile::tempdir().expect("a folder");
    for frame in 0..12_u32 {
        let is_l = |x: u32, y: u32, (left, top): (u32, u32)| {
            let (x, y) = (x.wrapping_sub(left), y.wrapping_sub(top));
            x < 24 && y < 32 && (x < 9 || y < 8)
        };
        // The second one is seen in the last two pictures.
        let second = (frame >= 10).then(|| (110, 70 + 3 * (frame - 10)));
        let is_light =
            |x: u32, y: u32| is_l(x, y, (20 + 4 * frame, 20)) || second.is_some_and(|place| is_l(x, y, place));
        let noise = |x: u32, y: u32| ((x * 31 + y * 17 + frame * 7) % 5) as u8;
        let value = |x: u32, y: u32| noise(x, y) + if is_light(x, y) { 180 } else { 60 };
        let picture = GrayImage::from_fn(160, 120, |x, y| Luma([value(x, y)]));
        picture.save(folder.path().join(format!("{frame:02}.png"))).expect("a picture");
    }
    let way = "--light --objects all";
    let document = json(&succeed(&format!("identify {} --fps 30 {way} --json", folder.path().display()), ""));
    let objects = document["objects"].as_array().expect("objects");
    let is_warned = |object: &serde_json::Value| {
        object["warnings"].as_array().into_iter().flatten().any(|warning| warning["code"] == "of_two_frames")
    };
    let told: Vec<_> = objects.iter().map(|object| (object["frames"].as_u64(), is_warned(object))).collect();
    assert_eq!(told, [(Some(12), false), (Some(2), true)], "{document}");
    let tracked = stderr(&run(&format!("track {} --fps 30 {way}", folder.path().display()), ""));
    assert_eq!(tracked.matches("its motion is that between two frames").count(), 1, "{tracked}");
}
