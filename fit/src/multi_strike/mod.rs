//! One recording, many strikes: modes, gains and all forces by maximum likelihood together.

mod arrow;
mod contact;
mod descend;
mod equations;
mod model;
mod ringing;
mod whitening;

pub(crate) use contact::Contact;
pub(crate) use model::{Model, Strike};
