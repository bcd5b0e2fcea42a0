//! Prints the accuracy of each form over the grid of one mode: the table of the README.

use host_tests::single_mode::{Case, float_forms::FloatForm, grid, q31, snr_db, worst_and_median};

fn main() {
    println!(
        "One mode against f64: 20 Hz to 20 kHz (40) x T60 0.05 to 20 s (5) x 44.1 and 48 kHz, over min(T60, 2 s)\n"
    );
    println!("| form | full scale: worst | median dB | 40 dB below: worst | median dB |");
    println!("| --- | --- | --- | --- | --- |");
    row("Q31 (coupled and shifted)", q31::render);
    for form in FloatForm::ALL {
        row(form.name(), |case| form.render(case));
    }
}

fn row(name: &str, render: impl Fn(&Case) -> Vec<f64>) {
    let [full, quiet] = [1.0, 0.01].map(|level| {
        worst_and_median(
            grid(40, level).iter().map(Case::exact).map(|case| snr_db(case.reference(), render(&case))).collect(),
        )
    });
    println!("| {name} | {:.1} | {:.1} | {:.1} | {:.1} |", full.0, full.1, quiet.0, quiet.1);
}
