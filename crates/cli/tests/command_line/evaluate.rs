use serde_json::Value;

use crate::support::{closing_its_pipe, file, freeform, json, run, stderr, stdout, succeed};

/// An evaluation that takes no time.
const SMALL: &str = "evaluate --points 120 --frames 8 --runs 4";

#[test]
fn the_table_reads_as_it_should() {
    // Of the baselines alone: the figures of the filter change with it.
    let arguments = format!("{SMALL} --shape bird van --method moments,icp --no-timing");
    insta::assert_snapshot!("evaluate_table", succeed(&arguments, ""));
    let arguments = "evaluate --acquisition --shape bird van --points 120 --runs 4 --method moments,icp";
    insta::assert_snapshot!("evaluate_acquisition", succeed(arguments, ""));
    let arguments = "evaluate --suite frames/s --method moments --runs 2 --no-timing";
    insta::assert_snapshot!("evaluate_markdown", succeed(arguments, ""));
}

#[test]
fn the_same_seed_gives_the_same_bytes_whatever_the_number_of_threads() {
    for format in ["table", "markdown", "json", "csv"] {
        let with = |more: &str| succeed(&format!("{SMALL} --shape bird hat --no-timing --format {format} {more}"), "");
        let one = with("--threads 1 --seed 3");
        assert_eq!(one, with("--threads 4 --seed 3"), "{format}");
        assert_ne!(one, with("--threads 4 --seed 4"), "{format}");
    }
}

#[test]
fn more_shapes_and_runs_leave_the_others_as_they_were() {
    let ratio = |arguments: &str| {
        let document = json(&succeed(&format!("{SMALL} --format json {arguments}"), ""));
        document["evaluations"][0]["methods"]["moments"]["shapes"]["bird"]["ratio"].clone()
    };
    let alone = ratio("--shape bird --method moments");
    assert!(alone.is_f64());
    assert_eq!(alone, ratio("--shape bird van --method filter,moments"));
}

#[test]
fn the_json_holds_every_setting_method_shape_and_parameter() {
    let document =
        json(&succeed("evaluate --points 120 --frames 8,3 --seconds 0.5 --runs 4 --shape bird van --format json", ""));
    assert_eq!((&document["schema"], &document["runs"]), (&"freeform.evaluate/1".into(), &4.into()));
    let evaluations = document["evaluations"].as_array().expect("a list");
    let frames: Vec<_> = evaluations.iter().map(|e| e["frames"].as_u64().expect("a number")).collect();
    assert_eq!(frames, [8, 3, 15]);
    assert!((evaluations[0]["truth"]["b1"].as_f64().expect("a number") + 0.3).abs() < 1e-12);
    for method in ["filter", "moments", "icp"] {
        let result = &evaluations[0]["methods"][method];
        for statistics in [&result["pooled"], &result["shapes"]["bird"], &result["shapes"]["van"]] {
            assert_eq!(statistics["lost"], 0, "{method}");
            assert!(statistics["microseconds_per_frame"].as_f64().is_some_and(|time| time > 0.0), "{method}");
            for name in ["omega", "b1", "b2"] {
                let parameter = &statistics["parameters"][name];
                let number = |field: &str| parameter[field].as_f64().expect(field);
                assert!(number("rmse") > 0.0 && number("bound") > 0.0 && number("bias_standard_error") > 0.0);
                assert!((0.0..=1.0).contains(&number("coverage")), "{parameter}");
                assert!((0.1..30.0).contains(&number("ratio")), "{parameter}");
            }
        }
        assert_eq!(result["pooled"]["runs"], 8);
    }
}

