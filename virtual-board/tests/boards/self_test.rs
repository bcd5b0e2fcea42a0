//! Self-test image on the virtual boards: it passes on a good one and names what is wrong.

use std::path::Path;

use virtual_board::{Board, LogLine, PiezoSignal, Setup, VirtualBoard};

const FIRMWARE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../firmware/Cargo.toml");
const SIGNAL_HZ: f64 = 48_000.0;

/// Runs the self-test and returns its log up to the last line.
fn table(board: Board, piezos: Vec<PiezoSignal>) -> Vec<LogLine> {
    let arguments = ["--no-default-features", "--features", board.name()];
    let elf = virtual_core::build_binary(Path::new(FIRMWARE), "self-test", &arguments).unwrap();
    let mut running = VirtualBoard::new(board, &elf, &Setup { flash_waits: true, piezos, ..Setup::default() }).unwrap();
    for step in 1..=16 {
        running.run_until(0.5 * f64::from(step)).unwrap();
        let report = running.report().unwrap();
        assert!(report.resets.is_empty(), "{:#?}", report.resets);
        if report.log.iter().any(|line| line.message.starts_with("self-test: ")) {
            report.log.iter().for_each(|line| println!("{:.3} {}", line.at_s, line.message));
            return report.log;
        }
    }
    panic!("no end: {:#?}", running.report().unwrap().log);
}

/// Returns the first line that begins with `begin`.
fn row<'a>(table: &'a [LogLine], begin: &str) -> &'a str {
    let row = table.iter().find(|line| line.message.starts_with(begin));
    &row.unwrap_or_else(|| panic!("no row {begin}")).message
}

/// Returns the whole numbers of a line.
fn numbers(row: &str) -> Vec<f64> {
    row.split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn the_self_test_passes_on_the_disc1_and_its_kernels_agree_with_the_cycle_model() {
    let table = table(Board::Stm32f407gDisc1, Vec::new());
    for begin in ["codec: ", "RAM, stack", "RAM, hot", "built-in kit", "I2S rate", "ADC rate", "piezo 0", "piezo 3"] {
        assert!(row(&table, begin).ends_with("good"), "{}", row(&table, begin));
    }
    // The dividers make 47 991.071 Hz.
    let rate_mhz = numbers(row(&table, "I2S rate"))[1];
    assert!((rate_mhz / 86e9 * 1792.0 - 1.0).abs() < 1e-4, "{rate_mhz}");
    let kernels: Vec<&str> =
        table.iter().map(|line| line.message.as_str()).filter(|row| row.starts_with("kernel ")).collect();
    assert_eq!(kernels.len(), 15);
    for kernel in kernels {
        // "..., ringing: MEASURED/1000 cycles a mode and sample, by the model MODEL: good"
        let [measured, _, model] = numbers(kernel.split_once(": ").unwrap().1)[..] else { panic!("{kernel}") };
        assert!((0.98..1.12).contains(&(measured / model)) && kernel.ends_with("good"), "{kernel}");
    }
    // A virtual ADC has no noise of its own, unlike that of a board.
    assert!(row(&table, "piezo 1").contains("noise 0/100"));
    assert_eq!(row(&table, "self-test: "), "self-test: passed");
}

#[test]
fn the_self_test_on_the_blackpill_measures_noise_and_names_the_wrong_bias() {
    // A square wave of 3 counts has 3 counts rms, and the bias of piezo 3 is 400 counts too high.
    let square = (0..48_000 * 8).map(|n| if n / 7 % 2 == 0 { 3.0 / 2048.0 } else { -3.0 / 2048.0 });
    let shaken = PiezoSignal { piezo: 1, start_s: 0.0, rate_hz: SIGNAL_HZ, samples: square.collect() };
    let biased = PiezoSignal { piezo: 3, start_s: 0.0, rate_hz: 1.0, samples: vec![400.0 / 2048.0; 10] };
    let table = table(Board::BlackpillF411, vec![shaken, biased]);
    let noise = numbers(row(&table, "piezo 1: "))[2];
    assert!((noise - 300.0).abs() < 30.0, "{noise}");
    let bias = row(&table, "piezo 3: ");
    assert!((numbers(bias)[1] - 2448.0).abs() <= 1.0 && bias.ends_with("WRONG"), "{bias}");
    assert!(row(&table, "I2S rate").ends_with("by its dividers 48000000 mHz: good"));
    assert_eq!(row(&table, "self-test: "), "self-test: 1 checks failed");
}
