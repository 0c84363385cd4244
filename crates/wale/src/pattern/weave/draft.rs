//! A draft: which warp ends lie on top at every pick, and what the threads are.

use std::fmt;

use thiserror::Error;

use crate::pattern::repeat::borders;

/// A warp end or a weft pick.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Thread {
    /// Which of the fabric's yarns it is.
    pub yarn: u8,
    /// Colour as sRGB, where the draft says.
    pub color: Option<[u8; 3]>,
    /// Distance from this thread to the next \[m\], where the draft says.
    pub spacing: Option<f64>,
    /// Diameter \[m\], where the draft says.
    pub thickness: Option<f64>,
}

impl Thread {
    /// An end of which nothing is known: of the first yarn.
    pub const WARP: Self = Self { yarn: 0, color: None, spacing: None, thickness: None };
    /// A pick of which nothing is known: of the second yarn.
    pub const WEFT: Self = Self { yarn: 1, ..Self::WARP };
}

/// Why threads and crossings are no draft.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum DraftError {
    /// No end or no pick.
    #[error("a draft has at least one warp end and one weft pick")]
    Empty,
    /// A pick with more or fewer crossings than there are ends.
    #[error("pick {} has {found} crossings, there are {expected} ends", .pick + 1)]
    Ragged {
        /// Pick, counted from 0.
        pick: usize,
        /// Its crossings.
        found: usize,
        /// The ends.
        expected: usize,
    },
    /// More crossings than [`Draft::MAX_CROSSINGS`].
    #[error("{ends} ends × {picks} picks are {} crossings, the limit is {}", u128::from(*.ends) * u128::from(*.picks), Draft::MAX_CROSSINGS)]
    TooLarge {
        /// Ends asked for.
        ends: u64,
        /// Picks asked for.
        picks: u64,
    },
    /// More ends or picks than [`Draft::MAX_THREADS`].
    #[error("{threads} threads, the limit is {} of warp and of weft each", Draft::MAX_THREADS)]
    TooLong {
        /// Ends or picks asked for, whichever are more.
        threads: u64,
    },
}

impl DraftError {
    /// Whether the draft asks for too much rather than being wrong.
    #[must_use]
    pub fn is_size(&self) -> bool {
        matches!(self, Self::TooLarge { .. } | Self::TooLong { .. })
    }
}

/// A draft: for every pick, from the first that was woven, and every end from the left, whether the warp lies on top as
/// seen from the front.
#[derive(Clone, PartialEq)]
pub struct Draft {
    warp_up: Vec<Vec<bool>>,
    /// The ends, from the left.
    pub warp: Vec<Thread>,
    /// The picks, from the first.
    pub weft: Vec<Thread>,
}

impl Draft {
    /// Most crossings of a draft.
    pub const MAX_CROSSINGS: u64 = 16_000_000;

    /// Most ends, and most picks: a kilometre of cloth. Every thread has numbers of its own, however few crossings it has.
    pub const MAX_THREADS: u64 = 1_000_000;

    /// Checks rows of crossings, the first pick first, each from the left; threads of which nothing is known.
    ///
    /// # Errors
    /// If there are none, too many, or rows of unequal length.
    pub fn new(warp_up: Vec<Vec<bool>>) -> Result<Self, DraftError> {
        let expected = warp_up.first().map_or(0, Vec::len);
        Self::check_size(expected as u64, warp_up.len() as u64)?;
        for (pick, row) in warp_up.iter().enumerate() {
            if row.len() != expected {
                return Err(DraftError::Ragged { pick, found: row.len(), expected });
            }
        }
        let (ends, picks) = (expected, warp_up.len());
        Ok(Self { warp_up, warp: vec![Thread::WARP; ends], weft: vec![Thread::WEFT; picks] })
    }

    /// Refuses a size before anything is allocated for it.
    ///
    /// # Errors
    /// If a count is zero, or the crossings are too many.
    pub fn check_size(ends: u64, picks: u64) -> Result<(), DraftError> {
        if ends == 0 || picks == 0 {
            return Err(DraftError::Empty);
        }
        if u128::from(ends) * u128::from(picks) > u128::from(Self::MAX_CROSSINGS) {
            return Err(DraftError::TooLarge { ends, picks });
        }
        if ends.max(picks) > Self::MAX_THREADS {
            return Err(DraftError::TooLong { threads: ends.max(picks) });
        }
        Ok(())
    }

    /// Plain weave: over one, under one.
    #[must_use]
    pub fn plain() -> Self {
        Self::sound(2, 2, |end, pick| (end + pick) % 2 == 0)
    }

    /// Twill: the warp over `over` picks and under `under`, one end further at every pick.
    ///
    /// # Errors
    /// If a count is zero or the repeat is too large.
    pub fn twill(over: usize, under: usize) -> Result<Self, DraftError> {
        let n = over.saturating_add(under);
        Self::check_size(over.min(under) as u64, 1)?;
        Self::check_size(n as u64, n as u64)?;
        Ok(Self::sound(n, n, |end, pick| (pick + n - end % n) % n < over))
    }

