use crate::support::{file, json, run, sequence, small_pictures, stderr, succeed};

#[test]
fn a_velocity_that_is_not_known_though_all_parameters_are_is_told_with_the_reason() {
    // How far a rod has gone along itself its few points at the ends tell, and their edges are in doubt.
    let folder = tempfile::tempdir().expect("a folder");
    let rod = file(folder.path(), "rod.csv", "x,y\n-1,-0.05\n1,-0.05\n1,0.05\n-1,0.05\n");
    let csv = succeed(&format!("simulate --shape {rod} --points 100 --noise 0.005 --seconds 0.5 --omega 2"), "");
    // Far from the origin, whose velocity is judged by that distance.
    let moved = csv.lines().map(|line| match line.splitn(4, ',').collect::<Vec<_>>()[..] {
        [frame, time, x, y] if x.parse::<f64>().is_ok() => {
            format!("{frame},{time},{},{y}\n", x.parse::<f64>().expect("a number") + 8.0)
        }
        _ if line.starts_with('#') => String::new(),
        _ => format!("{line}\n"),
    });
    let csv: String = moved.collect();
    let output = run("identify - --edge-uncertainty 0.05 --json", &csv);
    let object = &json(&String::from_utf8(output.stdout.clone()).expect("UTF-8"))["objects"][0];
    for name in ["omega", "b1", "b2"] {
        assert!(object["parameters"][name]["value"].is_f64(), "{object}");
    }
    assert!(object["velocity"].is_null() && object["unstated"]["velocity"] == "unknown", "{object}");
    let warnings = object["warnings"].as_array().expect("a list");
    let told = warnings.iter().find(|warning| warning["code"] == "not_known").expect("a warning");
    let message = "not known well enough at the end to be stated: v1, v2";
    assert_eq!(told["message"], message);
    assert!(stderr(&output).contains(message), "{}", stderr(&output));
    // Known edges tell it, and nothing is said.
    let known = run("identify - --json", &csv);
    assert!(!stderr(&known).contains("not known"), "{}", stderr(&known));
}

#[test]
fn warnings_of_results_and_of_pictures_and_tables_are_printed_with_their_codes() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = sequence("") + "20,5.0,1,1\n";
    let told = stderr(&run("identify -", &rows));
    assert!(told.contains("freeform: warning[frame_rejected]: object 0: rejected: <stdin>:"), "{told}");
    let pictures = small_pictures(folder.path(), 12);
    let table = folder.path().join("o.csv");
    let told = stderr(&run(&format!("outline {pictures} --output {}", table.display()), ""));
    assert!(told.contains("freeform: warning[rate_assumed]: 30 frames/s assumed"), "{told}");
    // The table says it again.
    let told = stderr(&run(&format!("identify {}", table.display()), ""));
    assert!(told.contains("freeform: warning[rate_assumed]: "), "{told}");
    // What is in no list has no code.
    let told = stderr(&run("identify - --degree 4", &sequence("")));
    assert!(told.contains("freeform: warning: --degree: "), "{told}");
}
