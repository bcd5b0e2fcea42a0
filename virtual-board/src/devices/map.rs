//! Map of the peripherals: addresses, names, and the bits of the RCC that clock them (RM0090 tables
//! 1 and 33, RM0383 table 1).

use crate::chip::Chip;

/// Peripheral that the virtual board models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Device {
    /// TIM2 to TIM5, numbered 0 to 3.
    Timer(u8),
    Watchdog,
    /// SPI2 (0) or SPI3 (1).
    I2s(u8),
    I2c,
    Power,
    Adc,
    Syscfg,
    Exti,
    /// GPIO port; 0 is port A.
    Gpio(u8),
    Rcc,
    Flash,
    /// DMA1 (0) or DMA2 (1).
    Dma(u8),
    Debug,
    Usb,
    /// Unique identity of the chip.
    Signature,
}

/// Peripheral of the chip.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Block {
    /// First address.
    pub(crate) base: u32,
    /// Name in the reference manual.
    pub(crate) name: &'static str,
    /// Model of the peripheral, or `None` if it is not modelled.
    pub(crate) device: Option<Device>,
    /// Offset in the RCC of the register with the enable bit, and the number of that bit.
    pub(crate) enable: Option<(u32, u32)>,
}

/// Offset of RCC_AHB1ENR.
const AHB1: u32 = 0x30;
/// Offset of RCC_AHB2ENR.
const AHB2: u32 = 0x34;
/// Offset of RCC_APB1ENR.
const APB1: u32 = 0x40;
/// Offset of RCC_APB2ENR.
const APB2: u32 = 0x44;

/// Returns a peripheral that is modelled.
const fn block(base: u32, name: &'static str, register: u32, bit: u32, device: Device) -> Block {
    Block { base, name, device: Some(device), enable: Some((register, bit)) }
}

/// Returns a peripheral that is modelled and whose clock is always on.
const fn always(base: u32, name: &'static str, device: Device) -> Block {
    Block { base, name, device: Some(device), enable: None }
}

/// Returns a peripheral that is not modelled.
const fn unmodelled(base: u32, name: &'static str, register: u32, bit: u32) -> Block {
    Block { base, name, device: None, enable: Some((register, bit)) }
}

/// Peripherals in the order of their addresses, of 1 KB each, and USB of 256 KB.
const BLOCKS: [Block; 55] = [
    always(0x1fff_7a00, "device signature", Device::Signature),
    block(0x4000_0000, "TIM2", APB1, 0, Device::Timer(0)),
    block(0x4000_0400, "TIM3", APB1, 1, Device::Timer(1)),
    block(0x4000_0800, "TIM4", APB1, 2, Device::Timer(2)),
    block(0x4000_0c00, "TIM5", APB1, 3, Device::Timer(3)),
    unmodelled(0x4000_1000, "TIM6", APB1, 4),
    unmodelled(0x4000_1400, "TIM7", APB1, 5),
    unmodelled(0x4000_1800, "TIM12", APB1, 6),
    unmodelled(0x4000_1c00, "TIM13", APB1, 7),
    unmodelled(0x4000_2000, "TIM14", APB1, 8),
    unmodelled(0x4000_2800, "RTC", APB1, 28),
    unmodelled(0x4000_2c00, "WWDG", APB1, 11),
    always(0x4000_3000, "IWDG", Device::Watchdog),
    unmodelled(0x4000_3400, "I2S2ext", APB1, 14),
    block(0x4000_3800, "SPI2", APB1, 14, Device::I2s(0)),
    block(0x4000_3c00, "SPI3", APB1, 15, Device::I2s(1)),
    unmodelled(0x4000_4000, "I2S3ext", APB1, 15),
    unmodelled(0x4000_4400, "USART2", APB1, 17),
    unmodelled(0x4000_4800, "USART3", APB1, 18),
    unmodelled(0x4000_4c00, "UART4", APB1, 19),
    unmodelled(0x4000_5000, "UART5", APB1, 20),
    block(0x4000_5400, "I2C1", APB1, 21, Device::I2c),
    unmodelled(0x4000_5800, "I2C2", APB1, 22),
    unmodelled(0x4000_5c00, "I2C3", APB1, 23),
    unmodelled(0x4000_6400, "CAN1", APB1, 25),
    unmodelled(0x4000_6800, "CAN2", APB1, 26),
    block(0x4000_7000, "PWR", APB1, 28, Device::Power),
    unmodelled(0x4000_7400, "DAC", APB1, 29),
    unmodelled(0x4001_0000, "TIM1", APB2, 0),
    unmodelled(0x4001_0400, "TIM8", APB2, 1),
    unmodelled(0x4001_1000, "USART1", APB2, 4),
    unmodelled(0x4001_1400, "USART6", APB2, 5),
    block(0x4001_2000, "ADC1", APB2, 8, Device::Adc),
    unmodelled(0x4001_2c00, "SDIO", APB2, 11),
    unmodelled(0x4001_3000, "SPI1", APB2, 12),
    unmodelled(0x4001_3400, "SPI4", APB2, 13),
    block(0x4001_3800, "SYSCFG", APB2, 14, Device::Syscfg),
    always(0x4001_3c00, "EXTI", Device::Exti),
    unmodelled(0x4001_4000, "TIM9", APB2, 16),
    unmodelled(0x4001_4400, "TIM10", APB2, 17),
    unmodelled(0x4001_4800, "TIM11", APB2, 18),
    block(0x4002_0000, "GPIOA", AHB1, 0, Device::Gpio(0)),
    block(0x4002_0400, "GPIOB", AHB1, 1, Device::Gpio(1)),
    block(0x4002_0800, "GPIOC", AHB1, 2, Device::Gpio(2)),
    block(0x4002_0c00, "GPIOD", AHB1, 3, Device::Gpio(3)),
    block(0x4002_1000, "GPIOE", AHB1, 4, Device::Gpio(4)),
    block(0x4002_1c00, "GPIOH", AHB1, 7, Device::Gpio(7)),
    unmodelled(0x4002_3000, "CRC", AHB1, 12),
    always(0x4002_3800, "RCC", Device::Rcc),
    always(0x4002_3c00, "FLASH", Device::Flash),
    block(0x4002_6000, "DMA1", AHB1, 21, Device::Dma(0)),
    block(0x4002_6400, "DMA2", AHB1, 22, Device::Dma(1)),
    block(0x5000_0000, "USB_OTG_FS", AHB2, 7, Device::Usb),
    unmodelled(0x5006_0800, "RNG", AHB2, 6),
    always(0xe004_2000, "DBGMCU", Device::Debug),
];

