//! Sums, products, quotients, square roots and comparisons (DDI 0403 A2.5).
//!
//! The host rounds to nearest, as the FPU does in the modes of reset. Its result is used if it can
//! raise no exception flag other than IXC, that of inexact results. Whether a result is inexact is
//! no longer computed once IXC is set: only the program clears that flag.

use rsemu::cpu::arm::v7m::fp::{self, fpscr};
use rsemu::cpu::arm::v7m::fpisa::{DataOp, UnaryOp};
use rsemu::float::{Env, Flags};

use super::Direct;

/// Least magnitude from which a result cannot have been a subnormal before it was rounded: twice
/// the smallest normal number.
const SMALLEST: f32 = 2.0 * f32::MIN_POSITIVE;

/// Mask of the fraction bits of a double that a single lacks, and their value half-way between two
/// singles.
const DROPPED: u64 = (1 << 29) - 1;
const HALF_WAY: u64 = 1 << 28;

/// Arithmetic in the modes of reset. A function returns `None` if its result may raise another flag
/// than that of inexact results.
struct Arithmetic {
    /// True if a result was inexact.
    is_inexact: bool,
}

impl Arithmetic {
    /// Returns a result. `is_exact` is not called if an earlier result was inexact.
    #[inline]
    fn rounded(&mut self, result: f32, is_exact: impl Fn() -> bool) -> Option<f32> {
        self.is_inexact = self.is_inexact || !is_exact();
        Some(result)
    }

    /// Returns a + b. A sum in the range of the subnormals is exact.
    #[inline]
    fn add(&mut self, a: f32, b: f32) -> Option<f32> {
        let sum = a + b;
        if !sum.is_finite() {
            return None;
        }
        self.rounded(sum, || is_sum(sum, f64::from(a), f64::from(b)))
    }

    /// Returns a b.
    #[inline]
    fn multiply(&mut self, a: f32, b: f32) -> Option<f32> {
        let product = a * b;
        if !is_far_from_subnormal(product) {
            return if product == 0.0 && (a == 0.0 || b == 0.0) { Some(product) } else { None };
        }
        self.rounded(product, || f64::from(a) * f64::from(b) == f64::from(product))
    }

    /// Returns a / b.
    #[inline]
    fn divide(&mut self, a: f32, b: f32) -> Option<f32> {
        let quotient = a / b;
        if !is_far_from_subnormal(quotient) {
            return if quotient == 0.0 && a == 0.0 { Some(quotient) } else { None };
        }
        self.rounded(quotient, || f64::from(quotient) * f64::from(b) == f64::from(a))
    }

    /// Returns the square root of a.
    #[inline]
    fn square_root(&mut self, a: f32) -> Option<f32> {
        let root = a.sqrt();
        if !root.is_finite() {
            return None;
        }
        self.rounded(root, || f64::from(root) * f64::from(root) == f64::from(a))
    }

    /// Returns a + b c, rounded once.
    #[inline]
    fn fused(&mut self, a: f32, b: f32, c: f32) -> Option<f32> {
        let (addend, product) = (f64::from(a), f64::from(b) * f64::from(c));
        // The product is exact. The sum is rounded twice, which is the same as once unless the
        // first result lies half-way between two singles.
        let sum = addend + product;
        let result = sum as f32;
        if sum == 0.0 {
            return Some(result);
        }
        if !is_far_from_subnormal(result) || sum.to_bits() & DROPPED == HALF_WAY {
            return None;
        }
        self.rounded(result, || is_sum(result, addend, product))
    }

    /// Returns the result of an operation on sd, sn and sm.
    #[inline]
    fn compute(&mut self, op: DataOp, [d, n, m]: [f32; 3]) -> Option<f32> {
        match op {
            DataOp::Add => self.add(n, m),
            DataOp::Sub => self.add(n, -m),
            DataOp::Mul => self.multiply(n, m),
            DataOp::Nmul => self.multiply(n, m).map(|product| -product),
            DataOp::Div => self.divide(n, m),
            DataOp::Mla => self.multiply(n, m).and_then(|product| self.add(d, product)),
            DataOp::Mls => self.multiply(n, m).and_then(|product| self.add(d, -product)),
            DataOp::Nmla => self.multiply(n, m).and_then(|product| self.add(-d, -product)),
            DataOp::Nmls => self.multiply(n, m).and_then(|product| self.add(-d, product)),
            DataOp::Fma => self.fused(d, n, m),
            DataOp::Fms => self.fused(d, -n, m),
            DataOp::Fnma => self.fused(-d, -n, m),
            DataOp::Fnms => self.fused(-d, n, m),
            DataOp::Maxnm | DataOp::Minnm => None,
        }
    }
}

/// Returns true if a rounded sum of two numbers is exact.
fn is_sum(result: f32, a: f64, b: f64) -> bool {
    let sum = a + b;
    // What rounding to a double has taken off (Knuth's two-sum).
    let added = sum - a;
    let lost = (a - (sum - added)) + (b - added);
    lost == 0.0 && f64::from(result) == sum
}

