//! A headless Chromium that opens a page, runs a script in it, and hands back what it answers or how it looks.

#[path = "../../../wale/tests/chromium/mod.rs"]
mod chromium;

use std::fs;
use std::path::Path;

use serde_json::Value;
use wale::picture::{Image, read_png};

pub use chromium::chromium_or_say_so;

/// Runs the browser on a page; what it prints.
fn browse(browser: &Path, folder: &Path, html: &str, more: &[String]) -> String {
    let page = folder.join("page.html");
    fs::write(&page, html).expect("a page");
    let more = [&["--disable-gpu".to_owned()], more].concat();
    chromium::browse(browser, folder, &format!("file://{}", page.display()), &more)
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
