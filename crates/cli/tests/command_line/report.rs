//! The report of `identify`: the data that its player plays, its figures, and that neither grows without bound.
use serde_json::Value;

use super::support::{file, json, sequence, succeed};

/// The data of every player of a page.
fn played(page: &str) -> Vec<Value> {
    let blocks = page.split("<script type=\"application/json\">").skip(1);
    blocks.map(|rest| json(rest.split("</script>").next().expect("an end"))).collect()
}

/// The report of outlines in CSV, with options.
fn report(csv: &str, options: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("report.html");
    succeed(&format!("identify - --quiet {options} --report {}", path.display()), csv);
    std::fs::read_to_string(path).expect("the report")
}

/// The points of the lines of a frame.
fn points(frame: &Value) -> usize {
    let lines = frame["points"].as_array().expect("lines");
    lines.iter().map(|line| line.as_array().expect("numbers").len() / 2).sum()
}

#[test]
fn a_player_has_every_frame_with_its_points_what_was_known_of_the_outline_and_why_a_frame_was_not_used() {
    let mut csv = sequence("");
    csv.push_str("15,0.5,5,5\n15,0.5,6,5\n15,0.5,5.5,6\n15,0.5,5.2,5.5\n");
    let page = report(&csv, "");
    let players = played(&page);
    assert_eq!(players.len(), 1);
    let frames = players[0]["frames"].as_array().expect("frames");
    let known = players[0]["known"].as_array().expect("outlines");
    assert_eq!(frames.len(), 16);
    let (last, used) = frames.split_last().expect("frames");
    for frame in used {
        assert_eq!(points(frame), 120, "{}", frame["frame"]);
        let number = frame["known"][0].as_u64().expect("a known outline") as usize;
        assert!(number < known.len() && frame["rejected"].is_null());
    }
    let middle = used[14]["middle"].as_array().expect("the path of the middle");
    let [width, height] = [0, 1].map(|k| players[0]["size"][k].as_i64().expect("a size"));
    assert!((0..=width).contains(&middle[0].as_i64().expect("a number")));
    assert!((0..=height).contains(&middle[1].as_i64().expect("a number")));
    assert!(used[14]["values"][0][0].as_str().is_some_and(|omega| omega.starts_with("1.5")), "{}", used[14]["values"]);
    assert!(used[0]["values"][0][0].as_str().is_some_and(str::is_empty), "nothing is known from one frame");
    assert!(last["rejected"].as_str().is_some_and(|reason| !reason.is_empty()) && points(last) == 4);
    for text in ["<noscript>", "aria-label=\"Frame\"", "role=\"group\"", "Angle since the first frame", "95 % band"] {
        assert!(page.contains(text), "{text}");
    }
    for text in ["Cramer-Rao bound", "least possible (bound)", "Position x of the middle", "standard deviation"] {
        assert!(page.contains(text), "{text}");
    }
    assert_eq!(page.matches("<script>").count(), 1, "one script for all players");
}

#[test]
fn what_a_frame_does_not_show_of_the_known_outline_is_told_apart() {
    let page = report(&sequence("--occlusion 0.3 --seconds 2"), "");
    let players = played(&page);
    let frames = players[0]["frames"].as_array().expect("frames");
    let hidden = |frame: &Value| -> u64 {
        let runs = frame["hidden"].as_array().expect("runs");
        runs.iter().map(|run| run[1].as_u64().expect("a number")).sum()
    };
    let last = frames.iter().rfind(|frame| frame["rejected"].is_null()).expect("a frame that was used");
    let number = last["known"][0].as_u64().expect("a known outline") as usize;
    let known = players[0]["known"][number].as_array().expect("lines");
    let known: usize = known.iter().map(|line| line.as_array().expect("numbers").len() / 2).sum();
    let share = hidden(last) as f64 / known as f64;
    assert!((0.1..0.5).contains(&share), "{share} of {known} points hidden");
    let whole = played(&report(&sequence(""), ""));
    let last = whole[0]["frames"].as_array().expect("frames").last().expect("a frame").clone();
    assert_eq!(hidden(&last), 0);
}

