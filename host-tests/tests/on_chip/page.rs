//! Figures of docs/run_time_vs_error.md and of the README's "How fast", one by one. The bench
//! `run_time_vs_error` makes the page.

use host_tests::on_chip::{BankOnChip, scenes};
use host_tests::run_time::rows::KernelRow;
use host_tests::run_time::{accuracy, cycles_over_modes, measure};
use host_tests::single_mode::{Case, grid};

const PAGE: &str = include_str!("../../../docs/run_time_vs_error.md");
const README: &str = include_str!("../../../README.md");

/// Cells of the table whose first heading is `heading`, without marks of bold type and code.
fn table<'p>(page: &'p str, heading: &str) -> Vec<Vec<&'p str>> {
    let is_header = |line: &&str| line.strip_prefix("| ").is_some_and(|rest| rest.starts_with(heading));
    let lines = page.lines().skip_while(|line| !is_header(line)).skip(2).take_while(|line| line.starts_with('|'));
    let cells = |line: &'p str| {
        let inside = line.trim_matches('|').split('|');
        inside.map(|cell| cell.trim().trim_matches(['*', '`'])).collect::<Vec<_>>()
    };
    let rows: Vec<_> = lines.map(cells).collect();
    assert!(!rows.is_empty(), "no table of {heading}");
    rows
}

fn number(cell: &str) -> f64 {
    cell.trim_end_matches([' ', '%', 'd', 'B']).parse().unwrap_or_else(|_| panic!("{cell:?} is no number"))
}

/// True if a figure is within 3 % of the page's, plus the rounding of its last printed place.
fn near(measured: f64, page: f64, rounding: f64) -> bool {
    (measured - page).abs() <= 0.03 * page + rounding
}

#[test]
fn kernels_take_the_cycles_and_keep_the_snr_that_the_page_says() {
    let mut chip = BankOnChip::new().expect("the image builds");
    // The eight lowest frequencies of the page's grid are where single precision loses most. Every
    // third of the others is added.
    let kept = |index: &usize| index % 40 < 8 || (index % 40).is_multiple_of(3);
    let cases: Vec<Case> =
        grid(40, 1.0).into_iter().enumerate().filter(|(index, _)| kept(index)).map(|(_, case)| case).collect();
    let accuracies = accuracy::measure(&cases, || {});
    let rows = measure::kernel_rows(&mut chip, &accuracies, || {}).expect("they run");
    let page = table(PAGE, "kernel | form");
    assert_eq!(rows.len(), page.len());
    for (row, page) in rows.iter().zip(page) {
        let KernelRow { kernel, form, driven, block, .. } = row;
        assert_eq!(page[..4], [kernel, form, driven.name(), &block.to_string()]);
        assert_eq!(page[4], row.modes.map_or("-".into(), |modes| modes.to_string()), "{kernel}, {form}");
        println!("{page:?}: {:.2} cycles, {:.2} with flash", row.cycles_nominal, row.cycles_with_flash);
        for (measured, page) in
            [(row.cycles_nominal, page[5]), (row.cycles_with_flash, page[7]), (row.instructions, page[8])]
        {
            assert!(near(measured, number(page), 0.006), "{kernel}, {form}: {measured:.3}, {page} in the page");
        }
        let Some(worst_db) = row.snr_worst_db else { continue };
        let lost_db = number(page[10]) - worst_db;
        assert!((-3.0..=0.1).contains(&lost_db), "{kernel}, {form}: {worst_db:.1} dB, {} in the page", page[10]);
    }
}

