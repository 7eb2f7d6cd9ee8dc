use crate::support::{file, run, sequence, stderr, stdout, succeed};

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_does_not() {
    let first = sequence("--seed 3");
    assert_eq!(first, sequence("--seed 3"));
    assert_ne!(first, sequence("--seed 4"));
}

#[test]
fn the_head_holds_the_truth_and_the_rows_follow_the_header() {
    let csv = sequence("--omega -1.5 --b -1,2 --scale 0.5 --fps 10");
    let lines: Vec<&str> = csv.lines().collect();
    assert!(lines[0].starts_with("# freeform simulate"), "{}", lines[0]);
    // In the last frame, after 0.4 s, the velocity (-1, 2) of the middle has turned by 0.6 rad.
    let (s, c) = 0.6_f64.sin_cos();
    assert_eq!(lines[1].split(" v1=").next(), Some("# truth omega=-1.5 b1=-1 b2=2 scale=0.5"));
    let told = truth(&csv);
    let value = |name: &str| told.iter().find(|(key, _)| key == name).map(|(_, value)| *value);
    assert!(value("v1").is_some_and(|v| (v - (-c - 2.0 * s)).abs() < 1e-12), "{}", lines[1]);
    assert!(value("v2").is_some_and(|v| (v - (-s + 2.0 * c)).abs() < 1e-12), "{}", lines[1]);
    assert_eq!(value("time"), None);
    assert_eq!(lines[2], "frame,time,x,y");
    assert_eq!(lines.len(), 3 + 5 * 120);
    assert!(lines[3].starts_with("0,0,"));
}

/// The fields of the comment line with the truth.
fn truth(csv: &str) -> Vec<(String, f64)> {
    let line = csv.lines().find_map(|line| line.strip_prefix("# truth ")).expect("a truth");
    let fields = line.split_whitespace().map(|field| field.split_once('=').expect("a field"));
    fields.map(|(name, value)| (name.to_owned(), value.parse().expect("a number"))).collect()
}

/// Mean of the points of each frame: the middle of a circle, to the noise over the root of their number.
fn middles(csv: &str) -> Vec<[f64; 3]> {
    let mut sums: Vec<[f64; 4]> = Vec::new();
    for line in csv.lines().filter(|line| !line.starts_with(['#', 'f'])) {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
        if sums.len() <= fields[0] as usize {
            sums.push([0.0; 4]);
        }
        let sum = sums.last_mut().expect("a frame");
        let added = [fields[1], fields[2], fields[3], 1.0];
        sum.iter_mut().zip(added).for_each(|(sum, value)| *sum += value);
    }
    sums.into_iter().map(|[t, x, y, n]| [t / n, x / n, y / n]).collect()
}

#[test]
fn the_velocity_of_the_middle_in_the_head_is_that_of_the_simulated_path_at_its_end() {
    for motion in [
        "",
        "--dynamics velocity --velocity 6,-2",
        "--dynamics accelerating --velocity 3,8 --acceleration 0.5,0,-9.8",
        "--dynamics stop-and-go --velocity 5,0 --period 0.8",
        "--dynamics oscillating --velocity 5,1 --period 1.7 --amplitude 0.6",
        "--projective 0,1.6,-1.6,0,-3,4,-0.012,0.016",
    ] {
        let arguments = format!("simulate --shape circle --points 3000 --noise 0 --fps 200 --seconds 1 {motion}");
        let csv = succeed(&arguments, "");
        let value = |name: &str| truth(&csv).into_iter().find(|(key, _)| key == name).map(|(_, value)| value);
        assert_eq!(value("time").is_some(), motion.contains("dynamics"), "{motion}");
        let path = middles(&csv);
        let [from, to] = [path[path.len() - 3], path[path.len() - 1]];
        for (axis, name) in [(1, "v1"), (2, "v2")] {
            let found = (to[axis] - from[axis]) / (to[0] - from[0]) / 0.1;
            let told = value(name).expect("a velocity");
            assert!((found - told).abs() < 0.2, "{motion} {name}: {found} {told}");
        }
    }
}

#[test]
fn the_truth_of_a_motion_that_changes_is_that_in_the_last_frame() {
    let csv = succeed(
        "simulate --fps 10 --seconds 1.05 --omega 1 --dynamics accelerating --velocity 1,0 --acceleration 0.5,0,2",
        "",
    );
    let told = truth(&csv);
    let value = |name: &str| told.iter().find(|(key, _)| key == name).expect("a field").1;
    // The middle is at (1, 1) after a second, where it runs with (1, 2) and omega is 1.5.
    for (name, expected) in
        [("time", 1.0), ("omega", 1.5), ("v1", 1.0), ("v2", 2.0), ("b1", 1.0 - 1.5), ("b2", 2.0 + 1.5), ("scale", 0.1)]
    {
        assert!((value(name) - expected).abs() < 1e-9, "{name}: {}", value(name));
    }
}

#[test]
fn a_constant_generator_is_simulated_as_it_was_whether_it_is_named_or_not() {
    let rows = |csv: String| csv.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(rows(sequence("")), rows(sequence("--dynamics generator")));
}

