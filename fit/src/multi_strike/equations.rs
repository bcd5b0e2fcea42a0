//! Normal equations of all parameters over a recording, and what the model leaves of it.
//!
//! Between attacks all inner products follow from sums of powers. Within an attack, which is some
//! tens of samples long, the derivatives are written out sample by sample. Both pass through the
//! whitening filter.

use std::ops::Range;

use nalgebra::{Complex, DMatrix, DVector};
use rayon::prelude::*;

use super::arrow::Arrow;
use super::contact::Contact;
use super::model::{Model, Segment, Strike, segments};
use super::ringing::{Effect, Ringing};
use super::whitening::Whitening;
use crate::modes::{Basis, Stretch, add_ringing, project};

type C64 = Complex<f64>;

/// Number of segments that are worked on at a time.
///
/// It bounds the memory, and does not depend on the number of threads.
const AT_A_TIME: usize = 16;
/// Level of a strike relative to the noise below which its derivatives are left out.
const FORGOTTEN: f64 = 0.03;
/// Maximum number of strikes that ring at a time with derivatives of their own.
const MOST_HEARD: usize = 40;

/// Sound of one of a model's strikes alone, with its sign turned, over `length` samples from the
/// sample `from` on.
pub(super) fn of_one_strike(model: &Model, strike: &Strike, from: usize, length: usize) -> Vec<f64> {
    let contact = Contact { middle: strike.contact.middle - from as f64, ..strike.contact };
    let alone = Model { strikes: vec![Strike { contact, ..*strike }], ..model.clone() };
    residual(&alone, &vec![0.0; length])
}

/// Residual of the model within some ranges of the recording.
pub(super) fn residual_within(model: &Model, samples: &[f64], ranges: &[Range<usize>]) -> Vec<Vec<f64>> {
    let mut left: Vec<Vec<f64>> =
        ranges.iter().map(|range| samples.get(range.clone()).unwrap_or(&[]).to_vec()).collect();
    let mut amplitudes = vec![C64::new(0.0, 0.0); model.poles.len()];
    for segment in segments(&model.strikes, samples.len(), 0) {
        for (range, left) in ranges.iter().zip(&mut left) {
            let (from, to) = (range.start.max(segment.start), range.end.min(segment.end));
            if let Some(part) = left.get_mut(from - range.start..to.saturating_sub(range.start)) {
                subtract_part(model, &segment, &amplitudes, from, part);
            }
        }
        for (mode, amplitude) in amplitudes.iter_mut().enumerate() {
            *amplitude = amplitude_at_end(model, &segment, mode, *amplitude);
        }
    }
    left
}

/// Subtracts a segment's sound from those of its samples that begin with `from`.
fn subtract_part(model: &Model, segment: &Segment, amplitudes: &[C64], from: usize, samples: &mut [f64]) {
    for (mode, amplitude) in amplitudes.iter().enumerate() {
        let pole = model.poles[mode];
        add_ringing(pole, -amplitude * pole.power((from - segment.start) as f64), samples);
    }
    for strike in &model.strikes[segment.strikes.clone()] {
        for mode in (0..model.poles.len()).filter(|mode| model.rings(*mode, strike)) {
            let gain = model.gain(mode, strike.position) * strike.contact.peak;
            strike.contact.add_motion(model.exponent(mode), -gain, from, samples);
        }
        for (n, x) in (from..).zip(samples.iter_mut()) {
            *x -= model.acceleration * strike.contact.peak * strike.contact.force(n as f64)[0];
        }
    }
}

/// Residual of the model over the whole recording.
pub(crate) fn residual(model: &Model, samples: &[f64]) -> Vec<f64> {
    let mut left = samples.to_vec();
    let all = segments(&model.strikes, samples.len(), 0);
    let Some(first) = all.first() else { return left };
    let mut amplitudes = vec![C64::new(0.0, 0.0); model.poles.len()];
    let mut rest = left.get_mut(first.start..).unwrap_or(&mut []);
    let mut work = Vec::with_capacity(all.len());
    for segment in &all {
        let (own, behind) = rest.split_at_mut(segment.end - segment.start);
        rest = behind;
        work.push((segment, own, amplitudes.clone()));
        for (mode, amplitude) in amplitudes.iter_mut().enumerate() {
            *amplitude = amplitude_at_end(model, segment, mode, *amplitude);
        }
    }
    work.into_par_iter().for_each(|(segment, own, amplitudes)| subtract(model, segment, &amplitudes, own));
    left
}

