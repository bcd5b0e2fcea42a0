//! `malleus study` as its user calls it: pages, sounds, and the stand-in for listeners.

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

use serde_json::Value;

fn report(words: &[&str]) -> Value {
    let done = Command::new(env!("CARGO_BIN_EXE_malleus")).args(words).output().expect("the program runs");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    serde_json::from_slice(&done.stdout).unwrap()
}

#[test]
fn folder_with_another_page_is_refused_before_anything_is_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("index.html");
    fs::write(&page, "<title>Malleus: rolling study</title>").unwrap();
    let words = ["study", "scraping", "-o", folder.path().to_str().unwrap()];
    let done = Command::new(env!("CARGO_BIN_EXE_malleus")).args(words).output().expect("the program runs");
    let message = String::from_utf8_lossy(&done.stderr);
    assert!(!done.status.success() && message.contains("another page has this name"), "{message}");
    assert!(!folder.path().join("sounds").exists());
    assert_eq!(fs::read_to_string(&page).unwrap(), "<title>Malleus: rolling study</title>");
}

#[test]
fn rolling_page_holds_each_trial_by_each_method_and_fetches_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("study");
    let report = report(&["study", "rolling", "-o", path.to_str().unwrap(), "--json"]);
    let sounds = report["sounds"].as_array().unwrap();
    assert_eq!((report["trials"].as_u64(), sounds.len()), (Some(18), 54));
    let texts: BTreeSet<&str> = sounds.iter().map(|sound| sound["text"].as_str().unwrap()).collect();
    assert_eq!(texts.len(), 18, "each trial has a description of its own");
    let page = fs::read_to_string(path.join("index.html")).unwrap();
    assert!(!page.contains("http://") && !page.contains("https://") && page.contains("default-src 'none'"));
    let data = page.split_once("id=\"data\">").unwrap().1.split_once("</script>").unwrap().0;
    let data: Value = serde_json::from_str(data).unwrap();
    for (number, trial) in data["trials"].as_array().unwrap().iter().enumerate() {
        let methods: Vec<&str> = trial["methods"].as_array().unwrap().iter().map(|m| m.as_str().unwrap()).collect();
        assert_eq!(methods, ["full", "without-normal-force", "without-nonlinearity"]);
        let uris: BTreeSet<&str> = trial["sounds"].as_array().unwrap().iter().map(|s| s.as_str().unwrap()).collect();
        assert_eq!(uris.len(), 3, "trial {number}: two methods sound the same");
        assert!(uris.iter().all(|uri| uri.starts_with("data:audio/wav;base64,")));
    }
    // All sounds are about equally loud, and none is clipped.
    let mut levels = Vec::new();
    for sound in sounds {
        let file = sound["file"].as_str().unwrap();
        let samples: Vec<f32> = hound::WavReader::open(file).unwrap().samples().map(Result::unwrap).collect();
        let peak = samples.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
        assert!((1e-3..=0.9001).contains(&peak), "{file}: {peak}");
        assert_eq!(samples.last(), Some(&0.0), "{file} ends in silence");
        assert_eq!(samples.len() as f64 / 48_000.0, sound["duration_s"].as_f64().unwrap());
        let both: Vec<[f64; 2]> = samples.iter().map(|&x| [f64::from(x); 2]).collect();
        levels.push(malleus::loudness::loudest_lkfs(&both, 48_000.0, 0.4));
    }
    let [least, most] =
        levels.iter().fold([0.0f64, -100.0], |[least, most], &level| [least.min(level), most.max(level)]);
    println!("{} sounds, {least:.1} to {most:.1} LKFS", levels.len());
    assert!(most < -25.9 && least > -32.0, "{least:.1} to {most:.1} LKFS");
}

#[test]
fn stand_in_tells_pairs_of_one_velocity_profile_apart_by_the_normal_force_alone() {
    let report = report(&["study", "scraping", "--stand-in", "--renderings", "12", "--json"]);
    let figures = |name: &str| {
        let method = report["methods"].as_array().unwrap().iter().find(|method| method["method"] == name).unwrap();
        ["groups_right", "pairs_right", "similarity"].map(|key| method[key].as_f64().unwrap())
    };
    for method in ["full", "without-scraper", "without-normal-force", "without-nonlinearity"] {
        println!("{method}: {:.3?}", figures(method));
    }
    let [groups, pairs, similarity] = figures("full");
    assert!(groups >= 0.95 && pairs >= 0.95 && similarity > 0.8);
    let [groups, pairs, similarity] = figures("without-normal-force");
    assert!(groups >= 0.95 && pairs <= 0.6 && similarity < 0.6);
}