/// Ports F, G and I, which the F407 has but its 100-pin package does not bring out.
const MORE_PORTS: [(u32, &str, u8); 3] =
    [(0x4002_1400, "GPIOF", 5), (0x4002_1800, "GPIOG", 6), (0x4002_2000, "GPIOI", 8)];

/// Ranges of the bus in which peripherals may lie, as first address and length in bytes.
pub(crate) const REGIONS: [(u32, u32); 5] = [
    (0x1fff_7a00, 0x400),
    (0x4000_0000, 0x0001_8000),
    (0x4002_0000, 0x0006_0000),
    (0x5000_0000, 0x0008_0000),
    (0xe004_2000, 0x400),
];

/// Returns the peripheral that contains an address, and the offset in it.
pub(crate) fn find(address: u32, chip: Chip) -> Option<(Block, u32)> {
    let index = BLOCKS.partition_point(|block| block.base <= address).checked_sub(1)?;
    let block = BLOCKS[index];
    let offset = address - block.base;
    let length = if block.name == "USB_OTG_FS" { 0x40000 } else { 0x400 };
    if offset < length {
        return Some((block, offset));
    }
    let port = MORE_PORTS.iter().find(|port| chip == Chip::Stm32F407 && address.wrapping_sub(port.0) < 0x400)?;
    let device = Some(Device::Gpio(port.2));
    Some((Block { base: port.0, name: port.1, device, enable: Some((AHB1, u32::from(port.2))) }, address - port.0))
}

/// Returns the name of an interrupt line that a modelled peripheral raises or that programs pend
/// themselves.
pub(crate) fn interrupt_name(line: u16) -> Option<&'static str> {
    Some(match line {
        4 => "FLASH",
        6 => "EXTI0",
        7 => "EXTI1",
        8 => "EXTI2",
        9 => "EXTI3",
        10 => "EXTI4",
        11 => "DMA1_STREAM0",
        12 => "DMA1_STREAM1",
        13 => "DMA1_STREAM2",
        14 => "DMA1_STREAM3",
        15 => "DMA1_STREAM4",
        16 => "DMA1_STREAM5",
        17 => "DMA1_STREAM6",
        18 => "ADC",
        23 => "EXTI9_5",
        28 => "TIM2",
        29 => "TIM3",
        30 => "TIM4",
        31 => "I2C1_EV",
        32 => "I2C1_ER",
        36 => "SPI2",
        40 => "EXTI15_10",
        47 => "DMA1_STREAM7",
        49 => "SDIO",
        50 => "TIM5",
        51 => "SPI3",
        52 => "UART4",
        53 => "UART5",
        56 => "DMA2_STREAM0",
        57 => "DMA2_STREAM1",
        58 => "DMA2_STREAM2",
        59 => "DMA2_STREAM3",
        60 => "DMA2_STREAM4",
        67 => "OTG_FS",
        68 => "DMA2_STREAM5",
        69 => "DMA2_STREAM6",
        70 => "DMA2_STREAM7",
        72 => "I2C3_EV",
        _ => return None,
    })
}

/// Returns the interrupt line of a stream of DMA1 (0) or DMA2 (1).
pub(crate) fn dma_line(controller: u8, stream: u8) -> u16 {
    match (controller, stream) {
        (0, 7) => 47,
        (0, stream) => 11 + u16::from(stream),
        (_, stream @ 0..=4) => 56 + u16::from(stream),
        (_, stream) => 63 + u16::from(stream),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peripherals_stand_in_the_order_of_their_addresses() {
        assert!(BLOCKS.is_sorted_by(|a, b| a.base < b.base));
    }

    #[test]
    fn an_address_is_named_even_if_its_peripheral_is_not_modelled() {
        for (address, chip, name) in [
            (0x4001_204c, Chip::Stm32F407, Some("ADC1")),
            (0x4000_4404, Chip::Stm32F407, Some("USART2")),
            (0x4002_1410, Chip::Stm32F407, Some("GPIOF")),
            (0x4002_1410, Chip::Stm32F411, None),
            (0x4002_4000, Chip::Stm32F407, None),
            (0x5000_0e00, Chip::Stm32F411, Some("USB_OTG_FS")),
        ] {
            assert_eq!(find(address, chip).map(|(block, _)| block.name), name, "{address:#x}");
        }
    }

    #[test]
    fn streams_have_the_lines_of_the_vector_table() {
        for (controller, stream, name) in
            [(0, 4, "DMA1_STREAM4"), (0, 7, "DMA1_STREAM7"), (1, 0, "DMA2_STREAM0"), (1, 5, "DMA2_STREAM5")]
        {
            assert_eq!(interrupt_name(dma_line(controller, stream)), Some(name));
        }
    }
}
