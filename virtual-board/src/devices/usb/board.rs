//! USB core on its board: its registers, its pins, and the host at the other end of the cable.

use crate::devices::{Access, Context, Devices, Problem};

impl Devices {
    pub(in crate::devices) fn read_usb(&mut self, offset: u32, context: &Context<'_>) -> Access<u32> {
        let asserted = self.usb.is_asserted();
        let value = self.usb.read(offset, context);
        if self.usb.is_asserted() != asserted {
            self.clock.pause_now();
        }
        value
    }

    pub(in crate::devices) fn write_usb(&mut self, offset: u32, value: u32, context: &Context<'_>) -> Access<()> {
        self.usb.write(offset, value, context)?;
        self.usb_pins_changed(context.now);
        self.usb.warnings.drain(..).for_each(|warning| self.recording.warn(&warning));
        Ok(())
    }

    /// Lets all events on the USB happen that are due.
    pub(in crate::devices) fn fire_usb(&mut self, context: &Context<'_>) -> Result<(), (&'static str, Problem)> {
        // The cycle of an event is rounded: it may lie before its time by the last bits.
        let context = Context { seconds: context.seconds + 1e-9, ..*context };
        self.usb.look_for_suspend(context.seconds);
        self.usb_host.fire(&mut self.usb, &context).map_err(|problem| ("USB_OTG_FS", problem))
    }

    /// Returns the cycle of the next event on the USB.
    pub(in crate::devices) fn next_usb_event(&self) -> u64 {
        self.cycle_at(self.usb.next_s().min(self.usb_host.next_s()))
    }

    /// Tells the USB host if the board pulls D+ up.
    pub(crate) fn usb_pins_changed(&mut self, now: u64) {
        let connected = self.wiring.usb_pins.iter().all(|&pin| self.is_alternate(pin, 10));
        if self.usb.is_attached() && !connected {
            self.recording.warn("USB is on, and PA11 and PA12 do not have its alternate function");
        }
        let at_s = self.seconds(now);
        self.usb_host.attached(self.usb.is_attached() && connected, at_s);
    }
}
