//! How much yarn lies between one pass and the next.

use super::layout::Layout;
use super::loops::{Form, Loop};
use crate::model::{KnitCard, SegmentKind};

/// A segment before its length is known.
#[derive(Clone, Copy)]
pub(super) struct Segment {
    pub kind: SegmentKind,
    /// Rest length beyond that of its kind \[m\].
    pub extra: f64,
    /// How many loops share the strand that it is part of.
    pub share: u8,
}

impl From<SegmentKind> for Segment {
    fn from(kind: SegmentKind) -> Self {
        Self { kind, extra: 0.0, share: 1 }
    }
}

/// Rest lengths of the parts of a loop \[m\]; every loop holds its length, however the layout shears it.
pub(super) struct RestLengths {
    /// A leg, a head and a sinker.
    pub parts: [f64; 3],
    /// A stitch contact.
    pub stitch: f64,
    /// Extra where knit and purl meet.
    transition: f64,
    /// For each place of the needle that a yarn floats past.
    past: f64,
}

impl RestLengths {
    pub fn new(card: &KnitCard, layout: &Layout) -> Self {
        let [leg, head, sinker] = layout.between_contacts();
        let laid = 2.0 * leg + head + sinker;
        let slack = (card.loop_length - 4.0 * card.stitch_length) / laid;
        Self {
            parts: [slack * leg, slack * head, slack * sinker],
            stitch: card.stitch_length,
            transition: card.transition_length * card.loop_length,
            past: card.wale_spacing,
        }
    }

    /// The segment between two loops that follow each other in a row, `past` places of the needle. A yarn-over has legs
    /// that nothing holds at their feet: half a sinker and the stitch contact that it lacks are part of each.
    pub fn joint(&self, from: &Loop, to: &Loop, past: u32) -> Segment {
        let [leg, _, sinker] = self.parts;
        let unheld = self.stitch;
        let float = f64::from(past) * self.past;
        let open = |of: &Loop| of.form == Form::Open;
        let knit = |of: &Loop| match of.form {
            Form::Worked { knit } => Some(knit),
            _ => None,
        };
        let bound = |of: &Loop| if open(of) && of.children.is_empty() { unheld } else { 0.0 };
        let (kind, extra) = match (open(from), open(to)) {
            (true, true) => (SegmentKind::Leg, leg + 2.0 * unheld + sinker),
            (true, false) | (false, true) => (SegmentKind::Leg, unheld + 0.5 * sinker),
            _ if matches!((knit(from), knit(to)), (Some(a), Some(b)) if a != b) => {
                (SegmentKind::Sinker, self.transition)
            }
            _ => (SegmentKind::Sinker, 0.0),
        };
        Segment { kind, extra: extra + bound(from) + bound(to) + float, share: 1 }
    }

    /// Rest length of a segment whose ends lie `distance` apart in the layout.
    pub fn of(&self, Segment { kind, extra, share }: Segment, distance: f64) -> f64 {
        let [leg, head, sinker] = self.parts;
        let own = match kind {
            SegmentKind::Stitch => self.stitch / f64::from(share),
            SegmentKind::Edge | SegmentKind::Chain | SegmentKind::Interlacing | SegmentKind::Float => distance,
            SegmentKind::Leg => leg,
            SegmentKind::Head => head / f64::from(share),
            SegmentKind::Sinker => sinker,
        };
        own + extra
    }
}