fn amplitude_at_end(model: &Model, segment: &Segment, mode: usize, amplitude: C64) -> C64 {
    let mut now = amplitude * model.poles[mode].power((segment.free - segment.start) as f64);
    for strike in &model.strikes[segment.strikes.clone()] {
        let effect = Effect::of(model, strike, mode, segment.free as f64);
        now += effect.gain * effect.response.value;
    }
    now * model.poles[mode].power((segment.end - segment.free) as f64)
}

fn subtract(model: &Model, segment: &Segment, amplitudes: &[C64], samples: &mut [f64]) {
    let (attack, free) = samples.split_at_mut(segment.free - segment.start);
    let strikes = &model.strikes[segment.strikes.clone()];
    for (mode, &amplitude) in amplitudes.iter().enumerate() {
        let pole = model.poles[mode];
        add_ringing(pole, -amplitude, attack);
        let mut now = amplitude * pole.power(attack.len() as f64);
        for strike in strikes.iter().filter(|strike| model.rings(mode, strike)) {
            let effect = Effect::of(model, strike, mode, segment.free as f64);
            now += effect.gain * effect.response.value;
            strike.contact.add_motion(model.exponent(mode), -effect.gain, segment.start, attack);
        }
        add_ringing(pole, -now, free);
    }
    for strike in strikes {
        for (n, x) in (segment.start..).zip(attack.iter_mut()) {
            *x -= model.acceleration * strike.contact.peak * strike.contact.force(n as f64)[0];
        }
    }
}

/// Energy of the whitened residual, summed in an order that does not depend on threads.
pub(crate) fn energy(residual: &[f64], whitening: &Whitening) -> f64 {
    const CHUNK: usize = 1 << 16;
    let starts: Vec<usize> = (0..residual.len()).step_by(CHUNK).collect();
    let sums: Vec<f64> = starts
        .into_par_iter()
        .map(|start| {
            let end = residual.len().min(start + CHUNK);
            whitening.filtered(residual, start..end).iter().map(|x| x * x).sum()
        })
        .collect();
    sums.into_iter().sum()
}

/// Normal equations of all parameters; `noise_rms` is that of the whitened residual.
pub(crate) fn equations(model: &Model, residual: &[f64], whitening: &Whitening, noise_rms: f64) -> Arrow {
    let all = segments(&model.strikes, residual.len(), whitening.order());
    let size = model.strike_size();
    let count = model.strikes.len() * size;
    // The states decide the width of the band, so they are walked through twice.
    let mut widest = 1;
    walk(model, &all, noise_rms, |first, _, last| {
        widest = widest.max(last - first);
    });
    let mut arrow = Arrow::zeros(count, widest * size - 1, model.shared_size());
    let mut waiting: Vec<(&Segment, Ringing, Ringing)> = Vec::with_capacity(AT_A_TIME);
    let flush = |waiting: &mut Vec<(&Segment, Ringing, Ringing)>, arrow: &mut Arrow| {
        let parts: Vec<(usize, DMatrix<f64>, DVector<f64>)> = waiting
            .par_iter()
            .map(|(segment, before, after)| of_segment(model, segment, before, after, residual, whitening))
            .collect();
        waiting.clear();
        parts.iter().for_each(|(first, normal, right)| arrow.add(first * size, normal, right));
    };
    let mut index = 0;
    let mut ringing = Ringing::silence(model, 0);
    for segment in &all {
        let before = ringing.clone();
        step_into(model, segment, &mut ringing);
        waiting.push((segment, before, ringing.clone()));
        index += 1;
        if index % AT_A_TIME == 0 {
            flush(&mut waiting, &mut arrow);
        }
        step_out(model, segment, &mut ringing, noise_rms);
    }
    flush(&mut waiting, &mut arrow);
    arrow
}

