//! Statistics of kits.

use std::fs;

use kit::{KitError, binary};

use crate::sample;

#[test]
fn statistics_count_modes_ringing_times_and_bytes() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("test.bin");
    let bytes = binary::build(&sample::kit())?;
    fs::write(&path, &bytes)?;
    let statistics = kit::load(&path)?.statistics();
    assert_eq!(statistics.bytes, bytes.len());
    let [bar, string] = statistics.objects.as_slice() else { panic!("two objects") };
    assert_eq!((bar.name.as_str(), bar.modes, bar.positions, bar.mode_bytes), ("bar", 4, 1, 4 * 16));
    assert_eq!((string.name.as_str(), string.modes, string.positions, string.mode_bytes), ("string", 3, 2, 3 * 24));
    assert_eq!(bar.frequency_hz, Some((110.0, 440.0)));
    let (shortest, longest) = bar.t60_s.expect("modes");
    assert!((longest - 6.907_755 / 2.0).abs() < 1e-4, "{longest}");
    assert!((shortest - 6.907_755 / 2.3).abs() < 1e-4, "{shortest}");
    assert_eq!(statistics.strikers.len(), 2);
    assert_eq!(statistics.mode_bytes, 4 * 16 + 3 * 24 + 2 * 16);
    assert!((statistics.mode_share() - statistics.mode_bytes as f64 / bytes.len() as f64).abs() < 1e-12);
    Ok(())
}

#[test]
fn object_without_modes_has_no_ringing_time() -> Result<(), KitError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("empty.toml");
    fs::write(&path, "format = 1\n[[object]]\nname = \"air\"\nmodes = []\n").expect("a file");
    let statistics = kit::load(&path)?.statistics();
    assert_eq!((statistics.objects[0].modes, statistics.objects[0].positions), (0, 1));
    assert_eq!((statistics.objects[0].t60_s, statistics.objects[0].frequency_hz), (None, None));
    Ok(())
}
