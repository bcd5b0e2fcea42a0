//! Task of USB: control requests, receiving and sending, none of which waits for another.

use core::future::poll_fn;
use core::pin::pin;
use core::task::Poll;

use embassy_futures::join::join3;
use embassy_futures::select::select;
use embassy_stm32::Peri;
use embassy_stm32::peripherals::{PA11, PA12, USB_OTG_FS};
use embassy_stm32::usb;
use embassy_time::{Duration, Timer, with_timeout};
use embassy_usb::driver::{EndpointError, EndpointIn, EndpointOut};
use embassy_usb::{Builder, UsbDevice};

use super::descriptors::{self, CONFIGURATION_BYTES, TRANSFER_BYTES};
use super::ends::{Gatherer, Inner, Packet, Router};
use super::interrupts::{self, BUS_RESET, Bound};
use crate::counters;
use crate::owned::Owned;

/// USB peripheral and its pins.
pub struct Port {
    /// USB core, full speed.
    pub peripheral: Peri<'static, USB_OTG_FS>,
    /// Pin of D+.
    pub dp: Peri<'static, PA12>,
    /// Pin of D-.
    pub dm: Peri<'static, PA11>,
}

type Otg = usb::Driver<'static, USB_OTG_FS>;

/// Time after which a transfer is given up that the host does not fetch. A host that listens asks
/// at least once a millisecond.
pub(super) const SEND_TIMEOUT: Duration = Duration::from_millis(20);
/// Time after which a reset of the bus is served whatever else waits. The reset itself lasts 10 ms.
const RESET_TIMEOUT: Duration = Duration::from_millis(2);

/// Memory of the driver.
struct Buffers {
    configuration: [u8; CONFIGURATION_BYTES],
    control: [u8; 64],
    /// Packets of the OUT endpoints: control and MIDI.
    received: [u8; 2 * TRANSFER_BYTES],
}

static BUFFERS: Owned<Buffers> = Owned::empty();

/// Serves USB for ever.
#[embassy_executor::task]
pub(super) async fn run(port: Port, inner: Inner) {
    let empty = Buffers { configuration: [0; _], control: [0; _], received: [0; _] };
    // SAFETY: the task runs once.
    let buffers = unsafe { BUFFERS.fill(empty) };
    // The BlackPill has the supply of the cable on no pin, and the DISC1 on PA9. Neither watches
    // it, so that both do the same: without a cable the bus is as if suspended.
    let mut config = usb::Config::default();
    config.vbus_detection = false;
    let driver = Otg::new_fs(port.peripheral, Bound, port.dp, port.dm, &mut buffers.received, config);
    let mut builder =
        Builder::new(driver, descriptors::device(), &mut buffers.configuration, &mut [], &mut [], &mut buffers.control);
    let (receiving, sending) = descriptors::add_midi(&mut builder);
    let device = builder.build();
    join3(control(device), receive(receiving, inner.router), send(sending, inner.gatherer)).await;
}

/// Serves the control requests of the host and the events of the bus.
async fn control(mut device: UsbDevice<'static, Otg>) {
    loop {
        // A request that the host breaks off would be waited for. Begun anew, the device serves the
        // reset first.
        select(device.run(), reset_is_not_served()).await;
    }
}

/// Waits until a reset of the bus has not been served for [`RESET_TIMEOUT`].
async fn reset_is_not_served() {
    loop {
        poll_fn(|context| {
            BUS_RESET.register(context.waker());
            if interrupts::reset_is_pending() { Poll::Ready(()) } else { Poll::Pending }
        })
        .await;
        Timer::after(RESET_TIMEOUT).await;
        if interrupts::reset_is_pending() {
            return;
        }
    }
}

/// Passes on the packets of the host.
async fn receive(mut endpoint: impl EndpointOut, mut router: Router) {
    let mut transfer = [0; TRANSFER_BYTES];
    loop {
        endpoint.wait_enabled().await;
        while let Ok((bytes, at)) = read(&mut endpoint, &mut transfer).await {
            counters::USB_TRANSFERS.add(1);
            for &packet in transfer.get(..bytes).unwrap_or_default().as_chunks().0 {
                router.take(packet, at).await;
            }
        }
    }
}

/// Reads a transfer. Returns its length in bytes, and the time at which it ended in core cycles.
async fn read(endpoint: &mut impl EndpointOut, transfer: &mut [u8]) -> Result<(usize, u32), EndpointError> {
    let mut read = pin!(endpoint.read(transfer));
    let (bytes, at) = poll_fn(|context| interrupts::with_arrival(|| read.as_mut().poll(context))).await;
    Ok((bytes?, at))
}

/// Sends packets to the host. Those that it does not fetch are counted as unsent.
async fn send(mut endpoint: impl EndpointIn, mut gatherer: Gatherer) {
    let mut transfer = [0; TRANSFER_BYTES];
    loop {
        let bytes = gatherer.gather(&mut transfer).await;
        let written = with_timeout(SEND_TIMEOUT, endpoint.write(transfer.get(..bytes).unwrap_or_default())).await;
        if !matches!(written, Ok(Ok(()))) {
            counters::USB_UNSENT.add((bytes / size_of::<Packet>()) as u32);
        }
    }
}
