//! The page of virtual tests: a table with a line for each, and below it their plots.

use std::fmt::Write;

use serde::{Deserialize, Serialize};

use super::document::{document, escaped, inlined};

/// A test that was made, as the file of its numbers has it.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct MadeTest {
    /// Its name on the command line: `kes-tensile`.
    pub test: String,
    /// The model that was tested: `shell`.
    pub by: String,
    /// What the fabric is called.
    pub title: String,
    /// What was done, in words.
    pub what: String,
    /// Its numbers.
    pub printed: Vec<PrintedGroup>,
    /// What the numbers do not tell.
    pub remarks: Vec<String>,
    /// Its plot, an SVG picture; none if it is not there.
    #[serde(skip)]
    pub plot: Option<String>,
}

/// Numbers of one direction, or of the whole specimen, as they are printed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PrintedGroup {
    /// In words: `weft`.
    pub name: String,
    /// What the laboratory calls each, and the number with its unit.
    pub numbers: Vec<[String; 2]>,
}

/// What the page says that it was made by.
const GENERATOR: &str = "wale lab";
const STYLE: &str = "th,td{text-align:left;vertical-align:top}td p{margin:0}";

/// The page of all tests of a folder.
#[must_use]
pub fn tests_page(tests: &[MadeTest]) -> String {
    let fabrics: Vec<&str> = tests.iter().map(fabric).collect();
    let title = match fabrics.first() {
        Some(first) if fabrics.iter().all(|fabric| fabric == first) => format!("{first}: virtual tests"),
        _ => "Virtual tests".to_owned(),
    };
    let mut body = format!(
        "<h1>{}</h1>\n<table><tr><th>test</th><th>fabric</th><th>by</th><th>numbers</th></tr>\n",
        escaped(&title)
    );
    for made in tests {
        let name = escaped(&made.test);
        let numbers: String = made.printed.iter().map(line).collect();
        let _ = writeln!(
            body,
            "<tr><td><a href=\"#{name}\">{name}</a></td><td>{}</td><td>{}</td><td>{numbers}</td></tr>",
            escaped(fabric(made)),
            escaped(&made.by)
        );
    }
    body.push_str("</table>\n");
    for made in tests {
        let name = escaped(&made.test);
        let plot =
            made.plot.as_ref().map_or_else(|| "<p>Its plot is not there.</p>".to_owned(), |svg| inlined(svg, &name));
        let remarks: String = made.remarks.iter().map(|remark| format!("<li>{}</li>", escaped(remark))).collect();
        let _ = writeln!(
            body,
            "<h2 id=\"{name}\">{name}</h2>\n<p>{}: {}</p>\n{plot}\n<ul>{remarks}</ul>",
            escaped(fabric(made)),
            escaped(&made.what)
        );
    }
    document(&title, GENERATOR, STYLE, &body)
}

/// Whether a text is a page of virtual tests.
#[must_use]
pub fn is_tests_page(text: &str) -> bool {
    text.contains(&format!("<meta name=\"generator\" content=\"{GENERATOR}\">"))
}

fn fabric(made: &MadeTest) -> &str {
    if made.title.is_empty() { "a fabric" } else { &made.title }
}

fn line(group: &PrintedGroup) -> String {
    let number =
        |[name, shown]: &[String; 2]| format!("{} <b>{}</b>", escaped(name), escaped(shown)).trim_start().to_owned();
    let numbers: Vec<String> = group.numbers.iter().map(number).collect();
    format!("<p>{}: {}</p>", escaped(&group.name), numbers.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(test: &str, title: &str) -> MadeTest {
        MadeTest {
            test: test.to_owned(),
            by: "shell".to_owned(),
            title: title.to_owned(),
            what: "to 5 N".to_owned(),
            printed: vec![PrintedGroup {
                name: "weft".to_owned(),
                numbers: vec![["B, rigidity".to_owned(), "0.1 gf·cm²/cm".to_owned()]],
            }],
            remarks: vec!["flat".to_owned()],
            plot: Some("<svg><g id=\"kuva-clip-0\"/></svg>".to_owned()),
        }
    }

    #[test]
    fn every_test_has_its_line_and_its_plot() {
        let one = made("stretch", "Calico <1>");
        let page = tests_page(&[one.clone(), MadeTest { plot: None, ..made("fast", "Calico <1>") }]);
        assert_eq!(page.matches("<tr><td>").count(), 2);
        assert!(page.contains("<h1>Calico &lt;1&gt;: virtual tests</h1>"), "{page}");
        assert!(page.contains("<p>weft: B, rigidity <b>0.1 gf·cm²/cm</b></p>"), "{page}");
        assert!(page.contains("id=\"stretch-clip-0\"") && page.contains("Its plot is not there"), "{page}");
        assert!(is_tests_page(&page) && !is_tests_page("<html></html>"));
        // Of several fabrics none gives the page its name.
        assert!(tests_page(&[one, made("fast", "")]).contains("<h1>Virtual tests</h1>"));
    }
}
