//! Pages on fitted recordings, with an index of them, and on surfaces and shapes: sound, pictures
//! and figures in one HTML file each.
//!
//! A page holds its sounds and pictures as data. It fetches nothing, and a Content-Security-Policy
//! forbids the browser to. It holds its figures as JSON, too, from which the index is made.

mod chart;
mod chladni;
mod deformed;
pub(crate) mod document;
mod error;
mod figures;
mod index;
pub(crate) mod markup;
mod page;
mod plan;
mod shape_charts;
mod shape_page;
mod strikes_figures;
mod strikes_page;
mod surface_page;
mod view;

pub use error::ReportError;
pub use index::{INDEX_FILE, write_index};
pub use page::{Summary, write_page};
pub use shape_page::{SHAPE_PAGE_FILE, ShapePage, is_shape_page, shape_html};
pub use strikes_page::{StrikesPage, write_strikes_page};
pub use surface_page::{SurfacePage, write_surface_page};
