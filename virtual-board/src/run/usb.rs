//! USB host of a board that a test or a program drives while the board runs.

use super::VirtualBoard;
use crate::usb_host::{UsbAction, UsbTransfer};

impl VirtualBoard {
    /// Lets the USB host do something now.
    ///
    /// A program that answers what the board sends runs the board in small steps, looks at what
    /// came ([`VirtualBoard::usb_received`]), and sends its answer. The same steps give the same
    /// run.
    ///
    /// ```no_run
    /// use virtual_board::{UsbAction, VirtualBoard};
    ///
    /// # fn identify(board: &mut VirtualBoard) -> Result<(), Box<dyn std::error::Error>> {
    /// let identity_request = [[0x04, 0xf0, 0x7e, 0x7f], [0x07, 0x06, 0x01, 0xf7]];
    /// board.usb(UsbAction::Send(identity_request.as_flattened().to_vec()));
    /// let before = board.usb_received(0).len();
    /// while board.usb_received(before).is_empty() {
    ///     board.run_until(board.now_s() + 1e-3)?;
    /// }
    /// # Ok(())
    /// # }
    /// # fn main() {}
    /// ```
    pub fn usb(&mut self, action: UsbAction) {
        let now_s = self.now_s();
        self.devices.lock().usb_host.add(now_s, action);
    }

    /// Returns the transfers that the board has sent, from number `first` on.
    pub fn usb_received(&self, first: usize) -> Vec<UsbTransfer> {
        self.devices.lock().usb_host.received().get(first..).unwrap_or_default().to_vec()
    }
}
