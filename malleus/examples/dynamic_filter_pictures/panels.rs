//! Panels of the pictures.

use std::f64::consts::TAU;

use fit::bark::{DampingLaw, damping_law};
use fit::dynamic_filter::study::{Heard, resynthesis};
use fit::dynamic_filter::{Model, Path, RATE_HZ, counted, mean_law, render, response};
use malleus::plot::{Axis, Curve, CurvesPanel, StrokeKind};

fn axis(label: &str, range: [f64; 2], logarithmic: bool) -> Axis {
    Axis { label: label.to_owned(), range, logarithmic }
}

fn frequency() -> Axis {
    axis("frequency (Hz)", [80.0, 20_000.0], true)
}

fn decay() -> Axis {
    axis("damping α (1/s)", [1.0, 1000.0], true)
}

fn curve(name: &str, colour: usize, stroke: StrokeKind, points: Vec<[f64; 2]>) -> Curve {
    Curve { name: name.to_owned(), colour, stroke, points }
}

fn law_points(law: &DampingLaw) -> Vec<[f64; 2]> {
    counted(law).map(|band| [band.centre_hz, band.decay_per_s]).collect()
}

/// Panels of b0 and a1 over time, and of |F| over frequency at several times for the first and the
/// last material.
pub(crate) fn coefficients(paths: &[(&str, Path)]) -> Vec<CurvesPanel> {
    let over_time = |of: &dyn Fn(&Path, f64) -> f64| -> Vec<Curve> {
        let points = |path: &Path| (0..=300).map(|step| f64::from(step) * 0.001).map(|t| [t, of(path, t)]).collect();
        let each = paths.iter().enumerate();
        each.map(|(index, (name, path))| curve(name, index, StrokeKind::Solid, points(path))).collect()
    };
    let time = || axis("time after the strike (s)", [0.0, 0.3], false);
    let b0 = |path: &Path, t: f64| 20.0 * (path.at(t).b[0] / path.at(0.0).b[0]).abs().max(1e-9).log10();
    let mut panels = vec![
        CurvesPanel {
            title: "b0".to_owned(),
            x: time(),
            y: axis("b0 over that at the strike (dB)", [-80.0, 5.0], false),
            curves: over_time(&b0),
        },
        CurvesPanel {
            title: "a1".to_owned(),
            x: time(),
            y: axis("a1", [-1.0, 1.0], false),
            curves: over_time(&|path, t| path.at(t).a[0]),
        },
    ];
    let ends = paths.first().into_iter().chain(paths.last());
    for (name, path) in ends {
        let times = [0.0, 0.02, 0.05, 0.1, 0.2];
        let top = magnitude_db(path, 0.0, 80.0).max(magnitude_db(path, 0.0, 2000.0));
        let at = |(index, t): (usize, &f64)| {
            let points = (0..=200).map(|step| 80.0 * 250f64.powf(f64::from(step) / 200.0));
            let points = points.map(|f| [f, magnitude_db(path, *t, f) - top]).collect();
            curve(&format!("{:.0} ms", 1e3 * t), index, StrokeKind::Solid, points)
        };
        panels.push(CurvesPanel {
            title: format!("|F|, {name}"),
            x: frequency(),
            y: axis("magnitude (dB)", [-70.0, 10.0], false),
            curves: times.iter().enumerate().map(at).collect(),
        });
    }
    panels
}

fn magnitude_db(path: &Path, time_s: f64, frequency_hz: f64) -> f64 {
    20.0 * response(&path.at(time_s), TAU * frequency_hz / RATE_HZ).norm().max(1e-12).log10()
}

/// Panel of the damping α(f) of a recording and of its two resyntheses.
pub(crate) fn damping(material: &str, heard: &Heard, laws: &[Option<DampingLaw>; 2]) -> CurvesPanel {
    let recorded = law_points(&heard.law);
    let within = |factor: f64| recorded.iter().map(|[f, decay]| [*f, decay * factor]).collect::<Vec<_>>();
    let mut curves = vec![
        curve("recording", 0, StrokeKind::Solid, recorded.clone()),
        curve("±15 %", 3, StrokeKind::Dashed, within(1.15)),
        curve("", 3, StrokeKind::Dashed, within(0.85)),
    ];
    for (index, (name, law)) in ["additive", "waveguide"].into_iter().zip(laws).enumerate() {
        let points = law.as_ref().map_or(Vec::new(), |law| {
            let counts = |hz: f64| counted(&heard.law).any(|band| band.centre_hz == hz);
            law.bands
                .iter()
                .filter(|band| counts(band.centre_hz))
                .map(|band| [band.centre_hz, band.decay_per_s])
                .collect()
        });
        curves.push(curve(name, index + 1, StrokeKind::Dots, points));
    }
    CurvesPanel { title: material.to_owned(), x: frequency(), y: decay(), curves }
}