#[test]
fn scenes_take_the_share_of_a_core_that_page_and_readme_say() {
    let rows = scenes::measure_all().expect("they run");
    let page = table(PAGE, "scene | modes");
    assert_eq!(rows.len(), page.len());
    let mut off = Vec::new();
    for (row, page) in rows.iter().zip(&page) {
        let measured = [
            row.cycles_per_frame_nominal,
            row.cycles_per_frame_with_flash,
            100.0 * row.share_of_168_mhz,
            100.0 * row.share_of_96_mhz,
        ];
        println!("{}: {measured:.1?}", row.scene);
        assert_eq!(page[..2], [row.scene.as_str(), &row.modes.to_string()]);
        for (column, (measured, page)) in measured.into_iter().zip(&page[2..]).enumerate() {
            // The waits of flash in silence are those of one line of code, and of its place.
            let has_luck = column == 1 && row.scene == "silence" && measured < number(page);
            if !has_luck && !near(measured, number(page), 0.6) {
                off.push(format!("{}: {measured:.1}, {page} in the page", row.scene));
            }
        }
    }
    assert!(off.is_empty(), "\n{}", off.join("\n"));
    let shares = |scene: &str| {
        let row = page.iter().find(|row| row[0] == scene).unwrap_or_else(|| panic!("no scene {scene}"));
        [number(row[4]), number(row[5])]
    };
    let readme = table(README, "scene | share");
    let scenes = [
        "silence",
        "bank alone, 256 modes",
        "bank alone, 512 modes",
        "4 pads of 64 modes ringing",
        "8 pads of 64 modes ringing",
        "every pad of the demo kit struck, 100 ms",
    ];
    assert_eq!(readme.len(), scenes.len());
    for (row, scene) in readme.iter().zip(scenes) {
        let said = row[1..].iter().filter(|cell| !cell.is_empty()).zip(shares(scene));
        said.for_each(|(said, page)| assert_eq!(number(said), page, "{scene}: README and page differ"));
    }
}

#[test]
fn pads_take_the_cycles_over_modes_and_cross_where_the_page_says() {
    let measured = cycles_over_modes::measure(&[32, 64, 160, 256], || {}).expect("they run");
    let page = table(PAGE, "modes | ringing");
    assert_eq!(page.len(), cycles_over_modes::MODES.len());
    for pair in measured.pads.chunks(2) {
        let modes = pair[0].modes.to_string();
        let row = page.iter().find(|row| row[0] == modes).unwrap_or_else(|| panic!("no row of {modes} modes"));
        println!("{modes} modes: {:.0?} in the bank, {:.0?} in frames", pair[0].cycles, pair[1].cycles);
        let both = pair[0].cycles.iter().zip(&pair[1].cycles).flat_map(|(bank, frames)| [*bank, *frames]);
        for (cycles, said) in both.zip(&row[1..]) {
            let said = said.trim_start_matches('~');
            assert!(near(cycles, number(said), 0.6), "{modes} modes: {cycles:.1}, {said} in the page");
        }
    }
    assert_eq!(measured.crossings.len(), 4);
    for crossing in &measured.crossings {
        let sentence = crossing.to_string();
        let (what, modes) = sentence.split_once(" from ").expect("the sentence of a crossing");
        let start = format!("- {what} from ");
        let said = PAGE.lines().find_map(|line| line.strip_prefix(&start)).unwrap_or_else(|| panic!("no {what:?}"));
        let first = |text: &str| number(text.split(' ').next().unwrap_or_default());
        println!("{what}: {modes}");
        assert!(near(first(modes), first(said), 1.0), "{sentence} The page says {said}");
    }
}

#[test]
fn kernels_of_the_readme_are_those_of_the_page() {
    let page = table(PAGE, "kernel | form");
    let of = |kernel: &str, form: &str, driven: &str| {
        let is_it = |row: &&Vec<&str>| row[..4] == [kernel, form, driven, "32"];
        page.iter().find(is_it).unwrap_or_else(|| panic!("no row {kernel}, {form}, {driven}"))
    };
    let readme = table(README, "kernel, blocks");
    let kernels = [
        ("Q31 bank", measure::ALL_FORMS),
        ("Q31 bank", measure::BOOKKEEPING),
        ("f32 modes", "modified coupled"),
        ("plain loop", "direct form, f32"),
        ("idsp", "Biquad<f32>, DirectForm2Transposed"),
        ("biquad", "DirectForm2Transposed<f32>"),
    ];
    assert_eq!(readme.len(), kernels.len());
    for (row, (kernel, form)) in readme.iter().zip(kernels) {
        let driven = ["free", "gain", "gain and phase"];
        for (said, driven) in row[1..4].iter().zip(driven).filter(|(said, _)| !said.is_empty()) {
            let page = number(of(kernel, form, driven)[5]);
            assert!((number(said) - page).abs() <= 0.051, "{kernel}, {form}, {driven}: {said}, {page} in the page");
        }
        for (said, driven) in row[4].split(", ").zip(driven).filter(|(said, _)| !said.is_empty()) {
            let page = number(of(kernel, form, driven)[7]);
            assert!((number(said) - page).abs() <= 0.051, "{kernel}, {form}, {driven}: {said}, {page} in the page");
        }
        if !row[5].is_empty() {
            assert_eq!(number(row[5]), number(of(kernel, form, "free")[10]), "{kernel}, {form}");
        }
    }
}
