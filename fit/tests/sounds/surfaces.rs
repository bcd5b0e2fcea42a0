//! Tables of surfaces: a computed one whose statistics are known, and measured ones.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use fit::surface::{Heights, Note, Options, Report, Source, SurfaceError, Table, fit, read};
use fourier::Complex;

/// Step of the computed surface in metres.
const STEP_M: f64 = 4e-6;
/// Shortest wave of the computed surface in metres.
const SHORTEST_M: f64 = 40e-6;

/// Numbers from -0.5 to 0.5 (xorshift, Marsaglia 2003).
fn random() -> impl FnMut() -> f64 {
    let mut state = 1u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }
}

/// A spiky surface that was interpolated: its heights fall by 20 dB a decade of wavelength to
/// 40 µm, and are rounded to 0.01 nm.
fn computed() -> Heights {
    const POINTS: usize = 65_536;
    let mut uniform = random();
    let spiky: Vec<f64> = (0..POINTS).map(|_| (uniform() + uniform() + uniform()).powi(5)).collect();
    let (forward, inverse) = (fourier::forward(POINTS), fourier::inverse(POINTS));
    let mut bins = forward.make_output_vec();
    forward.process(&mut spiky.clone(), &mut bins).expect("the lengths are right");
    for (bin, value) in bins.iter_mut().enumerate() {
        let frequency = bin as f64 / (POINTS as f64 * STEP_M);
        *value *= if frequency > 1.0 / SHORTEST_M { 0.0 } else { 1.0 / frequency.max(100.0) };
    }
    bins[0] = Complex::new(0.0, 0.0);
    let mut heights = inverse.make_output_vec();
    inverse.process(&mut bins, &mut heights).expect("the lengths are right");
    let largest = heights.iter().fold(0.0, |most: f64, height| most.max(height.abs()));
    let rounded = |height: f64| (height / largest * 2e-5 / 1e-11).round() * 1e-11;
    Heights { step_m: STEP_M, columns: POINTS, values: heights.into_iter().map(rounded).collect() }
}

fn table(heights: &Heights, options: Options) -> (Table, Report, Vec<Note>) {
    fit(heights.clone(), &options, |_| {}).expect("it is a surface")
}

/// Asserts that a table has the statistics of its surface.
fn assert_alike(name: &str, report: &Report) {
    let [of_surface, of_table] = report.kurtosis;
    println!(
        "{name}: shortest wave {:.2} µm; kurtosis {of_surface:.2}, {of_table:.2}; {} bands, {:.2} dB rms, at most {:.2} dB; {:.5} % below",
        1e6 * report.shortest_m,
        report.bands.len(),
        report.band_rms_db,
        report.band_max_db,
        report.below_shortest_percent
    );
    assert!(report.band_rms_db <= 0.5 && report.band_max_db <= 1.0, "{name}: {report:?}");
    assert!(((of_table + 3.0) / (of_surface + 3.0) - 1.0).abs() < 0.02, "{name}: {of_surface} and {of_table}");
    assert!(report.below_shortest_percent < 0.001, "{name}: {} %", report.below_shortest_percent);
}

#[test]
fn table_of_an_interpolated_surface_has_its_statistics_down_to_its_shortest_wave() {
    let (table, report, notes) = table(&computed(), Options::default());
    assert_alike("computed", &report);
    assert!((report.shortest_m / SHORTEST_M - 1.0).abs() < 0.05, "{}", report.shortest_m);
    assert!(matches!(notes[..], [Note::Upsampled { .. }]), "{notes:?}");
    assert_eq!((table.rows, table.heights.len(), report.columns), (1, 4096, 4096));
    assert!((50_000..=65_536).contains(&report.flash_bytes), "{}", report.flash_bytes);
    assert!(report.kurtosis[0] > 2.0 && table.heights.iter().any(|height| height.abs() > i16::MAX - 128));
}

#[test]
fn another_seed_is_another_profile_and_the_same_seed_the_same() {
    let heights = computed();
    let of_seed = |seed: u64| table(&heights, Options { seed, ..Options::default() }).0;
    assert_eq!(of_seed(1), of_seed(1));
    assert_ne!(of_seed(1).heights, of_seed(2).heights);
}

