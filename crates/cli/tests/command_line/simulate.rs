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
    assert_eq!(lines[1], "# truth omega=-1.5 b1=-1 b2=2 scale=0.5");
    assert_eq!(lines[2], "frame,time,x,y");
    assert_eq!(lines.len(), 3 + 5 * 120);
    assert!(lines[3].starts_with("0,0,"));
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
    ] {
        let output = run(&format!("simulate {arguments}"), "");
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", stderr(&output));
        assert_eq!(stderr(&output).lines().count(), 1, "{arguments}: {}", stderr(&output));
        assert!(stderr(&output).starts_with("freeform: "), "{arguments}");
        assert_eq!(stdout(&output), "", "{arguments}");
    }
}
