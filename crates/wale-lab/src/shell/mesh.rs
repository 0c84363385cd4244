//! Triangle meshes of what is cut from a fabric.

use std::ops::Range;

use wale::fabric::coordinates::BLOCK;

use super::error::{ShellError, positive};

/// A flat mesh of triangles in the specimen's plane.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    /// Vertices, along and across the specimen \[m\].
    pub points: Vec<[f64; 2]>,
    /// Vertices of each triangle, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}

/// Two triangles beside each other: the ends of the edge that they share, the vertex to its left, the vertex to its right.
pub type EdgeStencil = [u32; 4];

impl TriangleMesh {
    /// The edges between two triangles, ordered by their ends.
    ///
    /// # Errors
    /// [`ShellError::Mesh`] if an edge belongs to two triangles on the same side, or a triangle names no vertex.
    pub fn inner_edges(&self) -> Result<Vec<EdgeStencil>, ShellError> {
        let count = self.points.len();
        let mut sides = Vec::with_capacity(3 * self.triangles.len());
        for t in &self.triangles {
            if t.iter().any(|&v| v as usize >= count) {
                return Err(ShellError::Mesh(format!("triangle {t:?} names a vertex that is not among {count}")));
            }
            for k in 0..3 {
                let (a, b, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
                sides.push((a.min(b), a.max(b), a > b, c));
            }
        }
        sides.sort_unstable();
        let mut edges = Vec::new();
        for pair in sides.windows(2) {
            let ((a, b, turned, left), (c, d, other_turned, right)) = (pair[0], pair[1]);
            if (a, b) != (c, d) {
                continue;
            }
            if turned == other_turned {
                return Err(ShellError::Mesh(format!("two triangles lie on the same side of the edge {a}–{b}")));
            }
            edges.push([a, b, left, right]);
        }
        Ok(edges)
    }

    /// Places of the vertices where the mesh lies flat at height zero, as [`ShellSystem`](super::ShellSystem) takes them \[m\].
    #[must_use]
    pub fn laid_flat(&self) -> Vec<f64> {
        let mut q = vec![0.0; BLOCK * self.points.len()];
        for (slots, point) in q.chunks_exact_mut(BLOCK).zip(&self.points) {
            slots[..2].copy_from_slice(point);
        }
        q
    }

    /// Area of each triangle \[m²\], negative where it is clockwise.
    pub fn areas(&self) -> impl Iterator<Item = f64> {
        self.triangles.iter().map(|t| {
            let [p, q, r] = t.map(|v| self.points[v as usize]);
            0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))
        })
    }
}

/// A rectangle in rows of nearly equilateral triangles, whose rows lie across its length: rolled up along its length it is a
/// stack of flat strips, and stores what a cylinder does.
#[derive(Clone, Debug, PartialEq)]
pub struct Rectangle {
    /// The mesh; its first coordinate runs from 0 to the length, its second from 0 to the width \[m\].
    pub mesh: TriangleMesh,
    /// Vertices of each row, from one side to the other. Their number is odd, so one lies at mid-length.
    pub rows: Vec<Range<usize>>,
    /// Length \[m\].
    pub length: f64,
    /// Width \[m\].
    pub width: f64,
}

/// Most triangles of a rectangle: beyond them a mistyped unit is likelier than a large cloth.
const MOST_TRIANGLES: f64 = 4e6;

