//! Damaged, foreign and newer bytes are refused by name.

use dsp_core::table::layout::{FileHeader, NAME_BYTES, ObjectHeader, SectionEntry, tag};
use dsp_core::table::{Field, Place, TableError, checksum};
use kit::{Fault, Gain, Kit, KitError, binary};
use proptest::prelude::*;
use zerocopy::byteorder::little_endian::U32;
use zerocopy::{FromBytes, IntoBytes};

use crate::sample;

fn bytes() -> Vec<u8> {
    binary::build(&sample::kit()).expect("a valid kit")
}

/// Bytes of the sample kit with one more section of 4 bytes at their end.
fn with_section(section_tag: [u8; 4]) -> Vec<u8> {
    let old = bytes();
    let header = size_of::<FileHeader>();
    let entry_bytes = size_of::<SectionEntry>();
    let (count, rest) = U32::read_from_prefix(&old[header..]).expect("a count");
    let (entries, _) = <[SectionEntry]>::ref_from_prefix_with_elems(rest, count.get() as usize).expect("a directory");
    let mut body = U32::new(count.get() + 1).as_bytes().to_vec();
    for entry in entries {
        let moved = SectionEntry { offset: U32::new(entry.offset.get() + entry_bytes as u32), ..*entry };
        body.extend_from_slice(moved.as_bytes());
    }
    let added = SectionEntry {
        tag: section_tag,
        version: U32::new(7),
        offset: U32::new((old.len() + entry_bytes) as u32),
        length: U32::new(4),
    };
    body.extend_from_slice(added.as_bytes());
    body.extend_from_slice(&old[header + 4 + size_of_val(entries)..]);
    body.extend_from_slice(&[1, 2, 3, 4]);
    signed(&body)
}

/// The body behind a header with the right length and checksum.
pub(crate) fn signed(body: &[u8]) -> Vec<u8> {
    let (mut header, _) = FileHeader::read_from_prefix(&bytes()).expect("a header");
    header.length = U32::new((size_of::<FileHeader>() + body.len()) as u32);
    header.crc = U32::new(checksum(body));
    [header.as_bytes(), body].concat()
}

fn table_error(bytes: &[u8]) -> TableError {
    match binary::read(bytes).expect_err("damaged") {
        KitError::Binary { error, .. } => error,
        other => panic!("{other}"),
    }
}

#[test]
fn kit_with_a_flipped_bit_is_refused() {
    let good = bytes();
    for index in 0..good.len() {
        for bit in 0..8 {
            let mut bad = good.clone();
            bad[index] ^= 1 << bit;
            assert!(binary::read(&bad).is_err(), "byte {index}, bit {bit}");
        }
    }
}

#[test]
fn kit_that_is_cut_off_is_refused() {
    let good = bytes();
    for length in 0..good.len() {
        assert!(binary::read(&good[..length]).is_err(), "{length} of {} bytes", good.len());
    }
}

proptest! {
    #[test]
    fn damaged_bytes_never_panic_and_are_never_accepted(damage in prop::collection::vec((any::<prop::sample::Index>(), 1u8..), 1..9)) {
        let good = bytes();
        let mut bad = good.clone();
        for (index, change) in damage {
            bad[index.index(good.len())] ^= change;
        }
        prop_assert!(bad == good || binary::read(&bad).is_err());
    }

    /// Bytes that are read although they are damaged must be a kit that can be built again.
    #[test]
    fn damaged_bytes_with_a_right_checksum_never_panic(damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..9)) {
        let mut body = bytes().split_off(size_of::<FileHeader>());
        for (index, value) in damage {
            let index = index.index(body.len());
            body[index] = value;
        }
        if let Ok(kit) = binary::read(&signed(&body)) {
            prop_assert!(binary::build(&kit).is_ok());
        }
    }

    #[test]
    fn random_bytes_never_panic_and_are_never_accepted(noise in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(binary::read(&noise).is_err());
        prop_assert!(binary::read(&[&b"MALL\x01\0\0\0"[..], &noise].concat()).is_err());
    }
}

#[test]
fn erased_flash_may_follow_a_kit_and_nothing_else_may() {
    let mut flash = bytes();
    let length = flash.len();
    flash.resize(length + 100, 0xFF);
    assert_eq!(binary::read(&flash).ok(), Some(sample::kit()));
    flash[length + 7] = 0xFE;
    assert_eq!(table_error(&flash), TableError::TrailingBytes { offset: length + 7 });
}

