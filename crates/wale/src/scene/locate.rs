//! Where in a TOML text a value stands.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The bytes of the value at a path such as `obstacle.0.sphere.radius`, or of the innermost part of the path that the
/// text has. `None` if it has none, or is no TOML.
pub(super) fn span_of(text: &str, path: &str) -> Option<Range<usize>> {
    let document = DeTable::parse(text).ok()?;
    let mut steps = path.split('.');
    let first = steps.next()?;
    let (key, mut value) = document.get_ref().iter().find(|(key, _)| key.get_ref() == first)?;
    let mut span = place(key, value);
    for step in steps {
        let next = match value.get_ref() {
            DeValue::Table(table) => table.iter().find(|(key, _)| key.get_ref() == step),
            DeValue::Array(array) => {
                let Some(element) = step.parse().ok().and_then(|index: usize| array.get(index)) else { break };
                (value, span) = (element, element.span());
                continue;
            }
            DeValue::String(content) => {
                // Bytes within a string, as in `3-5`, where it is written without escapes.
                let within = step
                    .split_once('-')
                    .and_then(|(a, b)| -> Option<(usize, usize)> { Some((a.parse().ok()?, b.parse().ok()?)) });
                let inner = span.start + 1..span.end.saturating_sub(1);
                if let Some((a, b)) = within
                    && text.get(inner.clone()) == Some(content)
                    && a <= b
                    && b <= content.len()
                {
                    span = inner.start + a..inner.start + b;
                }
                None
            }
            _ => None,
        };
        let Some((key, inner)) = next else { break };
        span = place(key, inner);
        value = inner;
    }
    Some(span)
}

/// A table that was opened by a header is long or has no text of its own: its key says where it is.
fn place(key: &Spanned<std::borrow::Cow<'_, str>>, value: &Spanned<DeValue<'_>>) -> Range<usize> {
    if value.get_ref().is_table() || value.get_ref().is_array() && value.span().is_empty() {
        key.span()
    } else {
        value.span()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_tables_are_found() {
        let text = "a = 1\n[b.c]\nd = [10, 20]\n[[e]]\nf = { g = \"x\" }\n[[e]]\nf = 3\n";
        let at = |path| span_of(text, path).map(|span| &text[span]);
        assert_eq!(at("a"), Some("1"));
        assert_eq!(at("b.c.d"), Some("[10, 20]"));
        assert_eq!(at("b.c.d.1"), Some("20"));
        assert_eq!(at("e.0.f.g"), Some("\"x\""));
        assert_eq!(at("e.1.f"), Some("3"));
        assert_eq!(at("b.c.missing"), Some("c"), "the innermost part that is there");
        assert_eq!(at("e.0.f.g.0-1"), Some("x"), "bytes of a string");
        assert_eq!(at("e.0.f.g.0-9"), Some("\"x\""), "bytes that the string does not have");
        assert_eq!(at("missing"), None);
        assert_eq!(span_of("= bad", "a"), None);
    }
}
