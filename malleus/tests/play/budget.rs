//! Modes that a board has no time for: they are left out, reported, logged, and left out in replay.

use std::fs;

use crate::folder::Folder;

#[test]
fn log_of_a_budget_plays_to_the_bits_of_the_logged_run() {
    let folder = Folder::new();
    // Times between samples, so that the log must keep them exactly.
    folder.write("strikes.csv", b"time_s,pad,velocity\n0.00101,bar,0.9\n0.0507,bar,0.5\n0.11,bar,1\n");
    let played = |words: &str, file: &str| {
        let output = folder.malleus(words);
        assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
        fs::read(folder.path(file)).unwrap()
    };
    let whole = played("play --kit kit.toml --strikes strikes.csv -o whole.wav", "whole.wav");
    let busy = "play --kit kit.toml --strikes strikes.csv --budget-mhz 20 --log log.csv -o busy.wav";
    let busy = played(busy, "busy.wav");
    let log = fs::read_to_string(folder.path("log.csv")).unwrap();
    assert!(busy != whole && log.contains(",shed "), "{log}");
    assert!(played("play --kit kit.toml --strikes log.csv -o again.wav", "again.wav") == busy, "{log}");
}

/// Sound of the demo kit on the BlackPill.
fn on_blackpill(folder: &Folder, strikes: &str, options: &str) -> Vec<u8> {
    let words = format!("play --kit demo --board blackpill-f411 --strikes {strikes} -o out.wav{options}");
    let output = folder.malleus(&words);
    assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    fs::read(folder.path("out.wav")).unwrap()
}

#[test]
fn first_modes_of_each_pad_stay_where_time_is_short_and_the_log_says_so() {
    let folder = Folder::new();
    let played = |strikes: &str, options: &str| on_blackpill(&folder, strikes, options);
    let pads = kit::open("demo").unwrap().kit.pads;
    let [first, second] = [0, 9].map(|pad: usize| &pads[pad].name);
    let strikes = format!("sample,pad,velocity\n330,{first},0.8\n714,{second},0.8\n");
    folder.write("strikes.csv", strikes.as_bytes());
    let sound = played("strikes.csv", " --log log.csv");
    let log = fs::read_to_string(folder.path("log.csv")).unwrap();
    assert!(log.contains("\n714,,,,,shed all but first\n"), "{log}");
    assert!(played("log.csv", "") == sound, "{log}");
}

#[test]
fn log_of_a_strike_that_waits_for_time_plays_to_the_same_bits() {
    let folder = Folder::new();
    let played = |strikes: &str, options: &str| on_blackpill(&folder, strikes, options);
    let pads = kit::open("demo").unwrap().kit.pads;
    let [first, second] = [2, 3].map(|pad: usize| &pads[pad].name);
    folder.write("strikes.csv", format!("sample,pad,velocity\n330,{first},0.8\n378,{second},0.8\n").as_bytes());
    let sound = played("strikes.csv", " --log log.csv");
    let log = fs::read_to_string(folder.path("log.csv")).unwrap();
    assert!(log.contains(&format!("\n330,{first},")) && log.contains(&format!("\n384,{second},")), "{log}");
    assert!(played("log.csv", "") == sound, "{log}");
    assert!(played("log.csv", " --budget-mhz 0") == sound, "{log}");
}

/// A kit of two pads with 60 modes each: at once, the faster board has time for some of the modes,
/// the slower one for the first of each.
fn many_modes() -> String {
    let mut kit = String::from("format = 1\nname = \"many\"\n");
    for pad in 0..2 {
        kit += &format!("[[object]]\nname = \"bar {pad}\"\nmodes = [\n");
        for mode in 0..60 {
            let frequency_hz = 200.0 + 110.0 * f64::from(mode) + 7.0 * f64::from(pad);
            let gain = 30.0 / (1.0 + f64::from(mode));
            kit += &format!("{{ frequency_hz = {frequency_hz}, decay_per_s = 20, gain_sine = {gain} }},\n");
        }
        kit += "]\n";
    }
    kit += "[[striker]]\nname = \"stick\"\npeak_force = 1.0\ncontact_time_s = 0.0005\n";
    for pad in 0..2 {
        kit += &format!("[[pad]]\nname = \"bar {pad}\"\nobject = \"bar {pad}\"\nstrikers = [\"stick\"]\n");
    }
    kit
}

#[test]
fn board_plays_within_its_budget_unless_that_is_lifted() {
    let folder = Folder::new();
    folder.write("many.toml", many_modes().as_bytes());
    let strikes = (0..2).map(|pad| format!("0,bar {pad},1\n")).collect::<String>();
    folder.write("chord.csv", format!("time_s,pad,velocity\n{strikes}").as_bytes());
    let played = |options: &str, strikes: &str| {
        let words = format!("play --kit many.toml --strikes {strikes} -o out.wav --json {options}");
        let output = folder.malleus(&words);
        assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (report, fs::read(folder.path("out.wav")).unwrap())
    };
    let check = folder.malleus("kit check many.toml --json");
    let check: serde_json::Value = serde_json::from_slice(&check.stdout).unwrap();
    for (index, (board, cycles, mhz)) in
        [("stm32f407g-disc1", 42_700, 0.0), ("blackpill-f411", 25_700, 38.55)].into_iter().enumerate()
    {
        let (within, sound) = played(&format!("--board {board} --log log.csv"), "chord.csv");
        let shed = within["work"]["shed_modes"].as_u64().unwrap();
        println!("{board}: {shed} modes in {} ticks", within["work"]["shedding_ticks"]);
        assert_eq!((&within["board"], &within["budget_cycles"]), (&board.into(), &cycles.into()));
        assert!(shed > 0, "{board}");
        // The kit check says beforehand how many modes of each pad are shed.
        let board_check = &check["boards"][index];
        let told = board_check["chord_shed"].as_array().unwrap().iter().map(|shed| shed["modes"].as_u64().unwrap());
        assert_eq!((&board_check["board"], told.sum::<u64>()), (&board.into(), shed), "{board_check}");
        // A log holds the decisions, so that its playback takes none of its own.
        let (replayed, again) = played(&format!("--board {board}"), "log.csv");
        assert!(again == sound && replayed["budget_cycles"].is_null(), "{board}");
        let (whole, unlimited) = played(&format!("--board {board} --budget-mhz 0"), "chord.csv");
        assert!(unlimited != sound && whole["work"]["shed_modes"] == 0 && whole["budget_cycles"].is_null());
        if mhz > 0.0 {
            let (_, of_mhz) = played(&format!("--board {board} --budget-mhz {mhz}"), "chord.csv");
            assert!(of_mhz == sound, "{board} at {mhz} MHz");
        }
    }
    let text = String::from_utf8(folder.malleus("kit check many.toml").stdout).unwrap();
    assert!(text.contains("stm32f407g-disc1 sheds of all pads at once at velocity 1: "), "{text}");
    assert!(text.contains(" of 60 modes of \"bar 1\""), "{text}");
    assert!(
        text.contains("blackpill-f411 sheds of all pads at once at velocity 1: 54 of 60 modes of \"bar 0\", 54"),
        "{text}"
    );
    let text = String::from_utf8(folder.malleus("kit check kit.toml").stdout).unwrap();
    assert!(text.contains("blackpill-f411 sheds nothing of all pads at once at velocity 1"), "{text}");
}