#[test]
fn no_bound_is_drawn_of_a_motion_that_changes_and_no_deviations_where_there_are_none() {
    let bound = "least possible (bound)";
    let changing = report(&sequence("--seconds 2 --dynamics oscillating --period 1"), "");
    assert!(changing.contains("is not drawn: it is that of a constant motion") && !changing.contains(bound));
    assert!(changing.contains("How well that is known"));
    for (simulated, options) in [("--shape circle", ""), ("", "--method adaptive")] {
        let page = report(&sequence(simulated), options);
        assert!(!page.contains("How well that is known") && !page.contains(bound), "{simulated}{options}");
        assert_eq!(played(&page).len(), 1, "the outlines are played");
    }
}

#[test]
fn long_sequences_and_many_objects_make_no_huge_page_and_it_says_what_it_leaves_out() {
    let short = report(&sequence("--seconds 2"), "");
    let long = report(&sequence("--seconds 60 --points 200"), "");
    println!("60 frames: {} kB, 1800 frames: {} kB", short.len() / 1000, long.len() / 1000);
    let frames = played(&long)[0]["frames"].as_array().expect("frames").len();
    assert!((400..=1200).contains(&frames) && long.len() < 3_000_000, "{frames} {}", long.len());
    assert!(long.contains("Of 1800 frames every") && long.contains("Of long outlines some of the points are shown."));
    let one = sequence("");
    let rows: Vec<&str> = one.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).collect();
    let of = |object: usize| rows.iter().map(move |row| format!("{row},{object}\n"));
    let many: String = (0..30).flat_map(of).collect();
    let page = report(&format!("frame,time,x,y,object\n{many}"), "");
    assert_eq!(played(&page).len(), 3);
    assert_eq!(page.matches("Angle since the first frame").count(), 2 * 12, "a title and a label for each");
    assert!(page.contains("The first 3 objects are shown frame by frame, the first 12 with positions"), "told");
}

#[test]
fn no_name_ends_the_data_of_a_player() {
    let rows: String = sequence("").lines().skip(3).map(|line| format!("{line},</script><b>x\n")).collect();
    let page = report(&format!("frame,time,x,y,object\n{rows}"), "");
    assert_eq!(played(&page).len(), 1);
    assert!(!page.contains("<b>x"));
    assert_eq!(page.matches("</script>").count(), 2);
}

#[test]
fn the_pose_in_a_plane_is_that_of_the_plane() {
    let folder = tempfile::tempdir().expect("a folder");
    let plane = file(folder.path(), "plane.txt", "2 0 1 0 2 0 0 0 1");
    let page = report(&sequence(""), &format!("--rectify {plane}"));
    let players = played(&page);
    let frame = &players[0]["frames"][14];
    assert_eq!(points(frame), 120);
    // The known outline lies where the points do: what it does not show would be hidden.
    assert_eq!(frame["hidden"].as_array().map(Vec::len), Some(0), "{}", frame["hidden"]);
}

#[test]
fn angle_and_position_have_gaps_where_nothing_is_stated_and_where_the_object_is_begun_anew() {
    let csv = sequence("--seconds 1");
    let other = sequence("--shape van --seconds 3");
    // Something else in another place, for long enough that it is taken for the object.
    let later = other.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).map(|line| {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
        format!("{},{},{},{}\n", fields[0] + 30.0, fields[1] + 1.0, fields[2] + 9.0, fields[3])
    });
    let page = report(&(csv + &later.collect::<String>()), "");
    let segments: Vec<u64> = played(&page)[0]["frames"]
        .as_array()
        .expect("frames")
        .iter()
        .map(|frame| frame["segment"].as_u64().expect("a number"))
        .collect();
    assert!(segments.is_sorted() && segments.first() == Some(&0) && segments.last() > Some(&0), "{segments:?}");
    for title in ["Angle since the first frame", "Position x of the middle"] {
        let (_, panel) = page.split_once(&format!("aria-label=\"{title}\"")).expect("a panel");
        let panel = panel.split_once("</svg>").expect("its end").0;
        let of = |class: &str| {
            // The legend comes after the data.
            let (_, path) = panel.split_once(&format!("class=\"{class}\" d=\"")).expect("a line");
            path.split_once('"').expect("its end").0.matches('M').count()
        };
        assert_eq!((of("line"), of("band")), (2, 2), "{title}");
    }
}

