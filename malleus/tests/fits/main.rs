//! `malleus fit` as its user calls it: dynamic filters, priors and reports.
//! `cargo test -p malleus --test fits report::` runs one part.

mod dynamic_filter;
mod prior;
mod report;
