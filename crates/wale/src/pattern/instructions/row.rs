//! The grammar of one row.

use super::lexer::Line;
use super::parts::{Part, PartKind, Row};
use super::yarns::Yarns;
use super::{DEEPEST_NESTING, InstructionError, InstructionErrorReason as Reason};
use crate::pattern::increase::{Part as Into, Parts};
use crate::pattern::stitch::{NotHeld, Stitch};

type Parsed<T> = Result<T, InstructionError>;

/// Reads parts up to the end of the line.
pub(super) fn parse(line: &mut Line<'_>, yarns: &mut Yarns) -> Parsed<Row> {
    let yarn = yarns.current;
    let mut parts = sequence(line, End::Line, 0, yarns)?;
    if !line.is_empty() {
        return Err(line.expected("a stitch"));
    }
    if parts.iter().all(|part| matches!(part.kind, PartKind::With(_))) {
        return Err(line.expected("stitches"));
    }
    // "Row 1: knit" knits the whole row.
    let mut worked = parts.iter_mut().filter(|part| !matches!(part.kind, PartKind::With(_)));
    if let (Some(part), None) = (worked.next(), worked.next())
        && let PartKind::Stitches(Stitch::Knit | Stitch::Purl, 1) = part.kind
        && !part.source.ends_with(|c: char| c.is_ascii_digit())
    {
        let whole = part.clone();
        part.kind = PartKind::Fill(vec![whole], 1, Some(0));
    }
    Ok(Row { parts, yarn })
}

/// What ends a sequence of parts.
#[derive(Clone, Copy, PartialEq)]
enum End {
    Line,
    Bracket(char),
    Star,
}

fn sequence(line: &mut Line<'_>, end: End, depth: usize, yarns: &mut Yarns) -> Parsed<Vec<Part>> {
    if depth > DEEPEST_NESTING {
        return Err(line.error(Reason::TooDeep));
    }
    let mut parts = Vec::new();
    loop {
        line.skip_separators();
        let start = line.place().start;
        let kind = match (line.sign(), end) {
            (Some('*'), End::Star) => break,
            (Some(close), End::Bracket(closer)) if close == closer => break,
            (Some(open @ ('[' | '(')), _) => bracket(line, open, depth, yarns)?,
            (Some('*'), _) => star(line, depth, yarns)?,
            (Some(_), _) => return Err(line.expected("a stitch")),
            (None, _) => match line.word() {
                None => break,
                Some("rep" | "repeat") if end == End::Star => break,
                Some("with") => PartKind::With(yarns.switch(line)?),
                Some(_) => stitches(line)?,
            },
        };
        let place = start..line.end_of_last();
        let source = line.source(&place);
        // Of yarns that are taken in hand one after the other the last is knitted with; a repeat of many would be long work for nothing.
        let is_yarn = |part: &Part| matches!(part.kind, PartKind::With(_));
        let part = Part { kind, place, source };
        if is_yarn(&part) {
            parts.pop_if(|before| is_yarn(before));
        }
        parts.push(part);
    }
    Ok(parts)
}

/// `[…]` or `(…)` and how often.
fn bracket(line: &mut Line<'_>, open: char, depth: usize, yarns: &mut Yarns) -> Parsed<PartKind> {
    let start = line.place().start;
    line.advance(1);
    let closer = if open == '[' { ']' } else { ')' };
    let parts = sequence(line, End::Bracket(closer), depth + 1, yarns)?;
    if !line.take_sign(closer) {
        return Err(line.expected("the closing bracket"));
    }
    if matches!(line.word(), Some("in" | "into")) {
        return increase(line, &parts, start);
    }
    let count = fixed_count(line, &parts, start)?;
    if let Some(leave) = stretch(line)? {
        return fill(line, parts, count, Some(leave), start);
    }
    let times = times(line)?.unwrap_or(1);
    repeat(line, parts, count, times, start)
}

/// `(k1, yo, k1) in next st`: several loops out of one.
fn increase(line: &mut Line<'_>, parts: &[Part], start: usize) -> Parsed<PartKind> {
    let place = start..line.end_of_last();
    line.advance(1);
    line.take_word(&["the"]);
    line.take_word(&["next", "same", "1", "one"]);
    if !line.take_word(&["st", "stitch"]) {
        return Err(line.expected("`next st`"));
    }
    let mut worked = Vec::new();
    for part in parts {
        let (into, count) = match part.kind {
            PartKind::Stitches(Stitch::Knit, count) => (Into::Knit, count),
            PartKind::Stitches(Stitch::Purl, count) => (Into::Purl, count),
            PartKind::Stitches(Stitch::YarnOver, 1) => (Into::YarnOver, 1),
            _ => (Into::YarnOver, u64::MAX),
        };
        // One more than can be is as good as any.
        worked.extend((0..count.min(Parts::MOST as u64 + 1)).map(|_| into));
    }
    let parts = Parts::new(&worked).ok_or_else(|| {
        let part = line.source(&place);
        line.error_at(place.clone(), Reason::Increase { part })
    })?;
    Ok(PartKind::Stitches(Stitch::Increase(parts), times(line)?.unwrap_or(1)))
}

