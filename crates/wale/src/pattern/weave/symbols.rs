//! Drafts drawn with symbols, as drawdowns are printed.

use thiserror::Error;

use super::draft::{Draft, DraftError};

/// Why lines are no draft.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum DraftSymbolError {
    /// A symbol that is neither.
    #[error("line {} has `{symbol}`; `x` or `#` is the warp on top, `.` or `-` the weft", .line + 1)]
    Symbol {
        /// Line from the top, counted from 0.
        line: usize,
        /// The symbol.
        symbol: char,
    },
    /// Lines of unequal length, or none.
    #[error(transparent)]
    Shape(#[from] DraftError),
}

/// Reads a drawdown, the last pick first, `x` where the warp lies on top and `.` where the weft does.
///
/// # Errors
/// If a symbol is another, or the lines make no draft.
pub fn read_draft(lines: &[String]) -> Result<Draft, DraftSymbolError> {
    let line = |(at, text): (usize, &String)| -> Result<Vec<bool>, DraftSymbolError> {
        text.chars()
            .filter(|c| !c.is_whitespace())
            .map(|symbol| match symbol {
                'x' | 'X' | '#' | '|' | '■' => Ok(true),
                '.' | '-' | '_' | '□' => Ok(false),
                _ => Err(DraftSymbolError::Symbol { line: at, symbol }),
            })
            .collect()
    };
    let rows: Result<Vec<Vec<bool>>, DraftSymbolError> = lines.iter().enumerate().rev().map(line).collect();
    Ok(Draft::new(rows?)?)
}

/// The lines of a draft.
pub(super) fn lines(draft: &Draft) -> Vec<String> {
    let symbol = |up: bool| if up { 'x' } else { '.' };
    let row = |pick: usize| (0..draft.ends()).map(|end| symbol(draft.warp_up(end, pick))).collect();
    (0..draft.picks()).rev().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawdowns() {
        let twill = Draft::twill(2, 1).unwrap();
        assert_eq!(read_draft(&lines(&twill)).unwrap(), twill);
        let wrong = read_draft(&["x.".to_owned(), "k.".to_owned()]).unwrap_err();
        assert_eq!(wrong, DraftSymbolError::Symbol { line: 1, symbol: 'k' });
        assert!(matches!(read_draft(&[]), Err(DraftSymbolError::Shape(DraftError::Empty))));
    }
}
