//! `malleus fit` as its user calls it: dynamic filters and reports.
//! `cargo test -p malleus --test fits report::` runs one part.

mod dynamic_filter;
mod report;
