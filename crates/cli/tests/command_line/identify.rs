use serde_json::Value;

use crate::support::{json, run, sequence, stderr, stdout, succeed};

/// Field names of an object in alphabetical order.
fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value.as_object().expect("an object").keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

#[test]
fn the_json_has_the_fields_of_the_contract_and_says_what_b_is_and_what_was_left_out() {
    let csv = sequence("");
    let document = json(&succeed("identify - --format json --scale 0.1", &csv));
    assert_eq!(document["schema"], "freeform.identify/2");
    assert_eq!(keys(&document), ["b", "left_out", "objects", "schema"]);
    assert_eq!(keys(&document["b"]), ["point", "scale", "unit"]);
    assert_eq!(keys(&document["left_out"]), ["count", "pictures"]);
    let object = &document["objects"][0];
    let fields = ["frames", "frames_rejected", "generator", "method", "motion", "object", "parameters", "warnings"];
    let mut with_later_ones = [&["ambiguity", "dynamics", "unstated", "velocity"][..], &fields].concat();
    with_later_ones.sort_unstable();
    assert_eq!(keys(object), with_later_ones);
    assert_eq!((&object["ambiguity"], keys(&object["velocity"])), (&Value::Null, vec!["point", "std", "value"]));
    assert_eq!((&object["object"], &object["motion"]), (&"0".into(), &"rigid".into()));
    assert_eq!((&object["frames"], &object["frames_rejected"]), (&15.into(), &0.into()));
    assert_eq!(keys(&object["parameters"]), ["b1", "b2", "omega"]);
    for (name, unit) in [("omega", "rad/s"), ("b1", "1/s"), ("b2", "1/s")] {
        let parameter = &object["parameters"][name];
        let fields = ["observable", "reason", "std", "std_random", "std_systematic", "unit", "value"];
        let with_aliases = ["aliases", "observable", "reason", "std", "std_random", "std_systematic", "unit", "value"];
        assert_eq!(keys(parameter), if name == "omega" { &with_aliases[..] } else { &fields[..] });
        assert!(parameter["value"].is_f64() && parameter["observable"] == true && parameter["unit"] == unit);
        assert!(parameter["reason"].is_null());
    }
    let generator = &object["generator"];
    assert_eq!(generator[0][1], object["parameters"]["omega"]["value"]);
    assert_eq!(generator[1][2], object["parameters"]["b2"]["value"]);
    assert_eq!(generator[2], json("[0.0, 0.0, 0.0]"));
}

#[test]
fn the_adaptive_method_says_that_it_gives_no_standard_deviation() {
    let document = json(&succeed("identify - --method adaptive --format json", &sequence("")));
    assert_eq!(document["objects"][0]["method"], "adaptive");
    assert_eq!(document["objects"][0]["parameters"]["omega"]["std"], Value::Null);
}

#[test]
fn an_affine_motion_has_six_parameters() {
    let document = json(&succeed("identify - --motion affine --format json", &sequence("")));
    assert_eq!(keys(&document["objects"][0]["parameters"]), ["a1", "a2", "a3", "a4", "b1", "b2"]);
    assert_eq!(document["objects"][0]["motion"], "affine");
}

#[test]
fn the_scale_divides_the_velocity_and_nothing_else() {
    let csv = sequence("");
    let image = json(&succeed("identify - --format json", &csv));
    let space = json(&succeed("identify - --format json --scale 0.5", &csv));
    let value =
        |document: &Value, name: &str| document["objects"][0]["parameters"][name]["value"].as_f64().expect("a number");
    assert_eq!(value(&image, "omega"), value(&space, "omega"));
    for name in ["b1", "b2"] {
        assert!((value(&space, name) - 2.0 * value(&image, name)).abs() < 1e-12);
    }
}

