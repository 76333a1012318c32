//! Vectors of floats, as wide as the machine has them, with the operators of numbers.
//!
//! [`dispatch`] runs a kernel with the widest instructions that the machine has of those that the
//! program was built for, picked at run time.
//!
//! Every lane takes the same operations in the same order as a number would, none fused, so f64
//! results do not depend on the machine. Operations of f32 that say so may be fused. They serve
//! bounds only: what is within their rounding is decided in f64.
//!
//! Kernels must not use closures, which would not be compiled for those instructions.

use pulp::{Arch, Simd, WithSimd};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// Runs a kernel.
#[inline(always)]
pub fn dispatch<K: WithSimd>(kernel: K) -> K::Output {
    instructions().dispatch(kernel)
}

/// Returns the widest instructions that the machine has.
#[cfg(not(test))]
#[inline(always)]
fn instructions() -> Arch {
    Arch::new()
}

/// Returns the instructions that a test asked for; by itself the widest.
#[cfg(test)]
fn instructions() -> Arch {
    if scalar::IS_ON.load(std::sync::atomic::Ordering::Relaxed) { Arch::Scalar } else { Arch::new() }
}

/// Kernels without vectors, for tests that compare results.
#[cfg(test)]
pub(crate) mod scalar {
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::{Mutex, PoisonError};

    /// Whether kernels take one number at a time, on all threads.
    pub(super) static IS_ON: AtomicBool = AtomicBool::new(false);

    /// Held by the test that compares: what runs beside it may be either way, as it is the same.
    static TURN: Mutex<()> = Mutex::new(());

    /// Switches back, also after a panic.
    struct Scalar;

    impl Drop for Scalar {
        fn drop(&mut self) {
            IS_ON.store(false, Ordering::Relaxed);
        }
    }

    /// Returns what `work` returns in vectors, and what it returns in scalar code.
    pub(crate) fn in_vectors_and_scalars<T>(work: impl Fn() -> T) -> [T; 2] {
        let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let in_vectors = work();
        IS_ON.store(true, Ordering::Relaxed);
        let _until_the_end = Scalar;
        [in_vectors, work()]
    }
}

macro_rules! numbers {
    ($numbers:ident, $mask:ident, $float:ident, $vector:ident, $bits:ident,
     $splat:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $min:ident, $max:ident, $sqrt:ident,
     $less:ident, $at_most:ident, $select:ident, $and:ident, $or:ident, $first:ident, $count:ident, $load:ident, $store:ident) => {
        #[doc = concat!("Several `", stringify!($float), "`.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $numbers<S: Simd>(S, S::$vector);

        /// A mask: a truth value for each lane.
        #[derive(Clone, Copy, Debug)]
        pub struct $mask<S: Simd>(S, S::$bits);

        impl<S: Simd> $numbers<S> {
            /// The number of lanes.
            pub const COUNT: usize = S::$count;

            /// Returns the same number in all lanes.
            #[inline(always)]
            pub fn splat(simd: S, x: $float) -> Self {
                $numbers(simd, simd.$splat(x))
            }

            /// Returns the vectors that eight numbers fill, one after the other.
            #[inline(always)]
            pub fn load(simd: S, from: &[$float; 8], vector: usize) -> Self {
                $numbers(simd, S::$load(from).0[vector])
            }

            /// Puts a vector back among eight numbers.
            #[inline(always)]
            pub fn store(self, to: &mut [$float; 8], vector: usize) {
                S::$store(to).0[vector] = self.1;
            }

            /// Returns the smaller number of each lane.
            #[inline(always)]
            pub fn min(self, other: Self) -> Self {
                $numbers(self.0, self.0.$min(self.1, other.1))
            }

            /// Returns the larger number of each lane.
            #[inline(always)]
            pub fn max(self, other: Self) -> Self {
                $numbers(self.0, self.0.$max(self.1, other.1))
            }

            /// Returns the square roots.
            #[inline(always)]
            pub fn sqrt(self) -> Self {
                $numbers(self.0, self.0.$sqrt(self.1))
            }

            /// Returns a mask of the lanes that are less than those of `other`.
            #[inline(always)]
            pub fn less(self, other: Self) -> $mask<S> {
                $mask(self.0, self.0.$less(self.1, other.1))
            }

            /// Returns a mask of the lanes that are at most those of `other`.
            #[inline(always)]
            pub fn at_most(self, other: Self) -> $mask<S> {
                $mask(self.0, self.0.$at_most(self.1, other.1))
            }
        }

        impl<S: Simd> $mask<S> {
            /// Returns `yes` where the mask holds, `no` elsewhere.
            #[inline(always)]
            pub fn select(self, yes: $numbers<S>, no: $numbers<S>) -> $numbers<S> {
                $numbers(self.0, self.0.$select(self.1, yes.1, no.1))
            }

            /// Whether the mask holds in any lane.
            #[inline(always)]
            pub fn any(self) -> bool {
                self.0.$first(self.1) < S::$count
            }
        }

        impl<S: Simd> BitAnd for $mask<S> {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, other: Self) -> Self {
                $mask(self.0, self.0.$and(self.1, other.1))
            }
        }

        impl<S: Simd> BitOr for $mask<S> {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, other: Self) -> Self {
                $mask(self.0, self.0.$or(self.1, other.1))
            }
        }

        impl<S: Simd> Add for $numbers<S> {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                $numbers(self.0, self.0.$add(self.1, other.1))
            }
        }

        impl<S: Simd> Sub for $numbers<S> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                $numbers(self.0, self.0.$sub(self.1, other.1))
            }
        }

        impl<S: Simd> Mul for $numbers<S> {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                $numbers(self.0, self.0.$mul(self.1, other.1))
            }
        }

        impl<S: Simd> Div for $numbers<S> {
            type Output = Self;
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                $numbers(self.0, self.0.$div(self.1, other.1))
            }
        }
    };
}

