//! The graph of loops: which loop is drawn through which, and along which loops each yarn runs.
//!
//! Charts and machine programs are worked to this graph, and the network of nodes is made of it
//! (`docs/topics/knit-structure.md`).

/// A loop of the graph.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, PartialOrd, Ord)]
pub struct LoopId(pub u32);

impl LoopId {
    /// The loop at an index.
    ///
    /// # Panics
    /// If the index needs more than 32 bits; charts are limited far below.
    #[must_use]
    pub fn new(index: usize) -> Self {
        Self(u32::try_from(index).expect("loops are limited to 32 bits"))
    }
    /// Its index.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A loop as another sees it: in a periodic tile, in a neighbouring image of it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Held {
    /// The loop.
    pub of: LoopId,
    /// Its image (course, wale) relative to the loop that holds it or is held by it; zero in a finite fabric.
    pub image: [i16; 2],
}

/// How a loop came about.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Form {
    /// Tied at its foot, drawn through nothing.
    CastOn,
    /// Drawn through its parents.
    Worked {
        /// To the front (`true`) or to the back, as seen from the front of the fabric.
        knit: bool,
    },
    /// Laid over the needle: a yarn-over or a tuck.
    Open,
    /// The strand between two loops, lifted and used as a loop.
    Lifted,
}

/// One loop.
#[derive(Clone, PartialEq, Debug)]
pub struct Loop {
    /// How it came about.
    pub form: Form,
    /// Row of the chart; −1 of the cast-on.
    pub row: i32,
    /// Place on the needle after that row, from the left as seen from the front.
    pub column: u32,
    /// Where it lies in the plain layout: columns from the left, rows from the cast-on \[–\].
    pub place: [f64; 2],
    /// How far in front of the middle of the fabric it lies in that layout, in columns.
    pub depth: f64,
    /// The loops that it is drawn through, front to back.
    pub parents: Vec<Held>,
    /// The loops drawn through it, from the left.
    pub children: Vec<Held>,
    /// The place of the bind-off that holds it.
    pub bound: Option<u32>,
    /// Line of the program that made it; 0 of a chart.
    pub source: u32,
}

/// What lies between one place of a yarn and the next.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Onward {
    /// A sinker to the next loop of the row, past `over` places of the needle that the yarn floats over.
    Sinker {
        /// Places floated over.
        over: u32,
    },
    /// The chain of a cast-on.
    Chain,
    /// A turn, a tail, or yarn carried up: as long as it is laid.
    Edge,
}

/// Where a yarn goes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Stop {
    /// Through a loop.
    Loop {
        /// The loop.
        id: LoopId,
        /// From its left leg to its right leg as seen from the front.
        rightward: bool,
    },
    /// Beside an edge of the fabric: a turn, or a tail.
    Beside {
        /// Row, −1 below the first.
        row: i32,
        /// Rows above that row.
        offset: f64,
        /// At the right edge.
        right: bool,
    },
    /// Beside a loop: a turn or a tail of a machine's carrier.
    At {
        /// Columns from the left, rows from the cast-on.
        place: [f64; 2],
        /// Columns in front of the middle.
        depth: f64,
    },
    /// Behind the fabric at a place: the tail of a yarn that begins or ends within a row.
    Behind {
        /// Columns from the left, rows from the cast-on.
        place: [f64; 2],
    },
}

/// A yarn from end to end, or around once in a periodic tile.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Strand {
    /// Which of the fabric's yarns it is of.
    pub yarn: u8,
    /// Where it goes, and what leads on from there.
    pub stops: Vec<(Stop, Onward)>,
}

/// A place of the bind-off: the loops that lie there, and where it is.
#[derive(Clone, PartialEq, Debug)]
pub struct Bound {
    /// The loops that it holds.
    pub loops: Vec<LoopId>,
    /// Columns from the left, rows from the cast-on.
    pub place: [f64; 2],
}

/// How the fabric lies.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Form2d {
    /// A sheet with four edges.
    Sheet,
    /// A tube about the wale direction.
    Tube,
    /// A piece that repeats without end in both directions.
    Tile,
}

/// All loops of a fabric and the yarns that make them.
#[derive(Clone, PartialEq, Debug)]
pub struct LoopGraph {
    /// Sheet, tube or tile.
    pub form: Form2d,
    /// Rows and columns.
    pub size: [u32; 2],
    /// Places on the needle after each row.
    pub row_places: Vec<u32>,
    /// The loops: those of the cast-on, then row by row, each from the left.
    pub loops: Vec<Loop>,
    /// The yarns; each bind-off is a yarn of its own beside these.
    pub strands: Vec<Strand>,
    /// The bind-off, from the left.
    pub bound: Vec<Bound>,
    /// The yarn that binds off.
    pub bind_off_yarn: u8,
}

impl LoopGraph {
    /// A loop.
    #[must_use]
    pub fn of(&self, id: LoopId) -> &Loop {
        &self.loops[id.index()]
    }

    /// Lists the children of every loop after its parents are known; loops of a row are in the order of their places.
    pub(super) fn find_children(&mut self) {
        for child in &mut self.loops {
            child.children.clear();
        }
        for at in 0..self.loops.len() {
            for k in 0..self.loops[at].parents.len() {
                let Held { of, image } = self.loops[at].parents[k];
                let held = Held { of: LoopId::new(at), image: image.map(|shift| -shift) };
                self.loops[of.index()].children.push(held);
            }
        }
    }

    /// Loops that nothing holds: no loop is drawn through them and no bind-off goes through them.
    pub fn unsupported(&self) -> impl Iterator<Item = &Loop> {
        self.loops.iter().filter(|of| of.children.is_empty() && of.bound.is_none())
    }

    /// Strands that float past needles: the most places past, over all yarns.
    #[must_use]
    pub fn longest_float(&self) -> u32 {
        let over = |(_, onward): &(Stop, Onward)| match onward {
            Onward::Sinker { over } => *over,
            _ => 0,
        };
        self.strands.iter().flat_map(|strand| &strand.stops).map(over).max().unwrap_or(0)
    }
}
