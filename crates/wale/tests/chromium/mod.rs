//! A headless Chromium for tests of pages, of this crate and of others.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

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

/// Runs the browser on an address, with a folder of its own; what it prints.
pub fn browse(browser: &Path, folder: &Path, address: &str, more: &[String]) -> String {
    let printed = folder.join("printed");
    let mut child = Command::new(browser)
        .args(["--headless=new", "--no-sandbox", "--disable-background-networking", "--no-first-run"])
        .args(["--hide-scrollbars", "--disable-dev-shm-usage", "--virtual-time-budget=10000"])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .args(more)
        .arg(address)
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