#[test]
fn the_bound_is_that_of_the_points_that_inform_and_follows_noise_and_points() {
    let bound = |arguments: &str| {
        let arguments = format!("evaluate --frames 5 --runs 6 --method moments --format json {arguments}");
        let document = json(&succeed(&arguments, ""));
        let pooled = &document["evaluations"][0]["methods"]["moments"]["pooled"];
        pooled["parameters"]["omega"]["bound"].as_f64().expect("a number")
    };
    let whole = bound("--points 400");
    for (arguments, factor) in [
        ("--points 100", 2.0),
        ("--points 400 --noise 0.01", 2.0),
        ("--points 400 --occlusion 0.19", 1.0 / 0.9),
        ("--points 400 --outliers 0.19", 1.0 / 0.9),
        ("--points 400 --wrong-frames 0.19", 1.0 / 0.9),
    ] {
        let found = bound(arguments) / whole;
        assert!((found - factor).abs() < 1e-6, "{arguments}: {found}");
    }
}

#[test]
fn every_row_of_the_csv_has_the_columns_of_its_header() {
    let csv = succeed(&format!("{SMALL} --shape bird van --format csv"), "");
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|head| *head == name).expect(name);
    // Three methods, two shapes and both together, three parameters and all.
    assert_eq!(rows.len(), 1 + 3 * 3 * 4);
    assert!(rows.iter().all(|row| row.len() == rows[0].len()));
    let (shape, parameter, ratio) = (column("shape"), column("parameter"), column("ratio"));
    assert!(rows[1..].iter().all(|row| row[ratio].parse::<f64>().is_ok()));
    assert_eq!(rows.iter().filter(|row| row[shape] == "pooled" && row[parameter] == "all").count(), 3);
    assert!(column("microseconds_per_frame") > 0);
}

#[test]
fn an_affine_motion_a_similarity_model_and_the_adaptive_method_are_evaluated_too() {
    let methods = |arguments: &str| json(&succeed(arguments, ""))["evaluations"][0]["methods"].clone();
    let affine = methods(
        "evaluate --affine 0.05,1.2,-1.7,-0.08,-0.3,0.4 --scale 1 --frames 20 --runs 3 --format json --points 200",
    );
    for method in ["filter", "moments", "icp"] {
        assert_eq!(affine[method]["pooled"]["lost"], 0, "{method}");
        assert!(affine[method]["pooled"]["parameters"]["a3"]["rmse"].is_f64(), "{method}");
    }
    let adaptive = methods("evaluate --motion similarity --frames 20 --runs 2 --format json --method adaptive,moments");
    assert!(adaptive["moments"]["pooled"]["parameters"]["sigma"]["rmse"].is_f64());
    assert_eq!(adaptive["adaptive"]["pooled"]["coverage"], Value::Null);
}

#[test]
fn a_shape_from_a_file_goes_by_the_name_of_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let wedge = file(folder.path(), "wedge.csv", "x,y\n10,10\n40,10\n40,50\n");
    let arguments = format!("{SMALL} --shape {wedge} bird --method moments --format json");
    assert_eq!(json(&succeed(&arguments, ""))["shapes"], serde_json::json!(["wedge.csv", "bird"]));
    let arguments = format!("evaluate --suite acquisition --runs 1 --method moments --format json --shape {wedge}");
    let document = json(&succeed(&arguments, ""));
    assert_eq!(document["shapes"].as_array().map(Vec::len), Some(7));
    assert_eq!(document["acquisitions"][0]["methods"]["moments"]["shapes"]["wedge.csv"]["runs"], 10);
}

#[test]
fn the_pose_of_an_outline_without_symmetry_is_found_from_two_frames() {
    let document = json(&succeed("evaluate --acquisition --runs 8 --shape van --format json", ""));
    let methods = &document["acquisitions"][0]["methods"];
    for method in ["filter", "moments"] {
        assert_eq!(methods[method]["pooled"], serde_json::json!({"runs": 8, "found": 8, "share": 1.0}), "{method}");
    }
}

#[test]
fn where_every_run_is_lost_there_is_no_result() {
    let output = run("evaluate --method filter --points 5 --frames 3 --runs 2", "");
    assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(1), ""));
    assert_eq!(stderr(&output), "freeform: every run of every method was lost\n");
}

#[test]
fn without_noise_there_are_errors_but_no_ratio() {
    let document = json(&succeed("evaluate --noise 0 --frames 5 --runs 2 --method moments --format json", ""));
    let pooled = &document["evaluations"][0]["methods"]["moments"]["pooled"];
    assert_eq!((&pooled["ratio"], &pooled["lost"]), (&Value::Null, &0.into()));
    assert!(pooled["parameters"]["omega"]["rmse"].is_f64());
}

