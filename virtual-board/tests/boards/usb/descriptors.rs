//! Descriptors against USB 2.0, chapter 9, and the Device Class Definition for MIDI Devices 1.0.

use super::{host, run};
use virtual_board::Board;

/// Parts of a list of descriptors, each with its type.
fn parts(bytes: &[u8]) -> Vec<(u8, &[u8])> {
    let mut rest = bytes;
    let mut parts = Vec::new();
    while let [length, kind, ..] = *rest {
        assert!(length >= 2, "a descriptor of {length} bytes");
        let (part, others) = rest.split_at(usize::from(length));
        parts.push((kind, part));
        rest = others;
    }
    assert!(rest.is_empty(), "{rest:?} behind the last descriptor");
    parts
}

fn word(bytes: &[u8]) -> usize {
    usize::from(u16::from_le_bytes([bytes[0], bytes[1]]))
}

/// Jack of the MIDI interface.
#[derive(Debug, PartialEq)]
struct Jack {
    is_output: bool,
    is_embedded: bool,
    id: u8,
    sources: Vec<u8>,
}

/// Reads a jack descriptor (sections 6.1.2.2 and 6.1.2.3).
fn jack(part: &[u8]) -> Jack {
    let is_output = part[2] == 3;
    assert!(part[2] == 2 || is_output, "subtype {}", part[2]);
    assert!(part[3] == 1 || part[3] == 2, "jack type {}", part[3]);
    let pins = if is_output { usize::from(part[5]) } else { 0 };
    assert_eq!(part.len(), if is_output { 6 + 2 * pins + 1 } else { 6 });
    let sources = (0..pins).map(|pin| part[6 + 2 * pin]).collect();
    for pin in 0..pins {
        assert_eq!(part[7 + 2 * pin], 1, "a jack has one output pin");
    }
    Jack { is_output, is_embedded: part[3] == 1, id: part[4], sources }
}

#[test]
fn both_images_enumerate_with_descriptors_of_the_usb_midi_specification() {
    for board in Board::ALL {
        let (_, report) = run(board, host(vec![]), 0.5);
        super::assert_sound(board, &report);
        assert_eq!(report.usb.configured_s.len(), 1);
        assert!(report.usb.configured_s[0] < super::CONFIGURED_S, "{:?}", report.usb.configured_s);

        // USB 2.0, table 9-8.
        let device = &report.usb.device_descriptor;
        assert_eq!((device.len(), device[0], device[1]), (18, 18, 1));
        assert_eq!(word(&device[2..]), 0x0200);
        assert_eq!(device[4..7], [0, 0, 0], "the interfaces name their classes");
        assert!([8, 16, 32, 64].contains(&device[7]));
        assert_eq!((word(&device[8..]), word(&device[10..])), (0x1209, 0x0001), "pid.codes, for tests");
        assert_eq!(device[17], 1, "configurations");
        let [maker, product, serial] = report.usb.strings.as_slice() else { panic!("{:?}", report.usb.strings) };
        assert_eq!((maker.as_str(), product.as_str()), ("Malleus", "Malleus"));
        // Windows takes letters and digits alone.
        assert!(serial.len() == 24 && serial.chars().all(|c| c.is_ascii_hexdigit()), "{serial}");
        check_configuration(&report.usb.configuration_descriptor);
    }
}

/// Checks a configuration with one MIDI function.
fn check_configuration(bytes: &[u8]) {
    let parts = parts(bytes);
    // USB 2.0, table 9-10.
    let (kind, configuration) = parts[0];
    assert_eq!((kind, configuration.len(), word(&configuration[2..])), (2, 9, bytes.len()));
    assert_eq!((configuration[4], configuration[5]), (2, 1), "interfaces, value");
    assert_eq!(configuration[7] & 0xc0, 0x80, "bus-powered");
    assert_eq!(configuration[8], 50, "100 mA");

    let interfaces: Vec<usize> = (0..parts.len()).filter(|&index| parts[index].0 == 4).collect();
    let [control, midi] = interfaces[..] else { panic!("{} interfaces", interfaces.len()) };
    assert_eq!(control, 1);
    // Section 6, and USB Audio 1.0 section 4.3: the audio control interface names the MIDI
    // interface.
    assert_eq!(parts[control].1[2..8], [0, 0, 0, 1, 1, 0], "number, alternate, endpoints, class");
    assert_eq!((parts[control + 1].0, parts[control + 1].1), (0x24, &[9, 0x24, 1, 0, 1, 9, 0, 1, 1][..]));
    assert_eq!(midi, control + 2);
    assert_eq!(parts[midi].1[2..8], [1, 0, 2, 1, 3, 0], "number, alternate, endpoints, class");

    // Section 6.1.2.1. In the example of appendix B the total length contains the endpoints.
    let (kind, header) = parts[midi + 1];
    assert_eq!((kind, header.len(), header[2], word(&header[3..])), (0x24, 7, 1, 0x0100));
    let total: usize = parts[midi + 1..].iter().map(|part| part.1.len()).sum();
    assert_eq!(word(&header[5..]), total);

    let first_endpoint = (0..parts.len()).find(|&index| parts[index].0 == 5).unwrap();
    let jacks: Vec<Jack> = parts[midi + 2..first_endpoint].iter().map(|part| jack(part.1)).collect();
    let mut ids: Vec<u8> = jacks.iter().map(|jack| jack.id).collect();
    ids.sort_unstable();
    ids.dedup();
    assert!(ids.len() == jacks.len() && !ids.contains(&0), "each jack has a number of its own: {jacks:?}");
    let find = |is_output, is_embedded| {
        let mut found = jacks.iter().filter(|jack| jack.is_output == is_output && jack.is_embedded == is_embedded);
        let jack = found.next().unwrap();
        assert!(found.next().is_none(), "one cable in each direction");
        jack
    };
    // What the host sends leaves by the external OUT jack, what comes in goes to the host.
    assert_eq!(find(true, false).sources, [find(false, true).id]);
    assert_eq!(find(true, true).sources, [find(false, false).id]);

    // Section 6.2: standard and class-specific descriptor of each bulk endpoint.
    let endpoints = &parts[first_endpoint..];
    assert_eq!(endpoints.len(), 4);
    let mut addresses = Vec::new();
    for pair in endpoints.chunks_exact(2) {
        let (standard, specific) = (pair[0], pair[1]);
        assert_eq!((standard.0, standard.1.len()), (5, 9));
        assert_eq!((standard.1[3], word(&standard.1[4..])), (2, 64), "bulk of 64 bytes");
        assert_eq!(standard.1[6..9], [0, 0, 0], "interval, refresh, synchronisation");
        assert_eq!((specific.0, specific.1.len(), specific.1[2], specific.1[3]), (0x25, 5, 1, 1));
        let is_in = standard.1[2] & 0x80 != 0;
        assert_eq!(specific.1[4], find(is_in, true).id, "the endpoint's embedded jack");
        addresses.push(standard.1[2]);
    }
    addresses.sort_unstable();
    assert_eq!(addresses, [0x01, 0x81]);
}
