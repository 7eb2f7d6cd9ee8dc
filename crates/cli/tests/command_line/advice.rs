//! What warnings advise, by what has been chosen already, and where the same is said of streams.
use crate::support::{json, pictures, run, sequence, stderr, stdout, succeed};

/// Pictures of a light disc that drifts, with a dark hole that turns about its middle.
fn disc_with_hole(folder: &std::path::Path) -> String {
    pictures(&folder.join("disc"), 16, [120, 90], |frame, x, y| {
        let [frame, x, y] = [frame, x, y].map(f64::from);
        let (middle, angle) = ([45.0 + 1.3 * frame, 42.0 + 0.4 * frame], 0.06 * frame);
        let hole = [middle[0] + 12.0 * angle.cos(), middle[1] + 12.0 * angle.sin()];
        let within = |[cx, cy]: [f64; 2], radius: f64| (radius - (x - cx).hypot(y - cy) + 0.5).clamp(0.0, 1.0);
        (20.0 + 200.0 * (within(middle, 26.0) - within(hole, 7.0))) as u8
    })
}

#[test]
fn a_disc_of_which_the_boundary_alone_is_traced_is_told_that_holes_may_show_its_turn() {
    let folder = tempfile::tempdir().expect("a folder");
    let disc = disc_with_hole(folder.path());
    let advice = "warning[not_observable]: object 0: not observable from these outlines: omega";
    let advised = "; holes or marks within the object may show it: --contours all";
    for options in ["--light", "--light --contours boundary"] {
        for command in ["identify", "track"] {
            let told = stderr(&run(&format!("{command} {disc} --fps 25 {options}"), ""));
            let line = told.lines().find(|line| line.contains(advice)).expect("a warning");
            assert!(line.ends_with(advised), "{command} {options}: {told}");
        }
    }
    // With them the turn is shown, and of a table nobody knows whether there are any.
    let whole = run(&format!("identify {disc} --fps 25 --light --contours all --json"), "");
    assert!(json(&stdout(&whole))["objects"][0]["parameters"]["omega"]["value"].is_f64(), "{}", stderr(&whole));
    let told = stderr(&run("identify -", &sequence("--shape circle")));
    assert!(told.contains("not_observable") && !told.contains("--contours"), "{told}");
}

#[test]
fn a_stream_has_the_warnings_of_results_on_standard_error() {
    let csv = sequence("--shape ellipse");
    let lines_of = |output| stderr(&output).lines().map(str::to_owned).collect::<Vec<_>>();
    let told = lines_of(run("track", &csv));
    assert!(told.iter().any(|line| line.contains("warning[aliases]: object 0: ")), "{told:?}");
    assert_eq!(told, lines_of(run("identify -", &csv)));
    assert!(lines_of(run("track --quiet", &csv)).is_empty());
    // Frames have their reasons in their lines.
    let told = stderr(&run("track", &(csv + "20,5.0,1,1\n")));
    assert!(told.contains("warning[aliases]") && !told.contains("rejected"), "{told}");
}

#[test]
fn the_last_line_of_an_object_that_leaves_a_stream_has_its_warnings() {
    let named = |name: &str, from: u32, seconds: u32| {
        let rows = succeed(&format!("simulate --shape ellipse --points 60 --seconds {seconds}"), "");
        let rows = rows.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit()));
        rows.map(|row| {
            let cells: Vec<&str> = row.split(',').collect();
            let frame = cells[0].parse::<u32>().expect("a number") + from;
            format!("{frame},{},{name},{},{}\n", f64::from(frame) / 30.0, cells[2], cells[3])
        })
        .collect::<String>()
    };
    let csv = format!("frame,time,object,x,y\n{}{}", named("a", 0, 1), named("b", 30, 35));
    let output = run("track", &csv);
    let closed = stdout(&output).lines().map(json).find(|line| line["phase"] == "closed").expect("a last line");
    assert_eq!(closed["object"], "a");
    assert_eq!(closed["warnings"][0]["code"], "aliases", "{closed}");
    for name in ["a", "b"] {
        let told = format!("warning[aliases]: object {name}: ");
        assert_eq!(stderr(&output).matches(&told).count(), 1, "{}", stderr(&output));
    }
}

#[test]
fn a_video_that_was_converted_by_repeating_pictures_is_told_with_its_rates() {
    let source = succeed("simulate --points 120 --fps 25 --seconds 1 --noise 0.003 --shape glider", "");
    let rows = |frame: u32| {
        let start = format!("{frame},");
        let rows = source.lines().filter(move |line| line.starts_with(&start));
        rows.map(|row| row.splitn(3, ',').nth(2).expect("x and y").to_owned()).collect::<Vec<_>>()
    };
    let frames = (0..30).flat_map(|frame| {
        let time = f64::from(frame) / 30.0;
        rows(frame * 25 / 30).into_iter().map(move |row| format!("{frame},{time},{row}\n"))
    });
    let converted: String = std::iter::once("frame,time,x,y\n".to_owned()).chain(frames).collect();
    let told = stderr(&run("identify -", &converted));
    assert!(told.contains("warning[repeated_frames]: object 0: one frame in 6 repeats the one before it"), "{told}");
    assert!(told.contains("from 25 to 30 frames a second"), "{told}");
    assert!(!stderr(&run("identify -", &source)).contains("repeated_frames"));
}
