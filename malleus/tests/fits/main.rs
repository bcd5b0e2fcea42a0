//! `malleus fit`, `malleus surface` and `malleus shape` as their user calls them: tables on any
//! number of cores, dynamic filters, priors, many strikes, reports, surfaces and shapes.
//! `cargo test -p malleus --test fits report::` runs one part.

mod cores;
mod descent;
mod dynamic_filter;
mod modulus;
mod outputs;
mod page;
mod prior;
mod report;
mod shape;
mod shape_report;
mod strikes_report;
mod surface;
