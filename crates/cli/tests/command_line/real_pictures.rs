//! Real pictures from the command line, where they are beside the workspace.
use std::path::Path;

use crate::support::{json, run, stderr, stdout, succeed};

/// A file or folder of real data, if it is there.
fn data(name: &str) -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name);
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    Some(path.to_str().expect("UTF-8").to_owned())
}

/// The frames of the robot, and its angles by its own tracker, if they are there.
fn robot() -> Option<(String, Vec<f64>)> {
    let (frames, tracker) =
        data("sequences/microrobot_h/frames").zip(data("sequences/microrobot_h/authors_tracker.csv"))?;
    Some((frames, tracked(&std::fs::read_to_string(tracker).expect("the tracker"))))
}

/// Number and poses of the frames that were used, by the name of the column.
fn used(trajectory: &str) -> Vec<(usize, impl Fn(&str) -> f64 + use<>)> {
    let mut rows = trajectory.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = rows.next().expect("a header");
    let rows = rows.filter(|row| row[3] == "true" && !row[4].is_empty());
    rows.map(|row| {
        let header = header.clone();
        let frame = row[1].parse().expect("a frame");
        let value = move |name: &str| {
            let column = header.iter().position(|head| head == name).expect("a column");
            row[column].parse().expect("a number")
        };
        (frame, value)
    })
    .collect()
}

/// The difference of two angles in degrees, within half a turn.
fn turn_between(from: f64, to: f64) -> f64 {
    (to - from + 180.0).rem_euclid(360.0) - 180.0
}

/// Angles of all frames in degrees, anticlockwise, by the tracker of those who took the pictures.
fn tracked(csv: &str) -> Vec<f64> {
    let rows = csv.lines().skip(1);
    rows.map(|line| line.split(',').nth(3).expect("an angle").parse().expect("a number")).collect()
}

/// Median difference from the tracker of the turn from one used frame to the next, and the difference of the whole turn.
fn errors_of_turn(angles: &[(usize, f64)], tracker: &[f64]) -> (f64, f64) {
    let (mut errors, mut total) = (Vec::new(), 0.0);
    for pair in angles.windows(2) {
        let [(from, before), (to, after)] = pair else { continue };
        let error = turn_between(turn_between(tracker[*from], tracker[*to]), turn_between(*before, *after));
        total += error;
        errors.push(error.abs());
    }
    errors.sort_by(f64::total_cmp);
    (errors[errors.len() / 2], total.abs())
}

#[test]
fn the_turn_of_the_robot_in_raw_frames_is_that_of_its_own_tracker() {
    let Some((frames, tracker)) = robot() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let base = folder.path().to_str().expect("UTF-8");
    let found = "--ring dark --channel red --fps 15.07 --quiet";
    for (motion, aspect) in [("affine", "1"), ("rigid", "1.14")] {
        let csv = succeed(&format!("outline {frames} {found} --pixel-aspect {aspect}"), "");
        let seen = csv.lines().skip(1).map(|line| line.split(',').next()).collect::<std::collections::HashSet<_>>();
        assert!(seen.len() >= 130, "{} outlines", seen.len());
        succeed(&format!("identify - --motion {motion} --quiet --trajectory {base}/poses.csv"), &csv);
        let trajectory = std::fs::read_to_string(folder.path().join("poses.csv")).expect("poses");
        if motion == "affine" {
            // A turn in stretched pixels has -m21/m12 = aspect^2.
            let products = |value: &dyn Fn(&str) -> f64| (value("m12") * value("m21"), -value("m21") / value("m12"));
            let poses = used(&trajectory).into_iter().map(|(_, value)| products(&value));
            let mut aspects: Vec<f64> = poses.filter(|(product, _)| *product < -0.25).map(|(_, r)| r.sqrt()).collect();
            aspects.sort_by(f64::total_cmp);
            println!(
                "aspect {:.3} to {:.3}, median {:.3}",
                aspects[0],
                aspects[aspects.len() - 1],
                aspects[aspects.len() / 2]
            );
            assert!(aspects.len() > 50 && aspects[0] > 1.1 && aspects[aspects.len() - 1] < 1.18, "{aspects:?}");
        }
        let angles: Vec<(usize, f64)> = std::iter::once((0, 0.0))
            .chain(used(&trajectory).iter().map(|(frame, value)| {
                // A positive angle turns as a positive omega does, clockwise.
                let angle = match motion {
                    "rigid" => -value("angle"),
                    _ => (value("m21") - value("m12")).atan2(value("m11") + value("m22")),
                };
                (*frame, angle.to_degrees())
            }))
            .collect();
        if motion == "rigid" {
            let mut deviations: Vec<f64> = used(&trajectory).iter().map(|(_, value)| value("angle_std")).collect();
            deviations.sort_by(f64::total_cmp);
            let (middle, largest) = (deviations[deviations.len() / 2], deviations[deviations.len() - 1]);
            println!("deviations of the turn: {middle:.4} in the median, {largest:.3} at most");
            assert!(middle < 0.02 && largest < 0.3, "{middle} {largest}");
        }
        let (median, total) = errors_of_turn(&angles, &tracker);
        println!(
            "{motion}: {} outlines, {} frames used, turn within {median:.2} degrees, the whole within {total:.2}",
            seen.len(),
            angles.len()
        );
        // The tracker jumps by 7 degrees in the last two frames: the affine turn is 3.5 off after them, and 4.5 the other way before.
        let most = if motion == "rigid" { 3.0 } else { 4.0 };
        assert!(angles.len() >= 120 && median < 2.0 && total < most, "{motion}: {median} {total}");
    }
}

