//! A headless Chromium that opens a page, runs a script in it, and hands back what it answers or how it looks.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use wale::picture::{Image, read_png};

/// Longest that a browser may take: a hung one must fail the test, not hang it.
const PATIENCE: Duration = Duration::from_secs(120);

/// The browser to test with: `WALE_CHROMIUM`, or the first of the usual names in the path.
fn chromium() -> Option<PathBuf> {
    if let Some(path) = std::env::var_os("WALE_CHROMIUM") {
        return Some(path.into());
    }
    let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).flat_map(|folder| names.map(|name| folder.join(name))).find(|file| file.is_file())
}

/// The browser, or a loud word that the test saw nothing.
pub fn chromium_or_say_so(test: &str) -> Option<PathBuf> {
    let found = chromium();
    if found.is_none() {
        let required = std::env::var("WALE_REQUIRE_CHROMIUM").is_ok_and(|v| v == "1");
        assert!(!required, "{test}: no Chromium found, and WALE_REQUIRE_CHROMIUM=1");
        eprintln!("SKIPPED {test}: no Chromium found (set WALE_CHROMIUM to its path)");
    }
    found
}

/// Runs the browser on a page; what it prints.
fn browse(browser: &Path, folder: &Path, html: &str, more: &[String]) -> String {
    let page = folder.join("page.html");
    fs::write(&page, html).expect("a page");
    let printed = folder.join("printed");
    let mut child = Command::new(browser)
        .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run"])
        .args(["--hide-scrollbars", "--disable-dev-shm-usage", "--virtual-time-budget=10000"])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .args(more)
        .arg(format!("file://{}", page.display()))
        .stdout(File::create(&printed).expect("a file"))
        .stderr(Stdio::null())
        .spawn()
        .expect("Chromium starts");
    let start = Instant::now();
    // Some versions stay after their work is done; none may hang the test.
    while child.try_wait().expect("Chromium can be waited for").is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().expect("Chromium can be stopped");
            child.wait().expect("Chromium ends");
            break;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    fs::read_to_string(&printed).expect("what Chromium printed")
}

/// The page with a script that runs when the page is ready, which it may be before the script is read.
fn with_script(html: &str, script: &str) -> String {
    let (before, after) = html.rsplit_once("</body>").expect("a page has a body");
    format!(
        "{before}<script>const whenReady = () => {{ {script} }};
        if (document.body.dataset.state) whenReady(); else window.addEventListener('register-ready', whenReady);</script></body>{after}"
    )
}

/// A page that is visited.
pub struct Visit<'a> {
    browser: &'a Path,
    html: &'a str,
}

impl<'a> Visit<'a> {
    pub fn new(browser: &'a Path, html: &'a str) -> Self {
        Self { browser, html }
    }

    /// What a script returns, run as the body of a function.
    pub fn run(&self, script: &str) -> Value {
        let folder = tempfile::tempdir().expect("a folder for the browser");
        // The answer alone is left of the page: photographs need not be printed.
        let whole = format!(
            "let answer; try {{ answer = (() => {{ {script} }})(); }} catch (error) {{ answer = {{ thrown: error.stack }}; }}
             const held = document.createElement('pre'); held.textContent = JSON.stringify(answer);
             held.id = 'answer'; document.body.replaceChildren(held);"
        );
        let printed = browse(self.browser, folder.path(), &with_script(self.html, &whole), &["--dump-dom".into()]);
        let answer = printed.split_once("<pre id=\"answer\">").and_then(|(_, rest)| rest.split_once("</pre>"));
        let (answer, _) = answer.unwrap_or_else(|| panic!("no answer in {}", &printed[..printed.len().min(2000)]));
        let answer = answer.replace("&lt;", "<").replace("&gt;", ">").replace("&nbsp;", "\u{a0}").replace("&amp;", "&");
        let value: Value = serde_json::from_str(&answer).expect("JSON");
        assert!(value["thrown"].is_null(), "{}", value["thrown"]);
        value
    }
}

/// How a page looks after a script; kept in the folder `WALE_KEEP_SCREENSHOTS` if there is such a variable.
pub fn screenshot(browser: &Path, html: &str, script: &str, size: [usize; 2], name: &str) -> Image {
    let folder = tempfile::tempdir().expect("a folder for the browser");
    let shot = folder.path().join("shot.png");
    let more = [format!("--window-size={},{}", size[0], size[1]), format!("--screenshot={}", shot.display())];
    browse(browser, folder.path(), &with_script(html, script), &more);
    let bytes = fs::read(&shot).expect("Chromium wrote a screenshot");
    if let Some(keep) = std::env::var_os("WALE_KEEP_SCREENSHOTS") {
        fs::write(Path::new(&keep).join(format!("{name}.png")), &bytes).expect("screenshots can be kept");
        fs::write(Path::new(&keep).join(format!("{name}.html")), html).expect("pages can be kept");
    }
    read_png(&bytes).expect("the screenshot is a picture")
}
