use crate::support::{json, run, sequence, stderr, stdout};

/// Bad inputs, the exit status, and what the message names.
const CASES: [(&str, &str, i32, &str); 23] = [
    ("empty file", "", 2, "<stdin>: "),
    ("only comments", "# nothing\n", 2, "<stdin>: "),
    ("only a header", "frame,time,x,y\n", 1, "<stdin>: "),
    ("one point", "frame,time,x,y\n0,0,1,1\n", 1, "<stdin>:2"),
    ("two points", "frame,time,x,y\n0,0,1,1\n0,0,1,2\n", 1, "<stdin>:2-3"),
    ("equal points", "frame,time,x,y\n0,0,1,1\n0,0,1,1\n0,0,1,1\n0,0,1,1\n", 1, "<stdin>:2-5"),
    ("collinear points", "frame,time,x,y\n0,0,0,0\n0,0,1,1\n0,0,2,2\n0,0,3,3\n", 1, "<stdin>:2-5"),
    (
        "arcs on one line",
        "frame,time,x,y,arc\n0,0,0,0,a\n0,0,1,1,a\n0,0,2,2,a\n0,0,3,3,b\n0,0,4,4,b\n0,0,5,5,b\n",
        1,
        "all 6 points lie on one line",
    ),
    ("NaN", "frame,time,x,y\n0,0,NaN,1\n", 2, "<stdin>:2: column x"),
    ("infinity", "frame,time,x,y\n0,0,1,inf\n", 2, "<stdin>:2: column y"),
    ("a huge number", "frame,time,x,y\n0,0,1e300,1\n", 2, "<stdin>:2: column x"),
    ("an overflowing number", "frame,time,x,y\n0,0,1e999,1\n", 2, "<stdin>:2: column x"),
    ("text for a number", "frame,time,x,y\n0,0,abc,1\n", 2, "<stdin>:2: column x: \"abc\" is not a number"),
    ("text for a time", "frame,time,x,y\n0,soon,0,1\n", 2, "<stdin>:2: column time"),
    ("a negative frame", "frame,time,x,y\n-1,0,0,1\n", 2, "<stdin>:2: column frame"),
    ("names in upper case", "Frame,Time,X,Y\n0,0,0,0\n", 2, "names of columns are in lower case"),
    ("a tiny outline", "frame,time,x,y\n0,0,0,0\n0,0,1e-200,0\n0,0,0,1e-200\n", 1, "the outline is too small"),
    ("a missing column", "frame,time,x\n0,0,1\n", 2, "missing column(s) y"),
    ("time running backwards", "frame,time,x,y\n0,1,0,0\n0,1,1,0\n0,1,0,1\n1,0.5,0,0\n", 2, "<stdin>:5: column time"),
    ("two outlines in one frame", "frame,time,x,y,object\n0,0,0,0,a\n0,0,1,0,b\n0,0,0,1,a\n", 2, "<stdin>:4"),
    ("a cut last line", "frame,time,x,y\n0,0,0,0\n0,0,1", 2, "<stdin>:3"),
    ("a long row", "frame,time,x,y\n0,0,0,0,0,0\n", 2, "<stdin>:2"),
    ("binary", "\u{0}\u{1}\u{2}\u{3}", 2, "<stdin>:1: "),
];

#[test]
fn every_bad_input_ends_with_one_line_that_names_the_place() {
    for command in ["identify -", "identify - --format json", "fit -", "fit - --format json", "track"] {
        for (name, input, status, place) in CASES {
            let output = run(command, input);
            let message = stderr(&output);
            assert_eq!(output.status.code(), Some(status), "{command}, {name}: {message}");
            assert_eq!(message.lines().count(), 1, "{command}, {name}: {message}");
            assert!(message.starts_with("freeform: ") && message.contains(place), "{command}, {name}: {message}");
            assert!(!message.contains("panicked"), "{command}, {name}: {message}");
            for word in ["NaN", "inf"] {
                assert!(!stdout(&output).contains(word), "{command}, {name}: {}", stdout(&output));
            }
        }
    }
}

#[test]
fn frames_before_a_bad_row_are_not_lost() {
    let csv = sequence("") + "15,0.5,0.1,abc\n";
    let line = csv.lines().count();
    let output = run("identify - --format json", &csv);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains(&format!("<stdin>:{line}: column y: \"abc\" is not a number")));
    assert_eq!(stderr(&output).lines().count(), 1);
    assert_eq!(json(&stdout(&output))["objects"][0]["frames"], 15);

    let output = run("fit - --format json", &csv);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(json(&stdout(&output))["outlines"].as_array().map(Vec::len), Some(15));

    let output = run("track", &csv);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(stdout(&output).lines().count(), 15);
}

