//! What each stage of the model promises, a file a stage, in signal order.

mod build;
mod contact;
mod pad;
mod resonator;
mod scene;