impl Rectangle {
    /// Meshes a rectangle of this length and width with edges of about this length \[m\].
    ///
    /// # Errors
    /// [`ShellError::Number`] if a length is not positive, [`ShellError::Mesh`] if there would be millions of triangles.
    pub fn new(length: f64, width: f64, edge: f64) -> Result<Self, ShellError> {
        positive("length of the specimen", length)?;
        positive("width of the specimen", width)?;
        positive("edge length of the mesh", edge)?;
        let altitude = 0.75f64.sqrt() * edge;
        let strips = 2.0 * (0.5 * length / altitude).round().max(1.0);
        let columns = (width / edge).round().max(1.0);
        if strips * (2.0 * columns + 1.0) > MOST_TRIANGLES {
            return Err(ShellError::Mesh(format!(
                "edges of {edge} m cut {length} m × {width} m into millions of triangles"
            )));
        }
        let (strips, columns) = (strips as usize, columns as usize);
        let (mut points, mut rows) = (Vec::new(), Vec::new());
        for row in 0..=strips {
            let along = length * row as f64 / strips as f64;
            let start = points.len();
            let place = |k: f64| [along, width * (k / columns as f64).clamp(0.0, 1.0)];
            // Every other row lies half an edge aside, with a vertex more, so that both sides are straight.
            if row % 2 == 0 {
                points.extend((0..=columns).map(|k| place(k as f64)));
            } else {
                points.extend((0..columns + 2).map(|k| place(k as f64 - 0.5)));
            }
            rows.push(start..points.len());
        }
        let mut triangles = Vec::new();
        for strip in 0..strips {
            let turned = strip % 2 == 1;
            let (even, odd) = if turned { (strip + 1, strip) } else { (strip, strip + 1) };
            let e = |k: usize| (rows[even].start + k) as u32;
            let o = |k: usize| (rows[odd].start + k) as u32;
            let mut push = |[a, b, c]: [u32; 3]| triangles.push(if turned { [a, c, b] } else { [a, b, c] });
            for k in 0..=columns {
                push([e(k), o(k), o(k + 1)]);
                if k < columns {
                    push([e(k), o(k + 1), e(k + 1)]);
                }
            }
        }
        Ok(Self { mesh: TriangleMesh { points, triangles }, rows, length, width })
    }

    /// Vertices of the row at mid-length.
    #[must_use]
    pub fn middle(&self) -> Range<usize> {
        self.rows[self.rows.len() / 2].clone()
    }
    /// Vertices of the first and the last row.
    #[must_use]
    pub fn ends(&self) -> [Range<usize>; 2] {
        [self.rows[0].clone(), self.rows[self.rows.len() - 1].clone()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_is_covered_once_by_nearly_equilateral_triangles() {
        let rectangle = Rectangle::new(0.1, 0.06, 0.005).unwrap();
        let mesh = &rectangle.mesh;
        let areas: Vec<f64> = mesh.areas().collect();
        assert!((areas.iter().sum::<f64>() - 0.006).abs() < 1e-15);
        assert!(areas.iter().all(|&a| a > 0.0));
        let equilateral = 0.75f64.sqrt() * 0.5 * 0.005 * 0.005;
        assert!(areas.iter().filter(|&&a| (a / equilateral - 1.0).abs() < 0.1).count() * 10 > 9 * areas.len());
        // Euler: V − E + F = 1 for a disc, and every triangle has three edges of which the inner ones are shared.
        let inner = mesh.inner_edges().unwrap().len();
        let all = 3 * mesh.triangles.len() - inner;
        assert_eq!(mesh.points.len() + mesh.triangles.len(), all + 1);
        for &v in &[rectangle.middle().start, rectangle.middle().end - 1] {
            assert!((mesh.points[v][0] - 0.05).abs() < 1e-15);
        }
        assert_eq!(mesh.points[rectangle.middle().end - 1][1], 0.06);
    }

    #[test]
    fn meshes_that_are_none_are_errors() {
        assert!(Rectangle::new(0.1, f64::NAN, 0.005).is_err());
        assert!(Rectangle::new(0.1, 0.06, 1e-6).unwrap_err().to_string().contains("millions"));
        let points = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.1, 1.0]];
        let mesh = TriangleMesh { points: points.clone(), triangles: vec![[0, 1, 2], [0, 1, 3]] };
        assert!(mesh.inner_edges().is_err());
        assert!(TriangleMesh { points, triangles: vec![[0, 1, 9]] }.inner_edges().is_err());
    }
}
