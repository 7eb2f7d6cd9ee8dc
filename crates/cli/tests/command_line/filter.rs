use serde_json::Value;

use crate::support::{json, run, sequence, stderr, stdout, succeed};

/// Frames of two shapes after one another, the second from frame 15 on.
fn first_one_then_another(frames_of_other: usize) -> String {
    let other = sequence(&format!("--shape square --omega 0 --b 0,0 --seconds {}", frames_of_other as f64 / 30.0));
    let moved = other.lines().skip(3).map(|line| {
        let fields: Vec<&str> = line.split(',').collect();
        let frame: u32 = fields[0].parse().expect("a frame");
        let (frame, x, y) = (frame + 15, fields[2], fields[3]);
        format!("{frame},{},{x},{y}\n", f64::from(frame) / 30.0)
    });
    sequence("") + &moved.collect::<String>()
}

fn first_object(document: &Value) -> &Value {
    &document["objects"][0]
}

fn warnings(object: &Value) -> Vec<&str> {
    object["warnings"].as_array().expect("a list").iter().map(|w| w["message"].as_str().expect("text")).collect()
}

#[test]
fn every_parameter_of_every_model_lies_within_five_standard_deviations_of_the_truth() {
    let rigid = ("rigid", "--omega 1.2 --b -3,4 --scale 0.1", vec![("omega", 1.2), ("b1", -0.3), ("b2", 0.4)]);
    let growing = vec![("sigma", -0.2), ("omega", 0.9), ("b1", 0.1), ("b2", -0.3)];
    let similarity = ("similarity", "--affine -0.2,0.9,-0.9,-0.2,0.1,-0.3 --scale 1", growing);
    let sheared = vec![("a1", 0.05), ("a2", 1.2), ("a3", -1.7), ("a4", -0.08), ("b1", -0.3), ("b2", 0.4)];
    let affine = ("affine", "--affine 0.05,1.2,-1.7,-0.08,-0.3,0.4 --scale 1", sheared);
    for (model, motion, truth) in [rigid, similarity, affine] {
        let csv = succeed(&format!("simulate --seconds 2 {motion}"), "");
        let document = json(&succeed(&format!("identify - --motion {model} --format json"), &csv));
        let object = first_object(&document);
        assert_eq!((&object["method"], &object["motion"]), (&"filter".into(), &model.into()));
        for (name, truth) in truth {
            let number = |field: &str| object["parameters"][name][field].as_f64().expect("a number");
            let (value, std) = (number("value"), number("std"));
            assert!(std > 0.0 && std < 0.02 && (value - truth).abs() < 5.0 * std, "{model} {name}: {value} +- {std}");
        }
    }
}

#[test]
fn hidden_arcs_and_outliers_do_not_lead_the_filter_astray() {
    let csv = succeed("simulate --seconds 2 --occlusion 0.2 --outliers 0.05", "");
    let document = json(&succeed("identify - --format json", &csv));
    let omega = &first_object(&document)["parameters"]["omega"];
    let (value, std) = (omega["value"].as_f64().expect("a number"), omega["std"].as_f64().expect("a number"));
    assert!((value - std::f64::consts::FRAC_PI_2).abs() < 5.0 * std && std < 0.01, "{value} +- {std}");
}

#[test]
fn the_turn_of_a_circle_is_unobservable_and_that_is_told() {
    let point = |frame: u32, k: u32| {
        let (time, angle) = (f64::from(frame) / 30.0, std::f64::consts::TAU * f64::from(k) / 200.0);
        format!("{frame},{time},{},{}\n", 0.1 * time + 0.5 * angle.cos(), 0.5 * angle.sin() - 0.2 * time)
    };
    let rows: String = (0..12).flat_map(|frame| (0..200).map(move |k| point(frame, k))).collect();
    let output = run("identify - --format json", &format!("frame,time,x,y\n{rows}"));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let document = json(&stdout(&output));
    let omega = &first_object(&document)["parameters"]["omega"];
    assert_eq!((&omega["value"], &omega["observable"]), (&Value::Null, &false.into()));
    assert_eq!(first_object(&document)["generator"], Value::Null);
    assert!(
        warnings(first_object(&document))
            .iter()
            .any(|text| text.starts_with("not observable") && text.contains("omega"))
    );
    assert!(stderr(&output).contains("not observable"), "{}", stderr(&output));
}