/// `*…*`, `*…* 3 times`, `*…*; rep from * to end` or `*…; rep from * to end`.
fn star(line: &mut Line<'_>, depth: usize, yarns: &mut Yarns) -> Parsed<PartKind> {
    let start = line.place().start;
    line.advance(1);
    let parts = sequence(line, End::Star, depth + 1, yarns)?;
    let closed = line.take_sign('*');
    let count = fixed_count(line, &parts, start)?;
    // A separator may stand between the closing star and "rep from *".
    let mut ahead = 0;
    while closed && matches!(line.sign_after(ahead), Some(',' | ';' | '.')) {
        ahead += 1;
    }
    if matches!(line.word_after(ahead), Some("rep" | "repeat")) {
        line.advance(ahead + 1);
        if !(line.take_word(&["from"]) && line.take_sign('*')) {
            return Err(line.expected("`from *`"));
        }
        if let Some(leave) = stretch(line)? {
            return fill(line, parts, count, Some(leave), start);
        }
        return match times(line)? {
            // Knitters count the times after the first.
            Some(more) => repeat(line, parts, count, more + 1, start),
            None => fill(line, parts, count, None, start),
        };
    }
    if !closed {
        return Err(line.expected("a closing `*` or `rep from *`"));
    }
    if let Some(leave) = stretch(line)? {
        return fill(line, parts, count, Some(leave), start);
    }
    match times(line)? {
        Some(times) => repeat(line, parts, count, times, start),
        None => fill(line, parts, count, None, start),
    }
}

fn repeat(line: &Line<'_>, parts: Vec<Part>, count: u64, times: u64, start: usize) -> Parsed<PartKind> {
    match count.checked_mul(times) {
        Some(_) => Ok(PartKind::Repeat(parts, count, times)),
        None => {
            let found = format!("{count} × {times}");
            Err(line.error_at(start..line.end_of_last(), Reason::Count { found }))
        }
    }
}

/// `k`, `k2`, `knit 2 sts`, `k to end`, `purl to last 3 sts`, `knit across`, `k2tog tbl`, `sl1, k1, psso`.
fn stitches(line: &mut Line<'_>) -> Parsed<PartKind> {
    if let Some(stitch) = passed_over(line) {
        return Ok(PartKind::Stitches(stitch, times(line)?.unwrap_or(1)));
    }
    let place = line.place();
    let whole = line.word().unwrap_or_default().to_owned();
    let unknown = || {
        let word = line.source(&place);
        line.error(
            NotHeld::named(&word)
                .map_or(Reason::UnknownStitch { word: word.clone() }, |why| Reason::NotHeld { word, why }),
        )
    };
    if line.sign_after(1) == Some('/') && whole.bytes().all(|b| b.is_ascii_digit()) {
        return Err(crossing(line));
    }
    // `k2togtbl` is `k2tog tbl`.
    let word = whole.strip_suffix("tbl").filter(|word| !word.is_empty()).unwrap_or(&whole);
    let (name, digits) = match word.find(|c: char| c.is_ascii_digit()) {
        // `k2tog` and its like have a digit of their own.
        Some(at) if Stitch::named(word).is_none() => word.split_at(at),
        _ => (word, ""),
    };
    let stitch = Stitch::named(name).ok_or_else(unknown)?;
    if !digits.bytes().all(|b| b.is_ascii_digit()) {
        return Err(unknown());
    }
    let count = if digits.is_empty() { None } else { Some(line.count(digits)?) };
    line.advance(1);
    let stitch = through_back(line, stitch, word.len() < whole.len(), place.start)?;
    if let Some(count) = count {
        return Ok(PartKind::Stitches(slipped(line, stitch)?, count));
    }
    if let Some(leave) = stretch(line)? {
        let (start, takes) = (place.start, stitch.takes() as u64);
        let one = Part { kind: PartKind::Stitches(stitch, 1), source: line.source(&place), place };
        return fill(line, vec![one], takes, Some(leave), start);
    }
    if !matches!(stitch, Stitch::Knit | Stitch::Purl | Stitch::Slip { .. }) {
        return Ok(PartKind::Stitches(stitch, times(line)?.unwrap_or(1)));
    }
    let counted = line.word().is_some_and(|word| word.starts_with(|c: char| c.is_ascii_digit()));
    let count = if counted { line.number("a count")? } else { 1 };
    line.take_word(&["st", "sts", "stitch", "stitches"]);
    let stitch = through_back(line, stitch, false, place.start)?;
    Ok(PartKind::Stitches(slipped(line, stitch)?, count))
}

