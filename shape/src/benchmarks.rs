//! Published benchmarks of free vibration.

use crate::file::ShapeFile;
use crate::outline::Outline;
use crate::solve::{self, SolveError, Wanted};

/// Published frequencies of a body.
#[derive(Clone, Copy, Debug)]
pub struct Benchmark {
    /// Name, and what its frequencies come from.
    pub name: &'static str,
    /// Shape file.
    pub shape: &'static str,
    /// Frequencies, Hz, the lowest first.
    pub published_hz: &'static [f64],
}

impl Benchmark {
    /// Frequencies of as many modes as were published, Hz.
    ///
    /// # Errors
    /// A [`SolveError`]; none for the error 0.001.
    pub fn solve(&self, error: f64) -> Result<Vec<f64>, SolveError> {
        let file = ShapeFile::parse(self.shape)?;
        let outline = Outline::polygon(file.shape.polygon_m.as_deref().unwrap_or(&[]), &file.shape.holes_m)?;
        let wanted = Wanted::Lowest(self.published_hz.len());
        let solved = solve::solve(&file, &outline, vec![], wanted, error, &mut |_| {})?;
        Ok(solved.modes.iter().map(|mode| mode.frequency_hz).collect())
    }
}

/// Benchmarks of NAFEMS (Selected benchmarks for natural frequency analysis, 1987), and thin-plate
/// values of FV16. Those of FV52 in bending are Mindlin's plate theory, up to 0.55 % below
/// elasticity in space.
pub fn all() -> [Benchmark; 6] {
    [
        Benchmark {
            name: "FV12 free plate",
            shape: FV12,
            published_hz: &[1.622, 2.360, 2.922, 4.190, 4.190, 7.356, 7.356, 7.668],
        },
        Benchmark { name: "FV16 cantilever", shape: FV16, published_hz: &[0.421, 1.029, 2.582, 3.306, 3.753, 6.555] },
        Benchmark {
            name: "FV16 thin-plate theory",
            shape: FV16,
            published_hz: &[0.4179, 1.0242, 2.5628, 3.2749, 3.7272, 6.5242],
        },
        Benchmark {
            name: "FV32 tapered sheet",
            shape: FV32,
            published_hz: &[44.623, 130.03, 162.70, 246.05, 379.90, 391.44],
        },
        Benchmark { name: "FV52 hinged, bending", shape: FV52_PLATE, published_hz: &[45.897, 109.44, 109.44, 167.89] },
        Benchmark { name: "FV52 in its plane", shape: FV52_SHEET, published_hz: &[193.59, 206.64, 206.64] },
    ]
}

const FV12: &str = r#"
format = 1
name = "FV12"
shape = { kind = "plate", polygon_m = [[0, 0], [10, 0], [10, 10], [0, 10]], thickness_m = 0.05 }
material = { density_kg_per_m3 = 8000, youngs_modulus_pa = 200e9, poisson = 0.3, loss_factor = 0 }
"#;

const FV16: &str = r#"
format = 1
name = "FV16"
shape = { kind = "plate", polygon_m = [[0, 0], [10, 0], [10, 10], [0, 10]], thickness_m = 0.05 }
material = { density_kg_per_m3 = 8000, youngs_modulus_pa = 200e9, poisson = 0.3, loss_factor = 0 }
support = { edges = ["free", "free", "free", "clamped"] }
"#;

const FV32: &str = r#"
format = 1
name = "FV32"
shape = { kind = "sheet", polygon_m = [[0, 0], [10, 2], [10, 3], [0, 5]], thickness_m = 0.05 }
material = { density_kg_per_m3 = 8000, youngs_modulus_pa = 200e9, poisson = 0.3, loss_factor = 0 }
support = { edges = ["free", "free", "free", "clamped"] }
"#;

const FV52_PLATE: &str = r#"
format = 1
name = "FV52"
shape = { kind = "plate", polygon_m = [[0, 0], [10, 0], [10, 10], [0, 10]], thickness_m = 1 }
material = { density_kg_per_m3 = 8000, youngs_modulus_pa = 200e9, poisson = 0.3, loss_factor = 0 }
support = { edge = "hinged" }
"#;

const FV52_SHEET: &str = r#"
format = 1
name = "FV52"
shape = { kind = "sheet", polygon_m = [[0, 0], [10, 0], [10, 10], [0, 10]], thickness_m = 1 }
material = { density_kg_per_m3 = 8000, youngs_modulus_pa = 200e9, poisson = 0.3, loss_factor = 0 }
"#;
