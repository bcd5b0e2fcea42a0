//! Dynamic filters and biquad banks in text and bytes: invalid ones are refused with their place.

use dsp_core::table::layout::{BiquadRecord, BiquadsHeader, DynamicFilterHeader, tag};
use dsp_core::table::{Field, Kit as TableView, Place, TableError};
use kit::{KitError, ModesGo, Order, binary};
use zerocopy::FromBytes;

use crate::binary_refusals::{section_of, signed};
use crate::sample;

const TEXT: &str = r#"format = 1
name = "test"

[[object]]
name = "block"
modes = []

[[object]]
name = "bar"
modes = []

[object.dynamic_filter]
seed = 7
modes = "through"
exciter = { low_hz = 80, high_hz = 9000, exponent = 0.25 }
path = [
    { time_s = 0, a1 = -0.5, b0 = 0.25 },
    { time_s = 0.25, a1 = -0.98, b0 = 0.01, b1 = 0.02 },
    { time_s = 0.5, a1 = -0.75, b0 = 0 },
]
loops = [
    { frequency_hz = 440, bandwidth_hz = 3, gain = 1.25, delay_s = 0.002 },
    { frequency_hz = 1000, bandwidth_hz = 4, gain = -0.5, delay_s = 0.001 },
]

[object.biquads]
rate_hz = 44100
chains = [
    [ { pole = [0.5, 0.75], zero = [0.25, 0.5], gain = 0.125 }, { pole = [0.0, 0.5], gain = 2 } ],
    [ { pole = [-0.5, 0.75], gain = 4 }, { pole = [0.875, 0.25], zero = [1, 0], gain = 8 } ],
]
"#;

fn refusal(from: &str, to: &str) -> String {
    assert_eq!(TEXT.matches(from).count(), 1, "{from:?} stands there once");
    sample::parse(&TEXT.replace(from, to)).expect_err("a wrong text").to_string()
}

#[test]
fn filters_come_through_text_and_bytes_unchanged() {
    let kit = sample::parse(TEXT).expect("a right text");
    let filter = kit.objects[1].dynamic_filter.as_ref().expect("the object has one");
    assert_eq!(
        (filter.seed, filter.modes, filter.rate_hz, filter.order),
        (7, ModesGo::Through, 48_000.0, Order::First)
    );
    // Eq. 17: b1 = b0 where b1 is missing.
    assert_eq!(filter.path.iter().map(|point| point.b1).collect::<Vec<_>>(), [0.25, 0.02, 0.0]);
    assert_eq!((filter.loops.len(), filter.exciter.map(|exciter| exciter.exponent)), (2, Some(0.25)));
    let biquads = kit.objects[1].biquads.as_ref().expect("the object has them");
    assert_eq!(
        (biquads.rate_hz, biquads.chains[0][1].zero, biquads.chains[1][1].zero),
        (44_100.0, [0.0; 2], [1.0, 0.0])
    );
    assert_eq!(sample::parse(&kit::text::write(&kit)).expect("its own text"), kit);
    let bytes = binary::build(&kit).expect("a right kit");
    assert_eq!(binary::read(&bytes).expect("its own bytes"), kit);
    let view = TableView::parse(&bytes).expect("a right kit");
    assert!(view.dynamic_filter_of(0).expect("right tables").is_none());
    assert_eq!(
        view.biquads_of(1).expect("right tables").map(|bank| (bank.depth(), bank.records().len())),
        Some((2, 4))
    );
}