/// Returns true if a result is finite and so far from the subnormals that it cannot have been one
/// before it was rounded.
#[inline]
fn is_far_from_subnormal(result: f32) -> bool {
    (SMALLEST..=f32::MAX).contains(&result.abs())
}

impl Direct {
    /// Executes an operation of two operands, or of three if it adds to its result register.
    #[inline]
    pub(super) fn compute(&mut self, op: DataOp, [d, n, m]: [u8; 3]) -> Option<()> {
        let operands = [d, n, m].map(|register| self.floats.get(register));
        if self.floats.has_reset_modes() {
            let mut arithmetic = Arithmetic { is_inexact: self.floats.is_inexact() };
            if let Some(result) = arithmetic.compute(op, operands.map(f32::from_bits)) {
                self.floats.finish_rounded(d, result, arithmetic.is_inexact);
                return Some(());
            }
        }
        let result = compute_slowly(op, operands, self.float_modes())?;
        self.floats.finish(d, result);
        Some(())
    }

    /// Executes an operation of one operand.
    #[inline]
    pub(super) fn compute_unary(&mut self, op: UnaryOp, d: u8, m: u8) -> Option<()> {
        let bits = self.floats.get(m);
        match op {
            UnaryOp::Mov => self.floats.set(d, bits),
            UnaryOp::Abs => self.floats.set(d, fp::abs(bits)),
            UnaryOp::Neg => self.floats.set(d, fp::neg(bits)),
            UnaryOp::Sqrt => {
                let mut arithmetic = Arithmetic { is_inexact: self.floats.is_inexact() };
                let root =
                    if self.floats.has_reset_modes() { arithmetic.square_root(f32::from_bits(bits)) } else { None };
                match root {
                    Some(root) => self.floats.finish_rounded(d, root, arithmetic.is_inexact),
                    None => self.floats.finish(d, fp::sqrt(bits, self.float_modes())),
                }
            }
            UnaryOp::RintR | UnaryOp::RintZ | UnaryOp::RintX => return None,
        }
        Some(())
    }

    /// Compares two numbers, and sets the condition flags of FPSCR. Quiet NaNs are invalid operands
    /// only if `signal_all`.
    #[inline]
    pub(super) fn compare(&mut self, left: u32, right: u32, signal_all: bool) -> Option<()> {
        let order = f32::from_bits(left).partial_cmp(&f32::from_bits(right));
        let (conditions, flags) = match order {
            Some(order) if self.floats.has_reset_modes() => {
                let conditions = if order.is_lt() {
                    fpscr::N
                } else if order.is_gt() {
                    fpscr::C
                } else {
                    fpscr::Z | fpscr::C
                };
                (conditions, Flags::NONE)
            }
            _ => fp::compare(left, right, signal_all, self.float_modes()),
        };
        self.floats.status = self.floats.status & !fpscr::FLAGS | conditions | flags.to_fpsr();
        Some(())
    }

    /// Returns the modes of FPSCR for the arithmetic of `rsemu`.
    pub(super) fn float_modes(&self) -> Env {
        fp::env(self.floats.status)
    }
}

/// Computes an operation on the bits of sd, sn and sm by the arithmetic of `rsemu`. Operations that
/// the Cortex-M4F lacks have no result.
#[cold]
fn compute_slowly(op: DataOp, [d, n, m]: [u32; 3], modes: Env) -> Option<(u32, Flags)> {
    // Sum of an addend and a product, each rounded.
    let chained = |addend: u32, negates: bool| {
        let (product, first) = fp::mul(n, m, modes);
        let (sum, second) = fp::add(addend, if negates { fp::neg(product) } else { product }, modes);
        (sum, first | second)
    };
    Some(match op {
        DataOp::Add => fp::add(n, m, modes),
        DataOp::Sub => fp::sub(n, m, modes),
        DataOp::Mul => fp::mul(n, m, modes),
        DataOp::Nmul => {
            let (product, flags) = fp::mul(n, m, modes);
            (fp::neg(product), flags)
        }
        DataOp::Div => fp::div(n, m, modes),
        DataOp::Mla => chained(d, false),
        DataOp::Mls => chained(d, true),
        DataOp::Nmla => chained(fp::neg(d), true),
        DataOp::Nmls => chained(fp::neg(d), false),
        DataOp::Fma => fp::mul_add(d, n, m, modes),
        DataOp::Fms => fp::mul_add(d, fp::neg(n), m, modes),
        DataOp::Fnma => fp::mul_add(fp::neg(d), fp::neg(n), m, modes),
        DataOp::Fnms => fp::mul_add(fp::neg(d), n, m, modes),
        DataOp::Maxnm | DataOp::Minnm => return None,
    })
}
