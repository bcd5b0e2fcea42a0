//! Kits and settings in the flash of a board, which a computer sends over USB.

mod deeds;
mod page;
mod power;
mod refusals;
mod settings;
mod uploads;

use cable::{Answer, Content, Download, Exchange, HostError, Query, Request, Task, Upload, converse};
use virtual_board::{Board, Report, Setup, UsbAction, UsbHost, VirtualBoard};

use crate::common;
use crate::usb::link::{BoardLink, LinkError};

/// Time at which the board is configured, in s from power-on: the BlackPill has loaded its kit at
/// 0.35 s.
const CONFIGURED_S: f64 = 0.5;

/// Board with a computer at its cable.
struct Session {
    board: VirtualBoard,
    exchange: Exchange,
}

impl Session {
    /// Starts a board with its cable plugged in, and waits until it is configured.
    fn start(board: Board, setup: Setup) -> Self {
        let plugged = std::iter::once((0.2, UsbAction::Plug)).chain(setup.usb.actions).collect();
        let setup = Setup { usb: UsbHost { actions: plugged, ..UsbHost::default() }, ..setup };
        let mut running = VirtualBoard::new(board, &common::application(board), &setup).unwrap();
        running.run_until(CONFIGURED_S).unwrap();
        Self { board: running, exchange: Exchange::new(1) }
    }

    fn do_task(&mut self, task: &mut impl Task) -> Result<(), HostError> {
        let told = converse(&mut BoardLink::new(&mut self.board), &mut self.exchange, task, |_| {});
        told.map_err(|error| match error {
            LinkError::Host(error) => error,
            LinkError::Board(error) => panic!("{error}"),
        })
    }

    fn ask(&mut self, request: Request<'_>) -> Result<Answer<'static>, HostError> {
        let mut query = Query::new(request);
        self.do_task(&mut query)?;
        Ok(query.answer().unwrap())
    }

    fn send(&mut self, slot: u8, kit: &[u8]) -> Result<(), HostError> {
        self.do_task(&mut Upload::new(kit, slot)?)
    }

    fn play(&mut self, slot: Option<u8>) -> Result<(), HostError> {
        self.ask(Request::Start { slot }).map(drop)
    }

    fn content(&mut self, slot: u8) -> Content {
        match self.ask(Request::Slot { slot }).unwrap() {
            Answer::Slot { content, .. } => content,
            other => panic!("{other:?}"),
        }
    }

    fn read(&mut self, slot: u8) -> Vec<u8> {
        let mut kit = vec![0; Download::length(slot, self.content(slot)).unwrap()];
        self.do_task(&mut Download::new(slot, &mut kit, 0)).unwrap();
        kit
    }

    fn run_for(&mut self, seconds: f64) {
        let until_s = self.board.now_s() + seconds;
        self.board.run_until(until_s).unwrap();
    }

    fn report(&self) -> Report {
        self.board.report().unwrap()
    }
}

/// Number of slots of a board.
fn slots(board: Board) -> u8 {
    if board == Board::Stm32f407gDisc1 { 2 } else { 1 }
}

/// Returns the lines of the log that contain `words`.
fn says<'r>(report: &'r Report, words: &str) -> Vec<&'r str> {
    report.log.iter().map(|line| line.message.as_str()).filter(|message| message.contains(words)).collect()
}

/// Returns a kit of one pad with a name, of `bytes` bytes or a few less if its texts can be that
/// long.
fn kit_of(name: &str, bytes: usize) -> Vec<u8> {
    let mut kit = kit::open("demo").unwrap().kit;
    kit.name = name.to_owned();
    kit.pads.truncate(1);
    let used = kit.pads[0].object.clone();
    kit.objects.retain(|object| object.name == used);
    let strikers = kit.pads[0].strikers.clone();
    kit.strikers.retain(|striker| strikers.contains(&striker.name));
    let least = kit::binary::build(&kit).unwrap().len();
    let filler = bytes.saturating_sub(least) / 4 * 4;
    let object = &mut kit.objects[0];
    for text in [&mut object.source, &mut object.licence] {
        let left = filler.min(65_000);
        text.push_str(&"malleus ".repeat(left / 8));
    }
    kit::binary::build(&kit).unwrap()
}
