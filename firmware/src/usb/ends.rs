//! Queues between USB and the rest of the program.

use core::future::poll_fn;
use core::task::Poll;

use embassy_stm32::interrupt::{self, InterruptExt};
use embassy_sync::waitqueue::AtomicWaker;

use crate::counters;
use crate::queue::{Queue, Receiver, Sender};

/// USB-MIDI event packet: cable and code index number, then up to three MIDI bytes (USB Device
/// Class Definition for MIDI Devices 1.0, section 4).
pub type Packet = [u8; 4];

/// Maximum number of packets that wait in each queue.
const WAITING: usize = 64;
/// Code index numbers of SysEx: 4 starts or continues it, 5 to 7 end it with 1 to 3 bytes.
///
/// Number 5 is that of single-byte system common messages, too: they go with the SysEx.
const SYSEX: core::ops::RangeInclusive<u8> = 4..=7;

/// Packet of the host.
#[derive(Clone, Copy, Debug)]
pub struct Received {
    /// Event packet, not SysEx.
    pub packet: Packet,
    /// Time at which the transfer of the packet ended, in core cycles.
    pub at: u32,
}

static INCOMING: Queue<Received, WAITING> = Queue::new();
static OUTGOING: Queue<Packet, WAITING> = Queue::new();
static SYSEX_IN: Queue<Packet, WAITING> = Queue::new();
static REPLIES: Queue<Packet, WAITING> = Queue::new();

/// Waker of the part of the USB task that waits for packets to send.
static TO_SEND: AtomicWaker = AtomicWaker::new();
/// Waker of the part of the USB task that waits for room among the SysEx packets.
static ROOM: AtomicWaker = AtomicWaker::new();
/// Waker of the task that waits for SysEx.
static SYSEX_CAME: AtomicWaker = AtomicWaker::new();
/// Waker of the task that waits for room among the replies.
static REPLIES_LEFT: AtomicWaker = AtomicWaker::new();

/// Short messages of the host, which the audio interrupt takes.
pub struct Incoming(Receiver<Received, WAITING>);

/// Short messages to the host, which the audio interrupt appends.
pub struct Outgoing(Sender<Packet, WAITING>);

/// SysEx of the host, which a task takes.
///
/// While 64 packets wait here, USB takes no transfer, and the host keeps what it has to send.
pub struct Sysex(Receiver<Packet, WAITING>);

/// SysEx to the host, which a task appends.
pub struct Replies(Sender<Packet, WAITING>);

/// Ends of the queues between USB and the rest of the program.
pub struct Ends {
    /// Short messages of the host, for the audio interrupt.
    pub incoming: Incoming,
    /// Short messages to the host, of the audio interrupt.
    pub outgoing: Outgoing,
    /// SysEx of the host, for a task.
    pub sysex: Sysex,
    /// SysEx to the host, of a task.
    pub replies: Replies,
}

/// Ends of the queues on the side of USB.
pub(super) struct Inner {
    pub(super) router: Router,
    pub(super) gatherer: Gatherer,
}

/// Distributor of the packets of the host.
pub(super) struct Router {
    incoming: Sender<Received, WAITING>,
    sysex: Sender<Packet, WAITING>,
}

/// Collector of packets for a transfer to the host.
pub(super) struct Gatherer {
    outgoing: Receiver<Packet, WAITING>,
    replies: Receiver<Packet, WAITING>,
    /// True while a SysEx has been sent in part.
    in_sysex: bool,
}

/// Gives the ends of all queues, or `None` if they have been given before.
pub(super) fn split() -> Option<(Ends, Inner)> {
    let (to_audio, incoming) = INCOMING.split()?;
    let (outgoing, from_audio) = OUTGOING.split()?;
    let (to_task, sysex) = SYSEX_IN.split()?;
    let (replies, from_task) = REPLIES.split()?;
    let ends = Ends {
        incoming: Incoming(incoming),
        outgoing: Outgoing(outgoing),
        sysex: Sysex(sysex),
        replies: Replies(replies),
    };
    let router = Router { incoming: to_audio, sysex: to_task };
    let gatherer = Gatherer { outgoing: from_audio, replies: from_task, in_sysex: false };
    Some((ends, Inner { router, gatherer }))
}

impl Incoming {
    /// Returns true if no message waits.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Removes and returns the oldest message, or `None` if there is none.
    pub fn take(&mut self) -> Option<Received> {
        self.0.take()
    }
}

impl Outgoing {
    /// Appends a short message, or counts it as unsent if 64 wait.
    ///
    /// USB sends it as soon as no interrupt of higher priority runs.
    pub fn push(&mut self, packet: Packet) {
        match self.0.push(packet) {
            true => interrupt::I2C3_EV.pend(),
            false => counters::USB_UNSENT.add(1),
        }
    }
}

impl Sysex {
    /// Waits for the next packet, and removes and returns it.
    pub async fn next(&mut self) -> Packet {
        let packet = poll_fn(|context| {
            SYSEX_CAME.register(context.waker());
            self.0.take().map_or(Poll::Pending, Poll::Ready)
        })
        .await;
        ROOM.wake();
        packet
    }
}

impl Replies {
    /// Appends a packet of a SysEx as soon as fewer than 64 wait, which is soon: USB gives up what
    /// the host does not fetch.
    ///
    /// Short messages wait from the first packet of a SysEx to its last, so all of them must be
    /// pushed.
    pub async fn push(&mut self, packet: Packet) {
        poll_fn(|context| {
            REPLIES_LEFT.register(context.waker());
            if self.0.push(packet) { Poll::Ready(()) } else { Poll::Pending }
        })
        .await;
        interrupt::I2C3_EV.pend();
    }
}

/// Returns true if a packet belongs to a SysEx of the only cable.
fn is_sysex(packet: Packet) -> bool {
    packet[0] >> 4 == 0 && SYSEX.contains(&(packet[0] & 0xf))
}

/// Wakes the part of the USB task that sends.
pub(super) fn wake_sender() {
    TO_SEND.wake();
}

impl Router {
    /// Passes on a packet whose transfer ended at `at`.
    ///
    /// A packet of a SysEx waits until there is room. Another packet for which there is no room is
    /// counted as lost.
    pub(super) async fn take(&mut self, packet: Packet, at: u32) {
        if is_sysex(packet) {
            poll_fn(|context| {
                ROOM.register(context.waker());
                if self.sysex.push(packet) { Poll::Ready(()) } else { Poll::Pending }
            })
            .await;
            SYSEX_CAME.wake();
        } else if !self.incoming.push(Received { packet, at }) {
            counters::USB_LOST.add(1);
        }
    }
}

impl Gatherer {
    /// Waits for packets to send, and fills `transfer` from its start. Returns the number of bytes.
    pub(super) async fn gather(&mut self, transfer: &mut [u8]) -> usize {
        poll_fn(|context| {
            TO_SEND.register(context.waker());
            let mut packets = 0;
            for (place, packet) in transfer.as_chunks_mut().0.iter_mut().zip(core::iter::from_fn(|| self.next())) {
                *place = packet;
                packets += 1;
            }
            if packets == 0 { Poll::Pending } else { Poll::Ready(packets * size_of::<Packet>()) }
        })
        .await
    }

    /// Removes and returns the packet that is sent next.
    fn next(&mut self) -> Option<Packet> {
        if !self.in_sysex
            && let Some(packet) = self.outgoing.take()
        {
            return Some(packet);
        }
        let packet = self.replies.take()?;
        REPLIES_LEFT.wake();
        self.in_sysex = packet[0] & 0xf == *SYSEX.start();
        Some(packet)
    }
}