#[test]
fn section_is_the_profile_as_measured() {
    let heights = computed();
    let from = 20_000;
    let source = Source::Section([f64::from(from) * STEP_M, f64::from(from + 3_000) * STEP_M]);
    let (table, ..) = table(&heights, Options { source, ..Options::default() });
    // The first 20 points are left out, and the first ten shortest waves are faded.
    let at = |point: usize| {
        let place = 20.0 + f64::from(from) + point as f64 * table.step_m / STEP_M;
        let (below, share) = (place as usize, place.fract());
        (1.0 - share) * heights.values[below] + share * heights.values[below + 1]
    };
    let faded = (10.0 * SHORTEST_M / table.step_m) as usize + 1;
    let points = faded..table.heights.len() - faded;
    let own = |point: usize| f64::from(table.heights[point]) * table.unit_m;
    let offset = points.clone().map(|point| at(point) - own(point)).sum::<f64>() / points.len() as f64;
    // Less a straight line, which the whole profile lost.
    let slope = (at(points.end - 1) - own(points.end - 1) - at(points.start) + own(points.start)) / points.len() as f64;
    let middle = 0.5 * (points.start + points.end) as f64;
    for point in points {
        let error = at(point) - own(point) - offset - slope * (point as f64 - middle);
        assert!(error.abs() < 2e-7, "point {point}: {error} m");
    }
}

#[test]
fn spectrum_goes_on_below_the_shortest_wave_with_its_slope() {
    let (table, report, notes) = table(&computed(), Options { extend_to_m: Some(10e-6), ..Options::default() });
    assert_eq!((table.shortest_m, report.shortest_m), (10e-6, 10e-6));
    let slope = notes.iter().find_map(|note| match note {
        Note::Extended { slope, .. } => Some(*slope),
        _ => None,
    });
    assert!((slope.expect("a note says so") + 2.0).abs() < 0.2, "{slope:?}");
    // Curvature's power in a band grows as f^(4 - 2 + 1).
    let level = |band: usize| report.bands[band].table_db;
    let last = report.bands.len() - 1;
    let per_octave = (level(last) - level(last - 3)) / 1.0;
    assert!((per_octave - 30.0 * 2f64.log10()).abs() < 1.0, "{per_octave} dB");
}

#[test]
fn path_of_a_ball_is_smoother_than_the_surface_and_never_below_it() {
    let heights = computed();
    let rms = |tip_radius_m| table(&heights, Options { tip_radius_m, ..Options::default() }).1.curvature_rms_per_m;
    let (surface, small, large) = (rms(None), rms(Some(1e-5)), rms(Some(1e-3)));
    println!("curvature: {surface:.0}, {small:.0}, {large:.0} 1/m rms");
    assert!(large < small && small <= surface * 1.001 && large < 0.5 * surface);
}

/// A wavy map with a hole of a third of it, from a column on.
fn map_with_a_hole(from: usize) -> Heights {
    const SIDE: usize = 300;
    let height = |row: usize, column: usize| {
        let (x, y) = (column as f64 * 1e-5, row as f64 * 1e-5);
        if (from..from + 100).contains(&column) {
            return f64::NAN;
        }
        1e-6 * ((TAU * x / 1.1e-4).sin() + (TAU * (0.6 * x + 0.8 * y) / 0.7e-4).sin())
    };
    let values = (0..SIDE * SIDE).map(|index| height(index / SIDE, index % SIDE)).collect();
    Heights { step_m: 1e-5, columns: SIDE, values }
}

#[test]
fn map_with_a_third_missing_is_filled_and_says_so() {
    let heights = map_with_a_hole(200);
    let (table, report, notes) = table(&heights, Options { source: Source::Map, ..Options::default() });
    assert!(
        notes.iter().any(|note| matches!(note, Note::Filled { percent } if (*percent - 33.3).abs() < 0.1)),
        "{notes:?}"
    );
    assert!(table.rows > 80 && table.heights.len() > 80 * 80 && table.heights.len() % table.rows == 0);
    assert!(report.below_shortest_percent < 0.3, "{}", report.below_shortest_percent);
    // A hole in the middle is left out of the map.
    let (aside, ..) = self::table(&map_with_a_hole(100), Options { source: Source::Map, ..Options::default() });
    let rms = |table: &Table| {
        let square: f64 = table.heights.iter().map(|height| (f64::from(*height) * table.unit_m).powi(2)).sum();
        (square / table.heights.len() as f64).sqrt()
    };
    println!("map of waves of 1 µm rms: {:.3e} m, beside a hole {:.3e} m", rms(&table), rms(&aside));
    // The fades of the edges take 0.6 dB: a mean of two places is softer than each.
    assert!((rms(&table) - 0.93e-6).abs() < 3e-8 && (rms(&aside) - 0.93e-6).abs() < 3e-8);
    let mut half = map_with_a_hole(200);
    half.values.iter_mut().skip(60_000 / 2).step_by(2).for_each(|height| *height = f64::NAN);
    half.values.iter_mut().step_by(2).for_each(|height| *height = f64::NAN);
    let refused = fit(half, &Options::default(), |_| {});
    assert!(matches!(refused, Err(SurfaceError::Missing { .. })), "{refused:?}");
}

