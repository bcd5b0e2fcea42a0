//! Tests of I2S, I2C with the codec, pins and EXTI.

use super::{Bench, DMA1, GPIO, I2C1, RAM, RCC, SPI2};
use crate::frequency::Frequency;
use crate::wiring::Board;

/// Returns an F411 that plays by I2S2.
///
/// PLLI2S makes 25 MHz / 25 * 192 / 2 = 96 MHz, and I2S2 has 32-bit slots at 96 MHz / (64 * 31).
fn playing(connected: bool) -> Bench {
    let mut bench = Bench::new(Board::BlackpillF411);
    bench.write(RCC, 1 | 1 << 16);
    bench.pass(48_000);
    bench.write(RCC + 0x04, 25 | 192 << 6 | 1 << 22);
    bench.write(RCC + 0x84, 25 | 192 << 6 | 2 << 28);
    bench.write(RCC, 1 | 1 << 16 | 1 << 26);
    if connected {
        bench.write(GPIO + 0x400, 0x280 | 2 << 24 | 2 << 26 | 2 << 30);
        bench.write(GPIO + 0x424, 5 << 16 | 5 << 20 | 5 << 28);
    }
    let half_words: Vec<u8> = (0..32_u16).flat_map(|k| (0x0100 * k + 7).to_le_bytes()).collect();
    bench.machine.write(RAM, &half_words).unwrap();
    let stream = DMA1 + 0x10 + 4 * 0x18;
    bench.write(stream + 4, 32);
    bench.write(stream + 8, SPI2 + 0x0c);
    bench.write(stream + 0x0c, RAM);
    bench.write(stream, 1 << 13 | 1 << 11 | 1 << 10 | 1 << 8 | 1 << 6 | 0b11 << 3 | 1);
    bench.write(SPI2 + 0x20, 15 | 1 << 8);
    bench.write(SPI2 + 0x04, 1 << 1);
    bench.write(SPI2 + 0x1c, 1 << 11 | 2 << 8 | 1 << 1 | 1 | 1 << 10);
    bench
}

#[test]
fn the_i2s_sends_what_dma_brings_at_the_rate_of_its_registers() {
    let mut bench = playing(true);
    // At 16 MHz 20 frames take 20 * 64 * 31 / 96 times 16 core cycles.
    bench.pass((20.0 * 64.0 * 31.0 / 96.0 * 16.0) as u64 + 2);
    let stream = &bench.devices.audio().streams[0];
    assert_eq!(stream.rate, Frequency::hz(96_000_000).scaled(1, 64 * 31));
    assert_eq!((stream.frames.len(), stream.underruns, stream.unconnected_frames), (20, 0, 0));
    for (index, frame) in stream.frames.iter().enumerate() {
        let word = |k: usize| (0x100 * (4 * (index % 8) + k) + 7) as u32;
        assert_eq!(frame.map(|sample| sample as u32), [word(0) << 16 | word(1), word(2) << 16 | word(3)]);
    }
    assert!(bench.devices.recording.warnings.is_empty());
    // The flags were never cleared, so every half after the first is late.
    let late = bench.devices.recording.audio_halves.iter().filter(|half| half.late).count();
    assert_eq!((bench.devices.recording.audio_halves.len(), late), (5, 4));
}

#[test]
fn an_i2s_whose_pins_have_another_function_is_not_heard() {
    let mut bench = playing(false);
    bench.pass(10_000);
    let stream = &bench.devices.audio().streams[0];
    assert!(stream.frames.len() > 10 && stream.frames.iter().all(|frame| *frame == [0; 2]));
    assert_eq!(stream.unconnected_frames, stream.frames.len() as u64);
    assert!(bench.devices.recording.warnings[0].contains("alternate function"));
}

#[test]
fn a_stream_that_stops_repeats_its_last_half_word_in_every_slot() {
    let mut bench = playing(true);
    bench.pass(2000);
    bench.devices.armed.audio_dma_error = true;
    bench.pass(5000);
    let stream = &bench.devices.audio().streams[0];
    let last = stream.frames.last().unwrap().map(|sample| sample as u32);
    assert!(stream.underruns > 10);
    assert!(last[0] == last[1] && last[0] >> 16 == last[0] & 0xffff, "{last:x?}");
}

#[test]
fn a_byte_for_the_codec_takes_nine_bits_and_is_acknowledged_only_out_of_reset() {
    for released in [true, false] {
        let mut bench = Bench::new(Board::Stm32f407gDisc1);
        // PB6 and PB9 have alternate function 4, and PD4 is an output.
        bench.write(GPIO + 0x400, 0x280 | 2 << 12 | 2 << 18);
        bench.write(GPIO + 0x420, 4 << 24);
        bench.write(GPIO + 0x424, 4 << 4);
        bench.write(GPIO + 0xc00, 1 << 8);
        bench.write(GPIO + 0xc18, if released { 1 << 4 } else { 1 << 20 });
        bench.write(I2C1 + 4, 16);
        bench.write(I2C1 + 0x1c, 80);
        bench.write(I2C1, 1);
        bench.write(I2C1, 1 | 1 << 8);
        bench.pass(200);
        assert_ne!(bench.read(I2C1 + 0x14) & 1, 0, "SB");
        bench.write(I2C1 + 0x10, 0x94);
        // At 100 kHz and 16 MHz a bit takes 160 cycles.
        bench.pass(9 * 160 - 1);
        assert_eq!(bench.read(I2C1 + 0x14) & 0x402, 0);
        bench.pass(1);
        assert_eq!(bench.read(I2C1 + 0x14) & 0x402, if released { 2 } else { 0x400 }, "ADDR or AF");
    }
}

#[test]
fn the_button_makes_an_edge_on_the_line_that_watches_it() {
    let mut bench = Bench::new(Board::Stm32f407gDisc1);
    const EXTI: u32 = 0x4001_3c00;
    bench.write(EXTI, 1);
    bench.write(EXTI + 8, 1);
    bench.devices.set_button(true);
    bench.devices.pins_changed(0);
    assert_eq!((bench.read(EXTI + 0x14), bench.devices.lines()), (1, 1 << 6));
    assert_eq!(bench.read(GPIO + 0x10) & 1, 1);
    bench.write(EXTI + 0x14, 1);
    bench.devices.set_button(false);
    bench.devices.pins_changed(0);
    assert_eq!(bench.devices.lines(), 0, "falling edges are not asked for");
}

#[test]
fn leds_light_at_the_level_of_their_board() {
    for (board, port, bit, level) in [(Board::Stm32f407gDisc1, 3, 13, true), (Board::BlackpillF411, 2, 13, false)] {
        let mut bench = Bench::new(board);
        bench.write(GPIO + 0x400 * port + 0x18, if level { 1 << bit } else { 1 << (bit + 16) });
        bench.write(GPIO + 0x400 * port, 1 << (2 * bit));
        let leds = &bench.devices.recording.leds;
        assert!(leds.len() == 1 && leds[0].lit, "{leds:?}");
    }
}