#[test]
fn what_cannot_be_observed_is_left_out() {
    let arguments = "evaluate --shape circle --omega 0 --b 0,0 --frames 8 --runs 2 --method moments --format json";
    let pooled = json(&succeed(arguments, ""))["evaluations"][0]["methods"]["moments"]["pooled"].clone();
    assert_eq!(pooled["parameters"]["omega"]["bound"], Value::Null);
    assert_eq!(pooled["parameters"]["omega"]["rmse"], Value::Null);
    assert!(pooled["parameters"]["b1"]["ratio"].is_f64());
}

#[test]
fn wrong_usage_is_told_on_one_line() {
    for (arguments, word) in [
        ("--shape nonsense", "nonsense"),
        ("--shape bird bird", "twice"),
        ("--shape nowhere/mask.png", "nowhere/mask.png"),
        ("--frames 1", "2 frames"),
        ("--frames 3,x", "x"),
        ("--seconds 0.01", "no motion"),
        ("--seconds -1", "-1"),
        ("--runs 0", "below 1"),
        ("--threads 0", "below 1"),
        ("--threads 18446744073709551615", "more than 1024 threads"),
        ("--noise NaN", "NaN"),
        ("--points 2", "at least 3"),
        ("--occlusion 1", "[0, 1)"),
        ("--wrong-frames 1.5", "[0, 1)"),
        ("--outliers=-0.1", "[0, 1)"),
        ("--method guess", "guess"),
        ("--motion round", "round"),
        ("--motion rigid --affine 1,2,3,4,5,6", "does not contain"),
        ("--affine 300,0,0,300,0,0 --frames 120", "too large"),
        ("--suite nonsense", "affine, clean"),
        ("--suite --noise 0.1", "--noise"),
        ("--suite --acquisition", "--acquisition"),
        ("--acquisition --omega 1", "--omega"),
        ("--format html", "html"),
        ("--output /nowhere/table.md --frames 3", "/nowhere/table.md"),
    ] {
        let output = run(&format!("evaluate --runs 1 {arguments}"), "");
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {message}");
        assert_eq!(message.lines().count(), 1, "{arguments}: {message}");
        assert!(message.starts_with("freeform: ") && message.contains(word), "{arguments}: {message}");
        assert_eq!(stdout(&output), "", "{arguments}");
    }
}

#[test]
fn the_result_goes_into_a_file_and_a_closed_pipe_is_no_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("table.md");
    let arguments = format!("{SMALL} --method moments --format markdown --output {}", path.display());
    assert_eq!(succeed(&arguments, ""), "");
    assert!(std::fs::read_to_string(&path).expect("the file").contains("| 8 frames |"));

    let arguments: Vec<_> = SMALL.split_whitespace().chain(["--method", "moments"]).collect();
    let output = closing_its_pipe(&arguments);
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""));
}

#[test]
fn the_progress_bar_stays_away_from_a_pipe() {
    let output = freeform(&format!("{SMALL} --method moments")).output().expect("the binary runs");
    assert_eq!(stderr(&output), "");
}

/// A part of the stress suite that takes no time.
const STRESS: &str = "evaluate --suite stress --kinds plain/3 --runs 2";

#[test]
fn the_stress_suite_prints_a_line_for_each_kind_and_class_and_one_for_all() {
    let table = succeed("evaluate --suite stress --kinds frames --runs 1", "");
    for line in ["3 frames", "8 frames", "dropped frames of 20 %", "straight, 15 frames"] {
        assert!(table.contains(line), "{table}");
    }
    for start in ["  plain      all", "  dynamics   all", "  all        all"] {
        assert!(table.lines().any(|line| line.starts_with(start)), "{start}: {table}");
    }
    assert!(table.contains("silent wrong") && table.contains("motion_changed"), "{table}");
    let markdown = succeed(&format!("{STRESS} --format markdown"), "");
    assert!(markdown.lines().any(|line| line.starts_with("| plain | 3 frames | 2 |")), "{markdown}");
}

