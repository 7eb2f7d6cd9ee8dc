use crate::support::{json, run, stderr, succeed};

/// A tilted turntable: c is along b.
const MOTION: &str = "--projective 0,1.6,-1.6,0,-3,4,-0.012,0.016";

fn outlines() -> String {
    succeed(&format!("simulate --motion projective {MOTION} --seconds 1 --noise 0.001 --points 200"), "")
}

#[test]
fn a_projective_motion_is_simulated_with_its_truth_and_identified_with_eight_parameters() {
    let outlines = outlines();
    assert!(outlines.contains("# truth a1=0 a2=1.6 a3=-1.6 a4=0 b1=-3 b2=4 c1=-0.012 c2=0.016 scale=0.1 v1="));
    let document = json(&succeed("identify - --motion projective --format json", &outlines));
    let object = &document["objects"][0];
    assert_eq!(object["motion"], "projective");
    // In the image: b times the scale, c over it.
    let truth =
        [("a1", 0.0), ("a2", 1.6), ("a3", -1.6), ("a4", 0.0), ("b1", -0.3), ("b2", 0.4), ("c1", -0.12), ("c2", 0.16)];
    for (name, truth) in truth {
        let [value, std] = ["value", "std"].map(|field| object["parameters"][name][field].as_f64().expect("a number"));
        assert!((value - truth).abs() < 5.0 * std && std < 0.01, "{name}: {value} +- {std}");
    }
    let c1 = object["parameters"]["c1"]["value"].as_f64().expect("a number");
    assert_eq!(object["generator"][2][0].as_f64(), Some(c1));
    // No family is larger.
    assert_eq!(&object["warnings"], &json("[]"));
    assert_eq!(object["dynamics"]["held"], "generator");
    let table = succeed("identify - --motion projective --scale 0.1", &outlines);
    let row = table.lines().find(|line| line.trim_start().starts_with("c2 ")).expect("a row of c2");
    assert!(row.contains(" 0.016"), "{row}");
}

#[test]
fn dynamics_are_chosen_for_projective_motion_too_and_an_uncertain_edge_widens_its_deviations() {
    let outlines = outlines();
    let output = run("identify - --motion projective --dynamics velocity", &outlines);
    assert!(output.status.success() && !stderr(&output).contains("--dynamics"), "{}", stderr(&output));
    let document = json(&succeed("identify - --motion projective --edge-uncertainty 0.002 --format json", &outlines));
    for (name, parameter) in document["objects"][0]["parameters"].as_object().expect("parameters") {
        let [all, random] = ["std", "std_random"].map(|field| parameter[field].as_f64().expect("a number"));
        assert!(all > 1.05 * random, "{name}: {parameter}");
    }
}

#[test]
fn the_stream_and_the_adaptive_method_have_eight_parameters_too() {
    let outlines = outlines();
    let lines = succeed("track - --motion projective", &outlines);
    let last = json(lines.lines().last().expect("a line"));
    assert!((last["parameters"]["c2"]["value"].as_f64().expect("a number") - 0.16).abs() < 0.02, "{last}");
    let document = json(&succeed("identify - --motion projective --method adaptive --format json", &outlines));
    let c2 = document["objects"][0]["parameters"]["c2"]["value"].as_f64().expect("a number");
    assert!((c2 - 0.16).abs() < 0.05, "{c2}");
}

#[test]
fn projective_motion_is_evaluated_against_its_bound() {
    let arguments = format!("evaluate {MOTION} --frames 20 --runs 2 --points 150 --format json");
    let evaluation = &json(&succeed(&arguments, ""))["evaluations"][0];
    assert_eq!(evaluation["motion"], "projective", "{evaluation}");
    // Area moments have no projective pose and are left out where no method is asked for.
    assert!(evaluation["methods"]["icp"].is_object() && evaluation["methods"]["moments"].is_null());
    let ratio = evaluation["methods"]["filter"]["pooled"]["ratio"].as_f64().expect("a number");
    assert!(ratio < 3.0, "{ratio}");
    let unsupported = run(&format!("evaluate {MOTION} --frames 20 --runs 1 --method moments"), "");
    assert_eq!(unsupported.status.code(), Some(2));
    assert!(stderr(&unsupported).contains("projective"), "{}", stderr(&unsupported));
}

#[test]
fn a_motion_outside_the_family_that_is_asked_for_is_wrong_usage() {
    for command in ["simulate", "evaluate"] {
        let output = run(&format!("{command} {MOTION} --motion affine"), "");
        assert_eq!(output.status.code(), Some(2));
        assert!(
            stderr(&output).contains("--motion affine does not contain the motion of --projective"),
            "{}",
            stderr(&output)
        );
    }
    let output = run("simulate --projective 1,2,3", "");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("expected A1,A2,A3,A4,B1,B2,C1,C2, found 3 number(s)"), "{}", stderr(&output));
}