/// `tbl`, as a word of its own or joined to the stitch: through the back of the loops.
fn through_back(line: &mut Line<'_>, stitch: Stitch, joined: bool, start: usize) -> Parsed<Stitch> {
    if !line.take_word(&["tbl"]) && !joined {
        return Ok(stitch);
    }
    let place = start..line.end_of_last();
    let twisted = || Reason::NotHeld { word: line.source(&place), why: NotHeld::Twisted };
    stitch.through_back_loops().ok_or_else(|| line.error_at(place.clone(), twisted()))
}

/// `2/2 LC`, a cable by how many stitches cross how many.
fn crossing(line: &mut Line<'_>) -> InstructionError {
    let start = line.place().start;
    line.advance(1);
    while line.take_sign('/') {
        line.advance(1);
    }
    line.advance(usize::from(line.word().is_some()));
    let place = start..line.end_of_last();
    line.error_at(place.clone(), Reason::NotHeld { word: line.source(&place), why: NotHeld::Cable })
}

/// `sl1, k1, psso`, `sl1-k2tog-psso`, `sl 2 knitwise, k1, p2sso`, `sl1, p1, psso`: decreases that pass slipped stitches over what is worked.
fn passed_over(line: &mut Line<'_>) -> Option<Stitch> {
    let mark = line.mark();
    let found = slip_knit_pass(line).and_then(Stitch::named);
    if found.is_none() {
        line.back_to(mark);
    }
    found
}