/// The numbers in `5` or `7-9`.
fn frames_of(text: &str) -> std::ops::RangeInclusive<u64> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    let number = |text: &str| text.parse().expect("a number");
    number(first)..=number(last)
}

#[test]
fn broken_masks_of_the_robot_are_found_by_their_edges_or_rejected_and_named() {
    let Some(masks) = data("sequences/microrobot_h/masks") else { return };
    let output = run(&format!("track {masks} --fps 15.07 --pixel-aspect 1.14"), "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let lines = stdout(&output);
    let rejected: Vec<u64> = lines
        .lines()
        .map(json)
        .filter(|line| line["accepted"] == false)
        .map(|line| {
            let frame = line["frame"].as_u64().expect("a number");
            let reason = line["reason"].as_str().expect("a reason");
            assert!(reason.starts_with(&format!("frame {frame} of object")), "{reason}");
            frame
        })
        .collect();
    println!("rejected: {rejected:?}");
    let told = stderr(&output);
    let found = told
        .lines()
        .find_map(|line| line.split_once("by their edges where it was expected, in frame(s) "))
        .map(|(_, f)| f);
    let found: Vec<u64> = found.into_iter().flat_map(|frames| frames.split(", ")).flat_map(frames_of).collect();
    println!("found by their edges: {found:?}");
    // Open rings in place of a filled H, by eye.
    for broken in [40, 41, 42, 43, 44, 45, 53, 58, 62, 66, 67, 68] {
        assert!(rejected.contains(&broken) || found.contains(&broken), "frame {broken}");
    }
    // What is found of 66 fits better in another pose. Until another frame agrees none is known, so that edges are not looked for in the next two.
    assert!(rejected.len() <= 10 && found.len() >= 3, "{rejected:?} {found:?}");
}

#[test]
fn the_bolt_moves_evenly_while_in_view_and_is_followed_out_of_it() {
    let Some(gif) = data("sequences/bolt/bolt.gif") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let base = folder.path().to_str().expect("UTF-8");
    let table = succeed(&format!("identify {gif} --quiet --trajectory {base}/poses.csv"), "");
    let trajectory = std::fs::read_to_string(folder.path().join("poses.csv")).expect("poses");
    let poses = used(&trajectory);
    let shifts = |last: usize| -> Vec<f64> {
        let pairs = poses.windows(2).filter(|pair| pair[1].0 == pair[0].0 + 1 && pair[1].0 <= last);
        pairs.map(|pair| pair[1].1("x") - pair[0].1("x")).collect()
    };
    // Frames 3 to 21 show all of it.
    let in_view = shifts(21);
    let mean = in_view.iter().sum::<f64>() / in_view.len() as f64;
    let spread = (in_view.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / in_view.len() as f64).sqrt() / mean;
    println!("{table}{} frames used, {mean:.2} pixels per frame, steady to {:.2} %", poses.len(), 100.0 * spread);
    assert!(poses.len() >= 15 && (mean - 23.2).abs() < 0.3 && spread < 0.02, "{mean} {spread}");
    // Frame 22 shows half of it.
    let (last, leaving) = (poses.last().expect("poses").0, *shifts(22).last().expect("shifts"));
    assert!(last == 22 && (leaving / mean - 1.0).abs() < 0.05, "frame {last}: {leaving}");
}

#[test]
fn the_robot_is_found_and_followed_without_an_option_but_the_rate_and_its_aspect_is_told() {
    let Some((frames, tracker)) = robot() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let poses = folder.path().join("poses.csv");
    let output = run(&format!("identify {frames} --fps 15.07 --trajectory {}", poses.display()), "");
    let told = stderr(&output);
    assert!(told.contains("note: traced with ") && !told.contains("beyond doubt"), "{told}");
    assert!(told.contains("--pixel-aspect 1.1"), "{told}");
    let trajectory = std::fs::read_to_string(&poses).expect("poses");
    let angles: Vec<(usize, f64)> = std::iter::once((0, 0.0))
        .chain(used(&trajectory).iter().map(|(frame, value)| (*frame, -value("angle").to_degrees())))
        .collect();
    let (median, total) = errors_of_turn(&angles, &tracker);
    println!("{} frames used, turn within {median:.2} degrees, the whole within {total:.2}", angles.len());
    // Pixels that are taken to be square, and are not, put the angle off; the option that is told mends it. Three more frames are used than were, and the
    // deviation is a third of what it was, the error the same.
    let last = used(&trajectory).last().map(|(_, value)| value("angle_std").to_degrees()).expect("a pose");
    assert!(angles.len() >= 130 && median < 2.0 && total < 3.0 * last, "{} {median} {total} {last}", angles.len());
}
