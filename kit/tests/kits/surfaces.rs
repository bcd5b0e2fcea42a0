//! Surfaces, and strikers that scrape and roll, in text and bytes: invalid ones are refused with
//! their place.

use dsp_core::table::layout::{MapHeader, ScrapeRecord, SurfaceHeader, tag};
use dsp_core::table::{Kit as TableView, range};
use kit::binary;
use zerocopy::FromBytes;

use crate::binary_refusals::{section_of, signed};
use crate::sample;

/// Text of a kit whose surface has `points` heights.
fn text(points: usize) -> String {
    let heights: Vec<String> = (0..points).map(|index| (index * index * 7919 % 2001).to_string()).collect();
    format!(
        r#"format = 1
name = "test"

[[surface]]
name = "tile"
step_m = 2e-6
unit_m = 1e-9
shortest_m = 5e-6
heights = [{}]

[[object]]
name = "plate"
surface = "tile"
size_m = [0.3, 0.1]
modes = []

[[striker]]
name = "stick"
peak_force = 20.0
contact_time_s = 0.001

[striker.scrape]
mass_kg = 0.01
tilt_rad = 0.7
friction = 0.3

[striker.roll]
radius_m = 0.01

[[pad]]
name = "plate"
object = "plate"
strikers = ["stick"]
"#,
        heights.join(", ")
    )
}

fn refusal(from: &str, to: &str) -> String {
    let text = text(300);
    assert_eq!(text.matches(from).count(), 1, "{from:?} stands there once");
    match sample::parse(&text.replace(from, to)) {
        Err(error) => error.to_string(),
        Ok(kit) => binary::build(&kit).expect_err("a wrong text").to_string(),
    }
}

#[test]
fn surfaces_come_through_text_and_bytes_unchanged() {
    let kit = sample::parse(&text(300)).expect("a right text");
    assert_eq!((kit.surfaces[0].rows, kit.surfaces[0].heights.len()), (1, 300));
    let scrape = kit.strikers[0].scrape.as_ref().expect("the striker scrapes");
    assert_eq!((scrape.alpha_min_m, scrape.smoothing_s), (None, kit::Scrape::DEFAULT_SMOOTHING_S));
    assert_eq!(sample::parse(&kit::text::write(&kit)).expect("its own text"), kit);
    let bytes = binary::build(&kit).expect("a right kit");
    assert_eq!(binary::read(&bytes).expect("its own bytes"), kit);
    let view = TableView::parse(&bytes).expect("a right kit");
    view.check_surfaces().expect("right surfaces");
    assert_eq!((view.surfaces().count(), view.scrapes().len(), view.rolls().len()), (1, 1, 1));
}

#[test]
fn wrong_surfaces_are_refused_by_name() {
    let message = refusal("surface = \"tile\"", "surface = \"tiles\"");
    assert!(message.contains("tiles") && message.contains("tile"), "{message}");
    let message = refusal("shortest_m = 5e-6", "shortest_m = 3e-6");
    assert!(message.contains("shortest_m"), "{message}");
    let message = refusal("step_m = 2e-6", "step_m = 2");
    assert!(message.contains("step_m") && message.contains("0.01"), "{message}");
    let message = refusal("size_m = [0.3, 0.1]", "size_m = [0.3, 0]");
    assert!(message.contains("size_m"), "{message}");
    let message = refusal("size_m = [0.3, 0.1]", "surface_level_db = 41");
    assert!(message.contains("surface_level_db") && message.contains("40"), "{message}");
    let short = sample::parse(&text(200)).map(|kit| binary::build(&kit));
    let message = match short {
        Err(error) | Ok(Err(error)) => error.to_string(),
        Ok(Ok(_)) => panic!("200 heights are too few"),
    };
    assert!(message.contains("200") && message.contains("256"), "{message}");
}

#[test]
fn flat_surface_and_one_too_large_for_a_board_are_refused_by_name() {
    let mut kit = sample::parse(&text(300)).expect("a right text");
    kit.surfaces[0].heights.fill(12);
    let message = binary::build(&kit).expect_err("a flat surface").to_string();
    assert!(message.contains("tile") && message.contains("all are the same"), "{message}");
    let message = sample::parse(&text(8000)).expect_err("a large surface").to_string();
    assert!(message.contains("tile") && message.contains("65536"), "{message}");
}

