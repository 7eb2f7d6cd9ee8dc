//! The report in a real browser: no errors on the console, nothing wider than the page, on wide and narrow, light and dark
//! screens; its player by keys, slider and buttons. Skipped where no Chromium is installed.
use std::path::Path;
use std::process::{Command, Output};

/// The browser's name on different systems.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

fn browser() -> Option<&'static str> {
    NAMES
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success()))
}

fn report(folder: &Path) -> String {
    let freeform = |arguments: &[&str]| {
        let output = assert_cmd::Command::cargo_bin("freeform").expect("the binary is built");
        let mut output = output;
        let output = output.current_dir(folder).args(arguments).output().expect("the binary runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    freeform(&["simulate", "--seconds", "1", "--points", "150", "--output", "outlines.csv"]);
    // An outline that belongs to no frame before it, so that there is a rejected frame to tell of.
    let mut csv = std::fs::read_to_string(folder.join("outlines.csv")).expect("outlines");
    csv.push_str("40,2,5,5\n40,2,6,5\n40,2,5.5,6\n40,2,5.2,5.5\n");
    std::fs::write(folder.join("outlines.csv"), csv).expect("outlines");
    freeform(&["identify", "outlines.csv", "--scale", "0.1", "--report", "report.html", "--quiet"]);
    std::fs::read_to_string(folder.join("report.html")).expect("a report")
}

/// The report of pictures that show nothing.
fn report_of_nothing(folder: &Path) -> String {
    let picture = image::GrayImage::new(64, 64);
    let frames: Vec<String> = (0..12).map(|frame| format!("a-picture-with-nothing-in-it-{frame}.png")).collect();
    frames.iter().for_each(|name| picture.save(folder.join(name)).expect("a picture"));
    let mut command = assert_cmd::Command::cargo_bin("freeform").expect("the binary is built");
    let command = command.current_dir(folder).arg("identify").args(&frames);
    command.args(["--report", "nothing.html", "--quiet"]).assert().code(1);
    std::fs::read_to_string(folder.join("nothing.html")).expect("a report")
}

fn load(browser: &str, profile: &Path, page: &Path, scheme: &str) -> Output {
    Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--enable-logging=stderr"])
        .arg("--window-size=1400,1000")
        .arg(format!("--blink-settings=preferredColorScheme={scheme}"))
        .arg(format!("--user-data-dir={}", profile.display()))
        // Time goes on as fast as there is nothing to do, so that what plays is played.
        .args(["--virtual-time-budget=6000", "--dump-dom"])
        .arg(format!("file://{}", page.display()))
        .output()
        .expect("the browser runs")
}

#[test]
fn the_report_loads_without_errors_and_fits_the_page() {
    let Some(browser) = browser() else {
        println!("skipped: no Chromium is installed");
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let whole = report(folder.path());
    for needed in ["Rejected frames", "Residual of the points", "Innovation", "freeform identify outlines.csv"] {
        assert!(whole.contains(needed), "{needed}");
    }
    let nothing = report_of_nothing(folder.path());
    for needed in ["No motion was identified", "Pictures without an outline: 12", "2 more"] {
        assert!(nothing.contains(needed), "{needed}");
    }
    for html in [whole, nothing] {
        assert_readable(browser, folder.path(), &html);
    }
}

/// Loads a page on wide and narrow, light and dark screens.
fn assert_readable(browser: &str, folder: &Path, html: &str) {
    assert!(!html.contains("http://") && !html.contains("https://"), "the report needs nothing but itself");
    let html = serde_json::to_string(html).expect("text").replace("</", "<\\/");
    let page = folder.join("measured.html");
    let mut grounds = Vec::new();
    // 0 prefers dark, 1 light.
    for (width, scheme) in [(1280, "1"), (400, "1"), (400, "0")] {
        // A frame of its own, since a window is never as narrow.
        let measure = format!(
            "<!DOCTYPE html><title></title><body><script>const frame = document.createElement('iframe'); \
             frame.style = 'border: 0; width: {width}px; height: 900px'; frame.onload = () => {{ \
             const page = frame.contentDocument, e = page.documentElement; document.title = \
             e.scrollWidth + ' ' + e.clientWidth + ' ' + getComputedStyle(page.body).backgroundColor; }}; \
             frame.srcdoc = {html}; document.body.append(frame);</script></body>"
        );
        std::fs::write(&page, measure).expect("a page");
        let output = load(browser, &folder.join("profile"), &page, scheme);
        let (dom, log) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(!log.contains("CONSOLE"), "{log}");
        let title = dom.split("<title>").nth(1).and_then(|rest| rest.split("</title>").next()).expect("a title");
        let mut words = title.splitn(3, ' ');
        let mut number = || words.next().and_then(|word| word.parse::<u32>().ok()).expect("a width");
        let (content, screen) = (number(), number());
        println!("{width} px wide: page {screen}, content {content}, {title}");
        // All but the bar to scroll by.
        assert!((width - 20..=width).contains(&screen) && content <= screen, "{title}");
        grounds.push(words.next().expect("a colour").to_owned());
    }
    assert!(grounds[0] == grounds[1] && grounds[1] != grounds[2], "{grounds:?}");
}

/// Works the player of a report as a reader would, and gives what it shows after each act.
const DRIVER: &str = r#"<script>
const player = document.querySelector('.player');
const part = (name) => player.querySelector(name);
const shown = () => ({
  now: part('.now').textContent, spoken: part('input').getAttribute('aria-valuetext'), slider: part('input').value,
  rejected: part('.stage .points').classList.contains('rejected'), play: part('.play').textContent,
  points: part('.stage .points').getAttribute('d').length, known: part('.stage .known').getAttribute('d').length,
  way: part('.stage .travelled').getAttribute('d').length, view: part('.stage').getAttribute('viewBox'),
  omega: part('.values tr:nth-child(2) td:nth-child(2)').textContent,
});
const seen = {};
const press = (key, on = 'input') => part(on).dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }));
seen.first = shown();
press('ArrowRight'); seen.right = shown();
press('End'); seen.end = shown();
press('ArrowRight'); seen.beyond = shown();
press('ArrowLeft'); seen.left = shown();
part('.zoom').click(); seen.zoomed = shown(); seen.pressed = part('.zoom').getAttribute('aria-pressed');
part('.zoom').click();
part('input').value = 5; part('input').dispatchEvent(new Event('input', { bubbles: true })); seen.slid = shown();
press('Home'); seen.home = shown();
press(' '); seen.playing = shown();
seen.marks = part('.marks path').getAttribute('d');
setTimeout(() => {
  seen.later = shown();
  press(' '); seen.paused = shown();
  part('.play').click();
}, 1000);
setTimeout(() => {
  seen.done = shown();
  seen.errors = window.errors;
  seen.nameless = [...document.querySelectorAll('button, input')].filter(
    (e) => !(e.textContent.trim() || e.getAttribute('aria-label'))).length;
  document.title = JSON.stringify(seen);
}, 5500);
</script>"#;