    /// Satin: every end on top at all picks of `size` but one, which moves on by `step` from end to end.
    ///
    /// # Errors
    /// If the repeat is too large, or `step` shares a divisor with `size` or is next to it, so that no satin comes out.
    pub fn satin(size: usize, step: usize) -> Result<Self, DraftError> {
        Self::check_size(size as u64, size as u64)?;
        let divides = || (2..=step).any(|d| size.is_multiple_of(d) && step.is_multiple_of(d));
        if size < 5 || step < 2 || step > size - 2 || divides() {
            return Err(DraftError::Empty);
        }
        Ok(Self::sound(size, size, |end, pick| end * step % size != pick))
    }

    /// Basket: blocks of `ends` × `picks` crossings alike.
    ///
    /// # Errors
    /// If a count is zero or the repeat is too large.
    pub fn basket(ends: usize, picks: usize) -> Result<Self, DraftError> {
        Self::check_size(ends as u64, picks as u64)?;
        Self::check_size(2 * ends as u64, 2 * picks as u64)?;
        Ok(Self::sound(2 * ends, 2 * picks, |end, pick| (end < ends) == (pick < picks)))
    }

    fn sound(ends: usize, picks: usize, up: impl Fn(usize, usize) -> bool) -> Self {
        let warp_up = (0..picks).map(|pick| (0..ends).map(|end| up(end, pick)).collect()).collect();
        Self { warp_up, warp: vec![Thread::WARP; ends], weft: vec![Thread::WEFT; picks] }
    }

    /// The draft repeated in both directions to a size.
    ///
    /// # Errors
    /// If a count is zero or the crossings are too many.
    pub fn repeat(&self, ends: usize, picks: usize) -> Result<Self, DraftError> {
        Self::check_size(ends as u64, picks as u64)?;
        let mut draft = Self::sound(ends, picks, |end, pick| self.warp_up(end % self.ends(), pick % self.picks()));
        draft.warp = self.warp.iter().copied().cycle().take(ends).collect();
        draft.weft = self.weft.iter().copied().cycle().take(picks).collect();
        Ok(draft)
    }

    /// What warp and weft do on the other side of the fabric, drawn from this side.
    #[must_use]
    pub fn other_side(mut self) -> Self {
        self.warp_up.iter_mut().flatten().for_each(|up| *up = !*up);
        self
    }

    /// Number of warp ends.
    #[must_use]
    pub fn ends(&self) -> usize {
        self.warp.len()
    }

    /// Number of weft picks.
    #[must_use]
    pub fn picks(&self) -> usize {
        self.weft.len()
    }

    /// Whether the warp lies on top at a crossing, as seen from the front.
    #[must_use]
    pub fn warp_up(&self, end: usize, pick: usize) -> bool {
        self.warp_up[pick][end]
    }

    /// Parts of the segments between crossings that go to the other side: of the warp and of the weft, the mean of all
    /// threads and the most of any; the draft repeats.
    #[must_use]
    pub fn interlacing(&self) -> Interlacing {
        let changes = |count: usize, value: &dyn Fn(usize) -> bool| {
            (0..count).filter(|&at| value(at) != value((at + 1) % count)).count() as f64 / count as f64
        };
        let warp: Vec<f64> =
            (0..self.ends()).map(|end| changes(self.picks(), &|pick| self.warp_up(end, pick))).collect();
        let weft: Vec<f64> =
            (0..self.picks()).map(|pick| changes(self.ends(), &|end| self.warp_up(end, pick))).collect();
        let mean = |parts: &[f64]| parts.iter().sum::<f64>() / parts.len() as f64;
        let most = |parts: &[f64]| parts.iter().copied().fold(0.0, f64::max);
        Interlacing { mean: [mean(&warp), mean(&weft)], most: [most(&warp), most(&weft)] }
    }

    /// The smallest draft that this one repeats, threads included.
    #[must_use]
    pub fn smallest_repeat(&self) -> Self {
        let (ends, picks) = (self.ends(), self.picks());
        let period =
            |n: usize, equal: &dyn Fn(usize, usize) -> bool| n - borders(n, equal).last().copied().unwrap_or(0);
        let end = period(ends, &|a, b| self.warp[a] == self.warp[b] && self.warp_up.iter().all(|row| row[a] == row[b]));
        let pick = period(picks, &|a, b| self.weft[a] == self.weft[b] && self.warp_up[a] == self.warp_up[b]);
        Self {
            warp_up: self.warp_up[..pick].iter().map(|row| row[..end].to_vec()).collect(),
            warp: self.warp[..end].to_vec(),
            weft: self.weft[..pick].to_vec(),
        }
    }

