//! Outlines from pictures.

use std::f64::consts::{PI, TAU};

use proptest::prelude::*;
use shape::file::ShapeFile;
use shape::outline::{Outline, OutlineError};
use shape::solve::{self, Wanted};

/// PNG of grey values, or of opacities on black if the picture is transparent.
fn png(width: u32, values: &[u8], is_transparent: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    let height = values.len() as u32 / width;
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_depth(png::BitDepth::Eight);
    let pixels: Vec<u8> = if is_transparent { values.iter().flat_map(|&v| [0, v]).collect() } else { values.to_vec() };
    encoder.set_color(if is_transparent { png::ColorType::GrayscaleAlpha } else { png::ColorType::Grayscale });
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&pixels).unwrap();
    writer.finish().unwrap();
    bytes
}

/// Share of each pixel that a shape covers, by 16 x 16 points, as a byte.
fn covered(width: u32, height: u32, is_in: impl Fn(f64, f64) -> bool) -> Vec<u8> {
    let pixel = |x: u32, y: u32| {
        let points = (0..256).map(|k| [f64::from(k % 16), f64::from(k / 16)].map(|step| (step + 0.5) / 16.0));
        let count = points.filter(|[dx, dy]| is_in(f64::from(x) + dx, f64::from(y) + dy)).count();
        (count as f64 / 256.0 * 255.0).round() as u8
    };
    (0..height).flat_map(|y| (0..width).map(move |x| [x, y])).map(|[x, y]| pixel(x, y)).collect()
}

fn inverted(values: &[u8]) -> Vec<u8> {
    values.iter().map(|value| 255 - value).collect()
}

#[test]
fn drawn_disc_is_a_membrane_with_the_frequency_of_a_circle() {
    let disc = covered(140, 140, |x, y| (x - 70.3).hypot(y - 69.8) < 60.0);
    let outline = Outline::from_png(&png(140, &inverted(&disc), false), 0.001).unwrap();
    assert_eq!(outline.rings.len(), 1);
    assert!((12..40).contains(&outline.rings[0].len()), "{} corners", outline.rings[0].len());
    assert!((outline.area() / (PI * 0.0036) - 1.0).abs() < 0.003, "{}", outline.area());
    let text = "format = 1\nname = \"skin\"\nshape = { kind = \"membrane\", outline = \"disc.png\", unit_m = 0.001, \
        tension_n_per_m = 1, density_kg_per_m2 = 1 }\nmaterial = { loss_factor = 0 }\n";
    let file = ShapeFile::parse(text).unwrap();
    let solved = solve::solve(&file, &outline, vec![], Wanted::Lowest(1), 0.001, &mut |_| {}).unwrap();
    let expected = 2.404_825_6 / (TAU * 0.06);
    let off = solved.modes[0].frequency_hz / expected - 1.0;
    println!("a disc of 60 pixels: {:.3} % off, {} corners", 100.0 * off, outline.rings[0].len());
    assert!(off.abs() < 0.005, "{off}");
    // The opaque part of a transparent picture is the shape, too.
    let opaque = Outline::from_png(&png(140, &disc, true), 0.001).unwrap();
    assert_eq!(opaque.rings[0].len(), outline.rings[0].len());
    assert!((opaque.area() / outline.area() - 1.0).abs() < 1e-5);
}

/// PNG of a shape of one colour on a ground of another, mixed where pixels are covered in part.
fn coloured(width: u32, covered: &[u8], ground: [u8; 3], shape: [u8; 3]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, covered.len() as u32 / width);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_color(png::ColorType::Rgb);
    let mix = |share: u8, from: u8, to: u8| {
        let share = f64::from(share) / 255.0;
        (f64::from(from) * (1.0 - share) + f64::from(to) * share).round() as u8
    };
    let pixels: Vec<u8> =
        covered.iter().flat_map(|&share| [0, 1, 2].map(|part| mix(share, ground[part], shape[part]))).collect();
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&pixels).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn shapes_of_any_colour_are_traced_at_half_between_ground_and_shape() {
    let disc = covered(140, 140, |x, y| (x - 70.3).hypot(y - 69.8) < 60.0);
    let ring = covered(140, 140, |x, y| (30.0..60.0).contains(&(x - 70.3).hypot(y - 69.8)));
    let white = [255; 3];
    for (ground, shape) in [
        (white, [0, 0, 0]),
        (white, [255, 0, 0]),
        (white, [255, 255, 0]),
        (white, [0, 0, 255]),
        (white, [160, 160, 160]),
        (white, [255, 220, 200]),
        ([240, 235, 220], [30, 90, 40]),
        ([200, 255, 200], [255, 255, 255]),
    ] {
        let outline = Outline::from_png(&coloured(140, &disc, ground, shape), 0.001).unwrap();
        let radius = (outline.area() / PI).sqrt() / 0.001;
        assert!((radius - 60.0).abs() < 0.08, "{shape:?} on {ground:?}: a radius of {radius}");
        let outline = Outline::from_png(&coloured(140, &ring, ground, shape), 0.001).unwrap();
        assert_eq!(outline.rings.len(), 2, "{shape:?} on {ground:?}");
    }
    // A dark ground may be a shape without a margin, and what nobody sees is none.
    let open = Outline::from_png(&coloured(140, &disc, [0, 0, 60], [255, 255, 0]), 0.001);
    assert!(matches!(open, Err(OutlineError::OpenPicture { .. })), "{open:?}");
    let pale = Outline::from_png(&coloured(140, &disc, white, [250, 250, 250]), 0.001);
    assert_eq!(pale, Err(OutlineError::NoShape));
}

