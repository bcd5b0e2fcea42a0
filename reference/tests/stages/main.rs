//! Properties of each stage of the model, one file a stage, in signal order.

mod build;
mod contact;
mod pad;
mod resonator;
mod scene;