#[test]
fn heights_in_another_unit_are_doubted() {
    let mut heights = computed();
    heights.values.iter_mut().for_each(|height| *height *= 1e-4);
    let (.., notes) = table(&heights, Options::default());
    assert!(notes.iter().any(|note| matches!(note, Note::Scale { factor, .. } if *factor == 1000.0)), "{notes:?}");
}

#[test]
fn surfaces_that_tell_nothing_are_refused_by_name() {
    let of = |values: Vec<f64>| Heights { step_m: STEP_M, columns: values.len(), values };
    let refused = |heights: Heights, options: Options| fit(heights, &options, |_| {}).expect_err("it is no surface");
    let defaults = Options::default();
    assert!(matches!(refused(of(vec![1e-6; 200]), defaults), SurfaceError::TooFew { .. }));
    let line = (0..4_000).map(|n| 1e-6 * f64::from(n)).collect();
    assert!(matches!(refused(of(line), defaults), SurfaceError::Flat));
    let points = Options { points: 1000, ..defaults };
    assert!(matches!(refused(computed(), points), SurfaceError::Range { option: "--points", .. }));
    let map = Options { source: Source::Map, ..defaults };
    assert!(matches!(refused(computed(), map), SurfaceError::NoMap));
    let section = Options { source: Source::Section([0.2, 0.5]), ..defaults };
    assert!(matches!(refused(computed(), section), SurfaceError::Section { .. }));
    let longer = Options { extend_to_m: Some(60e-6), ..defaults };
    assert!(matches!(refused(computed(), longer), SurfaceError::Range { option: "--extend-to", .. }));
    // With ten times the step the shortest wave is near 0.4 mm, and 10 mm are 26 of them.
    let short = Heights { step_m: 10.0 * STEP_M, ..of(computed().values[..260].to_vec()) };
    assert!(matches!(refused(short, defaults), SurfaceError::TooShort { .. }));
}

#[test]
fn gaps_in_the_positions_are_missing_points() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("gap.csv");
    let written = |gap_m: f64| {
        let line = |index: u32| {
            let x_m = 2e-6 * f64::from(index) + if index < 10_000 { 0.0 } else { gap_m };
            format!("{x_m:e},{:e}\n", 1e-6 * (f64::from(index) * 0.7).sin())
        };
        let text: String = (0..20_000).map(line).collect();
        std::fs::write(&path, format!("x_m,height_m\n{text}")).expect("it is written");
        read(&path, None)
    };
    let (heights, notes) = written(0.01).expect("a fifth may be missing");
    let missing = heights.values.iter().filter(|height| height.is_nan()).count();
    assert!((4_998..=5_002).contains(&missing) && heights.values.len().abs_diff(25_000) < 3, "{missing}");
    assert!((heights.step_m / 2e-6 - 1.0).abs() < 1e-6 && matches!(notes[..], [Note::Resampled { .. }]), "{notes:?}");
    assert!(matches!(written(0.4), Err(SurfaceError::Missing { percent }) if percent > 90.0));
}

#[test]
fn uneven_positions_are_resampled_and_disorder_is_refused() {
    let folder = tempfile::TempDir::new().expect("a folder");
    let path = folder.path().join("profile.csv");
    let write = |lines: Vec<String>| {
        std::fs::write(&path, format!("x_m,height_m\n{}\n", lines.join("\n"))).expect("the folder is writable");
    };
    let wave = |x: f64| 1e-6 * (TAU * x / 1e-4).sin();
    let place = |n: usize| 1e-6 * (n as f64 + 0.3 * (n as f64).sin());
    write((0..1_000).map(|n| format!("{:e},{:e}", place(n), wave(place(n)))).collect());
    let (heights, notes) = read(&path, None).expect("it is a profile");
    assert!(matches!(notes[..], [Note::Resampled { .. }]), "{notes:?}");
    for (n, height) in heights.values.iter().enumerate() {
        let x = place(0) + n as f64 * heights.step_m;
        assert!((height - wave(x)).abs() < 2e-9, "point {n}: {height}");
    }
    write(vec!["0,0".to_owned(), "2,0".to_owned(), "1,0".to_owned()]);
    assert!(matches!(read(&path, None), Err(SurfaceError::Order { line: 4, .. })));
    write(vec!["0,0".to_owned(), "2,rough".to_owned()]);
    assert!(matches!(read(&path, None), Err(SurfaceError::CsvLine { line: 3, .. })));
    write((0..300).map(|n| format!("{n}")).collect());
    assert!(matches!(read(&path, None), Err(SurfaceError::NoStep { .. })));
    assert!(matches!(
        read(Path::new("heights.xyz"), None),
        Err(SurfaceError::Format { .. } | SurfaceError::Read { .. })
    ));
}