/// Visits each segment with its first strike still heard, its own, and the end of its own.
fn walk(model: &Model, all: &[Segment], noise_rms: f64, mut visit: impl FnMut(usize, usize, usize)) {
    let mut ringing = Ringing::silence(model, 0);
    for segment in all {
        visit(ringing.first, segment.strikes.start, segment.strikes.end);
        step_into(model, segment, &mut ringing);
        step_out(model, segment, &mut ringing, noise_rms);
    }
}

fn step_into(model: &Model, segment: &Segment, ringing: &mut Ringing) {
    ringing.pass(model, segment.free - segment.start);
    for strike in &model.strikes[segment.strikes.clone()] {
        ringing.strike(model, strike, segment.free);
    }
}

fn step_out(model: &Model, segment: &Segment, ringing: &mut Ringing, noise_rms: f64) {
    ringing.pass(model, segment.end - segment.free);
    ringing.forget(FORGOTTEN * noise_rms, MOST_HEARD);
}

/// Equations of one segment: its first strike, normal matrix and right side.
fn of_segment(
    model: &Model,
    segment: &Segment,
    before: &Ringing,
    after: &Ringing,
    residual: &[f64],
    whitening: &Whitening,
) -> (usize, DMatrix<f64>, DVector<f64>) {
    let rows = attack_rows(model, segment, before, whitening);
    let left = DVector::from_vec(whitening.filtered(residual, segment.start..segment.free));
    // The product of two matrices is faster than that of one with itself transposed.
    let mut normal = rows.transpose() * &rows;
    let mut right = rows.tr_mul(&left);
    if segment.end > segment.free {
        let tail = whitening.filtered(residual, segment.free..segment.end);
        add_ringing_equations(model, after, &tail, whitening, &mut normal, &mut right);
    }
    (before.first, normal, right)
}

/// Adds the equations of samples in which all modes ring freely.
///
/// The shared parameters of a mode have four rows, so that their products are of blocks.
fn add_ringing_equations(
    model: &Model,
    ringing: &Ringing,
    tail: &[f64],
    whitening: &Whitening,
    normal: &mut DMatrix<f64>,
    right: &mut DVector<f64>,
) {
    let stretch = Stretch::ringing(tail);
    let bases: Vec<Basis> = model.poles.iter().map(|&pole| Basis::new(pole, &stretch)).collect();
    let gram = gram(&bases);
    let mut along = DVector::zeros(4 * model.poles.len());
    for (mode, &pole) in model.poles.iter().enumerate() {
        let [plain, ramp] = project(pole, tail);
        for (row, sum) in [(0, plain), (2, ramp)] {
            along[4 * mode + row] = sum.re;
            along[4 * mode + row + 1] = -sum.im;
        }
    }
    let mut columns = ringing.columns(model, 0);
    whitening.filter_columns(&mut columns, &model.poles);
    let mut blocks = ringing.blocks(model);
    for (block, &pole) in blocks.iter_mut().zip(&model.poles) {
        whitening.filter_rows_of(pole, &mut block.as_view_mut());
    }
    let own = columns.ncols();
    let products = &gram * &columns;
    let mut corner = normal.view_mut((0, 0), (own, own));
    corner += columns.transpose() * &products;
    let mut first = right.rows_mut(0, own);
    first += columns.tr_mul(&along);
    for (mode, block) in blocks.iter().enumerate() {
        let across = block.transpose() * products.rows(4 * mode, 4);
        let local = block.tr_mul(&along.rows(4 * mode, 4));
        for (index, column) in model.columns_of(mode).enumerate() {
            right[own + column] += local[index];
            for strike in 0..own {
                normal[(own + column, strike)] += across[(index, strike)];
                normal[(strike, own + column)] += across[(index, strike)];
            }
        }
        for (other, block_of_other) in blocks.iter().enumerate() {
            let both = block.transpose() * (gram.view((4 * mode, 4 * other), (4, 4)) * block_of_other);
            for (b, column) in model.columns_of(other).enumerate() {
                for (a, row) in model.columns_of(mode).enumerate() {
                    normal[(own + row, own + column)] += both[(a, b)];
                }
            }
        }
    }
}

