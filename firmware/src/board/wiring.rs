//! Peripherals of the I2S output.

use embassy_stm32::interrupt::Interrupt;
use embassy_stm32::pac::{dma::Dma, spi::Spi};

/// Peripherals that a board's I2S output uses.
#[derive(Clone, Copy)]
pub struct Wiring {
    /// SPI peripheral in I2S mode; the board sets up its clock and pins.
    pub spi: Spi,
    /// Number of the SPI peripheral's bit in RCC_APB1RSTR.
    pub reset_bit: u8,
    /// DMA controller that serves the peripheral.
    pub dma: Dma,
    /// Number of the DMA stream.
    pub stream: usize,
    /// Number of the stream's request channel.
    pub channel: u8,
    /// Interrupt of the stream.
    pub interrupt: Interrupt,
}
