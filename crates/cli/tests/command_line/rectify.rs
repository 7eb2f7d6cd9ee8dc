use nalgebra::{Matrix3, Point2, Projective2};

use crate::support::{file, json, run, sequence, stderr, stdout, succeed};

/// A picture of a plane from aside, y upwards.
fn picture_from_plane() -> Projective2<f64> {
    Projective2::from_matrix_unchecked(Matrix3::new(900.0, 300.0, 1900.0, 10.0, 800.0, 1100.0, 0.0, 0.35, 3.0))
}

/// Outlines as they are seen in that picture.
fn seen(outlines: &str) -> String {
    let map = picture_from_plane();
    let seen = outlines.lines().filter(|line| !line.starts_with('#')).map(|line| {
        let fields: Vec<&str> = line.split(',').collect();
        match (fields[2].parse::<f64>(), fields[3].parse::<f64>()) {
            (Ok(x), Ok(y)) => {
                let p = map * Point2::new(x, y);
                format!("{},{},{},{}", fields[0], fields[1], p.x, p.y)
            }
            _ => line.to_owned(),
        }
    });
    seen.collect::<Vec<_>>().join("\n") + "\n"
}

/// The arguments of `rectify` for points of the plane.
fn pairs(points: &[(f64, f64)]) -> String {
    let pair = |&(u, v): &(f64, f64)| {
        let p = picture_from_plane() * Point2::new(u, v);
        format!("{},{}={u},{v}", p.x, p.y)
    };
    points.iter().map(pair).collect::<Vec<_>>().join(" ")
}

#[test]
fn a_rigid_motion_in_a_tilted_plane_is_found_in_the_plane_by_four_points() {
    let folder = tempfile::tempdir().expect("a folder");
    let map = succeed(&format!("rectify {}", pairs(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])), "");
    assert_eq!(map.lines().count(), 4);
    let plane = file(folder.path(), "plane.txt", &map);
    let outlines = seen(&succeed("simulate --omega 1.2 --b -2,1 --seconds 1 --noise 0.001 --points 200", ""));
    let numbers: Vec<&str> = map.lines().skip(1).flat_map(str::split_whitespace).collect();
    for given in [plane, numbers.join(",")] {
        let document = json(&succeed(&format!("identify - --rectify {given} --format json"), &outlines));
        let parameters = &document["objects"][0]["parameters"];
        for (name, truth) in [("omega", 1.2), ("b1", -0.2), ("b2", 0.1)] {
            let [value, std] = ["value", "std"].map(|field| parameters[name][field].as_f64().expect("a number"));
            assert!((value - truth).abs() < 5.0 * std && std < 0.01, "{name}: {value} +- {std}");
        }
        assert_eq!(document["b"]["point"], "the origin of the plane", "{document}");
        let lines = succeed(&format!("track - --rectify {given}"), &outlines);
        let last = json(lines.lines().last().expect("a line"));
        assert!((last["parameters"]["omega"]["value"].as_f64().expect("a number") - 1.2).abs() < 0.01);
    }
    let table = succeed(&format!("identify - --rectify {}", numbers.join(",")), &outlines);
    assert!(table.contains("b: velocity at the origin of the plane, in lengths of the plane/s"), "{table}");
}

#[test]
fn the_true_motion_in_the_picture_is_not_shown_beside_one_in_the_plane() {
    let output = run("identify - --rectify 2,0,0,0,2,0,0,0,1", &sequence(""));
    assert!(stderr(&output).contains("the truth in the file is that in the picture"), "{}", stderr(&output));
    assert!(!stdout(&output).contains("truth"), "{}", stdout(&output));
    let table = succeed("identify - --rectify 2,0,0,0,2,0,0,0,1 --truth 1.5708,-0.6,0.8", &sequence(""));
    assert!(table.contains("truth") && table.contains("-0.600000"), "{table}");
}

#[test]
fn of_more_points_the_error_is_told() {
    let five = pairs(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.4, 0.6)]);
    assert!(
        succeed(&format!("rectify {five}"), "").starts_with("# map from the picture to the plane; 5 points, off by ")
    );
}