/// Inner products of `Re u, Re ju, Re v, Re jv` of all modes.
fn gram(bases: &[Basis]) -> DMatrix<f64> {
    const UNITS: [C64; 2] = [C64::new(1.0, 0.0), C64::new(0.0, 1.0)];
    let mut gram = DMatrix::zeros(4 * bases.len(), 4 * bases.len());
    for (k, a) in bases.iter().enumerate() {
        for (l, b) in bases.iter().enumerate().take(k + 1) {
            let products = a.products(b);
            let pairs = [[products.uu, products.uv], [products.vu, products.vv]];
            for (i, row) in pairs.iter().enumerate() {
                for (j, pair) in row.iter().enumerate() {
                    for (m, alpha) in UNITS.into_iter().enumerate() {
                        for (n, beta) in UNITS.into_iter().enumerate() {
                            let value = pair.real(alpha, beta);
                            let (row, column) = (4 * k + 2 * i + m, 4 * l + 2 * j + n);
                            gram[(row, column)] = value;
                            gram[(column, row)] = value;
                        }
                    }
                }
            }
        }
    }
    gram
}

/// Whitened derivatives of each sample of an attack.
fn attack_rows(model: &Model, segment: &Segment, before: &Ringing, whitening: &Whitening) -> DMatrix<f64> {
    let history = whitening.order().min(segment.start);
    let from = segment.start - history;
    let count = segment.free - from;
    let own = segment.strikes.len();
    let columns = before.columns(model, own);
    let mut shapes = DMatrix::zeros(count, 4 * model.poles.len());
    for (mode, pole) in model.poles.iter().enumerate() {
        for row in 0..count {
            let n = row as f64 - history as f64;
            let power = pole.power(n);
            shapes[(row, 4 * mode)] = power.re;
            shapes[(row, 4 * mode + 1)] = -power.im;
            shapes[(row, 4 * mode + 2)] = n * power.re;
            shapes[(row, 4 * mode + 3)] = -n * power.im;
        }
    }
    let shared = columns.ncols();
    let mut rows = DMatrix::zeros(count, shared + model.shared_size());
    rows.columns_mut(0, shared).copy_from(&(&shapes * columns));
    for (mode, block) in before.blocks(model).into_iter().enumerate() {
        let local = shapes.columns(4 * mode, 4) * block;
        for (index, column) in model.columns_of(mode).enumerate() {
            rows.column_mut(shared + column).copy_from(&local.column(index));
        }
    }
    let size = model.strike_size();
    let gains_at: Vec<usize> = (0..model.poles.len()).map(|mode| model.gain_column(mode)).collect();
    for (index, strike) in segment.strikes.clone().enumerate() {
        let strike = &model.strikes[strike];
        let first = (before.heard() + index) * size;
        for row in history..count {
            let sample = (from + row) as f64;
            for mode in 0..model.poles.len() {
                let effect = Effect::of(model, strike, mode, sample);
                let (gain, response) = (effect.gain, effect.response);
                rows[(row, first)] += (gain * response.by_middle).re;
                rows[(row, first + 1)] += (gain * response.by_time).re * strike.contact.time;
                rows[(row, first + 2)] += (gain * response.value).re;
                if size > 3 {
                    rows[(row, first + 3)] += (effect.slope * response.value).re;
                }
                let by_pole = gain * response.by_pole;
                rows[(row, shared + 2 * mode)] -= by_pole.re;
                rows[(row, shared + 2 * mode + 1)] -= by_pole.im;
                let column = shared + gains_at[mode] + 2 * effect.weights.first;
                for (place, weight) in effect.weights.values().iter().enumerate() {
                    let value = response.value * (strike.contact.peak * weight);
                    rows[(row, column + 2 * place)] += value.re;
                    rows[(row, column + 2 * place + 1)] -= value.im;
                }
            }
            let [force, by_middle, by_time] = strike.contact.force(sample).map(|x| x * strike.contact.peak);
            rows[(row, first)] += model.acceleration * by_middle;
            rows[(row, first + 1)] += model.acceleration * by_time * strike.contact.time;
            rows[(row, first + 2)] += model.acceleration * force;
            let last = rows.ncols() - 1;
            rows[(row, last)] += force;
        }
    }
    whitening.of_rows(&rows, history)
}
