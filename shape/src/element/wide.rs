//! Sheets of any width: elasticity in space, expanded across the width.

use super::assembly::{self, pattern, scatter};
use super::sheet::{PlaneState, Sheet, Slice};
use super::support::Ties;
use super::triangle::{Sample, gauss};
use super::{Discrete, Error, Material, Nodes, Support, positive};
use crate::mesh::Mesh;

/// Number of strains: εx, εy, γxy, εz, γxz and γyz.
const STRAINS: usize = 6;

/// Sheet with free faces that moves alike on both sides of its middle plane z = 0, as it does when
/// it is struck there: a bar of a width b seen from its side.
///
/// Its motion is expanded in polynomials of ζ = 2 z/b between -1 and 1 (after Mindlin's expansion
/// across the thickness of plates, 1955, with Legendre's polynomials P), with n terms:
///
/// - in the plane u = u₀ + Σ uᵢ (P₂ᵢ(ζ) - P₂ᵢ(0)), i = 1 to n, so that u₀ is the motion of the
///   middle plane, and v alike;
/// - across it w = Σ wᵢ P₂ᵢ₋₁(ζ), i = 1 to n.
///
/// Both energies are those in space, integrated exactly across the width, so that frequencies fall
/// towards those of the body in space as n grows. One term becomes plane stress as b falls to 0:
/// 2 w₁/b is then the strain across, -ν/(1 - ν) (εx + εy), up to what the elements leave, which
/// falls with their size as fast as the error of plane stress does. Without terms the sheet is in
/// plane stress.
///
/// Components: u₀ and v₀ of the middle plane, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wide {
    /// Material.
    pub material: Material,
    /// Width b across the plane, metres.
    pub width: f64,
    /// Number of terms n.
    pub terms: usize,
    /// Poisson's ratio νyz of wood, across its grain; `None` takes that in the plane.
    pub around: Option<f64>,
}

impl Wide {
    /// Parts the sheet into elements of an order from 1 to 4, its sides supported as given by their
    /// numbers. Hinged sides hold the motion in the plane over the whole width; clamped ones hold
    /// that across it, too.
    pub fn discretise(&self, mesh: &Mesh, order: usize, supports: &[Support]) -> Result<Discrete, Error> {
        let Self { material, width, terms, .. } = *self;
        if terms == 0 {
            return Sheet { material, thickness: width, state: PlaneState::Stress }.discretise(mesh, order, supports);
        }
        material.check()?;
        positive("the width", width)?;
        let nodes = Nodes::new(mesh, order)?;
        let ties = Ties::new(&nodes, supports, false)?;
        let not_clamped = |support: &Support| if *support == Support::Clamped { *support } else { Support::Free };
        let across = Ties::new(&nodes, &supports.iter().map(not_clamped).collect::<Vec<_>>(), false)?;
        let mut size = 0;
        let mut number = |is_held: bool| {
            size += usize::from(!is_held);
            (!is_held).then(|| size - 1)
        };
        let unknowns: Vec<Vec<Option<usize>>> = ties
            .fixed
            .iter()
            .zip(&across.fixed)
            .map(|(inside, across)| {
                self.fields().iter().map(|field| number(if field.axis == 2 { across[0] } else { inside[0] })).collect()
            })
            .collect();
        if size == 0 {
            return Err(Error::Held);
        }
        let mut problem = pattern(&nodes, &unknowns, size);
        let products = self.products();
        let even = nodes.functions.samples(2 * order);
        let rich = nodes.functions.samples(3 * order + 2);
        for (number, triangle) in nodes.triangles.iter().enumerate() {
            let integrals = Integrals::new(&nodes, number, if nodes.curved[number] { &rich } else { &even })?;
            let places: Vec<Option<usize>> = triangle.iter().flat_map(|node| unknowns[*node].iter().copied()).collect();
            let fields = products.len();
            scatter(&mut problem, &places, |row, column| {
                let factors = &products[row % fields][column % fields];
                integrals.entry(row / fields, column / fields, factors)
            });
        }
        let unknowns = unknowns.iter().map(|own| [own[0], own[1], None]).collect();
        let rigid = assembly::rigid(&Slice::default(), &nodes, &ties);
        Ok(Discrete { problem, nodes, components: 2, unknowns, axes: ties.axes, turned: None, rigid })
    }

    /// Fields of a node: u₀ and v₀, then wᵢ, uᵢ and vᵢ of each term.
    fn fields(&self) -> Vec<Field> {
        let plane = [0, 1].map(|axis| Field { axis, degree: 0 });
        let of_term = |term: usize| {
            [
                Field { axis: 2, degree: 2 * term - 1 },
                Field { axis: 0, degree: 2 * term },
                Field { axis: 1, degree: 2 * term },
            ]
        };
        plane.into_iter().chain((1..=self.terms).flat_map(of_term)).collect()
    }