#[test]
fn every_object_has_its_own_result() {
    let one = sequence("--shape glider --omega -1 --b 0,1");
    let other = sequence("--shape bird");
    let rows = |csv: &str, name: &str| csv.lines().skip(3).map(|line| format!("{line},{name}\n")).collect::<String>();
    let csv = format!("frame,time,x,y,object\n{}{}", rows(&one, "glider <1>"), rows(&other, "bird"));
    let document = json(&succeed("identify - --format json", &csv));
    let objects = document["objects"].as_array().expect("a list");
    assert_eq!(objects.iter().map(|object| &object["object"]).collect::<Vec<_>>(), ["glider <1>", "bird"]);
    let alone = json(&succeed("identify - --format json", &one));
    assert_eq!(objects[0]["parameters"], alone["objects"][0]["parameters"]);
}

#[test]
fn the_csv_has_one_row_per_object_and_parameter() {
    let csv = succeed("identify - --method adaptive --format csv", &sequence(""));
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[0], "object,method,motion,frames,frames_rejected,parameter,value,std,unit,observable,reason");
    assert_eq!(lines.len(), 4);
    assert!(
        lines[1].starts_with("0,adaptive,rigid,15,0,omega,") && lines[1].ends_with(",,rad/s,true,"),
        "{}",
        lines[1]
    );
}

#[test]
fn the_velocity_of_the_middle_is_in_every_format_and_so_is_why_it_or_a_parameter_is_not_stated() {
    let circle = sequence("--shape circle --seconds 1");
    let csv = succeed("identify - --format csv", &circle);
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let names: Vec<&str> = rows[1..].iter().map(|row| row[5]).collect();
    assert_eq!(names, ["omega", "b1", "b2", "v1", "v2"]);
    assert_eq!((rows[1][6], rows[1][9], rows[1][10]), ("", "false", "unobservable"));
    assert_eq!((rows[4][9], rows[4][10]), ("true", ""));
    let whole = json(&succeed("identify - --format json", &circle));
    assert_eq!(whole["objects"][0]["parameters"]["omega"]["reason"], "unobservable");
    // Read by one parser: that of JSON rounds the last digit otherwise.
    assert_eq!(whole["objects"][0]["velocity"]["value"][0], json(rows[4][6]));
    let last = json(succeed("track", &circle).lines().last().expect("a line"));
    assert_eq!(last["velocity"], whole["objects"][0]["velocity"]);
    assert_eq!(last["parameters"], whole["objects"][0]["parameters"]);

    // Another outline in every second frame, so that the others are not to be trusted.
    let (one, other) = (sequence(""), sequence("--shape van --omega -1"));
    let rows = |csv: &str| -> Vec<String> {
        csv.lines()
            .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
            .map(|line| format!("{line}\n"))
            .collect()
    };
    let (one, other) = (rows(&one), rows(&other));
    let frames = one.chunks(120).zip(other.chunks(120)).enumerate();
    let turns: String =
        frames.map(|(frame, (one, other))| if frame % 2 == 0 { one.concat() } else { other.concat() }).collect();
    let lost = format!("frame,time,x,y\n{turns}");
    let table = succeed("identify -", &lost);
    for name in ["omega", "v1", "v2"] {
        let row = table.lines().find(|line| line.trim_start().starts_with(name)).expect("a row");
        assert!(row.contains("unknown"), "{table}");
    }
    assert!(table.contains("poses over time: --trajectory FILE"), "{table}");
    let lost_json = json(&succeed("identify - --json", &lost));
    assert_eq!(lost_json["objects"][0]["parameters"]["b1"]["reason"], "unknown");
    let folder = tempfile::tempdir().expect("a folder");
    let with = succeed(&format!("identify - --trajectory {}/t.csv", folder.path().display()), &lost);
    assert!(!with.contains("poses over time"), "{with}");
    assert!(!succeed("identify -", &sequence("")).contains("poses over time"));
}

#[test]
fn velocities_in_the_table_are_in_lengths_per_second_and_in_json_in_the_unit_of_the_contract() {
    let table = succeed("identify -", &sequence(""));
    let unit = |name: &str| {
        table.lines().find(|line| line.trim_start().starts_with(name)).expect("a row").contains(" lengths/s ")
    };
    assert!(unit("b1") && unit("v2") && !unit("omega"), "{table}");
}

