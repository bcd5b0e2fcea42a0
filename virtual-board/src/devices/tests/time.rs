//! Tests of timers, the ADC that one triggers, and its DMA.

use super::{ADC, Bench, DMA2, GPIO, RAM, TIM3};
use crate::input::PiezoSignal;
use crate::wiring::Board;

#[test]
fn a_timer_counts_updates_and_interrupts_at_its_rate() {
    let mut bench = Bench::new(Board::Stm32f407gDisc1);
    bench.write(TIM3 + 0x28, 15);
    bench.write(TIM3 + 0x2c, 999);
    bench.write(TIM3 + 0x14, 1);
    bench.write(TIM3 + 0x10, 0);
    bench.write(TIM3 + 0x0c, 1);
    bench.write(TIM3, 1);
    // The rate is 16 MHz / 16 / 1000 = 1 kHz.
    bench.pass(15_999);
    assert_eq!((bench.read(TIM3 + 0x24), bench.read(TIM3 + 0x10)), (999, 0));
    bench.pass(1);
    assert_eq!((bench.read(TIM3 + 0x24), bench.read(TIM3 + 0x10) & 1), (0, 1));
    assert_eq!(bench.devices.lines(), 1 << 29);
    bench.write(TIM3 + 0x10, 0);
    assert_eq!(bench.devices.lines(), 0);
    bench.pass(16_000 * 7 + 160);
    assert_eq!(bench.read(TIM3 + 0x24), 10);
}

#[test]
fn a_compare_value_sets_its_flag_once_a_period() {
    let mut bench = Bench::new(Board::Stm32f407gDisc1);
    bench.write(TIM3 + 0x2c, 0xffff);
    bench.write(TIM3 + 0x34, 1000);
    bench.write(TIM3, 1);
    bench.pass(999);
    assert_eq!(bench.read(TIM3 + 0x10), 0);
    bench.pass(1);
    assert_eq!(bench.read(TIM3 + 0x10), 2);
    bench.write(TIM3 + 0x10, 0);
    bench.pass(65_535);
    assert_eq!(bench.read(TIM3 + 0x10), 1, "the update only");
    bench.pass(1);
    assert_eq!(bench.read(TIM3 + 0x10), 3);
}

#[test]
fn a_compare_value_of_zero_interrupts_as_others_do() {
    let mut bench = Bench::new(Board::Stm32f407gDisc1);
    bench.write(TIM3 + 0x2c, 0xffff);
    bench.write(TIM3 + 0x38, 0);
    bench.write(TIM3 + 0x0c, 4);
    bench.write(TIM3, 1);
    bench.pass(65_535);
    assert_eq!(bench.devices.lines(), 0);
    bench.pass(1);
    assert_eq!(bench.devices.lines(), 1 << 29);
    assert_eq!(bench.read(TIM3 + 0x10) & 4, 4);
}

/// Returns a board that samples PA1 and PA2 in a scan every 1/8000 s, into a ring of 16 frames.
fn sampling() -> Bench {
    let mut bench = Bench::new(Board::Stm32f407gDisc1);
    let ramp = |piezo, from: f32, by: f32| PiezoSignal {
        piezo,
        start_s: 0.0,
        rate_hz: 8000.0,
        samples: (0..200).map(|k| from + by * k as f32).collect(),
    };
    bench.devices.piezos = vec![ramp(0, -0.5, 0.001), ramp(1, 0.25, 0.0)];
    bench.write(GPIO, 0xa800_0000 | 0xf << 2);
    bench.write(ADC + 0x304, 0);
    bench.write(ADC + 4, 1 << 8);
    bench.write(ADC + 0x2c, 1 << 20);
    bench.write(ADC + 0x34, 1 | 2 << 5);
    bench.write(ADC + 8, 1);
    bench.pass(100);
    let stream = DMA2 + 0x10;
    bench.write(stream + 4, 32);
    bench.write(stream + 8, ADC + 0x4c);
    bench.write(stream + 0x0c, RAM);
    // The stream moves half-words to rising addresses, in a circle, with both interrupts.
    bench.write(stream, 1 << 13 | 1 << 11 | 1 << 10 | 1 << 8 | 0b11 << 3 | 1);
    bench.write(ADC + 8, 1 | 1 << 8 | 1 << 9 | 8 << 24 | 1 << 28);
    bench.write(TIM3 + 0x2c, 1999);
    bench.write(TIM3 + 4, 2 << 4);
    bench.write(TIM3, 1);
    bench
}

#[test]
fn a_timer_samples_two_piezos_into_a_ring() {
    let mut bench = sampling();
    bench.pass(2000 * 8 + 200);
    assert_eq!(bench.read(DMA2) & 0x3f, 1 << 4, "half");
    assert_eq!(bench.devices.lines(), 1 << 56);
    assert_eq!(bench.read(DMA2 + 0x14), 16);
    bench.write(DMA2 + 8, 0x3d);
    bench.pass(2000 * 8);
    assert_eq!(bench.read(DMA2) & 0x3f, 1 << 5, "complete");
    let codes = bench.halves(RAM, 32);
    for (frame, pair) in codes.chunks(2).enumerate() {
        // The first sequence begins one period after the start and samples a few cycles later.
        let expected = 2048.0 + 2047.0 * (-0.5 + 0.001 * (frame + 1) as f32);
        assert!((f32::from(pair[0]) - expected).abs() < 1.0, "{frame}: {} {expected}", pair[0]);
        assert_eq!(pair[1], 2048 + 512);
    }
    assert_eq!(bench.devices.adc_counts(), (16, 0));
    bench.pass(2000);
    assert_ne!(bench.halves(RAM, 1)[0], codes[0], "the ring begins anew");
}

#[test]
fn a_conversion_that_is_not_fetched_overruns_and_stops_the_adc() {
    let mut bench = sampling();
    bench.pass(2000 * 3 + 200);
    bench.write(DMA2 + 0x10, 0);
    bench.pass(2000 * 2);
    assert_ne!(bench.read(ADC) & 1 << 5, 0, "OVR");
    let (sequences, _) = bench.devices.adc_counts();
    bench.pass(2000 * 4);
    assert_eq!(bench.devices.adc_counts().0, sequences, "no conversion until it is cleared");
}

#[test]
fn a_pin_that_is_not_analog_reads_nothing_and_warns() {
    let mut bench = sampling();
    bench.write(GPIO, 0xa800_0000 | 3 << 2);
    bench.pass(2000 * 2);
    assert_eq!(bench.halves(RAM, 2)[1], 0);
    assert!(bench.devices.recording.warnings[0].contains("PA2"), "{:?}", bench.devices.recording.warnings);
}

#[test]
fn a_stream_to_the_core_coupled_memory_ends_with_a_transfer_error() {
    let mut bench = sampling();
    let stream = DMA2 + 0x10;
    bench.write(stream, 0);
    bench.write(stream + 0x0c, 0x1000_0000);
    bench.write(stream, 1 << 13 | 1 << 11 | 1 << 10 | 1 << 8 | 1 << 2 | 1);
    bench.pass(2000 * 2);
    assert_eq!(bench.read(DMA2) & 0x3f, 1 << 3);
    assert_eq!(bench.read(stream) & 1, 0);
    assert_eq!(bench.devices.lines(), 1 << 56);
}
