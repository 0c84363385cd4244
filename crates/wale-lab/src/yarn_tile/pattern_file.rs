//! Reads and writes periodic yarn patterns, `.pyp` files [Sperl2020, Sperl2021].
//!
//! ```text
//! *pattern # px py radius number of vertices
//! *Q       # a vertex a line: x y z, and a twist angle that is not used
//! *E       # an edge a line: first vertex, last vertex, and in which tile the last one lies
//! *RL      # of each vertex: rest length of the edge that begins there
//! *RK      # of each vertex: rest curvature in two material directions
//! *RT      # of each vertex: rest twist of the material directions; without it yarns are as wound as they lie
//! ```
//!
//! Lengths in metres. Sections on reference frames are skipped, which this model does not have. Of curvatures and twists it keeps what the choice of
//! material directions does not change: sizes, and the angle from one to the next, which has half of each vertex's twist.

use std::f64::consts::PI;

use thiserror::Error;

use super::rest::RestShape;
use super::tile::{Edge, MOST_VERTICES, TileFault, YarnTile};

/// Why a file is no yarn pattern, and where.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{file}:{line}: {what}: {why}; {mend}")]
pub struct PatternFileError {
    /// The file's name.
    pub file: String,
    /// Line, from one; the line after the last where something is missing.
    pub line: usize,
    /// What is wrong.
    pub what: String,
    /// Why it is.
    pub why: String,
    /// What to do about it.
    pub mend: String,
}

/// Sections that are read, with the least and largest number of numbers in a line.
const SECTIONS: [(&str, usize, usize); 6] =
    [("pattern", 4, 4), ("Q", 3, 4), ("E", 4, 4), ("RL", 1, 1), ("RK", 2, 2), ("RT", 1, 1)];
/// The last of these may be missing.
const TWISTS: usize = 5;
/// Sections that are skipped.
const SKIPPED: [&str; 2] = ["RefD1", "RefT"];
/// Longest piece of the file that an error repeats.
const MOST_REPEATED: usize = 40;

/// The numbers of a section, row by row, each with its line.
#[derive(Default)]
struct Section {
    header: usize,
    rows: Vec<(usize, Vec<f64>)>,
}

struct Reader<'a> {
    file: &'a str,
    sections: [Option<Section>; 6],
    last_line: usize,
}

/// Reads a pattern.
///
/// # Errors
/// The first [`PatternFileError`].
pub fn read_pattern(file: &str, text: &str) -> Result<YarnTile, PatternFileError> {
    let mut reader = Reader { file, sections: Default::default(), last_line: text.lines().count() + 1 };
    reader.split(text)?;
    reader.tile()
}

