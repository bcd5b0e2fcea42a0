//! study
use fit::audio;
use fit::bark::{damping_law, emergence_db};
use fit::dynamic_filter::*;
use fit::modes;
use fit::score::quantile;
use fit::segment;
use std::path::Path as FilePath;

fn main() {
    let folder = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/recordings");
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "wav"))
        .collect();
    files.sort();
    for file in files {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        if !wanted.is_empty() && !wanted.iter().any(|w| name.contains(w.as_str())) {
            continue;
        }
        let rec = audio::read(&file, None).unwrap();
        let (hits, _) = segment::hits(&rec).unwrap();
        let peak = |h: &segment::Hit| rec.samples[h.onset..h.end].iter().fold(0.0f64, |p, x| p.max(x.abs()));
        let hit = hits.iter().max_by(|a, b| peak(a).total_cmp(&peak(b))).unwrap();
        let heard = &rec.samples[hit.onset..hit.end];
        let Some(law) = damping_law(heard, rec.rate_hz) else {
            println!("{name}: no law");
            continue;
        };
        let start = std::time::Instant::now();
        let at = (0..heard.len().min(2000)).max_by(|&a, &b| heard[a].abs().total_cmp(&heard[b].abs())).unwrap() + 20;
        let ringing = &heard[at..heard.len().min(at + (12.0 * rec.rate_hz) as usize)];
        let mut modes = modes::estimate(ringing, rec.rate_hz, modes::Settings::default());
        for m in &mut modes {
            let t = at as f64 / rec.rate_hz;
            m.amplitude *= (m.decay_per_s * t).exp();
            m.phase -= std::f64::consts::TAU * m.frequency_hz * t;
        }
        let emergence = emergence_db(&modes, heard, rec.rate_hz);
        let t_modes = start.elapsed().as_secs_f64();
        let length = ((heard.len() as f64 / rec.rate_hz).min(20.0) * RATE_HZ) as usize;
        let loudest = law.bands.iter().map(|b| b.gain).fold(0.0, f64::max);
        println!(
            "{name}: {} bands, {} counted, {} modes ({t_modes:.1} s), {:.1} s, loudest {loudest:.3}",
            law.bands.len(),
            counted(&law).count(),
            modes.len(),
            length as f64 / RATE_HZ
        );
        let mut rows: Vec<Vec<Comparison>> = Vec::new();
        for (label, model) in [
            ("three bands", Model { path: noise_alone(&law, Criterion::ThreeBands), ..Model::default() }),
            (
                "first order",
                Model { path: noise_alone(&law, Criterion::AllBands(Form::FirstOrder)), ..Model::default() },
            ),
            (
                "one-pole-zero",
                Model { path: noise_alone(&law, Criterion::AllBands(Form::OnePoleOneZero)), ..Model::default() },
            ),
            (
                "second order",
                Model { path: noise_alone(&law, Criterion::AllBands(Form::SecondOrder)), ..Model::default() },
            ),
            ("additive 1st", additive(&law, &modes, &emergence, Form::FirstOrder)),
            ("additive 1p1z", additive(&law, &modes, &emergence, Form::OnePoleOneZero)),
            ("additive 2nd", additive(&law, &modes, &emergence, Form::SecondOrder)),
        ] {
            let t0 = start.elapsed().as_secs_f64();
            let sounds: Vec<Vec<f64>> = (1..=4).map(|seed| render(&model, length, seed)).collect();
            let mean = mean_law(&sounds, RATE_HZ);
            let rows_now = compare(&law, mean.as_ref());
            let errors: Vec<f64> = rows_now.iter().map(Comparison::error).collect();
            println!(
                "  {label:14} {:2} points {:2} modes: median {:5.1} %, p90 {:5.1} %, {}/{} within 15 %  ({:.1} s)",
                model.path.points.len(),
                model.modes.len(),
                100.0 * quantile(&errors, 0.5),
                100.0 * quantile(&errors, 0.9),
                errors.iter().filter(|e| **e <= 0.15).count(),
                errors.len(),
                start.elapsed().as_secs_f64() - t0
            );
            rows.push(rows_now);
        }
        if wanted.len() > 0 {
            for k in 0..rows[0].len() {
                let r = rows[0][k].recorded;
                print!(
                    "   {:2} {:6.0} Hz L {:6.1} dB a {:6.1}:",
                    r.bark,
                    r.centre_hz,
                    20.0 * (r.gain / loudest).log10(),
                    r.decay_per_s
                );
                for row in &rows {
                    print!(" {:+6.0}", 100.0 * (row[k].decay_per_s.unwrap_or(f64::NAN) / r.decay_per_s - 1.0));
                }
                println!();
            }
        }
    }
}
