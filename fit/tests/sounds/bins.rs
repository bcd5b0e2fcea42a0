//! Fits by the bins estimator.

use fit::FitError;
use fit::recording::{Options, fit_file};
use fit::segment::Hit;
use fit::strike::{Estimator, Settings, fit_sound};
use fit::synthetic::struck;

fn settings(estimator: Estimator, most_modes: usize) -> Settings {
    let mut settings = Settings { estimator, ..Settings::default() };
    settings.modes.most_modes = most_modes;
    settings
}

#[test]
fn a_fit_by_the_bins_estimator_is_near_the_sound_but_the_modal_one_nearer() {
    for seed in [31, 32] {
        let sound = struck(seed, -70.0);
        let hits = [Hit { onset: 0, end: sound.samples.len() }];
        let fit = |estimator| {
            let fit = fit_sound(&sound.samples, sound.rate_hz, &hits, settings(estimator, 64)).expect("it rings");
            assert!(
                fit.modes.len() <= 64 && fit.modes.windows(2).all(|pair| pair[0].frequency_hz <= pair[1].frequency_hz)
            );
            fit.strikes[0].lsd_db
        };
        let (bins, modal) = (fit(Estimator::Bins), fit(Estimator::Modal));
        println!("seed {seed}: bins {bins:.2} dB, modal {modal:.2} dB");
        assert!(bins < 4.3 && modal < bins, "{bins} {modal}");
    }
}

#[test]
fn the_bins_estimator_refuses_a_force_channel() {
    let folder = tempfile::TempDir::new().expect("a folder");
    let path = folder.path().join("two.wav");
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: 44_100,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(&path, spec).expect("can be written");
    for x in struck(3, -70.0).samples {
        writer.write_sample((x * 30_000.0) as i16).expect("written");
        writer.write_sample(0_i16).expect("written");
    }
    writer.finalize().expect("written");
    let options = Options { strike: settings(Estimator::Bins, 64), force_channel: Some(1), ..Options::default() };
    assert!(matches!(fit_file(&path, &options), Err(FitError::BinsWithForce)));
}
