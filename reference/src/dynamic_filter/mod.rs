//! The dynamic filter in `f64` (*Analysis-Synthesis of Impact Sounds by Real-Time Dynamic
//! Filtering*, eq. 5, 6 and 17), and its exciter.

mod band_pass;
mod breakpoint;
mod carry;
mod exciter;
mod filter;
mod form;
mod noise;

pub use band_pass::BandPass;
pub use breakpoint::Breakpoint;
pub use exciter::Exciter;
pub use filter::Filter;
pub use form::Form;
pub use noise::White;
