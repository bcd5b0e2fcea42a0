//! Interrupt lines of the peripherals.

use super::Devices;
use super::map::dma_line;

impl Devices {
    /// Returns all asserted lines, as bits.
    pub(crate) fn lines(&self) -> u128 {
        let mut lines = 0_u128;
        let mut assert = |line: u16, asserted: bool| lines |= u128::from(asserted) << line;
        assert(4, self.flash.is_asserted());
        let exti = self.exti.asserted();
        for line in 0..5 {
            assert(6 + line, exti & 1 << line != 0);
        }
        assert(23, exti & 0x03e0 != 0);
        assert(40, exti & 0xfc00 != 0);
        for (timer, line) in self.timers.iter().zip([28, 29, 30, 50]) {
            assert(line, timer.is_asserted());
        }
        assert(18, self.adc.is_asserted());
        let (event, error) = self.i2c.asserted();
        assert(31, event);
        assert(32, error);
        for (i2s, line) in self.i2s.iter().zip([36, 51]) {
            assert(line, i2s.is_asserted());
        }
        assert(67, self.usb.is_asserted());
        let audio = self.audio_stream();
        for (controller, dma) in (0..).zip(&self.dma) {
            for (index, stream) in (0..).zip(&dma.streams) {
                let lost = self.armed.audio_interrupt_lost && audio == Some((controller, index));
                assert(dma_line(controller, index), stream.is_asserted() && !lost);
            }
        }
        lines
    }
}
