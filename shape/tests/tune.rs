//! Undercut bars: the ratios that are asked for, in the modes of the shape file that is written.

use shape::file::ShapeFile;
use shape::outline::Outline;
use shape::solve::{self, Wanted};
use shape::tune::{self, TuneError, Tuned, Wish};

/// Text of a bar of a length and a height, metres.
fn bar(length: f64, height: f64) -> String {
    format!(
        "format = 1 # a bar\nname = \"bar\"\n[shape]\nkind = \"sheet\"\n\
         polygon_m = [[0, 0], [{length}, 0], [{length}, {height}], [0, {height}]]\nthickness_m = 0.05\n\
         [material]\nname = \"rosewood\"\n[strike]\npath_m = [[{half}, {height}], [0, {height}]]\n",
        half = length / 2.0
    )
}

fn undercut(text: &str, ratios: &[f64], fundamental_hz: Option<f64>) -> Result<Tuned, TuneError> {
    tune::undercut(text, &Wish { ratios: ratios.to_vec(), fundamental_hz }, &mut |_| {})
}

/// Frequencies of the modes of a shape file, Hz, by the finest mesh.
fn modes(text: &str, count: usize) -> Vec<f64> {
    let file = ShapeFile::parse(text).expect("a shape file");
    let outline = Outline::polygon(file.corners_m().unwrap_or(&[]), &[]).expect("an outline");
    let solved = solve::solve(&file, &outline, vec![], Wanted::Lowest(count), 0.0005, &mut |_| {}).expect("a body");
    solved.modes.iter().map(|mode| mode.frequency_hz).collect()
}

#[test]
fn undercut_bar_has_the_ratios_of_a_marimba() {
    for (length, height) in [(0.36, 0.022), (0.30, 0.024)] {
        let started = std::time::Instant::now();
        let tuned = undercut(&bar(length, height), &[1.0, 4.0, 10.0], None).expect("a bar that can be tuned");
        println!("{:.1} s, {tuned:?}", started.elapsed().as_secs_f64());
        let hz = modes(&tuned.text, 4);
        let off = [4.0, 10.0].iter().zip(&hz[1..]).map(|(ratio, hz_n)| (hz_n / hz[0] / ratio - 1.0).abs());
        let worst = off.fold(0.0, f64::max);
        println!("{hz:?}: {:.4} % from 1 : 4 : 10; {:.1} s", 100.0 * worst, started.elapsed().as_secs_f64());
        assert!(worst < 0.001, "{hz:?}");
        assert!(tuned.text.contains("format = 1 # a bar"), "{}", tuned.text);
    }
}

#[test]
fn length_follows_the_pitch_and_strikes_follow_the_length() {
    let tuned = undercut(&bar(0.3, 0.02), &[1.0, 3.0], Some(440.0)).expect("a bar that can be tuned");
    let hz = modes(&tuned.text, 2);
    println!("{hz:?}, {:.4} m", tuned.length_m);
    assert!((hz[0] / 440.0 - 1.0).abs() < 0.001 && (hz[1] / hz[0] / 3.0 - 1.0).abs() < 0.001, "{hz:?}");
    let file = ShapeFile::parse(&tuned.text).expect("a shape file");
    let path = file.strike.path_m.expect("the path of the bar");
    assert!((path[0][0] - tuned.length_m / 2.0).abs() < 1e-6 && path[0][1] == 0.02, "{path:?}");
}

#[test]
fn longitudinal_modes_of_a_thick_bar_are_passed_over() {
    // Seven times as long as high: with soft shear the first longitudinal mode lies near the third
    // bending one.
    let text = bar(0.14, 0.02).replace("name = \"rosewood\"", "name = \"steel\"");
    let tuned = undercut(&text, &[1.0, 2.9, 5.4], None).expect("a bar that can be tuned");
    let hz = modes(&tuned.text, 5);
    println!("{hz:?}, {:?}", tuned.frequencies_hz);
    let nearest = |wanted: f64| hz.iter().map(|hz| (hz / wanted - 1.0).abs()).fold(f64::MAX, f64::min);
    assert!([1.0, 2.9, 5.4].iter().all(|ratio| nearest(ratio * hz[0]) < 0.001), "{hz:?}");
}

#[test]
fn what_no_undercut_can_do_is_named() {
    let fails = |text: &str, ratios: &[f64], hz: Option<f64>| {
        undercut(text, ratios, hz).expect_err("no undercut does this").to_string()
    };
    let plain = bar(0.3, 0.024);
    assert!(fails(&plain, &[1.0, 2.2], None).contains("cannot be had"));
    assert!(fails(&bar(0.06, 0.024), &[1.0, 4.0, 10.0], None).contains("longer or flatter"));
    for ratios in [&[1.0][..], &[4.0, 1.0], &[1.0, 4.0, 10.0, 20.0], &[1.0, f64::NAN], &[1.0, 1e9]] {
        assert!(fails(&plain, ratios, None).contains("such as 1:4:10"), "{ratios:?}");
    }
    assert!(fails(&plain, &[1.0, 4.0], Some(0.0)).contains("10 to 20000 Hz"));
    let plate = plain.replace("sheet", "plate");
    assert!(fails(&plate, &[1.0, 4.0], None).contains("seen from its side"));
    let slanted = plain.replace("[0, 0]", "[0.001, 0]");
    assert!(fails(&slanted, &[1.0, 4.0], None).contains("rectangle"));
    let hinged = format!("{plain}[support]\nedge = \"hinged\"\n");
    assert!(fails(&hinged, &[1.0, 4.0], None).contains("[support]"));
}