#[test]
fn the_player_is_worked_by_keys_slider_and_buttons() {
    let Some(browser) = browser() else {
        println!("skipped: no Chromium is installed");
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let watched = "<script>window.errors = []; onerror = (text) => errors.push(text);</script>";
    let page = report(folder.path()).replace("<head>", &format!("<head>{watched}"));
    let page = page.replace("</body>", &format!("{DRIVER}</body>"));
    std::fs::write(folder.path().join("driven.html"), page).expect("a page");
    let output = load(browser, &folder.path().join("profile"), &folder.path().join("driven.html"), "1");
    let (dom, log) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(!log.contains("CONSOLE"), "{log}");
    let title = dom.split("<title>").nth(1).and_then(|rest| rest.split("</title>").next()).expect("a title");
    let title = title.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
    let seen: serde_json::Value = serde_json::from_str(&title).unwrap_or_else(|_| panic!("{title}"));
    let text = |act: &str, what: &str| seen[act][what].as_str().expect("text").to_owned();
    let number = |act: &str, what: &str| seen[act][what].as_u64().expect("a number");

    assert_eq!(seen["errors"], serde_json::json!([]));
    assert_eq!(seen["nameless"], 0, "every control has a name");
    assert!(text("first", "now").starts_with("Frame 0, 0 s") && text("first", "omega") == "not stated");
    assert!(text("right", "now").starts_with("Frame 1, 0.03") && number("right", "known") > 1000);
    // The last of 31 is the outline that belongs to no frame before it.
    for act in ["end", "beyond"] {
        assert!(text(act, "now").starts_with("Frame 40") && text(act, "now").contains("not used: "), "{act}");
        assert_eq!((text(act, "slider").as_str(), seen[act]["rejected"].as_bool()), ("30", Some(true)));
    }
    assert_eq!(text("end", "now"), text("end", "spoken"), "what is seen is said");
    assert_eq!(seen["marks"], "M30 0v1");
    assert!(text("left", "now").starts_with("Frame 29") && seen["left"]["rejected"] == false);
    let omega = text("left", "omega").split_whitespace().next().and_then(|text| text.parse::<f64>().ok());
    assert!(omega.is_some_and(|omega| (omega - std::f64::consts::FRAC_PI_2).abs() < 0.005), "{omega:?}");
    assert!(number("left", "way") > number("right", "way"));
    assert!(number("left", "points") > 150 * 8, "a dot for each point");
    assert!(text("zoomed", "view") != text("left", "view") && seen["pressed"] == "true");
    assert!(text("slid", "now").starts_with("Frame 5,") && text("slid", "view") == text("left", "view"));
    assert!(text("home", "now").starts_with("Frame 0,"));
    assert_eq!((text("playing", "play").as_str(), text("paused", "play").as_str()), ("Pause", "Play"));
    let place = |act: &str| text(act, "slider").parse::<u32>().expect("a number");
    assert!(place("playing") == 0 && (5..29).contains(&place("later")), "{}", place("later"));
    assert_eq!(place("paused"), place("later"));
    assert_eq!((place("done"), text("done", "play").as_str()), (30, "Play"), "it plays to the end and stops");
}