#[test]
fn what_is_stated_in_no_frame_is_named_in_the_report_and_not_drawn_as_an_empty_figure() {
    let page = report(&sequence("--shape circle --b 0,0"), "");
    let moved =
        page.split("<h3>How it moved</h3>").nth(1).and_then(|rest| rest.split("<h3>").next()).expect("a section");
    assert!(moved.contains("Not stated in any frame, and so not drawn: "), "{moved}");
    assert_eq!(moved.matches("<svg").count(), 0, "{moved}");
    assert!(!page.contains("e-12"), "no axis of nothing");
    let page = report(&sequence(""), "");
    let moved =
        page.split("<h3>How it moved</h3>").nth(1).and_then(|rest| rest.split("<h3>").next()).expect("a section");
    assert!(!page.contains("Not stated in any frame") && moved.matches("<svg").count() == 3, "{moved}");
}

#[test]
fn an_angle_that_may_be_whole_turns_off_is_not_drawn_and_the_warning_has_its_code() {
    let page = report(&sequence("--omega 29.7 --fps 10 --seconds 2"), "");
    let poses = page.split("<h3>Where it was</h3>").nth(1).and_then(|rest| rest.split("<h3>").next());
    let poses = poses.expect("a section");
    assert!(poses.contains("Not stated in any frame, and so not drawn: Angle since the first frame."), "{poses}");
    assert_eq!(poses.matches("<svg").count(), 2, "{poses}");
    assert!(page.contains("<li><code>warning[ambiguous]</code>: ambiguous: another turn explains"), "{page}");
}

#[test]
fn bands_are_told_of_the_method_that_has_them_and_the_width_of_the_picture_has_its_unit() {
    let csv = sequence("--seconds 2");
    let (filter, adaptive) = (report(&csv, ""), report(&csv, "--method adaptive"));
    assert!(filter.contains("up to each time, with 95 % bands.") && !filter.contains("gives no bands"));
    assert!(!adaptive.contains("with 95 % bands") && adaptive.contains("The adaptive method gives no bands."));
    assert!(filter.contains("wide in the unit of the coordinates."));
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = crate::pears::pears(folder.path(), "frames", 6);
    succeed(&format!("identify {frames} --light --fps 30 --quiet --report {base}/report.html"), "");
    assert!(std::fs::read_to_string(format!("{base}/report.html")).expect("the report").contains(" pixels wide."));
}

#[test]
fn figures_go_on_to_the_end_of_the_recording_and_are_grey_where_nothing_is_stated() {
    // One object is there for half a second, the other one for two.
    let (short, long) = (sequence(""), sequence("--seconds 2 --shape van"));
    let mut csv = "frame,time,x,y,object\n".to_owned();
    for frame in 0..60 {
        for (rows, name) in [(&short, "a"), (&long, "b")] {
            let of_frame = rows.lines().filter(|row| row.starts_with(&format!("{frame},")));
            of_frame.for_each(|row| csv.push_str(&format!("{row},{name}\n")));
        }
    }
    let page = report(&csv, "");
    let [_, of_a, of_b] = page.split("<h2>Object ").collect::<Vec<_>>()[..3] else { panic!("two objects") };
    for heading in ["Where it was", "How it moved", "How well that is known"] {
        let section = |of: &str| {
            let figures = of.split(&format!("<h3>{heading}</h3>")).nth(1).and_then(|rest| rest.split("<h3>").next());
            figures.expect("a section").to_owned()
        };
        let of_a = section(of_a);
        assert_eq!(of_a.matches("not stated</text>").count(), of_a.matches("<svg").count(), "{heading}");
        let times: Vec<&str> =
            of_a.split("tick middle").skip(1).filter_map(|rest| rest.split(['>', '<']).nth(1)).collect();
        assert!(times.contains(&"1.5"), "the axis of a goes on to two seconds: {times:?}");
        assert!(!section(of_b).contains("not stated</text>"), "{heading}");
    }
    assert!(of_a.contains("rms (lengths)"), "in the unit of the file");
}
