//! `malleus fit` and `malleus surface` as their user calls them: tables on any number of cores,
//! dynamic filters, priors, many strikes, reports and surfaces.
//! `cargo test -p malleus --test fits report::` runs one part.

mod cores;
mod descent;
mod dynamic_filter;
mod prior;
mod report;
mod strikes_report;
mod surface;
