use crate::support::{json, run, sequence, stderr, stdout, succeed};

#[test]
fn the_coefficients_are_those_of_a_curve_that_the_points_lie_on() {
    let circle: String = (0..60)
        .map(|k| std::f64::consts::TAU * f64::from(k) / 60.0)
        .map(|angle| format!("0,0,{},{}\n", 1.0 + 2.0 * angle.cos(), 2.0 * angle.sin()))
        .collect();
    let csv = format!("frame,time,x,y\n{circle}");
    let document = json(&succeed("fit - --degree 2 --format json", &csv));
    assert_eq!(document["schema"], "freeform.fit/1");
    let outline = &document["outlines"][0];
    let a = |name: &str| {
        outline["coefficients"][name].as_f64().expect("a number")
            / outline["coefficients"]["a_20"].as_f64().expect("a number")
    };
    // x^2 + y^2 - 2 x + 1 - r^2 with r near 2: the level sets pull it a little inwards or outwards.
    assert!((a("a_02") - 1.0).abs() < 1e-9 && a("a_11").abs() < 1e-9);
    assert!((a("a_10") + 2.0).abs() < 1e-9 && a("a_01").abs() < 1e-9);
    assert!((a("a_00") + 3.0).abs() < 0.1);
    assert_eq!(outline["bounded"], true);
    assert!(outline["residual"]["geometric"].as_f64().expect("a number") < 0.05);
    assert_eq!(outline["levels"][0]["lines"].as_array().map(Vec::len), Some(2));
    let centre = &outline["related_points"][0];
    assert!((centre["x"].as_f64().expect("a number") - 1.0).abs() < 1e-9);
}

#[test]
fn a_quartic_has_six_lines_three_related_points_and_four_invariants() {
    let document = json(&succeed("fit - --frame 2 --format json", &sequence("")));
    let outlines = document["outlines"].as_array().expect("a list");
    assert_eq!(outlines.len(), 1);
    assert_eq!(outlines[0]["frame"], 2);
    assert_eq!(outlines[0]["coefficients"].as_object().map(serde_json::Map::len), Some(15));
    assert_eq!(outlines[0]["levels"][0]["lines"].as_array().map(Vec::len), Some(4));
    assert_eq!(outlines[0]["levels"][1]["lines"].as_array().map(Vec::len), Some(2));
    assert_eq!(outlines[0]["related_points"].as_array().map(Vec::len), Some(3));
    assert_eq!(outlines[0]["invariants"].as_array().map(Vec::len), Some(4));
}

#[test]
fn the_value_of_a_related_point_is_that_of_the_printed_polynomial_made_monic() {
    let csv = sequence("--seconds 0.1");
    for degree in [2, 4, 6, 8] {
        let document = json(&succeed(&format!("fit - --degree {degree} --frame 1 --format json"), &csv));
        let outline = &document["outlines"][0];
        let number = |value: &serde_json::Value| value.as_f64().expect("a number");
        let coefficients = outline["coefficients"].as_object().expect("coefficients");
        let leading = number(&coefficients[&format!("a_{degree}0")]);
        let points = outline["related_points"].as_array().expect("related points");
        assert!(!points.is_empty());
        for d in points {
            let (x, y, value) = (number(&d["x"]), number(&d["y"]), number(&d["value"]));
            let terms: Vec<f64> = coefficients
                .iter()
                .map(|(name, a)| {
                    let exponent = |at: usize| i32::from(name.as_bytes()[at] - b'0');
                    number(a) / leading * x.powi(exponent(2)) * y.powi(exponent(3))
                })
                .collect();
            let (sum, size) = (terms.iter().sum::<f64>(), terms.iter().map(|term| term.abs()).sum::<f64>());
            assert!((sum - value).abs() < 1e-10 * size, "degree {degree}: {sum} and {value}");
            // The comparison means something: the value is not lost among the terms.
            assert!(value.abs() > 1e-8 * size, "degree {degree}: {value} of {size}");
        }
    }
}

#[test]
fn every_method_and_degree_prints_a_table() {
    let csv = sequence("--seconds 0.02");
    for degree in [2, 4, 6, 8] {
        for method in ["3l", "gs3l --kappa 1e-4", "bounded --margin 0.1 --offset 0.2"] {
            let table = succeed(&format!("fit - --degree {degree} --method {method}"), &csv);
            assert!(table.contains(&format!("degree {degree}, 120 points")), "{table}");
            assert!(table.contains("bounded") && table.contains("a_00"), "{table}");
        }
    }
}

#[test]
fn a_frame_that_is_not_there_has_no_result() {
    let output = run("fit - --frame 99", &sequence(""));
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stdout(&output), "");
    assert!(stderr(&output).contains("no frame 99"));
}

#[test]
fn parts_of_the_curve_beside_the_outline_are_told() {
    let output = run("fit - --frame 0", &sequence("--shape glider --omega -1.047 --points 400"));
    assert!(stdout(&output).contains("\n  beside outline  1 part(s) of the curve, about ("), "{}", stdout(&output));
    assert!(stderr(&output).contains("1 of 1 curve(s) have a stray part away from the outline"), "{}", stderr(&output));
    let document = json(&succeed("fit - --frame 0 --format json", &sequence("--shape bird")));
    assert_eq!(document["outlines"][0]["stray_parts"], json("[]"));
}

/// The invariants of every outline.
fn invariants(arguments: &str, csv: &str) -> Vec<Vec<f64>> {
    let document = json(&succeed(&format!("fit - --format json {arguments}"), csv));
    let outlines = document["outlines"].as_array().expect("a list").clone();
    let values = |outline: &serde_json::Value| {
        let list = outline["invariants"].as_array().expect("invariants").clone();
        list.iter().map(|value| value.as_f64().expect("a number")).collect()
    };
    outlines.iter().map(values).collect()
}

fn largest_change(invariants: &[Vec<f64>]) -> f64 {
    let changes = invariants[1..].iter().flat_map(|list| list.iter().zip(&invariants[0]).map(|(a, b)| (a - b).abs()));
    changes.fold(0.0, f64::max)
}

#[test]
fn the_invariants_of_an_unbounded_curve_keep_sign_and_order_as_the_outline_turns() {
    let csv = succeed("simulate --shape glider --omega 1.57 --b 0,0 --fps 4 --seconds 1.5 --noise 0", "");
    let change = largest_change(&invariants("--method 3l", &csv));
    assert!(change < 0.01, "{change}");
}

#[test]
fn the_invariants_of_a_sheared_outline_stay_where_it_is_normalised_affinely() {
    let csv =
        succeed("simulate --shape glider --affine 0.5,1,-0.4,-0.3,0,0 --scale 1 --fps 4 --seconds 1.5 --noise 0", "");
    let [similarity, affine] =
        ["similarity", "affine"].map(|choice| largest_change(&invariants(&format!("--normalise {choice}"), &csv)));
    assert!(affine < 0.01 && similarity > 5.0 * affine, "{similarity} {affine}");
}

#[test]
fn related_points_and_invariants_have_deviations() {
    let document = json(&succeed("fit - --frame 2 --format json", &sequence("--noise 0.005")));
    let outline = &document["outlines"][0];
    let std = outline["invariants_std"].as_array().expect("deviations");
    assert_eq!(std.len(), 4);
    assert!(std.iter().all(|value| value.as_f64().is_some_and(|std| std > 0.0 && std < 1.0)), "{std:?}");
    let point = &outline["related_points"][0]["std"];
    assert!(point[0].as_f64().is_some_and(|std| std > 0.0 && std < 0.5), "{point}");
}
