//! The folder of a fabric's tests: what may be overwritten in it, and the page of all of them.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use wale::record::RecordError;
use wale::record::atomic_file::write_bytes_atomically;
use wale_lab::report::{MadeTest, is_tests_page, tests_page};

use crate::arguments::lab::Test;
use crate::exit::Failure;

/// That no file of this test is there yet, and no page but one of tests, unless they may be overwritten.
///
/// # Errors
/// [`RecordError::NotEmpty`].
pub fn refuse_taken(folder: &Path, test: &str, suffixes: &[&str], force: bool) -> Result<(), Failure> {
    if force {
        return Ok(());
    }
    let refused = |mend| Err(RecordError::NotEmpty { path: folder.to_owned(), mend }.into());
    if suffixes.iter().any(|suffix| folder.join(format!("{test}{suffix}")).exists()) {
        return refused("there is this test in it: choose another with `--out`, or overwrite it with `--force`");
    }
    match fs::read(page(folder)) {
        Ok(bytes) if !is_tests_page(&String::from_utf8_lossy(&bytes)) => refused(
            "its report.html is not one of virtual tests: choose another with `--out`, or overwrite it with `--force`",
        ),
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Failure::io(&page(folder), "read", error)),
        _ => Ok(()),
    }
}

/// Writes the page of all tests of a folder anew; where it is.
///
/// # Errors
/// If a test cannot be read, or the page not be written.
pub fn write_page(folder: &Path) -> Result<PathBuf, Failure> {
    let mut tests = Vec::new();
    for name in Test::names() {
        tests.extend(made(folder, &name)?);
    }
    let page = page(folder);
    write_bytes_atomically(&page, tests_page(&tests).as_bytes())?;
    Ok(page)
}

fn page(folder: &Path) -> PathBuf {
    folder.join("report.html")
}

/// A test of a folder with its plot; none if it was not made, or the file of that name is something else.
fn made(folder: &Path, name: &str) -> Result<Option<MadeTest>, Failure> {
    let read = |suffix: &str| {
        let path = folder.join(format!("{name}{suffix}"));
        match fs::read(&path) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(Failure::io(&path, "read", error)),
        }
    };
    let made = read(".json")?.and_then(|bytes| serde_json::from_slice::<MadeTest>(&bytes).ok());
    let Some(made) = made.filter(|made| made.test == name) else { return Ok(None) };
    let plot = read(".svg")?.and_then(|bytes| String::from_utf8(bytes).ok());
    Ok(Some(MadeTest { plot, ..made }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_are_none_of_a_test_are_left_out_and_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let test = |name: &str| {
            format!(
                "{{\"test\": \"{name}\", \"by\": \"shell\", \"title\": \"\", \"what\": \"\", \"printed\": [], \"remarks\": []}}"
            )
        };
        let files = [
            ("strip.json", test("strip")),
            ("drape.json", test("strip")),
            ("fast.json", "{\"test\": \"fast\"}".to_owned()),
            ("curl.json", "[".to_owned()),
            ("notes.json", test("notes")),
        ];
        for (name, text) in &files {
            fs::write(folder.path().join(name), text).unwrap();
        }
        let text = fs::read_to_string(write_page(folder.path()).unwrap()).unwrap();
        assert!(text.matches("<h2").count() == 1 && text.contains("id=\"strip\""), "{text}");
        for (name, text) in &files {
            assert_eq!(&fs::read_to_string(folder.path().join(name)).unwrap(), text);
        }
    }

    #[test]
    fn a_page_of_something_else_is_not_overwritten_unasked() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |force| refuse_taken(folder.path(), "strip", &[".csv"], force).is_err();
        assert!(!refused(false));
        write_page(folder.path()).unwrap();
        assert!(!refused(false));
        fs::write(page(folder.path()), "<html>a fit</html>").unwrap();
        assert!(refused(false) && !refused(true));
    }
}