#[test]
fn beside_the_velocity_of_a_disc_stands_that_of_its_middle_at_the_end() {
    let csv = succeed("simulate --shape circle --seconds 1 --dynamics velocity --omega 2 --velocity 3,-1", "");
    let table = succeed("identify -", &csv);
    let row = |name: &str| table.lines().find(|line| line.trim_start().starts_with(name)).expect("a row").to_owned();
    assert!(row("v1").contains("0.300000") && row("v2").contains("-0.100000"), "{table}");
    assert!(row("omega").contains("unobservable"), "{table}");
}

#[test]
fn negative_numbers_are_read_with_and_without_an_equals_sign() {
    let rows = |csv: String| csv.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(rows(sequence("--b -1,2 --omega -1.5")), rows(sequence("--b=-1,2 --omega=-1.5")));
    let affine = sequence("--affine -0.1,1,-1,0.1,-2,3");
    assert!(affine.contains("# truth a1=-0.1 a2=1 a3=-1 a4=0.1 b1=-2 b2=3 scale=0.1"));
}

#[test]
fn hidden_arcs_come_as_open_pieces() {
    let csv = sequence("--occlusion 0.25");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[2], "frame,time,x,y,arc");
    assert_eq!(lines.len(), 3 + 15 * 90);
    assert!(lines[3].ends_with(",0"));
}

#[test]
fn an_unknown_shape_lists_the_names_there_are() {
    let output = run("simulate --shape foo", "");
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    assert_eq!(message.lines().count(), 1);
    for name in ["foo", "bird", "glass_vase", "square"] {
        assert!(message.contains(name), "{message}");
    }
}

#[test]
fn a_polygon_from_a_file_is_moved_at_unit_size() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(folder.path(), "wedge.csv", "x,y\n10,10\n40,10\n40,50\n");
    let csv = succeed(&format!("simulate --shape {path} --noise 0 --fps 1 --seconds 1"), "");
    let points: Vec<(f64, f64)> = csv
        .lines()
        .skip(3)
        .map(|line| {
            let fields: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
            (fields[2], fields[3])
        })
        .collect();
    let largest =
        points.iter().flat_map(|p| points.iter().map(move |q| (p.0 - q.0).hypot(p.1 - q.1))).fold(0.0_f64, f64::max);
    assert!((largest - 1.0).abs() < 0.02, "{largest}");
}

#[test]
fn settings_out_of_range_are_refused_on_one_line() {
    for arguments in [
        "--fps 0",
        "--fps NaN",
        "--seconds -1",
        "--noise -0.1",
        "--occlusion 1",
        "--outliers 2",
        "--points 1",
        "--scale 0",
        "--b 1",
        "--b 1,2,3",
        "--b 1,x",
        "--omega inf",
        "--affine 1,2,3",
        "--affine 0,0,0,0,0,0 --omega 1",
        "--seconds 1e12",
        "--shape nowhere/shape.csv",
        "--shape .",
        "--affine 1e300,0,0,1e300,0,0",
        "--dynamics nonsense",
        "--dynamics accelerating",
        "--dynamics accelerating --acceleration 1,2",
        "--dynamics velocity --acceleration 1,2,3",
        "--dynamics velocity --affine 0,1,-1,0,0,0",
        "--dynamics velocity --projective 0,1,-1,0,0,0,0,0",
        "--dynamics velocity --velocity 1,2 --projective 0,1,-1,0,0,0,0,0",
        "--dynamics velocity --velocity 1",
        "--dynamics velocity --velocity 1,2 --b 1,2",
        "--dynamics velocity --period 1",
        "--dynamics stop-and-go --period 0",
        "--dynamics stop-and-go --amplitude 0.5",
        "--dynamics oscillating --amplitude 1.5",
        "--velocity 1,2",
        "--period 1",
    ] {
        let output = run(&format!("simulate {arguments}"), "");
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", stderr(&output));
        assert_eq!(stderr(&output).lines().count(), 1, "{arguments}: {}", stderr(&output));
        assert!(stderr(&output).starts_with("freeform: "), "{arguments}");
        assert_eq!(stdout(&output), "", "{arguments}");
    }
}

#[test]
fn pictures_of_a_scene_stand_beside_their_truth_and_are_read_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = folder.path().to_str().expect("UTF-8");
    for (name, options, extension) in [("a", "", "png"), ("b", "--jpeg 90", "jpg")] {
        succeed(
            &format!("simulate --pictures {base}/{name} --scene accelerating-l --seconds 0.2 --seed 4 {options}"),
            "",
        );
        let truth = std::fs::read_to_string(folder.path().join(name).join("truth.csv")).expect("the truth");
        let rows: Vec<Vec<f64>> = truth
            .lines()
            .skip(2)
            .map(|line| line.split(',').take(9).map(|field| field.parse().expect("a number")).collect())
            .collect();
        assert_eq!(rows.len(), 6, "{truth}");
        assert!(folder.path().join(name).join(format!("000005.{extension}")).exists());
        let before = rows[5][6] - rows[0][6];
        assert!(before.abs() > 0.04, "the spin accelerates by {before}");
    }
    let again = run(&format!("simulate --pictures {base}/a"), "");
    assert_eq!(again.status.code(), Some(2));
    assert!(stderr(&again).contains("an empty folder"), "{}", stderr(&again));
}