#[test]
fn kit_of_a_newer_version_is_refused() {
    let mut newer = bytes();
    newer[4] = 2;
    assert_eq!(table_error(&newer), TableError::NewerVersion { found: 2 });
}

#[test]
fn unknown_section_is_refused_by_name() {
    let error = table_error(&with_section(*b"ROOM"));
    assert_eq!(error, TableError::UnknownSection { tag: *b"ROOM" });
    assert!(error.to_string().contains("\"ROOM\""), "{error}");
}

#[test]
fn section_that_may_be_skipped_is_skipped_and_listed() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("kit.bin");
    let foreign = with_section(*b"colr");
    std::fs::write(&path, &foreign)?;
    let loaded = kit::load(&path)?;
    assert_eq!(loaded.kit, sample::kit());
    assert_eq!(loaded.skipped_sections, ["colr"]);
    assert_eq!(loaded.binary, foreign);
    Ok(())
}

#[test]
fn section_of_a_newer_version_is_refused_by_name() {
    let error = table_error(&with_section(tag::PADS));
    assert_eq!(error, TableError::NewerSection { tag: tag::PADS, found: 7 });
}

/// Refusal of the sample kit after a change.
fn refusal(change: impl FnOnce(&mut Kit)) -> KitError {
    let mut kit = sample::kit();
    change(&mut kit);
    binary::build(&kit).expect_err("a wrong kit")
}

fn refusal_message(change: impl FnOnce(&mut Kit)) -> String {
    refusal(change).to_string()
}

#[test]
fn number_outside_its_range_is_refused_with_item_field_and_range() {
    let message = refusal_message(|kit| kit.objects[1].modes[2].frequency_hz = f32::INFINITY);
    assert_eq!(message, "object 1 \"string\", mode 2: frequency_hz = inf: must be from 0.1 to 1000000");
    let message = refusal_message(|kit| kit.strikers[0].modes[0].decay_per_s = f32::NAN);
    assert_eq!(message, "striker 0 \"yarn\", mode 0: decay_per_s = NaN: must be from 0.01 to 20000");
    let message = refusal_message(|kit| kit.pads[1].pan = 1.5);
    assert_eq!(message, "pad 1 \"string\": pan = 1.5: must be from -1 to 1");
}

#[test]
fn names_that_would_be_cut_or_changed_are_refused() {
    for name in ["", " bar", "bar ", "a,b", "a\"b", "bär", "bar\0", "twenty-five characters...", &"x".repeat(70_000)] {
        let message = refusal_message(|kit| {
            kit.name = name.to_owned();
        });
        assert!(message.contains("name must be 1 to 24 printable ASCII"), "{message}");
    }
    let longest = "x".repeat(NAME_BYTES);
    let mut kit = sample::kit();
    kit.name = longest.clone();
    let read = binary::build(&kit).and_then(|bytes| binary::read(&bytes));
    assert_eq!(read.map(|kit| kit.name).ok(), Some(longest));
}

#[test]
fn sources_and_licences_that_do_not_fit_are_refused() {
    let most = usize::from(u16::MAX);
    let message = refusal_message(|kit| kit.objects[0].source = "x".repeat(most + 1));
    assert_eq!(message, "object 0 \"bar\": bytes of source: 65536: must be at most 65535");
    let message = refusal_message(|kit| kit.strikers[1].licence = "é".repeat(40_000));
    assert_eq!(message, "striker 1 \"wood\": bytes of licence: 80000: must be at most 65535");
    let mut kit = sample::kit();
    kit.objects[0].source = "x".repeat(most);
    assert!(binary::build(&kit).is_ok());
}

#[test]
fn more_modes_positions_strikers_or_notes_than_fit_are_refused() {
    for modes in [4097, 65_536, 65_536 + 4] {
        let message = refusal_message(|kit| kit.objects[0].modes = sample::bank(modes, 1));
        assert_eq!(message, format!("object 0 \"bar\": modes = {modes}: must be from 0 to 4096"));
    }
    let message = refusal_message(|kit| kit.objects[0].modes = sample::bank(1, 65));
    assert_eq!(message, "object 0 \"bar\": positions = 65: must be from 1 to 64");
    let message = refusal_message(|kit| kit.objects[0].modes = sample::bank(1, 0));
    assert_eq!(message, "object 0 \"bar\": positions = 0: must be from 1 to 64");
    for strikers in [0, 5] {
        let message = refusal_message(|kit| kit.pads[0].strikers = vec!["yarn".to_owned(); strikers]);
        assert_eq!(message, format!("pad 0 \"bar\": strikers = {strikers}: must be from 1 to 4"));
    }
    let message = refusal_message(|kit| kit.pads[0].midi_notes = vec![1, 2, 3, 4, 5]);
    assert_eq!(message, "pad 0 \"bar\": midi_notes = 5: must be from 0 to 4");
}