#[test]
fn the_table_shows_the_truth_where_the_file_tells_it() {
    let csv = sequence("--seconds 3 --noise 0");
    let table = succeed("identify - --scale 0.1", &csv);
    assert!(table.lines().nth(1).is_some_and(|head| head.ends_with("error")), "{table}");
    assert!(table.contains(" 1.57080 ") && table.contains(" -3.00000 "), "{table}");
    let without: String = csv.lines().skip(2).map(|line| format!("{line}\n")).collect();
    assert!(!succeed("identify -", &without).contains("truth"));
    let given = succeed("identify - --truth -1.5,2,-3", &without);
    assert!(given.contains("-1.50000") && given.contains("truth"), "{given}");
}

#[test]
fn a_truth_that_the_motion_model_does_not_hold_is_told_to_be_left_out() {
    let csv = sequence("--affine 0.1,0,0,0.1,0.2,0 --scale 1");
    let output = run("identify -", &csv);
    assert!(!stdout(&output).contains("truth"), "{}", stdout(&output));
    assert!(stderr(&output).contains("warning: the truth in the file is no rigid motion"), "{}", stderr(&output));
    let output = run("identify - --motion similarity", &csv);
    assert!(stdout(&output).contains("truth") && stderr(&output).is_empty(), "{}", stderr(&output));
}

#[test]
fn the_middle_of_the_object_moves_as_the_motion_says_and_the_scale_divides_its_velocity() {
    let csv = sequence("--seconds 1 --points 400 --shape glider");
    for scale in [1.0, 0.1] {
        let object = &json(&succeed(&format!("identify - --json --scale {scale}"), &csv))["objects"][0];
        let number = |value: &Value| value.as_f64().expect("a number");
        let pair = |name: &str| [0, 1].map(|i| number(&object["velocity"][name][i]));
        let [[x, y], velocity, deviations] = ["point", "value", "std"].map(pair);
        assert!(x.hypot(y) < 2.0 / scale && deviations.iter().all(|std| *std > 0.0 && *std < 0.01 / scale));
        for (row, found) in velocity.into_iter().enumerate() {
            let [a, b, c] = [0, 1, 2].map(|column| number(&object["generator"][row][column]));
            assert!((a * x + b * y + c - found).abs() < 1e-9, "{found}");
        }
    }
    let table = succeed("identify - --scale 0.1", &csv);
    let line = table.lines().last().expect("a line");
    assert!(line.starts_with("v: velocity of the object's middle, at ("), "{table}");
    let rows = table.lines().filter(|line| line.starts_with("  v") && line.split_whitespace().count() > 5).count();
    assert_eq!(rows, 2, "{table}");
    assert!(!succeed("identify - --method adaptive", &csv).contains("middle"));
}

#[test]
fn the_truth_of_the_file_is_told_in_the_units_of_the_result() {
    let csv = sequence("");
    assert!(succeed("identify -", &csv).contains(" -0.300000 "));
    assert!(succeed("identify - --scale 0.1", &csv).contains(" -3.00000 "));
}

#[test]
fn frames_that_are_no_outline_are_counted_and_the_rest_is_used() {
    let csv = sequence("");
    let csv = csv + "20,5.0,1,1\n21,5.1,1,1\n21,5.1,1,1\n21,5.1,1,1\n";
    let output = run("identify - --format json", &csv);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let object = &json(&stdout(&output))["objects"][0];
    assert_eq!((&object["frames"], &object["frames_rejected"]), (&17.into(), &2.into()));
    let warnings = object["warnings"].as_array().expect("a list");
    assert!(warnings.iter().any(|warning| warning["message"].as_str().is_some_and(|text| text.contains("frame 21"))));
    assert_eq!(stderr(&output).lines().filter(|line| line.contains("rejected")).count(), 2);
}