/// Corners of a tilted rectangle.
fn tilted(angle: f64) -> [[f64; 2]; 4] {
    let (sine, cosine) = angle.sin_cos();
    [[-50.0, -20.0], [50.0, -20.0], [50.0, 20.0], [-50.0, 20.0]]
        .map(|[x, y]| [75.3 + cosine * x - sine * y, 60.6 + sine * x + cosine * y])
}

#[test]
fn drawn_rectangle_keeps_its_four_corners_within_half_a_pixel() {
    for (angle, is_sharp) in [(0.0, true), (0.0, false), (0.3, true), (0.7, false), (1.1, true)] {
        let (sine, cosine) = f64::sin_cos(angle);
        let is_in = |x: f64, y: f64| {
            let [x, y] = [x - 75.3, y - 60.6];
            (cosine * x + sine * y).abs() < 50.0 && (cosine * y - sine * x).abs() < 20.0
        };
        let mut values = covered(150, 120, is_in);
        if is_sharp {
            // Without grey values a border is known to half a pixel.
            values.iter_mut().for_each(|value| *value = if *value > 127 { 255 } else { 0 });
        }
        let outline = Outline::from_png(&png(150, &inverted(&values), false), 1.0).unwrap();
        let found: Vec<[f64; 2]> = outline.rings[0].iter().map(|side| side.from).collect();
        assert_eq!(found.len(), 4, "at {angle}, sharp {is_sharp}: {found:?}");
        for corner in tilted(angle) {
            let nearest = found.iter().map(|at| (at[0] - corner[0]).hypot(at[1] + corner[1])).fold(f64::MAX, f64::min);
            let most = if is_sharp { 0.75 } else { 0.5 };
            assert!(nearest < most, "at {angle}, sharp {is_sharp}: {corner:?} is {nearest} off: {found:?}");
        }
    }
}

#[test]
fn hole_of_a_picture_is_a_hole_of_the_body() {
    let ring = covered(60, 60, |x, y| (8.0..22.0).contains(&(x - 30.0).hypot(y - 30.0)));
    let outline = Outline::from_png(&png(60, &inverted(&ring), false), 0.01).unwrap();
    assert_eq!(outline.rings.len(), 2);
    let expected = PI * (22.0 * 22.0 - 64.0) * 1e-4;
    assert!((outline.area() / expected - 1.0).abs() < 0.02, "{}", outline.area());
    assert!(!outline.contains([0.3, -0.3]) && outline.contains([0.45, -0.3]));
}

#[test]
fn pictures_that_are_no_body_are_named() {
    let of = |is_in: fn(f64, f64) -> bool| Outline::from_png(&png(40, &inverted(&covered(40, 30, is_in)), false), 0.01);
    assert_eq!(of(|_, _| false), Err(OutlineError::NoShape));
    assert!(matches!(of(|x, y| x < 20.0 && y < 15.0), Err(OutlineError::OpenPicture { .. })));
    let two = |x: f64, y: f64| (3.0..27.0).contains(&y) && ((3.0..15.0).contains(&x) || (20.0..35.0).contains(&x));
    assert!(matches!(of(two), Err(OutlineError::TwoPieces { .. })));
    assert_eq!(Outline::from_png(b"no picture", 0.01), Err(OutlineError::Png));
    let whole = png(40, &inverted(&covered(40, 30, |x, y| (x - 20.0).hypot(y - 15.0) < 9.0)), false);
    assert_eq!(Outline::from_png(&whole[..whole.len() / 2], 0.01), Err(OutlineError::Png));
    assert!(matches!(Outline::from_png(&whole, 0.0), Err(OutlineError::BadUnit { .. })));
    for (error, what) in [
        (of(|_, _| false), "dark on white"),
        (of(|x, y| x < 20.0 && y < 15.0), "leave a margin"),
        (of(two), "draw one body only"),
    ] {
        let message = error.unwrap_err().to_string();
        assert!(message.contains(what), "{message}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_pictures_never_panic(
        width in 1u32..12,
        height in 1u32..12,
        values in prop::collection::vec(prop::sample::select(vec![0u8, 100, 127, 128, 200, 255]), 144),
        margin in any::<bool>(),
        is_transparent in any::<bool>(),
    ) {
        let mut values = values[..(width * height) as usize].to_vec();
        if margin {
            for (index, value) in values.iter_mut().enumerate() {
                let (x, y) = (index as u32 % width, index as u32 / width);
                if x == 0 || y == 0 || x + 1 == width || y + 1 == height {
                    *value = if is_transparent { 0 } else { 255 };
                }
            }
        }
        if let Ok(outline) = Outline::from_png(&png(width, &values, is_transparent), 0.01) {
            prop_assert_eq!(outline.check(), Ok(()));
            prop_assert!(outline.area() > 0.0 && outline.area() < f64::from(width * height) * 1e-4);
        }
    }

    #[test]
    fn cut_and_damaged_pictures_never_panic(at in 0usize..200, byte in any::<u8>(), length in 0usize..200) {
        let mut bytes = png(20, &inverted(&covered(20, 20, |x, y| (x - 10.0).hypot(y - 10.0) < 6.0)), false);
        let last = bytes.len() - 1;
        bytes[at.min(last)] = byte;
        bytes.truncate(length.max(8).min(bytes.len()));
        let _ = Outline::from_png(&bytes, 0.01);
    }
}
