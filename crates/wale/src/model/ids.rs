//! Typed indices: a wrong index must not compile.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
        pub struct $name(pub u32);

        impl $name {
            /// Wraps a table index.
            ///
            /// # Panics
            /// If the index does not fit 32 bits; builders refuse such fabrics long before.
            #[must_use]
            pub fn new(index: usize) -> Self {
                Self(u32::try_from(index).expect("index fits 32 bits"))
            }
            /// The table index.
            #[must_use]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// A contact node: a place in space that a stack of yarn passes shares.
    NodeId
);
id!(
    /// One passage of one yarn through one node. Passes of a yarn are consecutive, in yarn order.
    PassId
);
id!(
    /// A yarn: an unbroken run of passes.
    YarnId
);
id!(
    /// A stitch contact: the two nodes at the ends of the stretch along which loops are wrapped.
    StitchId
);