#[test]
fn levels_of_the_noise_come_through_and_take_no_bytes_if_all_are_1() {
    let plain = binary::build(&sample::parse(TEXT).expect("a right text")).expect("a right kit");
    let text = TEXT.replace("{ time_s = 0.25, a1", "{ time_s = 0.25, noise = 0.5, a1");
    let kit = sample::parse(&text).expect("a right text");
    let levels = |kit: &kit::Kit| -> Vec<f32> {
        kit.objects[1].dynamic_filter.iter().flat_map(|filter| &filter.path).map(|point| point.noise).collect()
    };
    assert_eq!(levels(&kit), [1.0, 0.5, 1.0]);
    assert_eq!(sample::parse(&kit::text::write(&kit)).expect("its own text"), kit);
    let bytes = binary::build(&kit).expect("a right kit");
    assert_eq!(bytes.len(), plain.len() + 12);
    assert_eq!(levels(&binary::read(&bytes).expect("its own bytes")), [1.0, 0.5, 1.0]);
    let view = TableView::parse(&bytes).expect("a right kit");
    let filter = view.dynamic_filter_of(1).expect("right tables").expect("the object has one");
    assert_eq!(filter.levels().collect::<Vec<_>>(), [1.0, 0.5, 1.0]);
    for (level, shown) in [("1.5", "1.5"), ("-0.25", "-0.25"), ("nan", "NaN")] {
        let message = refusal("{ time_s = 0.25, a1", &format!("{{ time_s = 0.25, noise = {level}, a1"));
        let expected = format!("breakpoint 1: noise = {shown}: must be from 0 to 1");
        assert!(message.ends_with(&expected), "{message}");
    }
}

#[test]
fn filter_of_second_order_has_a2_and_b2_in_every_breakpoint() {
    let text = TEXT.replace("a1 = -0.5, b0 = 0.25 }", "a1 = -0.5, a2 = 0.25, b0 = 0.25, b2 = 1 }");
    let message = sample::parse(&text).expect_err("a mixed order").to_string();
    assert_eq!(
        message,
        "test.toml:18:5: object 1 \"bar\", dynamic filter, breakpoint 1: a2 and b2: give both in every breakpoint (second order), or in none (first order)"
    );
    let text = text
        .replace("b0 = 0.01, b1 = 0.02 }", "a2 = 0.5, b0 = 0.01, b1 = 0.02, b2 = 0 }")
        .replace("b0 = 0 }", "a2 = -0.125, b0 = 0, b2 = -1 }");
    let kit = sample::parse(&text).expect("a right text");
    let filter = kit.objects[1].dynamic_filter.as_ref().expect("the object has one");
    assert_eq!((filter.order, filter.path[2].a2), (Order::Second, -0.125));
    assert_eq!(sample::parse(&kit::text::write(&kit)).expect("its own text"), kit);
    // The poles are real: 1.05 and -0.05.
    let message = sample::parse(&text.replace("a1 = -0.75, a2 = -0.125", "a1 = -1.0, a2 = -0.0525"));
    let message = message.expect_err("an unstable pole").to_string();
    assert!(
        message.ends_with("breakpoint 2: a1: a pole of radius 1.05 does not decay; move it within the unit circle"),
        "{message}"
    );
}

#[test]
fn invalid_paths_are_refused_with_their_place() {
    assert_eq!(
        refusal("a1 = -0.98", "a1 = -1"),
        "test.toml:18:5: object 1 \"bar\", dynamic filter, breakpoint 1: a1: a pole of radius 1 does not decay; move it within the unit circle"
    );
    assert_eq!(
        refusal("time_s = 0.5", "time_s = 0.25"),
        "test.toml:19:5: object 1 \"bar\", dynamic filter, breakpoint 2: time_s = 0.25: must be later than the breakpoint before it, 0.25"
    );
    assert_eq!(
        refusal("time_s = 0,", "time_s = 0.125,"),
        "test.toml:17:5: object 1 \"bar\", dynamic filter, breakpoint 0: time_s = 0.125: must be from 0 to 0"
    );
    assert!(refusal("b0 = 0.01", "b0 = inf").ends_with("breakpoint 1: b0 = inf: must be from -1000000 to 1000000"));
    assert!(refusal("b1 = 0.02", "b1 = nan").ends_with("breakpoint 1: b1 = NaN: must be from -1000000 to 1000000"));
    let points = |count: usize| {
        let points: Vec<String> = (0..count).map(|index| format!("{{ time_s = {index}, a1 = 0, b0 = 1 }}")).collect();
        let start = TEXT.find("path = [").expect("a path");
        let end = TEXT.find("loops = [").expect("loops");
        format!("{}path = [{}]\n{}", &TEXT[..start], points.join(", "), &TEXT[end..])
    };
    assert!(sample::parse(&points(32)).is_ok());
    for (count, found) in [(33, "33"), (0, "0")] {
        let message = sample::parse(&points(count)).expect_err("a wrong number").to_string();
        assert_eq!(
            message,
            format!("test.toml:12:1: object 1 \"bar\", dynamic filter: path = {found}: must be from 1 to 32")
        );
    }
}

