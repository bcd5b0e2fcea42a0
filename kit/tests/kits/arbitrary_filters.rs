//! Arbitrary valid dynamic filters and biquad banks that the binary form can hold.

use dsp_core::table::range;
use kit::{Biquad, Biquads, Breakpoint, DynamicFilter, Exciter, Loop, ModesGo, Order};
use proptest::prelude::*;

use crate::arbitrary_number::number;

/// Any valid dynamic filter.
pub(crate) fn dynamic_filter() -> impl Strategy<Value = DynamicFilter> {
    let exciter = (1.0f32..40_000.0, 1.0f32..40_000.0, number(range::EXCITER_EXPONENT))
        .prop_map(|(low_hz, width, exponent)| Exciter { low_hz, high_hz: low_hz + width, exponent });
    let head = (any::<u32>(), any::<bool>(), number(range::RATE_HZ), prop::option::of(exciter));
    (head, any::<bool>()).prop_flat_map(|((seed, through, rate_hz, exciter), second)| {
        let order = if second { Order::Second } else { Order::First };
        let loops = prop::collection::vec(band(), 0..=range::LOOPS);
        (path(order), loops).prop_map(move |(path, loops)| DynamicFilter {
            seed,
            modes: if through { ModesGo::Through } else { ModesGo::Beside },
            rate_hz,
            exciter,
            order,
            path,
            loops,
        })
    })
}

/// Any valid path of a filter, with complex poles by radius and angle, or two real poles.
fn path(order: Order) -> impl Strategy<Value = Vec<Breakpoint>> {
    let numerator = [(); 3].map(|()| number(range::COEFFICIENT));
    let roots = (-0.999f32..0.999, -0.999f32..0.999, any::<bool>());
    let noise = prop_oneof![Just(1.0), number(range::NOISE_LEVEL)];
    let point = (1e-6f32..100.0, roots, numerator, noise).prop_map(
        move |(step, (one, other, conjugate), [b0, b1, b2], noise)| {
            let (a1, a2, b2) = match (order, conjugate) {
                (Order::First, _) => (one, 0.0, 0.0),
                (Order::Second, true) => (2.0 * one * other, one * one, b2),
                (Order::Second, false) => (-(one + other), one * other, b2),
            };
            (step, Breakpoint { time_s: 0.0, noise, a1, a2, b0, b1, b2 })
        },
    );
    prop::collection::vec(point, 1..=range::BREAKPOINTS).prop_map(|points| {
        let mut time_s = 0.0;
        let mut path: Vec<Breakpoint> = Vec::new();
        for (step, point) in points {
            path.push(Breakpoint { time_s, ..point });
            // Adding a very small step may leave the time unchanged; the next float is later.
            time_s = f32::max(time_s + step, time_s.next_up());
        }
        path
    })
}

/// Any valid loop.
fn band() -> impl Strategy<Value = Loop> {
    let (frequency, bandwidth) = (number(range::EDGE_HZ), number(range::BANDWIDTH_HZ));
    (frequency, bandwidth, number(range::LOOP_GAIN), number(range::DELAY_S)).prop_map(
        |(frequency_hz, bandwidth_hz, gain, delay_s)| Loop {
            frequency_hz,
            bandwidth_hz: bandwidth_hz.min(frequency_hz.next_down()),
            gain,
            delay_s,
        },
    )
}

/// Any valid biquad bank.
pub(crate) fn biquads() -> impl Strategy<Value = Biquads> {
    let zero = prop_oneof![Just([0.0; 2]), Just([-0.0, 0.0]), [number(range::ZERO), number(range::ZERO)]];
    let biquad =
        (0.0f32..0.999_999, -3.15f32..3.15, zero, number(range::GAIN)).prop_map(|(radius, angle, zero, gain)| Biquad {
            pole: [radius * angle.cos(), radius * angle.sin()],
            zero,
            gain,
        });
    (1..=range::CHAIN_DEPTH, number(range::RATE_HZ)).prop_flat_map(move |(depth, rate_hz)| {
        let chain = prop::collection::vec(biquad.clone(), depth);
        prop::collection::vec(chain, 1..=range::CHAINS).prop_map(move |chains| Biquads { rate_hz, chains })
    })
}