/// A measured surface of the shared data: path, step in metres, and shortest wave in metres where
/// that is known.
fn measured() -> Vec<(PathBuf, Option<f64>, Option<f64>)> {
    let folder = Path::new(env!("SHARED_DATA")).join("surfaces");
    let manifest = std::fs::read_to_string(folder.join("MANIFEST.csv")).expect("the manifest is there");
    let mut reader = csv::Reader::from_reader(manifest.as_bytes());
    let rows = reader.records().map(|row| row.expect("a row of the manifest"));
    let of_row = |row: csv::StringRecord| {
        let number = |column: usize| row.get(column).and_then(|text| text.parse::<f64>().ok()).map(|um| 1e-6 * um);
        let path = folder.join(row.get(0).expect("a name"));
        let step_m = number(5).filter(|_| path.extension().is_some_and(|ending| ending == "npy"));
        (path, step_m, number(11))
    };
    rows.map(of_row).collect()
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the surfaces in ../shared/data")]
fn tables_of_measured_surfaces_have_their_statistics() {
    let mut known = 0;
    for (path, step_m, shortest_m) in measured() {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let (heights, _) = read(&path, step_m).expect("it is a surface");
        let (_, report, notes) = fit(heights, &Options::default(), |_| {}).expect("it has a table");
        if let Some(shortest_m) = shortest_m {
            assert_alike(&name, &report);
            assert!((report.shortest_m / shortest_m - 1.0).abs() < 0.08, "{name}: {} m", report.shortest_m);
            known += 1;
        } else {
            let [of_surface, of_table] = report.kurtosis;
            println!("{name}: kurtosis {of_surface:.2}, {of_table:.2}; {:.2} dB rms", report.band_rms_db);
            assert!(report.band_rms_db <= 0.5, "{name}: {report:?}");
        }
        let is_doubted = notes.iter().any(|note| matches!(note, Note::Scale { .. }));
        assert_eq!(is_doubted, name.contains("sanded_acrylic"), "{name}: {notes:?}");
    }
    assert_eq!(known, 10);
}

#[test]
fn steep_surfaces_leave_next_to_nothing_below_their_shortest_wave() {
    for (slope, most_percent) in [(-3.0, 0.0014), (-4.0, 0.0052), (-5.0, 0.028)] {
        // Waves from 5 mm to 4 µm, of a density of heights that falls by f^slope.
        let (points, step_m) = (1 << 15, 2e-6);
        let length_m = f64::from(points) * step_m;
        let mut uniform = random();
        let mut values = vec![0.0; points as usize];
        let inverse = fourier::inverse(values.len());
        let mut bins = inverse.make_input_vec();
        for (bin, value) in bins.iter_mut().enumerate() {
            let frequency_per_m = bin as f64 / length_m;
            if (200.0..2.5e5).contains(&frequency_per_m) {
                let phase = TAU * uniform();
                *value = Complex::from_polar(frequency_per_m.powf(0.5 * slope), phase);
            }
        }
        inverse.process(&mut bins, &mut values).expect("plan and buffers have one length");
        let rms = (values.iter().map(|x| x * x).sum::<f64>() / f64::from(points)).sqrt();
        values.iter_mut().for_each(|height| *height *= 5e-6 / rms);
        let heights = Heights { step_m, columns: values.len(), values };
        let (_, report, notes) = table(&heights, Options::default());
        let percent = report.below_shortest_percent;
        println!("slope {slope}: {percent:.4} % below, bands {:.2} dB rms, {notes:?}", report.band_rms_db);
        assert!(percent < most_percent && report.band_rms_db < 0.5, "{percent} %, {report:?}");
        assert_eq!(notes.iter().any(|note| matches!(note, Note::LongWaves { .. })), slope < -3.5, "{notes:?}");
    }
}

#[test]
fn surfaces_that_no_kit_takes_and_files_without_points_are_refused_by_name() {
    let refused = |heights: Heights, options: Options| match fit(heights, &options, |_| {}) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("it is taken"),
    };
    let empty = |columns| Heights { step_m: 1e-6, columns, values: Vec::new() };
    assert!(refused(empty(0), Options::default()).contains("too few"));
    assert!(refused(empty(5), Options::default()).contains("too few"));
    let wide = Heights { step_m: 0.02, ..computed() };
    assert!(refused(wide, Options::default()).contains("step_m"));
    let short = Options { source: Source::Section([0.0, 21.0 * SHORTEST_M]), ..Options::default() };
    assert!(refused(computed(), short).contains("heights"));
    assert!(refused(computed(), Options { points: 8192, ..Options::default() }).contains("--points"));
}
