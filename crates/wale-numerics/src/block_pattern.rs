//! The sparsity pattern of a symmetric block matrix: which pairs of blocks meet.

/// Sorted columns of every block row; symmetric, diagonal always present.
///
/// Fixed for as long as the connections are; matrices share it through an `Arc`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockPattern {
    row_start: Vec<usize>,
    columns: Vec<u32>,
    diagonal: Vec<usize>,
}

impl BlockPattern {
    /// The pattern over `rows` blocks in which every given pair meets, in both orders.
    ///
    /// Pairs may repeat and come in any order; diagonal blocks need not be given.
    ///
    /// # Panics
    /// If a pair names a block that is not below `rows`, or `rows` exceeds `u32`.
    pub fn from_pairs(rows: usize, pairs: impl IntoIterator<Item = (u32, u32)>) -> Self {
        let count = u32::try_from(rows).expect("at most u32::MAX block rows");
        let mut entries: Vec<u64> = (0..u64::from(count)).map(|i| (i << 32) | i).collect();
        for (i, j) in pairs {
            assert!(i < count && j < count, "block pair ({i}, {j}) outside {rows} rows");
            if i != j {
                let (i, j) = (u64::from(i), u64::from(j));
                entries.push((i << 32) | j);
                entries.push((j << 32) | i);
            }
        }
        entries.sort_unstable();
        entries.dedup();
        let mut row_start = Vec::with_capacity(rows + 1);
        let mut diagonal = Vec::with_capacity(rows);
        let mut columns = Vec::with_capacity(entries.len());
        row_start.push(0);
        for (position, &entry) in entries.iter().enumerate() {
            let (row, column) = ((entry >> 32) as usize, entry as u32);
            if row + 1 > row_start.len() {
                row_start.push(position);
            }
            if row == column as usize {
                diagonal.push(position);
            }
            columns.push(column);
        }
        if rows > 0 {
            row_start.push(entries.len());
        }
        Self { row_start, columns, diagonal }
    }

    /// Number of block rows (and columns).
    #[inline]
    pub fn rows(&self) -> usize {
        self.diagonal.len()
    }

    /// Number of stored blocks.
    #[inline]
    pub fn block_count(&self) -> usize {
        self.columns.len()
    }

    /// Place of the first block of each row, one more entry than rows.
    #[inline]
    pub fn row_start(&self) -> &[usize] {
        &self.row_start
    }

    /// Columns of all blocks, row after row.
    #[inline]
    pub fn columns(&self) -> &[u32] {
        &self.columns
    }

    /// Sorted columns of one row.
    #[inline]
    pub fn row(&self, row: usize) -> &[u32] {
        &self.columns[self.row_start[row]..self.row_start[row + 1]]
    }

    /// Place of block `(row, column)`, if the two meet.
    #[inline]
    pub fn position(&self, row: usize, column: usize) -> Option<usize> {
        // Rows hold about ten blocks: looking along beats halving.
        let found = self.row(row).iter().position(|&c| c as usize == column)?;
        Some(self.row_start[row] + found)
    }

    /// Place of the diagonal block of one row.
    #[inline]
    pub fn diagonal_position(&self, row: usize) -> usize {
        self.diagonal[row]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pattern_is_sorted_symmetric_and_has_its_diagonal() {
        let pattern = BlockPattern::from_pairs(5, [(3, 1), (1, 3), (0, 4), (2, 2), (1, 0)]);
        assert_eq!(pattern.rows(), 5);
        assert_eq!(pattern.row(0), [0, 1, 4]);
        assert_eq!(pattern.row(1), [0, 1, 3]);
        assert_eq!(pattern.row(2), [2]);
        assert_eq!(pattern.row(3), [1, 3]);
        assert_eq!(pattern.row(4), [0, 4]);
        for row in 0..5 {
            assert_eq!(pattern.position(row, row), Some(pattern.diagonal_position(row)));
        }
        assert_eq!(pattern.position(2, 3), None);
    }

    #[test]
    fn an_empty_pattern_is_allowed() {
        let pattern = BlockPattern::from_pairs(0, []);
        assert_eq!((pattern.rows(), pattern.block_count()), (0, 0));
        assert_eq!(pattern.row_start(), [0]);
    }
}
