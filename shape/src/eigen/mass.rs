//! Products of the mass with vectors.

use super::Problem;
use super::search::BLOCK;
use pulp::Arch;

/// Mass without its entries that are zero, as they are between most components of the motion.
pub(super) struct Mass {
    size: usize,
    /// Begin of each column below the diagonal, and the end of the last one.
    starts: Vec<usize>,
    rows: Vec<u32>,
    entries: Vec<f64>,
    diagonal: Vec<f64>,
}

impl Mass {
    /// Takes the mass of a problem whose pattern is sound.
    pub(super) fn of(problem: &Problem) -> Self {
        let mut mass = Self {
            size: problem.size,
            starts: vec![0],
            rows: Vec::new(),
            entries: Vec::new(),
            diagonal: problem.starts[..problem.size].iter().map(|&at| problem.mass[at]).collect(),
        };
        for ends in problem.starts.windows(2) {
            let below = ends[0] + 1..ends[1];
            for (&row, &entry) in problem.rows[below.clone()].iter().zip(&problem.mass[below]) {
                if entry != 0.0 {
                    mass.rows.push(row as u32);
                    mass.entries.push(entry);
                }
            }
            mass.starts.push(mass.rows.len());
        }
        mass
    }

    /// Multiplies columns by the mass, a block of them at a time: each entry is read once for it.
    pub(super) fn times(&self, columns: &[f64], products: &mut [f64]) {
        if columns.len() > self.size {
            self.times_blocks::<BLOCK>(columns, products);
        } else {
            self.times_blocks::<1>(columns, products);
        }
    }

    fn times_blocks<const LANES: usize>(&self, columns: &[f64], products: &mut [f64]) {
        let (mut vectors, mut sums) = (vec![[0.0; LANES]; self.size], vec![[0.0; LANES]; self.size]);
        for (columns, products) in columns.chunks(LANES * self.size).zip(products.chunks_mut(LANES * self.size)) {
            for (lane, column) in columns.chunks_exact(self.size).enumerate() {
                vectors.iter_mut().zip(column).for_each(|(vector, &value)| vector[lane] = value);
            }
            Arch::new().dispatch(|| self.times_lanes(&vectors, &mut sums));
            for (lane, product) in products.chunks_exact_mut(self.size).enumerate() {
                product.iter_mut().zip(&sums).for_each(|(value, sum)| *value = sum[lane]);
            }
        }
    }

    #[inline(always)]
    fn times_lanes<const LANES: usize>(&self, vectors: &[[f64; LANES]], products: &mut [[f64; LANES]]) {
        products.fill([0.0; LANES]);
        for ((column, ends), diagonal) in self.starts.windows(2).enumerate().zip(&self.diagonal) {
            let of_column = vectors[column];
            let mut sum = [0.0; LANES];
            (0..LANES).for_each(|lane| sum[lane] = diagonal * of_column[lane]);
            for (&row, &entry) in self.rows[ends[0]..ends[1]].iter().zip(&self.entries[ends[0]..ends[1]]) {
                let (product, vector) = (&mut products[row as usize], &vectors[row as usize]);
                for lane in 0..LANES {
                    product[lane] += entry * of_column[lane];
                    sum[lane] += entry * vector[lane];
                }
            }
            (0..LANES).for_each(|lane| products[column][lane] += sum[lane]);
        }
    }
}