numbers!(
    F32s,
    Mask32s,
    f32,
    f32s,
    m32s,
    splat_f32s,
    add_f32s,
    sub_f32s,
    mul_f32s,
    div_f32s,
    min_f32s,
    max_f32s,
    sqrt_f32s,
    less_than_f32s,
    less_than_or_equal_f32s,
    select_f32s,
    and_m32s,
    or_m32s,
    first_true_m32s,
    F32_LANES,
    as_simd_f32s,
    as_mut_simd_f32s
);
numbers!(
    F64s,
    Mask64s,
    f64,
    f64s,
    m64s,
    splat_f64s,
    add_f64s,
    sub_f64s,
    mul_f64s,
    div_f64s,
    min_f64s,
    max_f64s,
    sqrt_f64s,
    less_than_f64s,
    less_than_or_equal_f64s,
    select_f64s,
    and_m64s,
    or_m64s,
    first_true_m64s,
    F64_LANES,
    as_simd_f64s,
    as_mut_simd_f64s
);

/// Three vectors as coordinates.
macro_rules! points {
    ($points:ident, $numbers:ident, $float:ident) => {
        #[doc = concat!("Points with coordinates of several `", stringify!($float), "`.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $points<S: Simd> {
            /// First coordinates.
            pub x: $numbers<S>,
            /// Second coordinates.
            pub y: $numbers<S>,
            /// Third coordinates.
            pub z: $numbers<S>,
        }

        impl<S: Simd> $points<S> {
            /// Returns the same point in all lanes.
            #[inline(always)]
            pub fn splat(simd: S, p: [$float; 3]) -> Self {
                $points {
                    x: $numbers::splat(simd, p[0]),
                    y: $numbers::splat(simd, p[1]),
                    z: $numbers::splat(simd, p[2]),
                }
            }

            /// Returns one of the vectors that eight points fill.
            #[inline(always)]
            pub fn load(simd: S, from: &[[$float; 8]; 3], vector: usize) -> Self {
                $points {
                    x: $numbers::load(simd, &from[0], vector),
                    y: $numbers::load(simd, &from[1], vector),
                    z: $numbers::load(simd, &from[2], vector),
                }
            }

            /// Puts vectors back among eight points.
            #[inline(always)]
            pub fn store(self, to: &mut [[$float; 8]; 3], vector: usize) {
                self.x.store(&mut to[0], vector);
                self.y.store(&mut to[1], vector);
                self.z.store(&mut to[2], vector);
            }

            /// Returns the scalar products.
            #[inline(always)]
            pub fn dot(self, other: Self) -> $numbers<S> {
                self.x * other.x + self.y * other.y + self.z * other.z
            }

            /// Returns the vector products.
            #[inline(always)]
            pub fn cross(self, other: Self) -> Self {
                $points {
                    x: self.y * other.z - other.y * self.z,
                    y: self.z * other.x - other.z * self.x,
                    z: self.x * other.y - other.x * self.y,
                }
            }

            /// Returns the vectors times numbers.
            #[inline(always)]
            pub fn times(self, factors: $numbers<S>) -> Self {
                $points { x: self.x * factors, y: self.y * factors, z: self.z * factors }
            }
        }

        impl<S: Simd> Add for $points<S> {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                $points { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
            }
        }

        impl<S: Simd> Sub for $points<S> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                $points { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
            }
        }
    };
}

points!(Vec3F32s, F32s, f32);
points!(Vec3F64s, F64s, f64);

impl<S: Simd> F32s<S> {
    /// Returns one of the vectors that eight words fill: byte number `n` of each word, from the
    /// lowest on, as a number.
    #[inline(always)]
    pub fn bytes(simd: S, words: &[u32; 8], vector: usize, n: u32) -> Self {
        let words = S::as_simd_u32s(words).0[vector];
        let bytes = simd.wrapping_dyn_shr_u32s(words, simd.splat_u32s(8 * n));
        let bytes = simd.and_u32s(bytes, simd.splat_u32s(0xff));
        // The last place of 2^23 is one: with the byte in its lowest bits it is 2^23 and the byte.
        let lifted = simd.or_u32s(bytes, simd.splat_u32s(8_388_608f32.to_bits()));
        F32s(simd, simd.transmute_f32s_u32s(lifted)) - F32s::splat(simd, 8_388_608.0)
    }

