//! Where the nodes of a knitted fabric lie before anything has moved: a flat sheet, or the same sheet rolled up.

use std::f64::consts::TAU;

use glam::DVec3;

use super::knit::{LEFT_FOOT, LEFT_LEG, RIGHT_LEG};

/// A node's place.
pub(super) struct Place {
    /// \[m\]
    pub position: DVec3,
    /// Unit vector to the front.
    pub front: DVec3,
    /// Columns from the left, rows from the cast-on.
    pub chart: [f64; 2],
}

/// Places on a flat sheet (x along the course, y along the wale, z to the front), or on a tube about the y axis whose
/// outside is the front.
pub(super) struct Layout {
    wale_spacing: f64,
    course_spacing: f64,
    /// Radius and columns of a tube \[m\].
    tube: Option<f64>,
    columns: usize,
}

/// Half the distance between the feet of a loop, in wales.
const FOOT: f64 = 0.30;
/// Half the distance between the legs of a loop where they cross the parent's head, in wales.
const LEG: f64 = 0.20;
/// Half the height of a stitch contact, in courses.
const CONTACT: f64 = 0.20;
/// How far selvedge turns and tails lie outside the edge, in wales.
const BESIDE: f64 = 0.35;

impl Layout {
    pub fn new(columns: usize, wale_spacing: f64, course_spacing: f64, round: bool) -> Self {
        let tube = round.then(|| columns as f64 * wale_spacing / TAU);
        Self { wale_spacing, course_spacing, tube, columns }
    }

    pub fn is_round(&self) -> bool {
        self.tube.is_some()
    }

    fn place(&self, column: f64, row: f64) -> Place {
        let (s, y) = (column * self.wale_spacing, row * self.course_spacing);
        let (position, front) = match self.tube {
            None => (DVec3::new(s, y, 0.0), DVec3::Z),
            Some(radius) => {
                let (sin, cos) = (s / radius).sin_cos();
                let out = DVec3::new(sin, 0.0, cos);
                (out * radius + DVec3::Y * y, out)
            }
        };
        Place { position, front, chart: [column, row] }
    }

    /// One of the four own nodes of a loop whose middle is there, as much narrower as it shares its parent with others.
    pub fn corner(&self, [column, row]: [f64; 2], corner: usize, share: u8) -> Place {
        let left = corner == LEFT_FOOT || corner == LEFT_LEG;
        let leg = corner == LEFT_LEG || corner == RIGHT_LEG;
        let x = if leg { LEG } else { FOOT } * if left { -1.0 } else { 1.0 } / f64::from(share);
        let y = if leg { CONTACT } else { -CONTACT };
        self.place(column + x, row + y)
    }

    /// The tie of a cast-on loop.
    pub fn cast_on(&self, [column, row]: [f64; 2]) -> Place {
        self.place(column, row + 0.25)
    }

    /// One of the two nodes of a bound-off loop.
    pub fn top(&self, [column, row]: [f64; 2], side: usize) -> Place {
        let x = if side == 0 { -LEG } else { LEG };
        self.place(column + x, row)
    }

    /// A turn or a tail, so many columns in front of the middle.
    pub fn at(&self, [column, row]: [f64; 2], depth: f64) -> Place {
        let mut place = self.place(column, row);
        place.position += place.front * (depth * self.wale_spacing);
        place
    }

    /// The tail of a yarn that begins or ends there, behind the fabric.
    pub fn behind(&self, [column, row]: [f64; 2]) -> Place {
        let mut place = self.place(column, row - CONTACT);
        place.position -= place.front * self.wale_spacing;
        place
    }

    /// A turn or a tail beside the edge, `offset` rows above a row.
    pub fn beside(&self, row: i32, offset: f64, right: bool) -> Place {
        let column = if right { self.columns as f64 + BESIDE } else { -BESIDE };
        if self.is_round() {
            // Beside the seam of a tube is on the next loop: step out of the surface instead.
            let mut place = self.place(if right { self.columns as f64 } else { 0.0 }, f64::from(row) + offset);
            place.position += place.front * (BESIDE * self.wale_spacing) + DVec3::Y * (0.3 * self.course_spacing);
            return place;
        }
        self.place(column, f64::from(row) + offset)
    }

    /// Lengths that a leg, a head and a sinker of a plain stitch have in the layout \[m\].
    pub fn between_contacts(&self) -> [f64; 3] {
        let leg_x = (FOOT - LEG) * self.wale_spacing;
        let leg_y = (1.0 - 2.0 * CONTACT) * self.course_spacing;
        [leg_x.hypot(leg_y), 2.0 * LEG * self.wale_spacing, (1.0 - 2.0 * FOOT) * self.wale_spacing]
    }
}
