//! Periodic tiles of yarns in full contact [Sperl2022, sections 6 and 7].
