//! Both ends of the cable: messages, uploads, refusals, and a wire that loses and mangles bytes.

mod board;
mod damage;
mod host;
mod messages;
mod page;
mod queries;
mod refusals;
mod uploads;
mod wire;
