use crate::common;
use virtual_board::{Board, Setup, UsbAction, UsbHost};

#[test]
fn smoke() {
    for board in Board::ALL {
        let note = |n: u8| vec![0x09, 0x99, n, 100];
        let actions = vec![(0.3, UsbAction::Plug), (0.6, UsbAction::Send((0..20).flat_map(note).collect()))];
        let setup = Setup { usb: UsbHost { actions, ..UsbHost::default() }, ..Setup::default() };
        let report = common::run(board, &setup, 1.1).report().unwrap();
        println!("{:#?}", report.usb);
        println!("{:#?}", report.log);
        println!("{:#?}", report.interrupts);
        println!("{:#?}", report.warnings);
    }
}