#[test]
fn nothing_is_found_of_an_object_that_was_seen_once() {
    let csv = sequence("--seconds 0.03");
    let output = run("identify - --format json", &csv);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stdout(&output), "");
    assert_eq!(stderr(&output).lines().count(), 1);
    assert!(stderr(&output).contains("at least 2"), "{}", stderr(&output));
}

#[test]
fn objects_that_are_followed_side_by_side_are_found_as_each_would_be_alone_in_the_order_they_appear() {
    let shapes = ["bird", "van", "glider", "bird", "van"];
    let sequences: Vec<String> = shapes
        .iter()
        .enumerate()
        .map(|(index, shape)| sequence(&format!("--shape {shape} --omega 0.{}", index + 3)))
        .collect();
    let alone: Vec<Value> =
        sequences.iter().map(|csv| json(&succeed("identify - --format json", csv))["objects"][0].clone()).collect();
    // Row by row of the rows of each frame, named by the object.
    let mut mixed = String::from("frame,time,x,y,object\n");
    for frame in 0..15 {
        for (index, csv) in sequences.iter().enumerate() {
            for row in csv.lines().filter(|row| row.starts_with(&format!("{frame},"))) {
                mixed.push_str(&format!("{row},object {index}\n"));
            }
        }
    }
    let document = json(&succeed("identify - --format json", &mixed));
    let objects = document["objects"].as_array().expect("a list");
    assert_eq!(objects.len(), shapes.len());
    for (index, (object, alone)) in objects.iter().zip(&alone).enumerate() {
        assert_eq!(object["object"], format!("object {index}"));
        assert_eq!(object["parameters"], alone["parameters"], "object {index}");
    }
    let frames: Vec<Value> = succeed("track", &mixed).lines().map(|line| json(line)["object"].clone()).collect();
    assert_eq!(frames.len(), 15 * shapes.len());
    assert!(frames.iter().enumerate().all(|(line, object)| *object == format!("object {}", line % shapes.len())));
}

#[test]
fn what_frames_gave_comes_in_the_order_of_the_input_however_unequal_the_objects_are() {
    // More points than are read ahead; the first object is most of the work, the last one appears late.
    let (frames, late) = (150, 100);
    let sequences = [1600, 60, 60, 200]
        .map(|points| succeed(&format!("simulate --points {points} --seconds 5 --omega 1 --b 0,0"), ""));
    let mut csv = String::from("frame,time,x,y,object\n");
    let mut expected = Vec::new();
    let mut rows = sequences.each_ref().map(|csv| csv.lines().filter(|row| !row.starts_with(['#', 'f'])).peekable());
    for frame in 0..frames {
        for (object, rows) in rows.iter_mut().enumerate() {
            let is_seen = object < 3 || frame >= late;
            // Some frames are no outline.
            let is_point = (frame + object) % 40 == 39;
            let mut row_count = 0;
            while let Some(row) = rows.next_if(|row| row.starts_with(&format!("{frame},"))) {
                if is_seen && (!is_point || row_count == 0) {
                    csv.push_str(&format!("{row},object {object}\n"));
                }
                row_count += 1;
            }
            if is_seen {
                expected.push((format!("object {object}"), frame.to_string(), (!is_point).to_string()));
            }
        }
    }
    let folder = tempfile::tempdir().expect("a folder");
    let trace = folder.path().join("trace.csv");
    succeed(&format!("identify - --quiet --trace {}", trace.display()), &csv);
    let trace = std::fs::read_to_string(trace).expect("the trace");
    let observed: Vec<_> = trace
        .lines()
        .skip(1)
        .map(|row| {
            let fields: Vec<&str> = row.split(',').collect();
            (fields[0].to_owned(), fields[1].to_owned(), fields[4].to_owned())
        })
        .collect();
    assert_eq!(observed, expected);
}

