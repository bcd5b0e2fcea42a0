//! Report of `malleus board run`, as text for people.

use std::fmt::Write;

use kit::counting::counted;
use virtual_board::Report;

pub(super) fn text(report: &Report) -> String {
    let mut text = String::new();
    let mhz = report.core_hz / 1e6;
    let microseconds = |cycles: f64| cycles / mhz;
    for line in &report.log {
        let _ = writeln!(text, "{:10.4} s  {:5} {}", line.at_s, line.level, line.message);
    }
    let waits = if report.flash_waits { " with the waits of flash" } else { "" };
    let _ =
        writeln!(text, "{}: {:.3} s at {mhz} MHz, {} cycles{waits}", report.board, report.seconds, report.cycle_case);
    let stack = report.stack_bytes.map_or("unknown".to_owned(), |bytes| format!("{bytes} bytes"));
    let _ = writeln!(
        text,
        "flash {} bytes, static RAM {} bytes, stack {stack}; {} instructions, idle {:.1} %",
        report.flash_bytes,
        report.static_ram_bytes,
        report.instructions,
        100.0 * report.idle_share
    );
    let audio = &report.audio;
    let frames: usize = audio.streams.iter().map(|stream| stream.frames).sum();
    let underruns: u64 = audio.streams.iter().map(|stream| stream.underruns).sum();
    let rate = audio.rate.as_deref().unwrap_or("no rate");
    let _ = writeln!(
        text,
        "I2S: {rate} Hz, {frames} frames in {}, {}; {}, {} late, worst load {:.1} %",
        counted(audio.streams.len(), "streams"),
        counted(underruns, "underruns"),
        counted(audio.halves, "halves"),
        audio.late_halves,
        100.0 * audio.worst_load.unwrap_or(0.0)
    );
    let _ = writeln!(
        text,
        "ADC: {}, {} lost",
        counted(report.adc.sequences, "sequences"),
        counted(report.adc.lost_triggers, "triggers")
    );
    for interrupt in &report.interrupts {
        let latency = interrupt
            .worst_latency_cycles
            .map_or(String::new(), |cycles| format!(", latency at most {:.2} us", microseconds(cycles as f64)));
        let _ = writeln!(
            text,
            "{:14} {:>14}, {:5.1} % of the time, at most {:.1} us{latency}",
            interrupt.name,
            counted(interrupt.count, "times"),
            100.0 * interrupt.cycles as f64 / (report.seconds * report.core_hz),
            microseconds(interrupt.worst_span_cycles as f64)
        );
    }
    let usb = &report.usb;
    if usb.resets > 0 {
        let _ = writeln!(
            text,
            "USB: configured {}, {} to the board, {} refused for the moment, {} from the board",
            counted(usb.configured_s.len(), "times"),
            counted(usb.sent.len(), "transfers"),
            usb.refused,
            usb.received.len()
        );
    }
    let flash = &report.flash;
    if flash.programmed + flash.failed + flash.torn > 0 || flash.erases.iter().any(|&erases| erases > 0) {
        let _ = writeln!(
            text,
            "flash: {} programmed, {} failed, {} torn; erases by sector {:?}",
            flash.programmed, flash.failed, flash.torn, flash.erases
        );
    }
    if let Some(lost_s) = report.power_lost_s {
        let _ = writeln!(text, "{lost_s:10.4} s  power lost");
    }
    for reset in &report.resets {
        let _ = writeln!(text, "{:10.4} s  reset: {}", reset.at_s, reset.cause);
    }
    for mute in &report.mutes {
        let _ = writeln!(text, "{:10.4} s  converter {}", mute.at_s, if mute.mute { "mute" } else { "audible" });
    }
    for volume in &report.volumes {
        let side = |db: Option<f64>| db.map_or("mute".to_owned(), |db| format!("{db} dB"));
        let [left, right] = volume.headphones_db.map(side);
        let _ = writeln!(text, "{:10.4} s  headphones {left} and {right}", volume.at_s);
    }
    let _ = writeln!(text, "LEDs: {}", counted(report.leds.len(), "changes"));
    for warning in report.codec_complaints.iter().chain(&report.warnings).chain(&usb.failures) {
        let _ = writeln!(text, "warning: {warning}");
    }
    text
}
