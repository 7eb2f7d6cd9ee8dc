//! The adaptive method as a bench for those who study it: its options, and what the trace says of the law.
use crate::support::{json, run, sequence, stderr, stdout};

/// The rows of a trace, without those before the motion is known: numbers by the names of their columns.
fn trace(arguments: &str, outlines: &str) -> Vec<std::collections::HashMap<String, f64>> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("trace.csv");
    let output = run(&format!("identify - --method adaptive --quiet {arguments} --trace {}", file.display()), outlines);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = std::fs::read_to_string(file).expect("a trace");
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    let number = |(name, cell): (&&str, &str)| Some(((*name).to_owned(), cell.parse().ok()?));
    let rows = lines.map(|row| header.iter().zip(row).filter_map(number).collect::<std::collections::HashMap<_, _>>());
    rows.filter(|row| row.contains_key("omega")).collect()
}

fn omega(arguments: &str, outlines: &str) -> f64 {
    let output = run(&format!("identify - --method adaptive --quiet --json {arguments}"), outlines);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    json(&stdout(&output))["objects"][0]["parameters"]["omega"]["value"].as_f64().expect("a number")
}

#[test]
fn the_trace_tells_error_lyapunov_function_and_excitation_and_the_function_hardly_ever_grows_without_noise() {
    let outlines = sequence("--shape bird --omega 1.2 --b 0.3,0.1 --noise 0 --points 400 --seconds 12 --fps 30");
    for law in ["structured", "printed", "least-squares", "drem"] {
        let rows = trace(&format!("--law {law}"), &outlines);
        assert!(rows.len() > 300, "{law}: {}", rows.len());
        for row in &rows {
            let [error, energy, lyapunov, excitation] =
                ["error", "energy", "lyapunov", "excitation"].map(|name| row[name]);
            assert!(error >= 0.0 && energy >= 0.0 && excitation >= 0.0 && lyapunov >= energy, "{law}: {row:?}");
        }
        if law == "structured" {
            let values: Vec<f64> = rows.iter().map(|row| row["lyapunov"]).collect();
            // Each frame shows other points of the outline, of which the curve is a little different. Of exact lines it never grows, which a
            // property of the law tests.
            let grows = values.windows(2).find(|pair| pair[1] > pair[0] + 5e-3 * values[0]);
            assert_eq!(grows, None);
            assert!(values[values.len() - 1] < 0.01 * values[0], "{values:?}");
        }
    }
}

#[test]
fn every_law_pair_fit_and_start_is_there_and_least_squares_and_mixing_find_the_turn_soon() {
    let outlines = sequence("--shape bird --omega 1.2 --b 0.3,0.1 --noise 0 --seconds 8 --fps 30");
    for law in ["least-squares", "drem"] {
        let found = omega(&format!("--law {law}"), &outlines);
        assert!((found - 1.2).abs() < 0.03, "{law}: {found}");
    }
    let usual = omega("", &outlines);
    for given in [
        "--pairs best",
        "--pairs 1",
        "--am -1,-1,-2,-2",
        "--q 1,1,1,1",
        "--initial 0.5,0,0",
        "--initial random",
        "--initial random:7",
        "--fit 3l",
        "--fit gs3l",
        "--size 1.5",
    ] {
        let found = omega(given, &outlines);
        assert!(found.is_finite() && found != usual, "{given}: {found}");
    }
    for same in
        ["--law structured", "--pairs all", "--am -0.5,-0.5,-1,-1", "--q 0.5,1,2,3", "--initial 0,0,0", "--size 0.6"]
    {
        assert_eq!(omega(same, &outlines), usual, "{same}");
    }
}

#[test]
fn a_larger_object_in_the_identifier_settles_sooner() {
    let outlines = sequence("--shape phone --omega 1.2 --b 0.3,0.1 --noise 0.002 --seconds 10 --fps 30");
    let [small, large] = ["0.6", "1.5"].map(|size| (omega(&format!("--size {size}"), &outlines) - 1.2).abs());
    assert!(large < 0.5 * small, "{small} {large}");
}

#[test]
fn options_of_the_laws_are_refused_where_they_mean_nothing() {
    let outlines = sequence("--seconds 1");
    let refused = |arguments: &str| {
        let output = run(&format!("identify - {arguments}"), &outlines);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", stderr(&output));
        stderr(&output)
    };
    assert!(refused("--law drem --size 2").contains("--law, --size: only for --method adaptive"));
    let wrong = [
        ("--initial 1,2", "expected omega,b1,b2, found 2 number(s)"),
        ("--am 1,1,1,1", "stab"),
        ("--am 1,2,3", "expected 4 numbers or 16, found 3"),
        ("--q -1,1,1,1", "positive definite"),
        ("--size 0", "above 0"),
        ("--pairs 4", "neither"),
        ("--law fast", "possible values"),
        ("--motion projective --law printed", "projective"),
    ];
    for (arguments, reason) in wrong {
        let told = refused(&format!("--method adaptive {arguments}"));
        assert!(told.contains(reason), "{arguments}: {told}");
    }
}