    /// Returns the absolute values.
    #[inline(always)]
    pub fn abs(self) -> Self {
        F32s(self.0, self.0.abs_f32s(self.1))
    }

    /// Returns the least of the lanes.
    #[inline(always)]
    pub fn least(self) -> f32 {
        self.0.reduce_min_f32s(self.1)
    }

    /// Returns the numbers times others, and more. May be fused: see the module.
    #[inline(always)]
    pub fn times_plus(self, factors: Self, more: Self) -> Self {
        F32s(self.0, self.0.mul_add_e_f32s(self.1, factors.1, more.1))
    }
}

impl<S: Simd> Vec3F32s<S> {
    /// Returns the scalar products, and more. May be fused: see the module.
    #[inline(always)]
    pub fn dot_plus(self, other: Self, more: F32s<S>) -> F32s<S> {
        self.x.times_plus(other.x, self.y.times_plus(other.y, self.z.times_plus(other.z, more)))
    }

    /// Returns the vectors times numbers, and more. May be fused: see the module.
    #[inline(always)]
    pub fn times_plus(self, factors: F32s<S>, more: Self) -> Self {
        Vec3F32s {
            x: self.x.times_plus(factors, more.x),
            y: self.y.times_plus(factors, more.y),
            z: self.z.times_plus(factors, more.z),
        }
    }
}

impl<S: Simd> Mask32s<S> {
    /// Returns a bit for each lane in which the mask holds, at the lane's place among eight
    /// numbers.
    #[inline(always)]
    pub fn bits(self, vector: usize) -> u8 {
        const BITS: [f32; 8] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0];
        let bits = self.select(F32s::load(self.0, &BITS, vector), F32s::splat(self.0, 0.0));
        self.0.reduce_sum_f32s(bits.1) as u8
    }

    /// Returns the points of `yes` where the mask holds, those of `no` elsewhere.
    #[inline(always)]
    pub fn select_points(self, yes: Vec3F32s<S>, no: Vec3F32s<S>) -> Vec3F32s<S> {
        Vec3F32s { x: self.select(yes.x, no.x), y: self.select(yes.y, no.y), z: self.select(yes.z, no.z) }
    }
}

impl<S: Simd> Mask64s<S> {
    /// Returns the points of `yes` where the mask holds, those of `no` elsewhere.
    #[inline(always)]
    pub fn select_points(self, yes: Vec3F64s<S>, no: Vec3F64s<S>) -> Vec3F64s<S> {
        Vec3F64s { x: self.select(yes.x, no.x), y: self.select(yes.y, no.y), z: self.select(yes.z, no.z) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Kernel: a bit for each number less than `limit`, the bytes of `words`, the least of
    /// `numbers`.
    struct Kernel<'a> {
        numbers: &'a [f32; 8],
        limit: f32,
        words: &'a [u32; 8],
    }

    impl WithSimd for Kernel<'_> {
        type Output = (u8, [[f32; 8]; 4], f32);

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let (mut bits, mut bytes, mut least) = (0, [[0.0; 8]; 4], f32::INFINITY);
            for vector in 0..8 / F32s::<S>::COUNT {
                let numbers = F32s::load(simd, self.numbers, vector);
                bits |= numbers.less(F32s::splat(simd, self.limit)).bits(vector);
                least = least.min(numbers.least());
                for (n, bytes) in bytes.iter_mut().enumerate() {
                    F32s::bytes(simd, self.words, vector, n as u32).store(bytes, vector);
                }
            }
            (bits, bytes, least)
        }
    }

    /// The number of lanes of f32 and of f64.
    struct Width;

    impl WithSimd for Width {
        type Output = [usize; 2];

        fn with_simd<S: Simd>(self, _: S) -> Self::Output {
            [F32s::<S>::COUNT, F64s::<S>::COUNT]
        }
    }

    #[test]
    fn scalar_code_has_one_lane() {
        let [widest, scalar] = scalar::in_vectors_and_scalars(|| dispatch(Width));
        assert_eq!((widest, scalar), (Arch::new().dispatch(Width), [1, 1]));
    }

    #[test]
    fn bits_and_bytes_are_those_of_each_lane() {
        let numbers = [3.0, -1.0, 0.0, 7.5, 2.0, f32::INFINITY, f32::NEG_INFINITY, 2.5];
        let words: [u32; 8] =
            std::array::from_fn(|n| 0x9e37_79b9u32.wrapping_mul(n as u32 + 1) | 0xff << (4 * n));
        for limit in [f32::NEG_INFINITY, -0.5, 2.5, f32::INFINITY] {
            let kernel = || Kernel { numbers: &numbers, limit, words: &words };
            let here = dispatch(kernel());
            assert_eq!(here, kernel().with_simd(pulp::Scalar));
            let (bits, bytes, least) = here;
            assert_eq!(least, f32::NEG_INFINITY);
            for n in 0..8 {
                assert_eq!(bits >> n & 1 == 1, numbers[n] < limit);
                for (k, byte) in words[n].to_le_bytes().into_iter().enumerate() {
                    assert_eq!(bytes[k][n], f32::from(byte));
                }
            }
        }
    }
}
