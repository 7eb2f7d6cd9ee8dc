//! Outlines in Parquet, and polygons of other programs.
use std::path::PathBuf;

use crate::support::{freeform, run, stderr, stdout, succeed};

/// A file that the tests of `outline-io` have too.
fn sample(name: &str) -> String {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../outline-io/tests/data");
    folder.join(name).display().to_string()
}

#[test]
fn results_from_parquet_and_csv_are_the_same_to_the_last_digit() {
    let folder = tempfile::tempdir().expect("a folder");
    for (index, options) in ["", "--noise 0.003 --occlusion 0.2 --outliers 0.05"].iter().enumerate() {
        let [csv, parquet] = ["csv", "parquet"].map(|format| folder.path().join(format!("{index}.{format}")));
        for path in [&csv, &parquet] {
            succeed(&format!("simulate --points 120 --seconds 0.5 {options} -o {}", path.display()), "");
        }
        assert!(std::fs::read(&parquet).expect("a file").starts_with(b"PAR1"));
        for command in [
            "identify --json",
            "identify",
            "identify --method adaptive --json",
            "track -q",
            "fit --frame 0 --format json",
        ] {
            let [from_csv, from_parquet] =
                [&csv, &parquet].map(|path| succeed(&format!("{command} {}", path.display()), ""));
            assert_eq!(from_csv.replace("0.csv", "0.parquet").replace("1.csv", "1.parquet"), from_parquet, "{command}");
        }
    }
}

#[test]
fn outline_turns_a_file_into_another_format_with_all_it_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let [csv, parquet, again] =
        ["a.csv", "b.parquet", "c.csv"].map(|name| folder.path().join(name).display().to_string());
    succeed(&format!("simulate --points 60 --seconds 0.2 --noise 0.002 -o {csv}"), "");
    succeed(&format!("outline {csv} -o {parquet}"), "");
    succeed(&format!("outline {parquet} -o {again}"), "");
    assert_eq!(succeed(&format!("identify {csv} --json"), ""), succeed(&format!("identify {again} --json"), ""));
    let [first, last] = [&csv, &again].map(|path| std::fs::read_to_string(path).expect("text"));
    let comments =
        |text: &str| text.lines().filter(|line| line.starts_with('#')).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(comments(&first), comments(&last));
}

#[test]
fn deviations_of_a_table_stay_with_its_points_through_parquet_and_csv() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (first, parquet, again) = (path("a.csv"), path("b.parquet"), path("c.csv"));
    let plain = succeed("simulate --points 60 --seconds 0.5 --noise 0.004 --occlusion 0.2", "");
    // Points on one side are known less well; of some frames nothing is said.
    let stating = |line: &str| {
        let fields: Vec<f64> = line.split(',').filter_map(|field| field.parse().ok()).collect();
        match fields[..] {
            [] if line.starts_with('#') => line.to_owned(),
            [] => format!("{line},deviation"),
            [frame, ..] if frame as u64 % 3 == 2 => format!("{line},"),
            [_, _, x, ..] => format!("{line},{}", 0.01 + 0.003 * x.abs()),
            _ => panic!("{line}"),
        }
    };
    let table: String = plain.lines().map(|line| stating(line) + "\n").collect();
    std::fs::write(&first, &table).expect("a file");
    succeed(&format!("outline {first} -o {parquet}"), "");
    succeed(&format!("outline {parquet} -o {again}"), "");
    for command in ["identify --json -q", "track -q", "identify --method adaptive --json -q"] {
        let [from_first, from_parquet, from_again] =
            [&first, &parquet, &again].map(|path| succeed(&format!("{command} {path}"), "").replace(path, "FILE"));
        assert_eq!(from_first, from_parquet, "{command}");
        assert_eq!(from_first, from_again, "{command}");
    }
    let without = path("plain.csv");
    std::fs::write(&without, &plain).expect("a file");
    assert_ne!(succeed(&format!("track -q {first}"), ""), succeed(&format!("track -q {without}"), ""));
    let copied = std::fs::read_to_string(&again).expect("text");
    let header = |text: &str| text.lines().find(|line| !line.starts_with('#')).map(str::to_owned);
    assert_eq!(header(&copied).as_deref(), Some("frame,time,x,y,object,arc,contour,deviation"));
    // A table without them is copied without, unless they are asked for.
    let copied = succeed(&format!("outline {without}"), "");
    assert_eq!(header(&copied).as_deref(), Some("frame,time,x,y,object,arc,contour"));
    let empty = succeed(&format!("outline {without} --deviations"), "");
    assert_eq!(header(&empty).as_deref(), Some("frame,time,x,y,object,arc,contour,deviation"));
}