impl Reader<'_> {
    fn error(&self, line: usize, what: impl Into<String>, why: impl Into<String>, mend: &str) -> PatternFileError {
        PatternFileError { file: self.file.into(), line, what: what.into(), why: why.into(), mend: mend.into() }
    }

    fn split(&mut self, text: &str) -> Result<(), PatternFileError> {
        // The section that lines now belong to, none where they are skipped.
        let mut current: Option<Option<usize>> = None;
        for (index, raw) in text.lines().enumerate() {
            let line = index + 1;
            let content = raw.split('#').next().unwrap_or_default().trim();
            if content.is_empty() {
                continue;
            }
            if let Some(name) = content.strip_prefix('*') {
                current = Some(self.begin(line, name.trim())?);
                continue;
            }
            match current {
                None => {
                    let why = "no section has begun";
                    return Err(self.error(line, repeated(content), why, "begin the file with `*pattern`"));
                }
                Some(None) => {}
                Some(Some(section)) => {
                    let row = self.row(line, content, section)?;
                    let rows = &mut self.sections[section].as_mut().expect("it has begun").rows;
                    if rows.len() >= MOST_VERTICES {
                        let why = format!("a section has at most {MOST_VERTICES} lines");
                        return Err(self.error(line, "a line too many", why, "give a smaller repeat"));
                    }
                    rows.push((line, row));
                }
            }
        }
        Ok(())
    }

    /// A section begins: its place among those that are read.
    fn begin(&mut self, line: usize, name: &str) -> Result<Option<usize>, PatternFileError> {
        if SKIPPED.contains(&name) {
            return Ok(None);
        }
        let Some(section) = SECTIONS.iter().position(|s| s.0 == name) else {
            let known: Vec<&str> = SECTIONS.iter().map(|s| s.0).chain(SKIPPED).collect();
            let why = format!("sections are {}", known.join(", "));
            return Err(self.error(line, format!("section {}", repeated(name)), why, "rename it or leave it out"));
        };
        if let Some(first) = &self.sections[section] {
            let why = format!("it stands in line {} already", first.header);
            return Err(self.error(line, format!("section `{name}`"), why, "keep one of the two"));
        }
        self.sections[section] = Some(Section { header: line, rows: Vec::new() });
        Ok(Some(section))
    }

    fn row(&self, line: usize, content: &str, section: usize) -> Result<Vec<f64>, PatternFileError> {
        let (name, least, most) = SECTIONS[section];
        let mut row = Vec::with_capacity(most);
        for word in content.split_whitespace() {
            let number = word.parse::<f64>().ok().filter(|x| x.is_finite() && x.abs() < 1e9);
            let Some(number) = number else {
                let why = format!("section `{name}` has finite numbers alone");
                return Err(self.error(line, repeated(word), why, "write a number there"));
            };
            if row.len() == most {
                let why = format!("a line of section `{name}` has at most {most} numbers");
                return Err(self.error(line, repeated(word), why, "take out what is too many"));
            }
            row.push(number);
        }
        if row.len() < least {
            let what = format!("{} numbers", row.len());
            let why = format!("a line of section `{name}` has at least {least}");
            return Err(self.error(line, what, why, "write those that are missing"));
        }
        Ok(row)
    }

    fn section(&self, section: usize) -> Result<&Section, PatternFileError> {
        let name = SECTIONS[section].0;
        self.sections[section].as_ref().ok_or_else(|| {
            let why = "the file ends without it";
            self.error(self.last_line, format!("section `{name}`"), why, "write the section")
        })
    }

    /// A section with as many lines as there are vertices.
    fn section_of(&self, section: usize, count: usize) -> Result<&Section, PatternFileError> {
        let found = self.section(section)?;
        if found.rows.len() == count {
            return Ok(found);
        }
        let what = format!("{} lines of section `{}`", found.rows.len(), SECTIONS[section].0);
        let why = format!("the pattern has {count} vertices and edges");
        Err(self.error(found.header, what, why, "write a line for each"))
    }

    /// A whole number within bounds.
    fn whole(&self, line: usize, value: f64, bounds: std::ops::Range<i64>) -> Result<i64, PatternFileError> {
        if value.fract() == 0.0 && bounds.contains(&(value as i64)) {
            return Ok(value as i64);
        }
        let why = format!("a whole number from {} to {} is asked for", bounds.start, bounds.end - 1);
        Err(self.error(line, format!("{value}"), why, "write such a number there"))
    }

    fn tile(&self) -> Result<YarnTile, PatternFileError> {
        let pattern = self.section(0)?;
        let [(line, sizes)] = &pattern.rows[..] else {
            let what = format!("{} lines of section `pattern`", pattern.rows.len());
            return Err(self.error(
                pattern.header,
                what,
                "it has one line",
                "write periods, radius and number of vertices",
            ));
        };
        let count = self.whole(*line, sizes[3], 1..MOST_VERTICES as i64 + 1)? as usize;
        let positions = self.section_of(1, count)?;
        let of_edges = self.section_of(2, count)?;
        let mut edges = Vec::with_capacity(count);
        for (line, row) in &of_edges.rows {
            let vertex = |k: usize| self.whole(*line, row[k], 0..count as i64).map(|v| v as u32);
            let tiles = |k: usize| self.whole(*line, row[k], -8..9).map(|s| s as i32);
            edges.push(Edge { ends: [vertex(0)?, vertex(1)?], shift: [tiles(2)?, tiles(3)?] });
        }
        let of_lengths = self.section_of(3, count)?;
        let of_curvatures = self.section_of(4, count)?;
        let vertices = positions.rows.iter().map(|(_, x)| [x[0], x[1], x[2]]).collect();
        // Rest lengths stand in the order of the vertices that edges begin at.
        let lengths = edges.iter().map(|edge| of_lengths.rows[edge.ends[0] as usize].1[0]).collect();
        let curvatures: Vec<[f64; 2]> = of_curvatures.rows.iter().map(|(_, k)| [k[0], k[1]]).collect();
        let twists = match self.sections[TWISTS] {
            Some(_) => Some(self.section_of(TWISTS, count)?.rows.iter().map(|(_, t)| t[0]).collect::<Vec<f64>>()),
            None => None,
        };
        let begins: Vec<u32> = edges.iter().map(|edge| edge.ends[0]).collect();
        let tile = YarnTile::new([sizes[0], sizes[1]], sizes[2], vertices, edges).and_then(|tile| {
            let torsions = match twists {
                Some(twists) => tile.edges().iter().map(|edge| torsion(edge.ends, &curvatures, &twists)).collect(),
                None => tile.rest().torsions.clone(),
            };
            let curvatures = curvatures.iter().map(|k| k[0].hypot(k[1])).collect();
            tile.with_rest(RestShape { lengths, curvatures, torsions })
        });
        tile.map_err(|fault| {
            let line = match &fault {
                TileFault::Edge { edge, .. } => of_edges.rows[*edge].0,
                TileFault::Vertex { vertex } => positions.rows[*vertex].0,
                TileFault::Rest { what: "length", index, .. } => of_lengths.rows[begins[*index] as usize].0,
                TileFault::Rest { what: "torsion", .. } => *line,
                TileFault::Rest { index, .. } => of_curvatures.rows[*index].0,
                TileFault::Fork { .. } => of_edges.header,
                TileFault::Size { .. } | TileFault::Thick { .. } | TileFault::Count { .. } => *line,
            };
            self.error(line, "the numbers", format!("{fault}"), "mend the line")
        })
    }
}