#[test]
fn the_stress_suite_gives_the_same_json_whatever_the_number_of_threads() {
    let with = |more: &str| succeed(&format!("{STRESS} --format json {more}"), "");
    let one = with("--threads 1 --seed 3");
    assert_eq!(one, with("--threads 4 --seed 3"));
    assert_ne!(one, with("--threads 4 --seed 4"));
    let document = json(&one);
    assert_eq!((&document["schema"], &document["runs"]), (&"freeform.stress/1".into(), &2.into()));
    for summary in [&document["kinds"][0], &document["classes"]["plain"], &document["overall"]] {
        assert!(summary["silent_wrong"].is_f64() && summary["warned"].is_f64(), "{summary}");
        assert!(summary["quantities"]["omega"]["unstated"].is_f64(), "{summary}");
    }
    assert_eq!(document["kinds"][0]["class"], "plain");
}

#[test]
fn the_stress_suite_judges_what_is_stated_after_so_many_frames() {
    let document = json(&succeed("evaluate --suite stress --kinds omega --runs 1 --frames 3 --format json", ""));
    assert_eq!(document["frames"], 3);
    // Nobody can tell a spin that grows slowly from a constant one by three frames.
    let omega = &document["overall"]["quantities"]["omega"];
    assert!(omega["median_deviations"].as_f64().expect("a number") < 3.0, "{omega}");
    let markdown = succeed(&format!("{STRESS} --frames 2 --format markdown"), "");
    assert!(markdown.ends_with("2 runs of each kind, at most the first 2 frames of each, seed 0.\n"), "{markdown}");
}

#[test]
fn the_stress_suite_judges_the_parameters_of_the_family_that_is_asked_for() {
    for (motion, names) in [("similarity", &["b", "omega", "sigma"][..]), ("affine", &["a", "b"])] {
        let document = json(&succeed(&format!("{STRESS} --motion {motion} --format json"), ""));
        assert_eq!(document["motion"], motion);
        let quantities = document["overall"]["quantities"].as_object().expect("an object");
        assert!(quantities.keys().eq(names), "{quantities:?}");
        assert!(quantities.values().all(|of| of["unstated"] == 0.0 && of["silent_wrong"] == 0.0), "{quantities:?}");
    }
    let markdown = succeed(&format!("{STRESS} --motion affine --format markdown"), "");
    assert!(markdown.contains("| a unstated |") && markdown.contains("affine motion, seed 0"), "{markdown}");
}

#[test]
fn the_kinds_of_the_stress_suite_are_listed_with_what_they_are() {
    let all = succeed("evaluate --suite stress --list", "");
    assert!(all.lines().count() > 80, "{all}");
    let round = json(&succeed("evaluate --suite stress --list --kinds round/ --format json", ""));
    let kinds = round["kinds"].as_array().expect("a list");
    assert!(kinds.iter().all(|kind| kind["class"] == "round" && kind["explanation"].is_string()));
    assert!(round["classes"]["round"].is_string());
}

#[test]
fn the_stress_suite_refuses_what_has_no_meaning_there() {
    for (arguments, word) in [
        ("--suite stress --kinds nonsense", "nonsense"),
        ("--suite stress --shape bird", "--shape"),
        ("--suite stress --method icp", "--method"),
        ("--suite stress --format csv", "json"),
        ("--suite stress --noise 0.1", "--noise"),
        ("--suite stress --frames 3,8", "one number"),
        ("--suite arc --kinds plain", "--kinds"),
        ("--suite arc --frames 3", "--frames"),
        ("--suite arc --motion affine", "--motion"),
        ("--suite stress --motion projective", "affine"),
        ("--suite stress --motion plane --focal 900 --principal 320,240", "affine"),
        ("--list", "--list"),
    ] {
        let output = run(&format!("evaluate {arguments}"), "");
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", stderr(&output));
        let message = stderr(&output);
        assert!(message.lines().count() == 1 && message.contains(word), "{arguments}: {message}");
    }
}