#[test]
fn points_and_maps_that_mean_no_plane_are_wrong_usage() {
    let folder = tempfile::tempdir().expect("a folder");
    let short = file(folder.path(), "short.txt", "# a map\n1 0 0\n0 1 0\n");
    let words = file(folder.path(), "words.txt", "one 0 0 0 1 0 0 0 1\n");
    let input = sequence("");
    for (arguments, message) in [
        ("rectify 0,0=0,0 1,0=1,0 1,1=1,1".to_owned(), "3 pair(s) of points, at least 4 are needed"),
        ("rectify 0,0=0,0 1,0=1,0 2,0=1,1 0,1=0,1".to_owned(), "no three may lie on one line"),
        ("rectify 0,0=0,0 1,0=1,1 1,1=1,0 0,1=0,1".to_owned(), "in the same order"),
        ("rectify 0,0=0".to_owned(), "expected X,Y=U,V"),
        ("identify - --rectify 1,2,3".to_owned(), "expected nine numbers, found 3"),
        ("identify - --rectify 1,2,3,2,4,6,0,0,1".to_owned(), "singular"),
        ("identify - --rectify nowhere.txt".to_owned(), "nowhere.txt"),
        (format!("track - --rectify {short}"), "expected nine numbers, found 6"),
        (format!("track - --rectify {words}"), "\"one\" is not a number"),
        ("identify - --rectify 1,0,0,0,1,0,0,0,1 --scale 0.1".to_owned(), "--scale"),
    ] {
        let output = run(&arguments, &input);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(stderr(&output).contains(message), "{arguments}: {}", stderr(&output));
    }
}

#[test]
fn a_known_outline_seen_at_rest_tells_the_plane_as_four_points_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let known = succeed("simulate --shape van --omega 0 --b 0,0 --fps 1 --seconds 1 --noise 0", "");
    let known = file(folder.path(), "known.csv", &known);
    // The plane does not know where the outline lies in it, so the object lies turned.
    let rest = "simulate --shape van --omega 0.8 --b 0.5,0.2 --fps 30 --seconds 1 --noise 0.001 --seed 3";
    let still: String = {
        let moved = seen(&succeed(rest, ""));
        let last = moved.lines().last().and_then(|line| line.split(',').next()).expect("a frame").to_owned();
        let rows = moved.lines().filter(|line| line.starts_with("frame") || line.split(',').next() == Some(&last));
        rows.collect::<Vec<_>>().join("\n") + "\n"
    };
    let still = file(folder.path(), "rest.csv", &still);
    let map = succeed(&format!("rectify --known {known} --seen {still}"), "");
    assert!(map.starts_with("# map from the picture to the plane; 400 points of 1 outline(s), off by "), "{map}");
    let plane = file(folder.path(), "plane.txt", &map);
    let outlines = seen(&succeed("simulate --omega 1.2 --b -2,1 --seconds 1 --noise 0.001 --points 200", ""));
    let document = json(&succeed(&format!("identify - --rectify {plane} --format json"), &outlines));
    let omega = document["objects"][0]["parameters"]["omega"]["value"].as_f64().expect("a number");
    assert!((omega - 1.2).abs() < 0.01, "{omega}");
}

#[test]
fn outlines_that_tell_no_plane_are_told_with_the_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let outline = |shape: &str| {
        let text = succeed(&format!("simulate --shape {shape} --omega 0 --b 0,0 --fps 1 --seconds 1 --noise 0"), "");
        file(folder.path(), &format!("{shape}.csv"), &text)
    };
    let [van, bird, circle] = ["van", "bird", "circle"].map(outline);
    for (arguments, status, message) in [
        (format!("rectify --known {van} --seen {bird}"), 1, "not the known outline"),
        (format!("rectify --known {circle} --seen {circle}"), 1, "leaves the map open"),
        (format!("rectify --known {van}"), 2, "--seen"),
        (format!("rectify --seen {van}"), 2, "--known"),
        (format!("rectify --known {van} --seen nowhere.csv"), 2, "nowhere.csv"),
        (format!("rectify --known nowhere.csv --seen {van}"), 2, "nowhere.csv"),
        (format!("rectify --known {van} --seen {van} --dark"), 2, "--dark"),
    ] {
        let output = run(&arguments, "");
        assert_eq!(output.status.code(), Some(status), "{arguments}: {}", stderr(&output));
        assert!(stderr(&output).contains(message), "{arguments}: {}", stderr(&output));
    }
}