#[test]
fn invalid_loops_and_exciters_are_refused_with_their_place() {
    assert_eq!(
        refusal("bandwidth_hz = 4", "bandwidth_hz = 1000"),
        "test.toml:23:5: object 1 \"bar\", dynamic filter, loop 1: bandwidth_hz = 1000: must be from 0.01 to 1000"
    );
    assert!(
        refusal("frequency_hz = 440", "frequency_hz = 96001").contains("loop 0: frequency_hz = 96001: must be from 1")
    );
    assert!(refusal("delay_s = 0.001 ", "delay_s = -0.001 ").contains("loop 1: delay_s = -0.001: must be from"));
    assert!(refusal("gain = -0.5", "gain = nan").contains("loop 1: gain = NaN: must be from"));
    assert_eq!(
        refusal("high_hz = 9000", "high_hz = 80.5"),
        "test.toml:12:1: object 1 \"bar\", dynamic filter: high_hz = 80.5: must be at least 1 Hz above the edge before it, 80"
    );
    assert!(refusal("exponent = 0.25", "exponent = 5").contains("dynamic filter: exponent = 5: must be from -4 to 4"));
    assert!(refusal("\"through\"", "\"thorugh\"").contains("must be \"beside\" or \"through\""));
    let many = "{ frequency_hz = 440, bandwidth_hz = 3, gain = 0, delay_s = 0.002 },\n".repeat(15);
    let message = refusal("    { frequency_hz = 1000", &format!("{many}    {{ frequency_hz = 1000"));
    assert!(message.ends_with("dynamic filter: loops = 17: must be from 0 to 16"), "{message}");
}

#[test]
fn invalid_biquads_are_refused_with_their_place() {
    assert_eq!(
        refusal("pole = [-0.5, 0.75]", "pole = [-0.75, 0.75]"),
        "test.toml:30:7: object 1 \"bar\", biquads, chain 1, biquad 0: pole: a pole of radius 1.0606601 does not decay; move it within the unit circle"
    );
    assert!(refusal("pole = [0.0, 0.5]", "pole = [0, 1]").contains("chain 0, biquad 1: pole: a pole of radius 1 does"));
    assert!(refusal("zero = [1, 0]", "zero = [1, inf]").contains("chain 1, biquad 1: zero = inf: must be from"));
    assert!(refusal("gain = 0.125", "gain = nan").contains("chain 0, biquad 0: gain = NaN: must be from"));
    assert_eq!(
        refusal(", { pole = [0.875, 0.25], zero = [1, 0], gain = 8 } ]", " ]"),
        "test.toml:30:5: object 1 \"bar\", biquads, chain 1: 1 biquad: must be 2, as many as the first chain has"
    );
    assert!(refusal("rate_hz = 44100", "rate_hz = 0").contains("biquads: rate_hz = 0: must be from 8000 to 192000"));
    let chain = |biquads: usize| format!("    [ {} ],\n", vec!["{ pole = [0.5, 0.5], gain = 1 }"; biquads].join(", "));
    let chains = |count: usize, biquads: usize| {
        let start = TEXT.find("chains = [").expect("chains");
        sample::parse(&format!("{}chains = [\n{}]\n", &TEXT[..start], chain(biquads).repeat(count)))
    };
    assert!(chains(64, 4).is_ok());
    let message = |count, biquads| chains(count, biquads).expect_err("a wrong number").to_string();
    assert_eq!(message(65, 1), "test.toml:26:1: object 1 \"bar\", biquads: chains = 65: must be from 1 to 64");
    assert_eq!(message(0, 1), "test.toml:26:1: object 1 \"bar\", biquads: chains = 0: must be from 1 to 64");
    assert_eq!(message(1, 5), "test.toml:29:5: object 1 \"bar\", biquads, chain 0: biquads = 5: must be from 1 to 4");
}

