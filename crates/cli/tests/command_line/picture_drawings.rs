//! Where drawings of pictures go, and where not.
use image::{GrayImage, ImageFormat, Luma};

use crate::pears::{encoded, names, pear, pears};
use crate::support::{file, run, stderr, stdout, succeed};

#[test]
fn a_file_that_has_no_place_is_told_before_the_work_and_not_after_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 8);
    // A picture that would be warned of.
    GrayImage::new(160, 120).save(format!("{frames}/3.png")).expect("a picture");
    for arguments in [
        "identify --trace",
        "identify --trajectory",
        "identify --svg",
        "identify --report",
        "identify --overlay",
        "fit --svg",
        "outline --output",
    ] {
        let name = if arguments.ends_with("--svg") { "file.svg" } else { "file.gif" };
        let output = run(&format!("{arguments} {base}/no/{name} {frames}"), "");
        assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(2), ""), "{arguments}");
        assert_eq!(stderr(&output), format!("freeform: {base}/no/{name}: No such file or directory\n"), "{arguments}");
    }
    assert_eq!(names(&base), ["frames"]);
}

#[test]
fn drawings_go_into_a_folder_or_a_gif_and_nothing_is_left_where_there_are_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 3);
    for command in ["outline", "identify", "track"] {
        for name in ["x.png", "x.mp4", "frames/0.png/x"] {
            let output = run(&format!("{command} {frames} --overlay {base}/{name}"), "");
            assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(2), ""), "{command} {name}");
        }
        let output = run(&format!("{command} {frames} --overlay {base}/x.png"), "");
        assert!(
            stderr(&output).contains("x.png: drawings go into a folder, or into one animation FILE.gif or FILE.y4m"),
            "{}",
            stderr(&output)
        );
        for drawn in ["drawn", "drawn.gif"] {
            let report = if command == "identify" { format!("--report {base}/report.html") } else { String::new() };
            let output = run(&format!("{command} {base}/missing.png --overlay {base}/{drawn} {report}"), "");
            assert_eq!(output.status.code(), Some(2), "{command}");
        }
        assert_eq!(names(&base), ["frames"], "{command}");
    }
}

#[test]
fn drawings_of_an_earlier_run_are_removed_and_other_pictures_are_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let (many, base) = pears(folder.path(), "many", 5);
    let (few, _) = pears(folder.path(), "few", 2);
    let drawn = format!("{base}/drawn");
    succeed(&format!("outline {many} --overlay {drawn} --output {base}/many.csv"), "");
    assert_eq!(names(&drawn).len(), 5);
    file(folder.path(), "drawn/notes.png", "not a drawing");
    succeed(&format!("track {few} --overlay {drawn}"), "");
    assert_eq!(names(&drawn), ["000000.png", "000001.png", "notes.png"]);

    let other = file(folder.path(), "drawn/000007.png", encoded(&pear(0), ImageFormat::Png));
    let output = run(&format!("track {few} --overlay {drawn}"), "");
    assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(2), ""));
    assert!(stderr(&output).contains(&format!("{other}: this picture is none that freeform has drawn")));
    assert_eq!(names(&drawn).len(), 4);
}

#[test]
fn drawings_do_not_go_among_the_pictures_of_the_input() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 3);
    for input in [frames.clone(), format!("{frames}/*.png"), format!("{frames}/0.png {frames}/1.png")] {
        for command in ["outline", "track"] {
            let output = run(&format!("{command} {input} --overlay {base}/frames"), "");
            assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(2), ""), "{command} {input}");
            assert!(
                stderr(&output).contains("the pictures of the input are here, draw elsewhere"),
                "{}",
                stderr(&output)
            );
        }
    }
    assert_eq!(names(&frames).len(), 3);
}

/// Pixels of a drawing in the colour of what the method knows, from some column on.
fn blue_pixels(path: &str, from: u32) -> usize {
    let picture = image::open(path).expect("a drawing").to_rgb8();
    picture.enumerate_pixels().filter(|(column, _, p)| *column >= from && p.0[2] > p.0[0].saturating_add(60)).count()
}

#[test]
fn a_drawing_shows_the_known_outline_also_where_a_part_is_hidden_and_no_curve_that_the_filter_does_not_fit() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 14);
    // The end of the last pear is covered.
    let covered = pear(13);
    let covered = GrayImage::from_fn(160, 120, |x, y| if x < 97 { *covered.get_pixel(x, y) } else { Luma([30]) });
    covered.save(format!("{frames}/13.png")).expect("a picture");
    for command in ["identify", "track"] {
        for (method, hidden) in [("filter", 60..250), ("adaptive", 0..50)] {
            let drawn = format!("{base}/{command}-{method}");
            succeed(&format!("{command} {frames} --fps 10 --method {method} --quiet --overlay {drawn}"), "");
            let blue = blue_pixels(&format!("{drawn}/000013.png"), 103);
            assert!(hidden.contains(&blue), "{command} {method}: {blue}");
        }
        // In the first frame all is seen: the known outline lies below what was traced.
        let blue = blue_pixels(&format!("{base}/{command}-filter/000000.png"), 0);
        assert!(blue < 40, "{command}: {blue}");
    }
}

#[test]
fn a_figure_whose_name_says_another_format_is_refused_and_one_of_any_other_name_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 4);
    for command in ["identify", "fit"] {
        for name in ["x.png", "x.JPG", "x.pdf"] {
            let output = run(&format!("{command} {frames} --svg {base}/{name}"), "");
            let reason = format!("freeform: {base}/{name}: --svg writes SVG, give a name that ends in .svg\n");
            assert_eq!((output.status.code(), stderr(&output)), (Some(2), reason), "{command}");
        }
        assert_eq!(names(&base), ["frames"], "{command}");
    }
    succeed(&format!("fit {frames} --frame 1 --svg {base}/figure.v2"), "");
    let figure = std::fs::read_to_string(format!("{base}/figure.v2")).expect("a figure");
    assert!(figure.contains("degree 4, residual "), "{}", &figure[..figure.len().min(2000)]);
}
