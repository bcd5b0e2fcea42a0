//! Panels of the picture.

use std::error::Error;

use dsp_core::scrape::{Contact, Motion};
use host_tests::scrape::bands::{apart, energies, middles_hz};
use host_tests::scrape::law::{Law, OVERSAMPLING};
use host_tests::scrape::on_chip::ScraperOnChip;
use host_tests::scrape::{RATE, Scrapes, along, render, twin};
use malleus::motion::normal::{Grip, NormalForce};
use malleus::motion::trials::{Shape, Trial};
use malleus::plot::{Axis, Curve, CurvesPanel, StrokeKind};
use reference::scrape::LEAK_POINTS;

use crate::path::path;

/// Pad whose surface is scraped.
const PAD: &str = "mug";
/// Ticks of a stroke whose force is compared.
const TICKS: usize = 1500;

fn axis(label: &str, range: [f64; 2], logarithmic: bool) -> Axis {
    Axis { label: label.to_owned(), range, logarithmic }
}

fn curve(name: &str, colour: usize, stroke: StrokeKind, points: Vec<[f64; 2]>) -> Curve {
    Curve { name: name.to_owned(), colour, stroke, points }
}

/// Path S over the heights z, at the least, the middle and the largest limit.
pub(crate) fn paths(scrapes: &Scrapes) -> CurvesPanel {
    let contact = scrapes.contact(PAD, "stick", false, [0.0, 1.0]);
    let surface = contact.surface;
    let heights: Vec<f64> =
        surface.heights().iter().map(|height| f64::from(height.get()) * f64::from(surface.unit_m())).collect();
    let length_m = heights.len() as f64 * f64::from(surface.step_m());
    let [least, most] = contact.alpha_m.map(f64::from);
    let mut curves = Vec::new();
    let (from, shown) = (0.012, 0.001);
    let leak_m = LEAK_POINTS * length_m / surface.grid_points() as f64;
    let limits = [
        ("none", None, StrokeKind::Dashed),
        ("1/c", Some(least), StrokeKind::Solid),
        ("3/c", Some(0.5 * (least + most)), StrokeKind::Solid),
        ("5/c", Some(most), StrokeKind::Solid),
    ];
    for (index, (name, alpha_m, stroke)) in limits.into_iter().enumerate() {
        let path = path(&heights, length_m, leak_m, alpha_m);
        let step = length_m / path.len() as f64;
        let range = (from / step) as usize..((from + shown) / step) as usize;
        let points = range.map(|at| [1e3 * (at as f64 * step - from), 1e6 * path[at]]).collect();
        curves.push(curve(name, (index + 4) % 5, stroke, points));
    }
    let highest =
        curves.iter().flat_map(|curve| &curve.points).fold(0.0f64, |highest, point| highest.max(point[1].abs()));
    CurvesPanel {
        title: "Path S, limit α".to_owned(),
        x: axis("way (mm)", [0.0, 1e3 * shown], false),
        y: axis("height (µm)", [-1.1 * highest, 1.1 * highest], false),
        curves,
    }
}

/// Normal force of a stroke there and back, and of a straight line.
pub(crate) fn normal_force() -> Result<CurvesPanel, Box<dyn Error>> {
    let normal = NormalForce::new(&Grip { mass_kg: 0.002, tilt_rad: 0.7, friction: 0.3 })?;
    let trials = [
        ("back and forth", Shape::BackAndForth { length_m: 0.2, period_s: 1.0, strokes: 4 }),
        ("four strokes", Shape::FourStrokes { length_m: 0.2, period_s: 1.0, strokes: 4 }),
        ("circle", Shape::Circle { length_m: 0.6, speed_m_per_s: 0.4 }),
    ];
    let mut curves = Vec::new();
    for (index, (name, shape)) in trials.into_iter().enumerate() {
        let motion = Trial { shape, start_s: 0.0, place_m: [0.0; 2] }.draw()?.motion()?;
        let points = (0..2000).map(|step| f64::from(step) * 1e-3);
        let points = points.map(|t| [t, motion.at(t).map_or(f64::NAN, |state| 1e3 * normal.at(&state))]);
        let stroke = if index == 0 { StrokeKind::Solid } else { StrokeKind::Dashed };
        curves.push(curve(name, index, stroke, points.collect()));
    }
    Ok(CurvesPanel {
        title: "Normal force over a motion".to_owned(),
        x: axis("time (s)", [0.0, 2.0], false),
        y: axis("N (mN)", [0.0, 45.0], false),
        curves,
    })
}

