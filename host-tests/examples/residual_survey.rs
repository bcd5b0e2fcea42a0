// scratch
use crate::host_tests::residual::{Spacing, edges_hz, law};
use dsp_core::residual::BandLaw;
fn main() {
    let arg: Vec<f64> = std::env::args().skip(1).map(|x| x.parse().unwrap()).collect();
    let (n, lo, hi, spread, dlo, dhi, seeds) = (arg[0] as usize, arg[1], arg[2], arg[3], arg[4], arg[5], arg[6] as u32);
    let spacing = if arg[7] > 0.0 { Spacing::Erb } else { Spacing::Linear };
    let edges = edges_hz(spacing, n, [lo, hi]);
    let mut r = dsp_core::noise::Sfc32::new(9, 9);
    let mut u = || f64::from(r.draw()) / 4294967296.0;
    let bands: Vec<BandLaw> = edges
        .windows(2)
        .map(|e| BandLaw {
            edges_hz: [e[0] as f32, e[1] as f32],
            weight: (0.01 * 10f64.powf(spread * (u() * 2.0 - 1.0) / 20.0) * ((e[1] - e[0]) / 100.0).sqrt()) as f32,
            decay_db_per_s: (dlo * (dhi / dlo).powf(u())) as f32,
        })
        .collect();
    let sounds = law::sounds(&bands, seeds, 65536);
    let e = law::energies(&bands, &sounds);
    let d = if n <= 30 { law::decays(&bands, &sounds, 0.0, 30.0) } else { vec![] };
    for (i, b) in bands.iter().enumerate() {
        let m = e[i];
        print!(
            "{:8.0}-{:8.0} w {:.4} g {:6.0}: {:+.2} se {:.2}",
            b.edges_hz[0], b.edges_hz[1], b.weight, b.decay_db_per_s, m.error, m.standard_error
        );
        if let Some(d) = d.get(i) {
            print!("   decay {:.3} se {:.3}", d.error, d.standard_error);
        }
        println!();
    }
}