    /// The draft as a drawdown, the last pick first: `x` where the warp lies on top, `.` where the weft does.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        super::symbols::lines(self)
    }

    /// Number of different yarns.
    #[must_use]
    pub fn yarn_count(&self) -> usize {
        self.warp.iter().chain(&self.weft).map(|thread| usize::from(thread.yarn) + 1).max().unwrap_or(1)
    }

    /// The longest run of crossings that a warp end stays on one side of, and the longest of a weft pick; the draft
    /// repeats. `usize::MAX` of a thread that never changes sides.
    #[must_use]
    pub fn longest_floats(&self) -> [usize; 2] {
        let warp = (0..self.ends()).map(|end| longest_run(self.picks(), |pick| self.warp_up(end, pick)));
        let weft = (0..self.picks()).map(|pick| longest_run(self.ends(), |end| self.warp_up(end, pick)));
        [warp.max().unwrap_or(0), weft.max().unwrap_or(0)]
    }
}

/// How much of warp and weft goes from one side of the fabric to the other \[–\].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Interlacing {
    /// Mean of all ends, and of all picks.
    pub mean: [f64; 2],
    /// Most of any end, and of any pick.
    pub most: [f64; 2],
}

/// Longest run of equal values of a sequence that repeats.
fn longest_run(n: usize, value: impl Fn(usize) -> bool) -> usize {
    let Some(change) = (0..n).find(|at| value(*at) != value((at + 1) % n)) else { return usize::MAX };
    let (mut longest, mut run) = (0, 0);
    for k in 1..=n {
        let (here, next) = ((change + k) % n, (change + k + 1) % n);
        run += 1;
        longest = longest.max(run);
        if value(here) != value(next) {
            run = 0;
        }
    }
    longest
}

impl fmt::Debug for Draft {
    /// As drawdowns are printed: `x` where the warp lies on top, the last pick first.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for row in self.warp_up.iter().rev() {
            writeln!(f)?;
            row.iter().try_for_each(|up| f.write_str(if *up { "x" } else { "." }))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weaves_look_as_weavers_know_them() {
        assert_eq!(format!("{:?}", Draft::plain()), "\n.x\nx.");
        // A right-hand twill rises to the right.
        assert_eq!(format!("{:?}", Draft::twill(2, 2).unwrap()), "\n..xx\n.xx.\nxx..\nx..x");
        assert_eq!(format!("{:?}", Draft::basket(2, 1).unwrap()), "\n..xx\nxx..");
        assert_eq!(format!("{:?}", Draft::satin(5, 2).unwrap()), "\nxx.xx\nxxxx.\nx.xxx\nxxx.x\n.xxxx");
        assert!(Draft::satin(6, 2).is_err() && Draft::satin(4, 2).is_err() && Draft::satin(5, 4).is_err());
        assert!(Draft::twill(0, 2).is_err() && Draft::twill(usize::MAX, 2).is_err());
    }

    #[test]
    fn floats_are_counted_around_the_repeat() {
        assert_eq!(Draft::plain().longest_floats(), [1, 1]);
        assert_eq!(Draft::twill(3, 1).unwrap().longest_floats(), [3, 3]);
        assert_eq!(Draft::satin(8, 3).unwrap().longest_floats(), [7, 7]);
        assert_eq!(Draft::new(vec![vec![true, false], vec![true, false]]).unwrap().longest_floats(), [usize::MAX, 1]);
    }

    #[test]
    fn interlacings_are_counted_around_the_repeat() {
        assert_eq!(Draft::plain().interlacing(), Interlacing { mean: [1.0; 2], most: [1.0; 2] });
        assert_eq!(Draft::twill(3, 1).unwrap().interlacing().mean, [0.5; 2]);
        assert_eq!(Draft::satin(8, 3).unwrap().interlacing().most, [0.25; 2]);
        assert_eq!(Draft::basket(2, 1).unwrap().interlacing().mean, [1.0, 0.5]);
    }

    #[test]
    fn repeats_are_found() {
        let twill = Draft::twill(2, 1).unwrap();
        assert_eq!(twill.repeat(12, 9).unwrap().smallest_repeat(), twill);
        let mut striped = twill.repeat(12, 9).unwrap();
        striped.weft[4].yarn = 3;
        // Nine picks are one and a half times six.
        assert_eq!((striped.smallest_repeat().ends(), striped.smallest_repeat().picks()), (3, 6));
        assert_eq!(striped.smallest_repeat().repeat(12, 9).unwrap(), striped);
        assert_eq!(striped.yarn_count(), 4);
        // One end that differs at the edge of half a million must not ask for their square.
        let mut wide = Draft::plain().repeat(500_000, 1).unwrap();
        (wide.warp[499_998].yarn, wide.warp[499_999].yarn) = (5, 6);
        assert_eq!(wide.smallest_repeat(), wide);
    }

    #[test]
    fn bad_drafts_are_refused() {
        assert_eq!(Draft::new(vec![]).unwrap_err(), DraftError::Empty);
        let ragged = Draft::new(vec![vec![true; 3], vec![true; 2]]).unwrap_err();
        assert_eq!(ragged.to_string(), "pick 2 has 2 crossings, there are 3 ends");
        assert!(Draft::plain().repeat(2, 1_000_001).unwrap_err().to_string().contains("1000001 threads, the limit is"));
        assert!(Draft::plain().repeat(1 << 20, 1 << 20).unwrap_err().to_string().contains("the limit is 16000000"));
    }
}