/// The name of a decrease that is written out.
fn slip_knit_pass(line: &mut Line<'_>) -> Option<&'static str> {
    fn hyphen_or_separators(line: &mut Line<'_>) {
        line.take_sign('-');
        line.skip_separators();
    }
    let slipped = counted(line, &["sl", "slip"])?;
    line.take_word(&["st", "sts", "stitch", "stitches"]);
    line.take_word(&["tog", "together"]);
    line.take_word(NEEDLE_GOES_IN);
    hyphen_or_separators(line);
    let purled = line.word()?.starts_with('p');
    let (together, alone) = if purled { ("p2tog", ["p", "purl"]) } else { ("k2tog", ["k", "knit"]) };
    let worked = if line.take_word(&[together]) { 2 } else { counted(line, &alone).filter(|count| *count == 1)? };
    hyphen_or_separators(line);
    if !line.take_word(&["psso", "p2sso"]) {
        if !line.take_word(&["pass"]) {
            return None;
        }
        while line.take_word(&["the", "both", "2", "two", "sl", "slip", "slipped", "st", "sts", "stitch", "stitches"]) {
        }
        if !line.take_word(&["over"]) {
            return None;
        }
    }
    // A purl goes through its loops away from the knitter, so that what is passed over it comes to lie behind.
    match (purled, slipped, worked) {
        (false, 1, 1) => Some("skp"),
        (false, 1, 2) => Some("sk2p"),
        (false, 2, 1) => Some("s2kp"),
        (true, 1, 1) => Some("p2tog"),
        (true, 1, 2) => Some("p3tog"),
        _ => None,
    }
}

/// `sl1`, `slip 1`: how often a stitch of one of these names is worked, if it is said.
fn counted(line: &mut Line<'_>, names: &[&str]) -> Option<u64> {
    let word = line.word()?;
    let name = word.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = word[name.len()..].to_owned();
    if !names.contains(&name) {
        return None;
    }
    line.advance(1);
    if !digits.is_empty() {
        return digits.parse().ok();
    }
    let count = match line.word()? {
        "1" | "one" => 1,
        "2" | "two" => 2,
        _ => return None,
    };
    line.advance(1);
    Some(count)
}

/// How the needle goes into a stitch that is slipped.
const NEEDLE_GOES_IN: &[&str] = &["purlwise", "pwise", "pw", "knitwise", "kwise", "kw"];

/// `sl1 purlwise with yarn in front`, `sl1 wyif`: where the yarn passes. The other words say how the needle goes in,
/// which leaves no trace in the fabric.
fn slipped(line: &mut Line<'_>, stitch: Stitch) -> Parsed<Stitch> {
    let Stitch::Slip { mut in_front } = stitch else { return Ok(stitch) };
    line.take_word(NEEDLE_GOES_IN);
    if line.take_word(&["wyif"]) {
        in_front = true;
    } else if line.take_word(&["wyib"]) {
        in_front = false;
    } else if line.word() == Some("with") && line.word_after(1) == Some("yarn") {
        line.advance(2);
        line.take_word(&["in"]);
        in_front = line.word() == Some("front");
        if !line.take_word(&["front", "back"]) {
            return Err(line.expected("`front` or `back`"));
        }
    }
    Ok(Stitch::Slip { in_front })
}

/// Parts that fill the row; they must take stitches of it.
fn fill(line: &Line<'_>, parts: Vec<Part>, takes: u64, leave: Option<u64>, start: usize) -> Parsed<PartKind> {
    if takes == 0 {
        let place = start..line.end_of_last();
        let part = line.source(&place);
        return Err(line.error_at(place, Reason::TakesNothing { part }));
    }
    Ok(PartKind::Fill(parts, takes, leave))
}

/// `to end`, `to last 3 sts`, `across`, `around`, `all sts`: how many stitches are left over.
fn stretch(line: &mut Line<'_>) -> Parsed<Option<u64>> {
    if line.take_word(&["across", "around", "all", "every"]) {
        line.take_word(&["st", "sts", "stitch", "stitches"]);
        return Ok(Some(0));
    }
    if !line.take_word(&["to"]) {
        return Ok(None);
    }
    line.take_word(&["the"]);
    if line.take_word(&["end"]) {
        if line.take_word(&["of"]) {
            line.take_word(&["the"]);
            line.take_word(&["row", "rnd", "round"]);
        }
        return Ok(Some(0));
    }
    if line.take_word(&["last"]) {
        let one = line.take_word(&["st", "stitch"]);
        let leave = if one { 1 } else { line.number("a count")? };
        line.take_word(&["st", "sts", "stitch", "stitches"]);
        return Ok(Some(leave));
    }
    Err(line.expected("`end` or `last … sts`"))
}

/// `3 times`, `3 more times`, `once`, `twice`, `x3`.
fn times(line: &mut Line<'_>) -> Parsed<Option<u64>> {
    let times = match line.word() {
        Some("once") => 1,
        Some("twice") => 2,
        Some("x") => {
            line.advance(1);
            return line.number("a count").map(Some);
        }
        Some(word) if word.starts_with('x') => {
            let times = line.count(&word[1..])?;
            line.advance(1);
            return Ok(Some(times));
        }
        Some(word) if word.starts_with(|c: char| c.is_ascii_digit()) => {
            let times = line.number("a count")?;
            line.take_word(&["more"]);
            if !line.take_word(&["times", "time"]) {
                return Err(line.expected("`times`"));
            }
            return Ok(Some(times));
        }
        _ => return Ok(None),
    };
    line.advance(1);
    line.take_word(&["more"]);
    Ok(Some(times))
}

/// Stitches that parts to be repeated take; none of them may stretch.
fn fixed_count(line: &Line<'_>, parts: &[Part], start: usize) -> Parsed<u64> {
    // Yarns that are changed and never knitted with are nothing, too, however often.
    if parts.iter().all(|part| matches!(part.kind, PartKind::With(_))) {
        return Err(line.error_at(start..line.end_of_last(), Reason::NothingToRepeat));
    }
    let mut sum = 0_u64;
    for part in parts {
        let count = part.fixed().ok_or_else(|| {
            let source = part.source.clone();
            line.error_at(part.place.clone(), Reason::SecondFill { part: source })
        })?;
        sum = sum.checked_add(count).ok_or_else(|| {
            let found = part.source.clone();
            line.error_at(part.place.clone(), Reason::Count { found })
        })?;
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yarns_that_nothing_is_knitted_with_are_no_parts_of_a_row() {
        let text = "with A, with B, k1, [with A, with C, with B, k1] 2 times, with A, with B";
        let row = parse(&mut Line::new(text, 0, text.len()), &mut Yarns::default()).unwrap();
        assert_eq!(row.parts.len(), 4, "with B, k1, the repeat, with B: {row:?}");
        let PartKind::Repeat(parts, ..) = &row.parts[2].kind else { panic!("{row:?}") };
        assert_eq!(parts.len(), 2, "with B, k1: {row:?}");
        let yarn = |part: &Part| if let PartKind::With(yarn) = part.kind { yarn } else { u8::MAX };
        assert_eq!(
            [yarn(&row.parts[0]), yarn(&parts[0]), yarn(&row.parts[3])],
            [1; 3],
            "the last named is knitted with"
        );
    }
}
