//! The two floating-point widths a block matrix can be stored in.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A real number of 32 or 64 bits.
pub trait Scalar:
    Copy
    + Send
    + Sync
    + Default
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The nearest number of this width.
    fn from_f64(value: f64) -> Self;
    /// The same number in 64 bits.
    fn to_f64(self) -> f64;
    /// `self * factor + summand`, in one rounding where the target has the instruction.
    fn fused(self, factor: Self, summand: Self) -> Self;
    /// Square root.
    fn root(self) -> Self;
    /// Neither infinite nor NaN.
    fn finite(self) -> bool;
}

/// Without the instruction `mul_add` is a library call, some fifty times slower than two roundings.
const FUSED: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));

macro_rules! scalar {
    ($t:ty) => {
        impl Scalar for $t {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn fused(self, factor: Self, summand: Self) -> Self {
                if FUSED { self.mul_add(factor, summand) } else { self * factor + summand }
            }
            #[inline(always)]
            fn root(self) -> Self {
                self.sqrt()
            }
            #[inline(always)]
            fn finite(self) -> bool {
                self.is_finite()
            }
        }
    };
}

scalar!(f32);
scalar!(f64);

/// A number as it is kept in memory.
pub trait Stored<T>: Copy {
    /// The number.
    fn load(self) -> T;
}

impl<T: Scalar> Stored<T> for T {
    #[inline(always)]
    fn load(self) -> T {
        self
    }
}

/// The upper half of a number of 32 bits: eight bits of precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coarse(u16);

impl Coarse {
    /// The nearest one, even if two are as near.
    #[inline(always)]
    pub fn nearest(value: f32) -> Self {
        let bits = value.to_bits();
        Self((bits.wrapping_add(0x7fff + (bits >> 16 & 1)) >> 16) as u16)
    }
}

impl Stored<f32> for Coarse {
    #[inline(always)]
    fn load(self) -> f32 {
        f32::from_bits(u32::from(self.0) << 16)
    }
}
