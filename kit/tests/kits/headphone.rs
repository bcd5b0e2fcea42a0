//! Volume of a board's headphones in text and bytes.

use dsp_core::table;
use dsp_core::table::layout::tag;
use kit::{binary, text};

use crate::binary_refusals::has_section;
use crate::sample;

const TEXT: &str = "format = 1\nname = \"test\"\nheadphone_db = -30.5\n";

#[test]
fn volume_of_headphones_comes_through_text_and_bytes_unchanged() {
    let kit = sample::parse(TEXT).expect("a right text");
    assert_eq!(kit.headphone_db, Some(-30.5));
    assert_eq!(sample::parse(&text::write(&kit)).expect("its own text"), kit);
    let bytes = binary::build(&kit).expect("a right kit");
    assert_eq!(binary::read(&bytes).expect("its own bytes"), kit);
    assert_eq!(table::Kit::parse(&bytes).expect("its own bytes").headphone_db(), Some(-30.5));
}

#[test]
fn kit_without_a_volume_has_no_section_for_it() {
    let mut kit = sample::parse(TEXT).expect("a right text");
    let with = binary::build(&kit).expect("a right kit");
    kit.headphone_db = None;
    let without = binary::build(&kit).expect("a right kit");
    assert!(has_section(&with, tag::HEADPHONE) && !has_section(&without, tag::HEADPHONE));
    assert_eq!(table::Kit::parse(&without).expect("its own bytes").headphone_db(), None);
    assert!(!text::write(&kit).contains("headphone_db"));
    // A line of the directory takes 16 bytes, and the number takes 4.
    assert_eq!(with.len(), without.len() + 16 + 4);
}

#[test]
fn invalid_volume_of_headphones_is_refused_with_its_range() {
    for (wrong, said) in [("-60.5", "-60.5"), ("0.5", "0.5"), ("nan", "NaN")] {
        let refused = sample::parse(&TEXT.replace("-30.5", wrong)).expect_err("a wrong text").to_string();
        assert!(refused.contains(&format!("headphone_db = {said}: must be from -60 to 0")), "{refused}");
    }
}
