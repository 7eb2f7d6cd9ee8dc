use crate::support::{json, run, stderr, succeed};

const CAMERA: &str = "--motion plane --focal 900 --principal 320,240";

fn outlines(arguments: &str) -> String {
    succeed(&format!("simulate {CAMERA} --shape van --points 300 {arguments}"), "")
}

#[test]
fn a_plane_in_space_is_simulated_with_its_truth_and_identified_with_its_normal() {
    let outlines = outlines("--seconds 1 --plane 0.12,-0.08,0.5,0.1,0.05,0.12 --normal 0.46,0.35");
    let head = outlines.lines().nth(1).expect("a truth");
    assert!(head.ends_with("wx=0.12 wy=-0.08 wz=0.5 vx=0.1 vy=0.05 vz=0.12 nx=0.46 ny=0.35"), "{head}");
    let document = json(&succeed(&format!("identify - {CAMERA} --format json"), &outlines));
    let object = &document["objects"][0];
    assert_eq!((&object["motion"], &object["method"]), (&json("\"plane\""), &json("\"filter\"")));
    let truth = [("wx", 0.12), ("wy", -0.08), ("wz", 0.5), ("vx", 0.1), ("vy", 0.05), ("vz", 0.12)];
    for (name, truth) in truth {
        let parameter = &object["parameters"][name];
        let [value, std] = ["value", "std"].map(|field| parameter[field].as_f64().expect("a number"));
        assert!((value - truth).abs() < 5.0 * std && std < 0.01, "{name}: {value} +- {std}");
        assert_eq!(parameter["unit"], if name.starts_with('w') { "rad/s" } else { "1/s" });
    }
    let normal = &object["normal"];
    for (index, truth) in [0.46, 0.35, 1.0].into_iter().enumerate() {
        let [value, std] = ["value", "std"].map(|field| normal[field][index].as_f64().expect("a number"));
        let variance = normal["covariance"][index][index].as_f64().expect("a number");
        assert!((value - truth).abs() <= 5.0 * std && std < 0.05 && (variance - std * std).abs() < 1e-12, "{normal}");
    }
    assert_eq!((&object["ambiguity"], &object["warnings"]), (&json("null"), &json("[]")));
    let table = succeed(&format!("identify - {CAMERA}"), &outlines);
    let row = table.lines().find(|line| line.trim_start().starts_with("normal y ")).expect("a row of the normal");
    assert!(row.contains(" 0.350000 "), "{row}");
    let lines = succeed(&format!("track - {CAMERA}"), &outlines);
    let last = json(lines.lines().last().expect("a line"));
    assert_eq!(last["parameters"]["wz"]["value"], object["parameters"]["wz"]["value"]);
    assert_eq!(last["normal"], *normal);
}

#[test]
fn dynamics_that_a_plane_does_not_use_are_told_of() {
    let output = run(&format!("identify - {CAMERA} --dynamics velocity"), &outlines("--seconds 0.2"));
    let said = "--dynamics: not used for a plane in space";
    assert!(output.status.success() && stderr(&output).contains(said), "{}", stderr(&output));
}

#[test]
fn of_a_plane_that_only_turns_the_normal_and_the_velocity_are_null_with_the_reason() {
    // With other noise a second plane may pass for it too.
    let outlines = outlines("--seconds 1 --plane 0.1,-0.1,0.5,0,0,0 --seed 7");
    let document = json(&succeed(&format!("identify - {CAMERA} --json"), &outlines));
    let object = &document["objects"][0];
    assert!((object["parameters"]["wz"]["value"].as_f64().expect("a turn") - 0.5).abs() < 0.01);
    for name in ["vx", "vy", "vz"] {
        let parameter = &object["parameters"][name];
        assert_eq!((&parameter["value"], &parameter["observable"]), (&json("null"), &json("false")), "{name}");
    }
    assert_eq!((&object["normal"]["value"], &object["normal"]["observable"]), (&json("null"), &json("false")));
    let codes: Vec<_> = object["warnings"].as_array().expect("warnings").iter().map(|w| w["code"].clone()).collect();
    assert_eq!(codes, ["plane_hardly_moves"]);
}

#[test]
fn a_camera_that_is_missing_or_cannot_be_is_wrong_usage() {
    let outlines = outlines("--seconds 0.2");
    for command in ["identify -", "track -"] {
        for (arguments, part) in [
            ("--motion plane", "--focal"),
            ("--motion plane --focal 900", "--principal"),
            ("--motion plane --principal 320,240", "--focal"),
            ("--motion plane --focal 0 --principal 320,240", "not above 0"),
            ("--motion plane --focal -900 --principal 320,240", "not above 0"),
            ("--motion plane --focal NaN --principal 320,240", "not a finite number"),
            ("--motion plane --focal 900 --principal 320", "expected X,Y"),
            ("--motion plane --focal 900 --principal inf,240", "not a finite number"),
            ("--focal 900 --principal 320,240", "are for --motion plane"),
            ("--focal 900", "are for --motion plane"),
            ("--principal 320,240", "are for --motion plane"),
            ("--motion plane --focal 900 --principal 320,240 --method adaptive", "cannot be combined"),
            ("--motion plane --focal 900 --principal 320,240 --scale 0.1", "cannot be combined"),
            ("--motion plane --focal 900 --principal 320,240 --edge-uncertainty 1", "cannot be combined"),
        ] {
            let output = run(&format!("{command} {arguments}"), &outlines);
            assert_eq!(output.status.code(), Some(2), "{command} {arguments}: {}", stderr(&output));
            assert!(stderr(&output).contains(part), "{command} {arguments}: {}", stderr(&output));
        }
    }
    for (arguments, part) in [
        ("simulate --motion plane", "--focal"),
        ("simulate --plane 0,0,1,0,0,0", "--plane is for --motion plane"),
        ("simulate --normal 1,0", "--normal is for --motion plane"),
        ("simulate --motion plane --focal 900 --principal 0,0 --plane 1,2,3", "expected WX"),
        ("evaluate --motion plane --focal 900 --principal 0,0 --method icp --runs 1", "no motion in space"),
        ("evaluate --motion plane --focal 900 --principal 0,0 --acquisition", "--motion projective"),
    ] {
        let output = run(arguments, "");
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", stderr(&output));
        assert!(stderr(&output).contains(part), "{arguments}: {}", stderr(&output));
    }
}

#[test]
fn a_plane_in_space_is_evaluated_against_its_bound() {
    let arguments = "--shape van --frames 30 --runs 2 --no-timing --format json --seed 3";
    let document = json(&succeed(&format!("evaluate {CAMERA} {arguments}"), ""));
    let evaluation = &document["evaluations"][0];
    assert_eq!((&evaluation["motion"], &evaluation["noise"]), (&json("\"plane\""), &json("0.3")));
    let pooled = &evaluation["methods"]["filter"]["pooled"];
    assert_eq!((&pooled["runs"], &pooled["lost"]), (&json("2"), &json("0")));
    for name in ["wx", "wy", "wz", "vx", "vy", "vz", "nx", "ny"] {
        let ratio = pooled["parameters"][name]["ratio"].as_f64().expect("observable");
        assert!(ratio < 4.0, "{name}: {ratio}");
    }
}
