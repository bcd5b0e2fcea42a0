//! From shape and material to the modes of a body, by finite elements.
//!
//! One folder a step: [`outline`] is what a flat body looks like, [`mesh`] parts it into triangles,
//! [`element`] makes the matrices of stiffness and mass, [`eigen`] finds the modes,
//! [`damping`] and [`gain`] say how they decay and how loud they are, and [`table`] is what a board
//! plays. [`file`](mod@file) is the text that says what the body is; [`solve`] goes all the way.

pub mod benchmarks;
pub mod damping;
pub mod eigen;
pub mod element;
pub mod file;
pub mod gain;
pub mod mesh;
pub mod outline;
pub mod solid;
pub mod solve;
pub mod surface;
pub mod table;
pub mod tune;