/// Refusal of the bytes after a change in the body of a section.
fn foreign(section: [u8; 4], change: impl FnOnce(&mut [u8])) -> TableError {
    let bytes = binary::build(&sample::parse(TEXT).expect("a right text")).expect("a right kit");
    let (mut body, range) = section_of(&bytes, section);
    change(&mut body[range]);
    match binary::read(&signed(&body)).expect_err("wrong bytes") {
        KitError::Binary { error, .. } => error,
        other => panic!("{other}"),
    }
}

#[test]
fn foreign_bytes_of_a_dynamic_filter_are_refused_by_name() {
    let header = |change: fn(&mut DynamicFilterHeader)| {
        foreign(tag::DYNAMIC_FILTER, |body| change(DynamicFilterHeader::mut_from_prefix(body).expect("a head").0))
    };
    let place = Place::ObjectFilter(1);
    assert!(matches!(header(|head| head.order = 3), TableError::Count { field: Field::Order, value: 3, .. }));
    assert_eq!(header(|head| head.flags = 8), TableError::NotZero { place, field: Field::Padding });
    // The flag for levels of the noise, which the section does not have.
    assert!(matches!(header(|head| head.flags = 4), TableError::LengthMismatch { expected: 144, found: 132, .. }));
    assert_eq!(header(|head| head.flags = 1), TableError::NotZero { place, field: Field::Exciter });
    assert!(matches!(header(|head| head.object.set(2)), TableError::Dangling { index: 2, count: 2, .. }));
    assert!(matches!(header(|head| head.loop_count.set(1)), TableError::LengthMismatch { .. }));
    assert!(matches!(header(|head| head.breakpoint_count.set(0)), TableError::Count { field: Field::Path, .. }));
    assert!(matches!(header(|head| head.rate_hz.set(f32::NAN)), TableError::OutOfRange { field: Field::RateHz, .. }));
    // A filter of first order with an a2.
    let error = foreign(tag::DYNAMIC_FILTER, |body| body[size_of::<DynamicFilterHeader>() + 8] = 1);
    assert_eq!(error, TableError::NotZero { place: Place::ObjectBreakpoint(1, 0), field: Field::A2 });
}

#[test]
fn foreign_bytes_of_a_biquad_bank_are_refused_by_name() {
    let header = |change: fn(&mut BiquadsHeader)| {
        foreign(tag::BIQUADS, |body| change(BiquadsHeader::mut_from_prefix(body).expect("a head").0))
    };
    assert!(matches!(header(|head| head.object.set(7)), TableError::Dangling { index: 7, .. }));
    assert!(matches!(header(|head| head.chain_count.set(3)), TableError::LengthMismatch { .. }));
    assert!(matches!(header(|head| head.depth.set(5)), TableError::Count { field: Field::Biquads, value: 5, .. }));
    assert!(matches!(header(|head| head.reserved.set(1)), TableError::NotZero { .. }));
    let error = foreign(tag::BIQUADS, |body| {
        let (_, biquads) = BiquadsHeader::mut_from_prefix(body).expect("a head");
        BiquadRecord::mut_from_prefix(biquads).expect("a biquad").0.pole_im.set(1.5);
    });
    assert!(matches!(error, TableError::OutOfRange { place: Place::ObjectBiquad(1, 0), field: Field::Pole, .. }));
}

#[test]
fn two_filters_of_one_object_are_refused() {
    let mut kit = sample::parse(TEXT).expect("a right text");
    kit.objects[0].dynamic_filter = kit.objects[1].dynamic_filter.clone();
    let bytes = binary::build(&kit).expect("a right kit");
    // Objects of such sections must rise, so that a second section for one object is refused.
    let (mut body, range) = section_of(&bytes, tag::DYNAMIC_FILTER);
    DynamicFilterHeader::mut_from_prefix(&mut body[range]).expect("a head").0.object.set(1);
    match binary::read(&signed(&body)).expect_err("wrong bytes") {
        KitError::Binary { error: TableError::Count { place, field: Field::Object, value: 1, .. }, .. } => {
            assert_eq!(place, Place::ObjectFilter(1));
        }
        other => panic!("{other}"),
    }
}
