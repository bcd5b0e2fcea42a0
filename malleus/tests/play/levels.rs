//! Sounds and forces that clip: they are counted and told.

use crate::folder::{Folder, KIT, samples};

#[test]
fn clipped_samples_are_counted_and_the_peak_before_clipping_is_told() {
    let folder = Folder::new();
    folder.write("s.csv", b"sample,pad,velocity\n0,bar,1\n");
    folder.write("loud.toml", KIT.replace("midi_notes", "level_db = 30\nmidi_notes").as_bytes());
    let played = |kit: &str, options: &str| {
        let words = format!("play --kit {kit} --strikes s.csv -o out.wav --json{options}");
        let output = folder.malleus(&words);
        assert_eq!(output.status.code(), Some(0), "{words}");
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (report, String::from_utf8(output.stderr).unwrap(), samples(&folder.path("out.wav")))
    };
    for renderer in ["", " --reference"] {
        let (soft, told, _) = played("kit.toml", renderer);
        assert_eq!(soft["clipped_samples"], 0, "{told}");
        assert!(!told.contains("clip"), "{told}");
        let (loud, told, sound) = played("loud.toml", renderer);
        let at_the_end = sound.iter().filter(|sample| !(-(1 << 23) + 1..(1 << 23) - 1).contains(*sample)).count();
        assert_eq!(loud["clipped_samples"], at_the_end, "{loud}");
        assert!(at_the_end > 100 && told.contains(&format!("clipped in {at_the_end} samples, since")), "{told}");
        let [soft, loud_peak] = [&soft, &loud].map(|report| report["unclipped_peak_dbfs"].as_f64().unwrap());
        assert!((loud_peak - soft - 30.0).abs() < 0.01 && loud_peak > 0.0, "{soft} {loud_peak}");
        assert!(loud["peak_dbfs"].as_f64().unwrap().abs() < 1e-5);
    }
    let output = folder.malleus("play --kit loud.toml --strikes s.csv -o out.wav");
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("dBFS, clipped in ") && text.contains(" samples") && text.contains("peak +"), "{text}");
}

#[test]
fn strikes_that_may_clip_the_force_bus_are_counted() {
    let folder = Folder::new();
    folder.write("hard.toml", KIT.replace("peak_force = 1.0", "peak_force = 9.0").as_bytes());
    folder.write("harder.toml", KIT.replace("peak_force = 1.0", "peak_force = 17.0").as_bytes());
    folder.write("roll.csv", b"time_s,pad,velocity\n0,bar,1\n0.0002,bar,1\n0.1,bar,1\n");
    folder.write("one.csv", b"time_s,pad,velocity\n0,bar,1\n0.1,bar,0.5\n");
    for (kit, strikes, overloads, largest) in
        [("kit", "roll", 0, 2.0), ("hard", "one", 0, 9.0), ("hard", "roll", 1, 18.0), ("harder", "one", 1, 17.0)]
    {
        let output = folder.malleus(&format!("play --kit {kit}.toml --strikes {strikes}.csv -o out.wav --json"));
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!((&report["force_overloads"], &report["largest_force"]), (&overloads.into(), &largest.into()));
        assert_eq!(told.contains("reference_force"), overloads > 0, "{told}");
    }
}