/// Contact in the middle of the limits, and motions at a constant speed.
fn middle(scrapes: &Scrapes, speed: f64) -> (Contact<'_>, f64, Vec<Motion>) {
    let contact = scrapes.contact(PAD, "stick", false, [1.0, 1.0]);
    let alpha_m = 0.5 * (contact.alpha_m[0] + contact.alpha_m[1]);
    let contact = Contact { alpha_m: [alpha_m; 2], reference_force_n: 8.0, ..contact };
    (contact, alpha_m.into(), along((0..TICKS).map(|_| speed), 1.0))
}

/// Third octaves of the force at a speed by four methods.
pub(crate) fn spectrum(scrapes: &Scrapes, speed: f64) -> CurvesPanel {
    let (contact, alpha_m, motions) = middle(scrapes, speed);
    let law = Law::new(&contact, alpha_m);
    let unit = f64::from(contact.reference_force_n) / f64::from(dsp_core::fixed::ONE_Q27);
    let bands = |force: &[f64], oversampling: usize| energies(force, RATE.hz() * oversampling as f64, middles_hz());
    let twin: Vec<f64> = twin(contact, &motions).into_iter().map(|force| force * unit).collect();
    let instrument: Vec<f64> = render(contact, &motions).into_iter().map(|force| f64::from(force) * unit).collect();
    let methods = [
        ("law", 0, StrokeKind::Solid, bands(&law.force(&contact, &motions), OVERSAMPLING)),
        ("reference", 2, StrokeKind::Dashed, bands(&twin, 1)),
        ("instrument", 4, StrokeKind::Dots, bands(&instrument, 1)),
        ("straight lines", 1, StrokeKind::Solid, bands(&law.by_straight_lines(&contact, &motions), 1)),
    ];
    let loudest = methods.iter().flat_map(|method| &method.3).fold(0.0f64, |loudest, energy| loudest.max(*energy));
    let db = |energy: f64| 10.0 * (energy / loudest).max(1e-12).log10();
    let curves = methods.into_iter().map(|(name, colour, stroke, energies)| {
        curve(name, colour, stroke, middles_hz().zip(energies).map(|(hz, energy)| [hz, db(energy)]).collect())
    });
    CurvesPanel {
        title: format!("{speed} m/s"),
        x: axis("frequency (Hz)", [50.0, 16_000.0], true),
        y: axis("third octave (dB)", [-70.0, 5.0], false),
        curves: curves.collect(),
    }
}

/// Cycles, and distance from the law, over speed.
pub(crate) fn over_speed(scrapes: &Scrapes) -> Result<[CurvesPanel; 2], Box<dyn Error>> {
    let speeds = [0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0];
    let (kit, striker) = scrapes.alone(PAD, "stick");
    let (mut cycles, mut own, mut lines) = (Vec::new(), Vec::new(), Vec::new());
    for speed in speeds {
        let (contact, alpha_m, motions) = middle(scrapes, speed);
        let law = Law::new(&contact, alpha_m);
        let exact = energies(&law.force(&contact, &motions), RATE.hz() * OVERSAMPLING as f64, middles_hz());
        let distance = |force: &[f64]| apart(&exact, &energies(force, RATE.hz(), middles_hz())).rms_db;
        let unit = f64::from(contact.reference_force_n) / f64::from(dsp_core::fixed::ONE_Q27);
        let instrument: Vec<f64> = render(contact, &motions).into_iter().map(|force| f64::from(force) * unit).collect();
        own.push([speed, distance(&instrument)]);
        lines.push([speed, distance(&law.by_straight_lines(&contact, &motions))]);
        let mut chip = ScraperOnChip::new(&kit, (0, striker, false), [0.0, 1.0])?;
        let mut spent = 0.0;
        for motion in motions.iter().take(200) {
            spent += chip.render(*motion)?.1.cost.nominal as f64;
        }
        cycles.push([speed, spent / (200.0 * 32.0)]);
    }
    let speed = || axis("speed (m/s)", [0.05, 2.0], true);
    Ok([
        CurvesPanel {
            title: "Cycles of a Cortex-M4F".to_owned(),
            x: speed(),
            y: axis("cycles a frame", [0.0, 700.0], false),
            curves: vec![curve("stick", 0, StrokeKind::Dots, cycles)],
        },
        CurvesPanel {
            title: "Distance from the law".to_owned(),
            x: speed(),
            y: axis("third octaves (dB rms)", [0.01, 30.0], true),
            curves: vec![
                curve("instrument", 4, StrokeKind::Dots, own),
                curve("straight lines", 1, StrokeKind::Dots, lines),
            ],
        },
    ])
}