#[test]
fn bad_deviations_in_parquet_are_told_with_row_and_column() {
    let path = sample("parquet/bad-deviations-negative.parquet");
    let output = run(&format!("identify {path} -q"), "");
    let message = "row 2: column deviation: -0.5 is not a standard deviation (a number above 0, or nothing)";
    assert!(stderr(&output).ends_with(&format!("{message}\n")), "{}", stderr(&output));
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn parquet_on_standard_input_and_damaged_parquet_are_told_on_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.parquet");
    succeed(&format!("simulate --points 60 --seconds 0.2 -o {}", path.display()), "");
    let bytes = std::fs::read(&path).expect("a file");
    let output = freeform("identify -").write_stdin(bytes.clone()).output().expect("it runs");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("it is read from a file that is named, not from a stream"), "{}", stderr(&output));
    std::fs::write(&path, &bytes[..bytes.len() / 2]).expect("a file");
    let output = run(&format!("identify {}", path.display()), "");
    assert_eq!((output.status.code(), stdout(&output).as_str(), stderr(&output).lines().count()), (Some(2), "", 1));
    std::fs::write(&path, "frame,time,x,y\n").expect("a file");
    assert!(stderr(&run(&format!("identify {}", path.display()), "")).contains("not a Parquet file"));
    let output = run(&format!("identify {} --dark", path.display()), "");
    assert!(stderr(&output).contains("--dark: only for pictures"), "{}", stderr(&output));
}

#[test]
fn polygons_are_read_as_files_streams_folders_and_patterns_wherever_outlines_are() {
    let coco = sample("polygons/coco.json");
    let csv = succeed(&format!("outline {coco} --fps 10 -q"), "");
    assert!(csv.starts_with("frame,time,x,y,object,arc,contour\n0,0,10,25,3,,0\n"), "{csv}");
    let text = std::fs::read_to_string(&coco).expect("text");
    assert_eq!(succeed("outline - --fps 10 -q", &text), csv);
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["labelme-9.json", "labelme-10.json"] {
        std::fs::copy(sample(&format!("polygons/{name}")), folder.path().join(name)).expect("a copy");
    }
    let place = folder.path().display();
    let of_folder = succeed(&format!("outline {place} --fps 10 -q"), "");
    assert_eq!(of_folder, succeed(&format!("outline {place}/*.json --fps 10 -q"), ""));
    assert_eq!(of_folder, succeed(&format!("outline {place}/labelme-10.json {place}/labelme-9.json --fps 10 -q"), ""));
    assert_eq!(of_folder.lines().count(), csv.lines().count());
    let fitted = succeed(&format!("fit {} --degree 2 --format json", sample("polygons/trackmate.xml")), "");
    assert!(fitted.contains("Track_0.3"));
    let output = run(&format!("outline {coco}"), "");
    assert!(stderr(&output).contains("30 frames/s assumed"), "{}", stderr(&output));
    let output = run(&format!("outline {coco} --threshold 9 --fps 3"), "");
    assert!(stderr(&output).starts_with("freeform: --threshold: only for pictures"), "{}", stderr(&output));
}