#[test]
fn notes_above_127_and_notes_of_two_pads_are_refused() {
    for note in [128, 254, 255] {
        let message = refusal_message(|kit| kit.pads[0].midi_notes = vec![note]);
        assert!(message.starts_with(&format!("pad 0 \"bar\": midi_notes has {note}: notes are 0 to 127")), "{message}");
    }
    let message = refusal_message(|kit| kit.pads[1].midi_notes = vec![60]);
    assert!(message.starts_with("pad 1 \"string\": midi_notes has 60"), "{message}");
}

#[test]
fn modes_with_different_numbers_of_gains_are_refused() {
    let message = refusal_message(|kit| kit.objects[1].modes[1].gains.push(Gain::default()));
    assert_eq!(message, "object 1 \"string\", mode 1: 3 gains: must be 2, as many as the object's first mode has");
    let message = refusal_message(|kit| kit.strikers[0].modes[0].gains.push(Gain::default()));
    assert_eq!(message, "striker 0 \"yarn\", mode 0: 2 gains: must be 1, since a striker has one position");
}

#[test]
fn pad_that_names_an_unknown_object_or_striker_is_refused_with_the_known_ones() {
    let error = refusal(|kit| kit.pads[0].object = "strign".to_owned());
    assert_eq!(
        error.to_string(),
        "pad 0 \"bar\": object names \"strign\": there is no such object (did you mean \"string\"?); objects: \"bar\", \"string\""
    );
    let KitError::Item { place: Place::Pad(0), fault, .. } = error else { panic!("{error}") };
    assert!(matches!(*fault, Fault::Unknown { kind: "object", .. }));
    let message = refusal_message(|kit| kit.strikers.clear());
    assert_eq!(message, "pad 0 \"bar\": strikers names \"yarn\": there is no such striker; the kit has no strikers");
}

#[test]
fn two_items_of_one_kind_and_name_are_refused() {
    let message = refusal_message(|kit| kit.objects[1].name = "bar".to_owned());
    assert!(message.starts_with("pad 1 \"string\": object names \"string\""), "{message}");
    let message = refusal_message(|kit| kit.strikers.push(sample::striker("yarn")));
    assert_eq!(message, "striker 2 \"yarn\": another one has the same name");
}

fn directory(bytes: &[u8]) -> &[SectionEntry] {
    let (count, rest) = U32::read_from_prefix(&bytes[size_of::<FileHeader>()..]).expect("a count");
    let (entries, _) = <[SectionEntry]>::ref_from_prefix_with_elems(rest, count.get() as usize).expect("a directory");
    entries
}

/// True if a binary kit has a section of a tag.
pub(crate) fn has_section(bytes: &[u8], wanted: [u8; 4]) -> bool {
    directory(bytes).iter().any(|entry| entry.tag == wanted)
}

/// Bytes behind a kit's header, and the range in them of the first section with a tag.
pub(crate) fn section_of(bytes: &[u8], wanted: [u8; 4]) -> (Vec<u8>, std::ops::Range<usize>) {
    let header = size_of::<FileHeader>();
    let section = directory(bytes).iter().find(|entry| entry.tag == wanted).expect("such a section");
    let start = section.offset.get() as usize - header;
    (bytes[header..].to_vec(), start..start + section.length.get() as usize)
}

#[test]
fn object_section_with_wrong_counts_is_refused() {
    let (mut body, range) = section_of(&bytes(), tag::OBJECT);
    let (record, _) = ObjectHeader::mut_from_prefix(&mut body[range.clone()]).expect("an object");
    record.mode_count.set(4096);
    assert!(matches!(table_error(&signed(&body)), TableError::LengthMismatch { place: Place::Object(0), .. }));
    record_positions(&mut body[range]);
    assert!(matches!(
        table_error(&signed(&body)),
        TableError::Count { place: Place::Object(0), field: Field::Positions, value: 0, .. }
    ));
}

fn record_positions(section: &mut [u8]) {
    let (record, _) = ObjectHeader::mut_from_prefix(section).expect("an object");
    record.position_count.set(0);
}
