//! `malleus fit` as its user calls it: tables on any number of cores, dynamic filters, priors,
//! many strikes and reports.
//! `cargo test -p malleus --test fits report::` runs one part.

mod cores;
mod descent;
mod dynamic_filter;
mod prior;
mod report;
mod strikes_report;