#[test]
fn wrong_maps_are_refused_by_name() {
    let message = refusal("step_m = 2e-6", "step_m = 2e-6\nrows = 7");
    assert!(message.contains("300") && message.contains("7 rows"), "{message}");
    let message = refusal("step_m = 2e-6", "step_m = 2e-6\nrows = 2");
    assert!(message.contains("three shortest waves"), "{message}");
    let message = refusal("step_m = 2e-6", "step_m = 2e-6\nrows = 300");
    assert!(message.contains("rows") && message.contains("150"), "{message}");
    // Its table is right, and other bytes of it are refused.
    let kit = sample::parse(&text(300).replace("step_m = 2e-6", "step_m = 2e-6\nrows = 15")).expect("a right text");
    let bytes = binary::build(&kit).expect("a right map");
    let with = |change: &dyn Fn(&mut MapHeader)| {
        let (mut body, section) = section_of(&bytes, tag::SURFACE);
        let (_, rest) = SurfaceHeader::mut_from_prefix(&mut body[section]).expect("a header");
        change(MapHeader::mut_from_prefix(rest).expect("a second header").0);
        let bytes = signed(&body);
        TableView::parse(&bytes).expect("the rest is right").check_surfaces()
    };
    with(&|_| ()).expect("a right map");
    with(&|map| map.grid_rows = (map.grid_rows.get() + 1).into()).expect_err("more rows than there are");
    with(&|map| map.grid_rows = u32::MAX.into()).expect_err("more rows than can be");
    with(&|map| map.mean_waves_per_m[1][2] = f32::NAN.into()).expect_err("no number");
}

#[test]
fn wrong_scrapes_and_rolls_are_refused_by_name() {
    let message = refusal("friction = 0.3", "friction = 1.3");
    assert!(message.contains("friction"), "{message}");
    let message = refusal("mass_kg = 0.01", "mass_kg = 0");
    assert!(message.contains("mass_kg"), "{message}");
    let message = refusal("mass_kg = 0.01", "mass_kg = 0.01\nalpha_min_m = 2e-6\nalpha_max_m = 1e-6");
    assert!(message.contains("alpha_min_m = 2e-6: must be at most alpha_max_m = 1e-6"), "{message}");
    let message = refusal("radius_m = 0.01", "radius_m = 0");
    assert!(message.contains("radius_m"), "{message}");
    let message = refusal("[striker.scrape]\nmass_kg = 0.01\ntilt_rad = 0.7\nfriction = 0.3\n", "");
    assert!(message.contains("scrape"), "{message}");
}

#[test]
fn limit_that_is_upside_down_is_blamed_on_its_scraper_and_key() {
    let with = |line: &str| refusal("mass_kg = 0.01", &format!("mass_kg = 0.01\n{line}"));
    for (line, key) in [
        ("alpha_min_m = 2e-6\nalpha_max_m = 1e-6", "alpha_min_m = 2e-6"),
        ("alpha_min_m = 0.5", "alpha_min_m = 5e-1"),
        ("alpha_max_m = 1e-9", "alpha_max_m = 1e-9"),
    ] {
        let message = with(line);
        assert!(message.contains(&format!("striker 0 \"stick\", scrape: {key}: must be")), "{message}");
        assert_eq!(message.contains("on surface \"tile\""), !line.contains('\n'), "{message}");
    }
}

#[test]
fn array_of_a_size_or_of_a_pole_with_a_third_number_is_refused() {
    for sizes in ["[0.3, 0.1, 0.2]", "[0.3]"] {
        let message = refusal("size_m = [0.3, 0.1]", &format!("size_m = {sizes}"));
        assert!(message.starts_with("test.toml:14:10: an array of length"), "{message}");
        assert!(message.ends_with("must be an array of two numbers"), "{message}");
    }
    for biquad in ["pole = [0.9, 0.1, 0.2]", "pole = [0.9, 0.1], zero = [0.5, 0, 0]"] {
        let bank = format!("modes = []\nbiquads = {{ chains = [[ {{ {biquad}, gain = 1 }} ]] }}");
        let message = refusal("modes = []", &bank);
        assert!(message.contains(":16:") && message.contains("an array of length 3: must be"), "{message}");
    }
}

#[test]
fn wrong_bytes_are_refused() {
    let kit = sample::parse(&text(300)).expect("a right text");
    let bytes = binary::build(&kit).expect("a right kit");
    let refused = |tag: [u8; 4], change: &dyn Fn(&mut [u8])| {
        let (mut body, section) = section_of(&bytes, tag);
        change(&mut body[section]);
        let bytes = signed(&body);
        let view = TableView::parse(&bytes).expect("the rest is right");
        view.check_surfaces().expect_err("wrong bytes")
    };
    refused(tag::SURFACE, &|body| SurfaceHeader::mut_from_prefix(body).expect("a header").0.point_count = 301.into());
    refused(tag::SURFACE, &|body| SurfaceHeader::mut_from_prefix(body).expect("a header").0.rows = 2.into());
    refused(tag::SURFACE, &|body| {
        SurfaceHeader::mut_from_prefix(body).expect("a header").0.alpha_m.reverse();
    });
    refused(tag::SCRAPE, &|body| ScrapeRecord::mut_from_prefix(body).expect("a record").0.striker = 1.into());
    refused(tag::SCRAPE, &|body| {
        ScrapeRecord::mut_from_prefix(body).expect("a record").0.mass_kg = (2.0 * range::MASS_KG.max).into();
    });
}