#[test]
fn objects_are_listed_as_they_first_appear_though_it_be_in_a_frame_that_is_no_outline() {
    // The first frames of the first object and all of the third one are single points; the second object is most of the work.
    let objects = [("a point at first", 60, 0), ("large", 1600, 0), ("a point", 60, 3), ("late", 60, 5)];
    let sequences = objects.map(|(_, points, _)| succeed(&format!("simulate --points {points} --seconds 0.5"), ""));
    let mut csv = String::from("frame,time,x,y,object\n");
    for frame in 0..15 {
        for ((name, _, first), sequence) in objects.iter().zip(&sequences).filter(|((_, _, first), _)| frame >= *first)
        {
            let is_point = *name == "a point" || *name == "a point at first" && frame < *first + 8;
            let rows = sequence.lines().filter(|row| row.starts_with(&format!("{frame},")));
            rows.take(if is_point { 1 } else { usize::MAX }).for_each(|row| csv.push_str(&format!("{row},{name}\n")));
        }
    }
    let document = json(&succeed("identify - --quiet --format json", &csv));
    let listed = document["objects"].as_array().expect("a list").iter().map(|object| {
        let count = |field: &str| object[field].as_u64().expect("a number");
        (object["object"].as_str().expect("a name"), count("frames"), count("frames_rejected"))
    });
    let expected = [("a point at first", 15, 8), ("large", 15, 0), ("a point", 12, 12), ("late", 10, 0)];
    assert_eq!(listed.collect::<Vec<_>>(), expected);
}

/// The rows of every frame taken in steps of 47 of 120, which are all of them in an order that is not the contour's.
fn out_of_order(csv: &str) -> String {
    let (head, rows): (Vec<&str>, Vec<&str>) = csv.lines().partition(|line| line.starts_with(['#', 'f']));
    let rows = rows.chunks(120).flat_map(|frame| (0..120).map(|index| frame[47 * index % 120]));
    head.into_iter().chain(rows).map(|line| format!("{line}\n")).collect()
}

#[test]
fn rows_that_do_not_follow_the_contour_are_told_once_whatever_the_method() {
    let in_order = sequence("");
    let shuffled = out_of_order(&in_order);
    let told = |command: &str, csv: &str| {
        stderr(&run(command, csv))
            .matches("warning[points_out_of_order]: object 0: frame 0: the points do not follow the contour")
            .count()
    };
    for command in ["identify -", "identify - --method adaptive", "track -"] {
        assert_eq!(told(command, &shuffled), 1, "{command}");
        assert_eq!(told(command, &in_order), 0, "{command}");
    }
    assert_eq!(told("track - --quiet", &shuffled), 0);
}

#[test]
fn outlines_of_pictures_follow_the_contour_however_deep_its_notches_are() {
    let folder = tempfile::tempdir().expect("a folder");
    for spikes in [3.0_f64, 12.0] {
        let frames: Vec<String> = (0..3_u8)
            .map(|frame| {
                let picture = image::GrayImage::from_fn(200, 200, |column, row| {
                    let (x, y) = (f64::from(column) - 98.0 - f64::from(frame), f64::from(row) - 100.0);
                    let radius = 90.0 * (0.6 + 0.4 * (spikes * y.atan2(x)).cos() + 0.05 * x / 90.0);
                    image::Luma([if x.hypot(y) < radius { 255 } else { 0 }])
                });
                let path = folder.path().join(format!("{spikes}-{frame}.png"));
                picture.save(&path).expect("a picture");
                path.to_str().expect("UTF-8").to_owned()
            })
            .collect();
        let output = run(&format!("identify {}", frames.join(" ")), "");
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(!stderr(&output).contains("contour"), "{}", stderr(&output));
    }
}

#[test]
fn the_method_that_was_removed_is_wrong_usage_and_the_error_names_its_replacement() {
    for command in ["identify", "track"] {
        let output = run(&format!("{command} - --method curve"), &sequence(""));
        assert_eq!(output.status.code(), Some(2), "{command}");
        assert!(stderr(&output).contains("use --method filter"), "{}", stderr(&output));
    }
}