/// The angle by which rest curvatures turn about an edge: that between them in the material directions of both ends, and what these turn
/// by from the middle of one bend to the middle of the other.
fn torsion(ends: [u32; 2], curvatures: &[[f64; 2]], twists: &[f64]) -> f64 {
    let [first, last] = ends.map(|vertex| {
        let [along, across] = curvatures[vertex as usize];
        (across.atan2(along), 0.5 * twists[vertex as usize])
    });
    wrapped(last.0 - first.0 + first.1 + last.1)
}

/// The same angle between −π and π.
fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(2.0 * PI) - PI
}

/// Rest curvatures in material directions without twist but at each yarn's first vertex, where the yarn closes: what [`torsion`] finds again.
fn in_material_directions(tile: &YarnTile) -> (Vec<[f64; 2]>, Vec<f64>) {
    let rest = tile.rest();
    let (mut curvatures, mut twists) = (vec![[0.0; 2]; tile.vertex_count()], vec![0.0; tile.vertex_count()]);
    for yarn in &tile.yarns {
        let begins = |edge: u32| tile.edges()[edge as usize].ends[0] as usize;
        let twist = wrapped(yarn.iter().map(|&edge| rest.torsions[edge as usize]).sum());
        let (first, mut angle) = (begins(yarn[0]), 0.0);
        for &edge in yarn {
            let vertex = begins(edge);
            let (sine, cosine) = f64::sin_cos(angle);
            curvatures[vertex] = [cosine, sine].map(|part| rest.curvatures[vertex] * part);
            angle += rest.torsions[edge as usize] - if vertex == first { 0.5 * twist } else { 0.0 };
        }
        twists[first] = twist;
    }
    (curvatures, twists)
}

/// A piece of the file, cut where it is long.
fn repeated(text: &str) -> String {
    let mut short: String = text.chars().take(MOST_REPEATED).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    format!("`{short}`")
}

/// Writes a tile as [`read_pattern`] reads it.
#[must_use]
pub fn write_pattern(tile: &YarnTile) -> String {
    let mut text = String::new();
    let mut line = |content: String| {
        text.push_str(&content);
        text.push('\n');
    };
    line("*pattern # px py radius vertices".into());
    let [px, py] = tile.periods();
    line(format!("{px:e} {py:e} {:e} {}", tile.radius(), tile.vertex_count()));
    line("\n*Q # x y z".into());
    tile.vertices().iter().for_each(|[x, y, z]| line(format!("{x:e} {y:e} {z:e}")));
    line("\n*E # first last dx dy".into());
    for edge in tile.edges() {
        let ([a, b], [dx, dy]) = (edge.ends, edge.shift);
        line(format!("{a} {b} {dx} {dy}"));
    }
    line("\n*RL # rest length of the edge that begins at each vertex".into());
    for around in &tile.around {
        line(format!("{:e}", tile.rest().lengths[around[1] as usize]));
    }
    let (curvatures, twists) = in_material_directions(tile);
    line("\n*RK # rest curvature in two material directions".into());
    curvatures.iter().for_each(|[along, across]| line(format!("{along:e} {across:e}")));
    line("\n*RT # rest twist of the material directions".into());
    twists.iter().for_each(|twist| line(format!("{twist:e}")));
    text
}

#[cfg(test)]
mod tests {
    use super::super::test_tiles::{basket, stockinette};
    use super::*;

    #[test]
    fn what_is_written_reads_back() {
        for tile in [basket(), stockinette()] {
            let read = read_pattern("tile.pyp", &write_pattern(&tile)).unwrap();
            assert_eq!(read.edges(), tile.edges());
            let (written, kept) = (tile.rest(), read.rest());
            assert_eq!(kept.lengths, written.lengths);
            let near = |a: &f64, b: &f64| (a - b).abs() < 1e-12;
            assert!(kept.curvatures.iter().zip(&written.curvatures).all(|(a, b)| near(a, b)));
            // Where a yarn is straight its torsion is anything.
            for ((edge, a), b) in tile.edges().iter().zip(&kept.torsions).zip(&written.torsions) {
                let bent = edge.ends.iter().all(|&vertex| written.curvatures[vertex as usize] > 1e-9);
                assert!(!bent || wrapped(a - b).abs() < 1e-9, "{a} {b}");
            }
            assert!(written.torsions.iter().any(|torsion| torsion.abs() > 0.1));
            // Heights are measured from their mean again.
            let near = |a: &[f64; 3], b: &[f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-15);
            assert!(read.vertices().iter().zip(tile.vertices()).all(|(a, b)| near(a, b)));
        }
    }