#[test]
fn a_time_that_runs_backwards_later_on_keeps_what_came_before() {
    let csv = sequence("") + "16,0.2,0,0\n16,0.2,1,0\n16,0.2,0,1\n";
    let output = run("identify - --format json", &csv);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("column time"), "{}", stderr(&output));
    assert_eq!(json(&stdout(&output))["objects"][0]["frames"], 15);
}

#[test]
fn a_file_that_is_not_there_or_is_a_folder_is_unreadable() {
    for command in ["identify /nowhere/outlines.csv", "fit /nowhere/outlines.csv", "track /", "identify /"] {
        let output = run(command, "");
        assert_eq!(output.status.code(), Some(2), "{command}");
        assert_eq!(stderr(&output).lines().count(), 1, "{command}: {}", stderr(&output));
    }
}

#[test]
fn wrong_usage_is_told_on_one_line() {
    for arguments in [
        "identify",
        "identify - --method guess",
        "identify - --motion round",
        "identify - --degree 3",
        "identify - --degree x",
        "identify - --scale 0",
        "identify - --scale NaN",
        "identify - --truth 1,2",
        "identify - --unknown",
        "fit - --method 3l --kappa 1",
        "fit - --method gs3l --margin 0.1",
        "fit - --margin 3",
        "fit - --offset 7",
        "fit - --method 3m",
        "identify - --method adaptive --size 1e200",
        "identify - --method adaptive --size 1e-200",
        "simulate --noise 1e100",
        "simulate --noise -1",
        "nonsense",
        "outline",
    ] {
        let output = run(arguments, &sequence("--seconds 0.1"));
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", stderr(&output));
        assert_eq!(stderr(&output).lines().count(), 1, "{arguments}: {}", stderr(&output));
        assert!(stderr(&output).starts_with("freeform: "), "{arguments}: {}", stderr(&output));
        assert_eq!(stdout(&output), "", "{arguments}");
    }
}

#[test]
fn tiny_far_and_flat_outlines_give_an_answer_or_a_reason_but_no_panic() {
    let outline = |frame: usize, scale: f64, shift: f64, flat: f64| -> String {
        let angle = |k: usize| std::f64::consts::TAU * k as f64 / 60.0 + 0.1 * frame as f64;
        let row = |k: usize| {
            let (x, y) =
                (shift + scale * angle(k).cos(), shift + scale * flat * (angle(k).sin() + 0.2 * angle(3 * k).cos()));
            format!("{frame},{},{x:e},{y:e}\n", frame as f64 * 0.1)
        };
        (0..60).map(row).collect()
    };
    for (scale, shift, flat) in
        [(1e-90, 0.0, 1.0), (1e90, 0.0, 1.0), (1.0, 1e14, 1.0), (1.0, 0.0, 1e-7), (1.0, 1e6, 1.0)]
    {
        let rows: String = (0..5).map(|frame| outline(frame, scale, shift, flat)).collect();
        for command in ["identify - --format json", "identify -", "fit -", "fit - --format json", "track"] {
            let output = run(command, &format!("frame,time,x,y\n{rows}"));
            let code = output.status.code();
            assert!(matches!(code, Some(0 | 1)), "{command} {scale} {shift} {flat}: {code:?} {}", stderr(&output));
            for word in ["NaN", "inf"] {
                assert!(!stdout(&output).contains(word), "{command} {scale} {shift} {flat}: {}", stdout(&output));
            }
        }
    }
}

#[test]
fn a_file_of_two_contours_in_one_and_one_in_milliseconds_are_told_of() {
    let of = |options: &str| -> Vec<Vec<f64>> {
        let csv = sequence(options);
        let rows = csv.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        rows.map(|row| row.split(',').map(|field| field.parse().expect("a number")).collect()).collect()
    };
    let (one, other) = (of("--noise 0.001"), of("--noise 0.001 --shape van"));
    let row = |row: &Vec<f64>, shift: f64, factor: f64| {
        format!("{},{},{},{}\n", row[0], factor * row[1], row[2] + shift, row[3])
    };
    let mixed = one.chunks(120).zip(other.chunks(120)).flat_map(|(one, other)| {
        let one = one.iter().map(|fields| row(fields, 0.0, 1.0));
        one.chain(other.iter().map(|fields| row(fields, 7.0, 1.0))).collect::<Vec<_>>()
    });
    let told = stderr(&run("identify -", &("frame,time,x,y\n".to_owned() + &mixed.collect::<String>())));
    assert!(told.contains("the points of frame 0 seem to be two contours"), "{told}");

    let slow: String = one.iter().map(|fields| row(fields, 0.0, 1000.0)).collect();
    let told = stderr(&run("identify -", &format!("frame,time,x,y\n{slow}")));
    assert!(told.contains("one frame every 33.3 s: times and rates are in seconds"), "{told}");
    let told = stderr(&run("identify -", &sequence("--noise 0.001")));
    assert!(!told.contains("one frame every") && !told.contains("two contours"), "{told}");
}