#[test]
fn what_a_square_may_have_turned_instead_is_told_and_not_that_it_cannot_be_seen() {
    let csv = sequence("--shape square --omega 1.5 --seconds 1 --fps 2 --points 400");
    let output = run("identify - --json", &csv);
    let document = json(&stdout(&output));
    let object = first_object(&document);
    let degrees = |value: &Value| value.as_f64().expect("a number").round();
    let is_as_it_was_turned = |ambiguity: &Value| {
        assert_eq!((degrees(&ambiguity["turn"]), degrees(&ambiguity["rival_turns"][0])), (43.0, -47.0), "{ambiguity}");
        assert_eq!(ambiguity["parameters"][0], "omega");
    };
    is_as_it_was_turned(&object["ambiguity"]);
    assert_eq!((&object["parameters"]["omega"]["observable"], &object["velocity"]), (&false.into(), &Value::Null));
    let told = warnings(object);
    assert!(
        told.len() == 1 && told[0].starts_with("ambiguous") && told[0].contains("-47.1 instead of 42.9"),
        "{told:?}"
    );
    assert!(stderr(&output).contains(told[0]), "{}", stderr(&output));
    let lines = succeed("track -", &csv);
    is_as_it_was_turned(&json(lines.lines().last().expect("a line"))["ambiguity"]);
    assert!(succeed("identify -", &csv).contains(" ambiguous "));
}

#[test]
fn the_frames_counted_in_warnings_are_those_of_the_table_where_the_object_was_begun_anew() {
    let output = run("identify -", &first_one_then_another(40));
    let [table, told] = [stdout(&output), stderr(&output)];
    assert!(table.contains("55 frames, 30 rejected") && told.contains("30 of 55 frames rejected"), "{table}{told}");
}

#[test]
fn a_frame_that_shows_something_else_is_rejected_with_its_reason() {
    let lines = succeed("track", &first_one_then_another(4));
    let frames: Vec<Value> = lines.lines().map(json).collect();
    assert_eq!(frames.len(), 19);
    assert_eq!((&frames[14]["phase"], &frames[14]["accepted"]), (&"tracking".into(), &true.into()));
    assert_eq!((&frames[18]["phase"], &frames[18]["accepted"]), (&"lost".into(), &false.into()));
    let reason = frames[15]["reason"].as_str().expect("a reason");
    assert!(reason.contains("frame 15") && reason.contains("does not fit the object"), "{reason}");
    assert_eq!(frames[14]["reason"], Value::Null);

    let document = json(&succeed("identify - --format json", &first_one_then_another(4)));
    let object = first_object(&document);
    assert_eq!((&object["frames"], &object["frames_rejected"]), (&19.into(), &4.into()));
    for text in ["4 of 19 frames rejected", "lost at the end"] {
        assert!(warnings(object).iter().any(|warning| warning.contains(text)), "{text}: {:?}", warnings(object));
    }
}

#[test]
fn two_rejected_frames_of_a_short_sequence_are_named_and_not_warned_of_as_many() {
    let document = json(&succeed("identify - --format json", &first_one_then_another(2)));
    let object = first_object(&document);
    assert_eq!((&object["frames"], &object["frames_rejected"]), (&17.into(), &2.into()));
    let codes: Vec<_> = object["warnings"].as_array().expect("a list").iter().map(|told| &told["code"]).collect();
    assert!(codes.contains(&&"frame_rejected".into()) && !codes.contains(&&"frames_rejected".into()), "{codes:?}");
}

#[test]
fn nothing_is_stated_of_an_object_that_was_given_up_until_the_next_one_is_known() {
    let document = json(&succeed("identify - --format json", &first_one_then_another(30)));
    let object = first_object(&document);
    assert_eq!(object["parameters"]["omega"]["value"], Value::Null);
    for text in
        ["begun anew at the end, and its motion is not known again yet; it was last known at 0.4667 s", "again 1 time"]
    {
        assert!(warnings(object).iter().any(|warning| warning.contains(text)), "{text}: {:?}", warnings(object));
    }
    let document = json(&succeed("identify - --format json", &first_one_then_another(45)));
    let omega = first_object(&document)["parameters"]["omega"]["value"].as_f64().expect("a number");
    assert!(omega.abs() < 0.1, "{omega}");
}
