//! MIDI packets: all of them arrive, in order and soon, however many come.

use super::{CONFIGURED_S, assert_sound, host, notes, received, run};
use virtual_board::{Board, UsbAction};

fn send(at_s: f64, packets: &[[u8; 4]]) -> (f64, UsbAction) {
    (at_s, UsbAction::Send(packets.as_flattened().to_vec()))
}

#[test]
fn packets_reach_the_sound_and_come_back_in_order_within_two_halves() {
    for board in Board::ALL {
        // Single packets, transfers of 16, and 60 at once, at different places in a half.
        let packets = notes(300);
        let mut actions = Vec::new();
        let (mut rest, mut at_s) = (packets.as_slice(), CONFIGURED_S);
        for count in [1, 16, 60].into_iter().cycle() {
            let (now, later) = rest.split_at(count.min(rest.len()));
            actions.push(send(at_s, now));
            (rest, at_s) = (later, at_s + 0.005_037);
            if rest.is_empty() {
                break;
            }
        }
        let (_, report) = run(board, host(actions), at_s + 0.05);
        assert_sound(board, &report);
        assert!(received(&report) == packets, "{}: {} packets are back", board.name(), received(&report).len());
        let singles = report.usb.sent.iter().filter(|transfer| transfer.bytes.len() == 4);
        let latencies = singles.map(|sent| {
            let back = report.usb.received.iter().find(|back| back.bytes == sent.bytes).unwrap();
            back.ended_s - sent.ended_s
        });
        let worst_s = latencies.fold(0.0, f64::max);
        println!("{}: single packets are back at most {:.3} ms later", board.name(), 1e3 * worst_s);
        assert!(worst_s < 2.0 * 32.0 / 48_000.0, "{}: {worst_s} s", board.name());
    }
}

#[test]
fn sysex_goes_to_a_task_and_holds_notes_up_no_longer_than_the_bus_needs() {
    for board in Board::ALL {
        // 1500 bytes: more than the queues hold, so that the host has to wait.
        let mut sysex = vec![[0x04, 0xf0, 0x7d, 0x00]];
        sysex.extend((0..498).map(|n: u32| [0x04, (n % 128) as u8, (n / 128) as u8, 0x55]));
        sysex.push([0x07, 0x01, 0x02, 0xf7]);
        let after = notes(3);
        let actions = vec![send(CONFIGURED_S, &[notes(2).as_slice(), &sysex, &after].concat())];
        let (_, report) = run(board, host(actions), CONFIGURED_S + 0.2);
        assert_sound(board, &report);
        let all = received(&report);
        let begins = all.iter().position(|packet| *packet == sysex[0]).unwrap();
        assert!(all[begins..].starts_with(&sysex), "{}: a note lies within the SysEx", board.name());
        let (pieces, short): (Vec<_>, Vec<_>) = all.into_iter().partition(|packet| packet[0] < 8);
        assert_eq!(pieces.len(), sysex.len(), "{}", board.name());
        assert_eq!(short, [notes(2), after].concat(), "{}", board.name());
        let last = report.usb.sent.last().unwrap();
        println!("{}: 1500 bytes of SysEx took {:.2} ms", board.name(), 1e3 * (last.ended_s - CONFIGURED_S));
        assert!(last.ended_s < CONFIGURED_S + 0.03, "{}: {last:?}", board.name());
    }
}

#[test]
fn storm_of_full_transfers_back_to_back_misses_no_half() {
    for board in Board::ALL {
        let storm = UsbAction::Storm { packets: notes(160).as_flattened().to_vec(), for_s: 2.0 };
        let (_, report) = run(board, host(vec![(CONFIGURED_S, storm)]), CONFIGURED_S + 2.2);
        assert_sound(board, &report);
        let told = report.log.iter().rfind(|line| line.message.starts_with("USB:")).unwrap();
        let per_ms = report.usb.sent.len() as f64 / 2000.0;
        println!("{}: {per_ms:.1} transfers in a millisecond; {}", board.name(), told.message);
        assert!(per_ms > 5.0, "{}: {per_ms}", board.name());
        // Each packet was taken or counted as lost, and each one that came back was sent.
        assert!(received(&report).iter().all(|packet| packet[..2] == [0x09, 0x99]));
    }
}
