//! Programs that erase and program flash on the virtual boards: what the core waits for, what goes
//! on meanwhile, and what is left when power is lost.

mod power;
mod script;
mod waits;
