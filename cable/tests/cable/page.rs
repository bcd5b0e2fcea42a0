//! `docs/midi-sysex.md` against the code.

use cable::{CHUNK_BYTES, Device, Key, MESSAGE_BYTES, Message, Outcome, Refusal, Request, Value, ValueRange};

use crate::board::TestBoard;

const PAGE: &str = include_str!("../../../docs/midi-sysex.md");

/// Bytes of the page's example, each line with its sender.
fn example() -> Vec<(&'static str, Vec<u8>)> {
    let line = |line: &'static str| {
        let (sender, bytes) = line.split_once(" F0 ")?;
        let bytes = format!("F0 {bytes}");
        let bytes = bytes.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap());
        Some((sender.trim(), bytes.collect()))
    };
    PAGE.lines().filter_map(line).collect()
}

/// Cells of the rows of the table under a heading.
fn rows(heading: &str) -> Vec<Vec<&'static str>> {
    let section = PAGE.split(&format!("## {heading}\n")).nth(1).unwrap();
    let section = section.split("\n## ").next().unwrap();
    let rows = section.lines().filter(|line| line.starts_with("| ")).skip(2);
    rows.map(|line| line.trim_matches('|').split('|').map(str::trim).collect()).collect()
}

#[test]
fn example_of_the_page_is_what_both_ends_say() {
    let key = Key::Threshold { piezo: 2 };
    let mut requests = [
        (5, Request::Identity),
        (6, Request::Set { key, value: Some(Value::Number(0.01)) }),
        (7, Request::Erase { slot: 2 }),
    ]
    .into_iter();
    let mut device = Device::new();
    let mut board = TestBoard { slot_count: 1, ..TestBoard::new() };
    let mut message = Message::new();
    let mut answers = Vec::new();
    let example = example();
    assert_eq!(example.len(), 7);
    for (sender, bytes) in example {
        if sender == "board" {
            assert_eq!(bytes, answers.remove(0));
            continue;
        }
        let (tag, request) = requests.next().unwrap();
        request.write(tag, &mut message);
        assert_eq!(bytes, message.bytes());
        for byte in bytes {
            if device.receive(byte, &mut board, &mut message) != Outcome::Nothing {
                answers.push(message.bytes().to_vec());
            }
        }
        if device.work(&mut board, &mut message) != Outcome::Nothing {
            answers.push(message.bytes().to_vec());
        }
    }
    assert!(answers.is_empty() && requests.next().is_none());
    assert_eq!(board.settings.get(&key), Some(&Value::Number(0.01)));
}

#[test]
fn page_has_a_row_for_each_refusal() {
    let rows = rows("Refusals");
    for (index, row) in rows.iter().enumerate() {
        let code = index as u8 + 1;
        assert_eq!(row[0].parse(), Ok(code), "{row:?}");
        let (_, first, second) = Refusal::from_parts(code, 1, 1).unwrap().parts();
        assert_eq!((first == 1, second == 1), (!row[2].is_empty(), !row[3].is_empty()), "{row:?}");
    }
    assert_eq!(Refusal::from_parts(rows.len() as u8 + 1, 0, 0), None);
}

#[test]
fn page_has_a_row_for_each_setting_with_its_range() {
    let rows = rows("Settings");
    for (index, row) in rows.iter().enumerate() {
        let key = Key::from_parts(index as u8 + 1, 0).unwrap();
        assert_eq!(row[0].parse(), Ok(key.parts().0), "{row:?}");
        let range = match key.range() {
            ValueRange::Number(min, max) => format!("{min} to {max}"),
            ValueRange::Count(min, max) => format!("{min} to {max}"),
        };
        assert!(row[3].starts_with(&range), "{row:?}: {range}");
    }
    assert_eq!(Key::from_parts(rows.len() as u8 + 1, 0), None);
}

#[test]
fn page_names_the_longest_message_and_the_size_of_a_chunk() {
    let mut message = Message::new();
    Request::Chunk { session: u32::MAX, number: u16::MAX, bytes: &[0xFF; CHUNK_BYTES] }.write(127, &mut message);
    assert_eq!(message.bytes().len(), 294);
    assert_eq!((MESSAGE_BYTES, CHUNK_BYTES), (300, 240));
    for told in ["at most 300 bytes", "294 bytes, a full chunk", "16 + 240 n", "up to 240 bytes"] {
        assert!(PAGE.contains(told), "{told}");
    }
}

#[test]
fn memory_of_the_boards_end_is_at_most_one_kilobyte() {
    // On a board, whose words are half as long, it is less.
    let bytes = size_of::<Device>() + size_of::<Message>();
    assert!(bytes <= 1024, "{bytes} bytes");
}