/// Panels that compare the wood's table with the same table under the metal's curves: the metal's
/// path of the filter, and the decays that the metal's damping law gives the modes.
pub(crate) fn material(wood: &Heard, of_wood: &Model, metal: &Heard, of_metal: &Model) -> Vec<CurvesPanel> {
    let mut changed = Model { path: of_metal.path.clone(), ..of_wood.clone() };
    changed.modes.iter_mut().for_each(|mode| mode.decay_per_s = metal.law.decay_per_s(mode.frequency_hz));
    // The paths of two recordings differ in level. The gain keeps the noise as loud relative to the
    // modes as it was.
    let gain = wood.law.bands.iter().map(|band| band.gain).sum::<f64>()
        / metal.law.bands.iter().map(|band| band.gain).sum::<f64>();
    changed.path.points.iter_mut().for_each(|point| point.coefficients.b.iter_mut().for_each(|b| *b *= gain));
    let sounds = [of_wood, &changed].map(|model| resynthesis(model, metal));
    let laws = [mean_law(&sounds[0]), mean_law(&sounds[1])];
    let mut damping = vec![
        curve("law of wood", 0, StrokeKind::Dashed, law_points(&wood.law)),
        curve("law of metal", 1, StrokeKind::Dashed, law_points(&metal.law)),
    ];
    let names = ["wood's table", "with metal's curves"];
    let laws = laws.iter().zip(names).enumerate();
    damping.extend(
        laws.map(|(index, (law, name))| {
            curve(name, index, StrokeKind::Dots, law.as_ref().map_or(Vec::new(), law_points))
        }),
    );
    let level = sounds.iter().zip(names).enumerate().map(|(index, (sounds, name))| {
        curve(name, index, StrokeKind::Solid, sounds.first().map_or(Vec::new(), |sound| levels(sound)))
    });
    vec![
        CurvesPanel { title: "α(f)".to_owned(), x: frequency(), y: decay(), curves: damping },
        CurvesPanel {
            title: "level".to_owned(),
            x: axis("time after the strike (s)", [0.0, 0.8], false),
            y: axis("rms over 5 ms (dB)", [-80.0, 0.0], false),
            curves: level.collect(),
        },
    ]
}

fn levels(sound: &[f64]) -> Vec<[f64; 2]> {
    let frame = (0.005 * RATE_HZ) as usize;
    let level = |(index, frame_samples): (usize, &[f64])| {
        let power = frame_samples.iter().map(|x| x * x).sum::<f64>() / frame as f64;
        [0.005 * (index as f64 + 0.5), 10.0 * power.max(1e-12).log10()]
    };
    sound.chunks_exact(frame).enumerate().map(level).collect()
}

/// Model whose modes' frequencies are multiplied by a factor. Their decays and amplitudes, and the
/// filter, are unchanged.
pub(crate) fn sized(model: &Model, factor: f64) -> Model {
    let mut sized = model.clone();
    sized.modes.iter_mut().for_each(|mode| mode.frequency_hz *= factor);
    sized.modes.retain(|mode| mode.frequency_hz < 0.45 * RATE_HZ);
    sized
}

/// Panels of models of several sizes: their modes and the centroid that moves with them, and their
/// gain over frequency.
pub(crate) fn sizes(heard: &Heard, sizes: &[(f64, Model)]) -> Vec<CurvesPanel> {
    let laws: Vec<Option<DampingLaw>> = sizes
        .iter()
        .map(|(_, model)| damping_law(&render(model, (heard.length_s * RATE_HZ) as usize, 1), RATE_HZ))
        .collect();
    let centroid = |law: &Option<DampingLaw>| law.as_ref().map_or(f64::NAN, |law| law.centroids.whole_hz);
    let prominent = |model: &Model| {
        let loudest =
            model.modes.iter().max_by(|a, b| (a.amplitude / a.decay_per_s).total_cmp(&(b.amplitude / b.decay_per_s)));
        loudest.map_or(f64::NAN, |mode| mode.frequency_hz)
    };
    let over = |of: &dyn Fn(usize) -> f64| (0..sizes.len()).map(|index| [sizes[index].0, of(index)]).collect();
    let gains =
        [0, sizes.len() / 2, sizes.len().saturating_sub(1)].into_iter().enumerate().filter_map(|(colour, index)| {
            let (size, law) = (sizes.get(index)?.0, laws.get(index)?.as_ref()?);
            let points = law.bands.iter().map(|band| [band.centre_hz, 20.0 * band.gain.log10()]).collect();
            Some(curve(&format!("times {size}"), colour, StrokeKind::Dots, points))
        });
    vec![
        CurvesPanel {
            title: "what is heard of size".to_owned(),
            x: axis("factor of the modes' frequencies", [0.45, 2.2], true),
            y: axis("frequency (Hz)", [200.0, 10_000.0], true),
            curves: vec![
                curve("spectral centroid", 0, StrokeKind::Dots, over(&|index| centroid(&laws[index]))),
                curve("strongest mode", 1, StrokeKind::Dots, over(&|index| prominent(&sizes[index].1))),
            ],
        },
        CurvesPanel {
            title: "Λ(f)".to_owned(),
            x: frequency(),
            y: axis("level at the strike (dB)", [-90.0, 0.0], false),
            curves: gains.collect(),
        },
    ]
}