    const GOOD: &str = "*pattern # a comment\n0.01 0.02 0.001 2\n\n*Q\n0 0 0 0.1\n0.005 0 0 0.2\n*E\n1 0 1 0\n0 1 0 0\n*RL\n\
                        0.005\n0.006\n*RK\n3 4\n0 0\n*RefT\nwhatever\n";

    #[test]
    fn rest_lengths_belong_to_the_vertex_that_an_edge_begins_at() {
        let tile = read_pattern("a.pyp", GOOD).unwrap();
        assert_eq!(tile.rest().lengths, [0.006, 0.005]);
        assert_eq!(tile.rest().curvatures, [5.0, 0.0]);
    }

    #[test]
    fn torsion_is_that_of_curvatures_and_twists() {
        let twisted = GOOD.replace("3 4\n0 0\n", "3 4\n0 2\n*RT\n0.1\n0.3\n");
        let turn = |from: [f64; 2], to: [f64; 2]| to[1].atan2(to[0]) - from[1].atan2(from[0]) + 0.2;
        let tile = read_pattern("a.pyp", &twisted).unwrap();
        let expected = [turn([0.0, 2.0], [3.0, 4.0]), turn([3.0, 4.0], [0.0, 2.0])];
        assert!(tile.rest().torsions.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
        let error = read_pattern("a.pyp", &twisted.replace("0.1\n0.3\n", "0.1\n")).expect_err("a line is missing");
        assert!(error.to_string().contains("section `RT`"), "{error}");
    }

    #[test]
    fn errors_say_where_what_why_and_the_mend() {
        let cases = [
            ("*RefT\nwhatever\n", "*twist\n", 16, "`twist`"),
            ("0.006", "six", 12, "`six`"),
            ("0.006", "nan", 12, "`nan`"),
            ("0.006", "1e300", 12, "`1e300`"),
            ("0.006", "0.006 7", 12, "`7`"),
            ("0.006", "-0.006", 12, "-0.006"),
            ("1 0 1 0", "1 0 1", 8, "3 numbers"),
            ("1 0 1 0", "2 0 1 0", 8, "2"),
            ("1 0 1 0", "1 0 0.5 0", 8, "0.5"),
            ("1 0 1 0", "1 0 99 0", 8, "99"),
            ("1 0 1 0", "0 1 1 0", 7, "vertex 0"),
            ("0.01 0.02 0.001 2", "0.01 0.02 0.001 3", 4, "2 lines"),
            ("0.01 0.02 0.001 2", "0.01 -0.02 0.001 2", 2, "second period"),
            ("0.01 0.02 0.001 2", "0.01 0.02 0.001 1e8", 2, "100000000"),
            ("0.01 0.02 0.001 2", "0.01 0.02 0.001 2\n1 1 1 1", 1, "2 lines"),
            ("*RK\n3 4\n0 0\n", "", 15, "`RK`"),
            ("*pattern # a comment\n", "", 1, "no section"),
            ("*RK", "*RL", 13, "line 10 already"),
            ("0.005 0 0 0.2", "0 0 0 0.2", 9, "no length"),
        ];
        for (from, to, line, says) in cases {
            let error = read_pattern("a.pyp", &GOOD.replacen(from, to, 1)).expect_err(to);
            let text = error.to_string();
            assert_eq!(error.line, line, "{to}: {text}");
            assert!(text.contains(says) && text.starts_with(&format!("a.pyp:{line}: ")), "{to}: {text}");
            assert!(!error.mend.is_empty() && text.len() < 250, "{text}");
        }
    }

    #[test]
    fn any_cut_or_changed_byte_is_an_answer_or_an_error() {
        let text = write_pattern(&stockinette());
        for cut in (0..text.len()).step_by(17) {
            let error = read_pattern("a.pyp", &text[..cut]);
            assert!(error.is_ok() || error.is_err_and(|e| e.line <= text.lines().count() + 1));
            let mut bytes = text.clone().into_bytes();
            bytes[cut] = b"*#- 9ex"[cut % 7];
            let changed = String::from_utf8(bytes).expect("ASCII");
            let _ = read_pattern("a.pyp", &changed);
        }
        let long = format!("*pattern\n{}", "9".repeat(100_000));
        assert!(read_pattern("a.pyp", &long).expect_err("too long").to_string().len() < 250);
    }
}
