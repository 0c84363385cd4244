//! A page that needs no other file: its style, its words, its figures.

/// Of all pages.
const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em}\
pre{white-space:pre-wrap}svg{max-width:100%;height:auto}table{border-collapse:collapse;margin:1em 0}\
th,td{padding:.15em .8em;text-align:right}th:first-child,td:first-child{text-align:left}tr{border-bottom:1px solid #ddd}";

/// A page of HTML around a body; `generator` is what made it, `style` is added to that of all pages.
pub fn document(title: &str, generator: &str, style: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"generator\" content=\"{generator}\">\
         <title>{}</title>\n<style>{STYLE}{style}</style>\n</head><body>\n{body}</body></html>\n",
        escaped(title)
    )
}

/// A figure as a page holds it: in the page's font, since one of its own would be half of the file, as wide as there is room, and
/// with `name` before the names of its clip paths: those of all figures of a page are known to all.
pub fn inlined(svg: &str, name: &str) -> String {
    let without_font = match (svg.find("<style>@font-face"), svg.find("</style>")) {
        (Some(from), Some(to)) if from < to => [&svg[..from], &svg[to + "</style>".len()..]].concat(),
        _ => svg.to_owned(),
    };
    let own = without_font.replace("kuva-clip-", &format!("{name}-clip-"));
    let side = |name: &str| {
        let (_, rest) = own.split_once(&format!(" {name}=\""))?;
        rest.split_once('"')?.0.parse::<f64>().ok()
    };
    match (side("width"), side("height")) {
        (Some(width), Some(height)) => own.replacen("<svg ", &format!("<svg viewBox=\"0 0 {width} {height}\" "), 1),
        _ => own,
    }
}

/// A text as HTML has it.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_in_a_page_has_no_font_of_its_own_and_scales() {
        let svg =
            "<svg xmlns=\"x\" width=\"300\" height=\"200.5\"><style>@font-face{src:url('data:…')}</style><path/></svg>";
        assert_eq!(
            inlined(svg, "one"),
            "<svg viewBox=\"0 0 300 200.5\" xmlns=\"x\" width=\"300\" height=\"200.5\"><path/></svg>"
        );
        assert_eq!(inlined("<svg><path/></svg>", "one"), "<svg><path/></svg>");
    }

    #[test]
    fn figures_of_a_page_share_no_names() {
        let svg = "<svg><clipPath id=\"kuva-clip-0\"/><g clip-path=\"url(#kuva-clip-0)\"/></svg>";
        let [one, other] = ["one", "other"].map(|name| inlined(svg, name));
        assert!(one.contains("id=\"one-clip-0\"") && one.contains("url(#one-clip-0)") && !other.contains("one-clip"));
    }
}