    /// Factors of the integrals over the plane, for each pair of fields.
    fn products(&self) -> Vec<Vec<Factors>> {
        let fields = self.fields();
        let elasticity = self.material.space(self.around);
        let mut products = vec![vec![Factors::default(); fields.len()]; fields.len()];
        for (at, weight) in gauss(2 * self.terms + 1) {
            let zeta = 2.0 * at - 1.0;
            let parts: Vec<Part> = fields.iter().map(|field| field.part(zeta, self.width)).collect();
            for (line, one) in products.iter_mut().zip(&parts) {
                for (factors, other) in line.iter_mut().zip(&parts) {
                    factors.add(one, other, &elasticity, self.material.density, weight * self.width);
                }
            }
        }
        products
    }
}

/// Field of the expansion: motion along an axis times a polynomial across the width.
#[derive(Clone, Copy)]
struct Field {
    axis: usize,
    degree: usize,
}

/// Field at a place across the width.
struct Part {
    axis: usize,
    /// Factor of the field's motion.
    value: f64,
    /// Factors, for each strain, of the field's derivatives along x and y and of the field.
    strains: [[f64; 3]; STRAINS],
}

impl Field {
    fn part(self, zeta: f64, width: f64) -> Part {
        let Self { axis, degree } = self;
        let [polynomial, slope] = legendre(degree, zeta);
        let mut strains = [[0.0; 3]; STRAINS];
        if axis == 2 {
            strains[3][2] = slope * 2.0 / width;
            strains[4][0] = polynomial;
            strains[5][1] = polynomial;
            return Part { axis, value: polynomial, strains };
        }
        let value = if degree == 0 { 1.0 } else { polynomial - legendre(degree, 0.0)[0] };
        strains[axis][axis] = value;
        strains[2][1 - axis] = value;
        strains[4 + axis][2] = slope * 2.0 / width;
        Part { axis, value, strains }
    }
}

/// Factors of the integrals over the plane for two fields: those of the stiffness, by the
/// derivative (along x, along y, none) of each field, and that of the mass.
#[derive(Clone, Copy, Default)]
struct Factors {
    stiffness: [[f64; 3]; 3],
    mass: f64,
}

impl Factors {
    fn add(&mut self, one: &Part, other: &Part, elasticity: &[[f64; STRAINS]; STRAINS], density: f64, weight: f64) {
        for (left, line) in one.strains.iter().zip(elasticity) {
            for (right, modulus) in other.strains.iter().zip(line) {
                for (row, left) in self.stiffness.iter_mut().zip(left) {
                    row.iter_mut().zip(right).for_each(|(entry, right)| *entry += weight * modulus * left * right);
                }
            }
        }
        if one.axis == other.axis {
            self.mass += weight * density * one.value * other.value;
        }
    }
}

/// Integrals of products over a triangle, for each two functions of its nodes. The first index
/// chooses the first factor: the function's derivative along x, along y, or the function. The
/// second index chooses the other factor.
struct Integrals {
    count: usize,
    values: Vec<[[f64; 3]; 3]>,
}

impl Integrals {
    fn new(nodes: &Nodes, number: usize, samples: &[Sample]) -> Result<Self, Error> {
        let members = &nodes.triangles[number];
        let count = members.len();
        let mut values = vec![[[0.0; 3]; 3]; count * count];
        for sample in samples {
            let (_, map) = assembly::place(nodes, members, sample);
            let area = map[0][0] * map[1][1] - map[0][1] * map[1][0];
            if area.is_nan() || area <= 0.0 {
                return Err(Error::Folded(number));
            }
            let parts = sample.values.iter().zip(&sample.derivatives).map(|(value, [first, second])| {
                let along_x = (first * map[1][1] - second * map[0][1]) / area;
                [along_x, (second * map[0][0] - first * map[1][0]) / area, *value]
            });
            let parts: Vec<[f64; 3]> = parts.collect();
            for (line, one) in values.chunks_mut(count).zip(&parts) {
                for (entry, other) in line.iter_mut().zip(&parts) {
                    for (row, one) in entry.iter_mut().zip(one) {
                        let weighted = sample.weight * area * one;
                        row.iter_mut().zip(other).for_each(|(value, other)| *value += weighted * other);
                    }
                }
            }
        }
        Ok(Self { count, values })
    }

    /// Stiffness and mass of one function with a field and another one with its field.
    fn entry(&self, one: usize, other: usize, factors: &Factors) -> [f64; 2] {
        let integrals = &self.values[one * self.count + other];
        let rows = integrals.iter().zip(&factors.stiffness);
        let stiffness = rows.flat_map(|(row, factors)| row.iter().zip(factors)).map(|(value, factor)| value * factor);
        [stiffness.sum(), integrals[2][2] * factors.mass]
    }
}

/// Legendre's polynomial of a degree and its derivative at a place.
fn legendre(degree: usize, at: f64) -> [f64; 2] {
    let (mut before, mut now) = ([0.0; 2], [1.0, 0.0]);
    for degree in 0..degree {
        let [twice, number] = [(2 * degree + 1) as f64, degree as f64];
        let value = (twice * at * now[0] - number * before[0]) / (number + 1.0);
        let slope = before[1] + twice * now[0];
        (before, now) = (now, [value, slope]);
    }
    now
}
