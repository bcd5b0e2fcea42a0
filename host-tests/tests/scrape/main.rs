//! Force of scraping and rolling: the instrument against the reference, and the reference against
//! the law itself.

mod law;
mod maps;
mod paths;
mod rolling;
mod stability;
mod twin;
