//! The report in a real browser: no errors on the console, nothing wider than the page, on wide and narrow, light and dark
//! screens. Skipped where no Chromium is installed.
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
        .arg("--dump-dom")
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
