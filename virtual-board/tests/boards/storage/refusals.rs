//! Refusals: each has its name over the cable and in the log, and the old kit plays on.

use cable::{HostError, Refusal, Request};
use virtual_board::{Board, Setup, UsbAction};

use super::{Session, kit_of, says, slots};

fn refusal<T: std::fmt::Debug>(result: Result<T, HostError>) -> Refusal {
    match result {
        Err(HostError::Refused(refusal)) => refusal,
        other => panic!("{other:?}"),
    }
}

/// Strikes the first pad of the kit that plays, and returns true if the log tells it.
fn plays(session: &mut Session) -> bool {
    let before = says(&session.report(), ",strike").len();
    session.board.usb(UsbAction::Send(vec![0x09, 0x99, 60, 100]));
    session.run_for(0.03);
    says(&session.report(), ",strike").len() > before
}

#[test]
fn kits_that_a_board_cannot_take_are_refused_by_name_and_the_old_kit_plays() {
    for board in Board::ALL {
        let mut session = Session::start(board, Setup::default());
        let good = kit_of("good", 6_000);
        session.send(0, &good).unwrap();
        session.play(Some(0)).unwrap();

        let mut damaged = kit_of("damaged", 6_000);
        damaged[1000] ^= 1;
        let mut newer = good.clone();
        newer[4] = 9;
        let mut long = good.clone();
        long[8..12].copy_from_slice(&(200_000u32).to_le_bytes());
        let last = slots(board) - 1;
        // The slot of the kit that plays is written last: on the BlackPill its kit is gone then.
        let header = |kit: &[u8]| *kit.first_chunk::<16>().unwrap();
        let begin = |session: u32, slot, kit: &[u8]| Request::Begin { session, slot, header: header(kit) };
        let mut told = vec![
            refusal(session.ask(begin(1, slots(board), &good))),
            refusal(session.ask(begin(1, last, &newer))),
            refusal(session.ask(begin(1, last, &long))),
            refusal(session.ask(Request::Chunk { session: 1, number: 0, bytes: &good[16..256] })),
        ];
        assert!(plays(&mut session), "{}", board.name());
        session.ask(begin(1, last, &good)).unwrap();
        told.push(refusal(session.ask(begin(2, last, &good))));
        told.push(refusal(session.ask(Request::Chunk { session: 1, number: 1, bytes: &good[256..496] })));
        session.ask(Request::Chunk { session: 1, number: 0, bytes: &good[16..256] }).unwrap();
        told.push(refusal(session.ask(Request::Chunk { session: 1, number: 0, bytes: &good[17..257] })));
        told.push(refusal(session.ask(Request::End { session: 1 })));
        session.ask(Request::Abandon).unwrap();
        told.push(refusal(session.send(last, &damaged)));
        assert!(plays(&mut session), "{}", board.name());
        println!("{}: {told:?}", board.name());
        let names: Vec<String> = told.iter().map(|refusal| format!("{refusal:?}")).collect();
        let expected = [
            "NoSuchSlot",
            "NewerKit",
            "TooLong",
            "NoUpload",
            "WriteUnderWay",
            "ChunkOutOfOrder",
            "ChunkTwice",
            "ChunksMissing",
            "WrongCrc",
        ];
        for (name, expected) in names.iter().zip(expected) {
            assert!(name.starts_with(expected), "{}: {name} instead of {expected}", board.name());
        }
        let report = session.report();
        for expected in expected {
            assert!(!says(&report, &format!("cable: {expected}")).is_empty(), "{expected}: {:#?}", report.log);
        }
        assert!(report.resets.is_empty());
    }
}

#[test]
fn kit_that_the_board_cannot_load_is_refused_and_the_old_kit_plays() {
    let board = Board::BlackpillF411;
    let mut kit = kit::open("demo").unwrap().kit;
    kit.name = "too large".to_owned();
    let mode = kit.objects[0].modes[0].clone();
    kit.objects[0].modes = (0..2400).map(|n| kit::Mode { frequency_hz: 100.0 + n as f32, ..mode.clone() }).collect();
    let large = kit::binary::build(&kit).unwrap();
    let mut session = Session::start(board, Setup::default());
    assert_eq!(refusal(session.send(0, &large)), Refusal::NotLoadable);
    assert!(plays(&mut session));
    assert_eq!(refusal(session.play(Some(0))), Refusal::NotLoadable);
    assert!(plays(&mut session));
}
