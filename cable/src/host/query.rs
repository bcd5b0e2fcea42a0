//! Single requests.

use super::{HostError, Next, Task};
use crate::answer::Answer;
use crate::request::Request;

/// Task of one request, such as [`Request::Identity`] or [`Request::Erase`].
pub struct Query<'r> {
    request: Request<'r>,
    answer: Option<Answer<'static>>,
}

impl<'r> Query<'r> {
    /// Makes the task of one request.
    pub const fn new(request: Request<'r>) -> Self {
        Self { request, answer: None }
    }

    /// Answer to the request, when the task is done; `None` for bytes of a slot, which
    /// [`Download`](super::Download) reads.
    pub fn answer(self) -> Option<Answer<'static>> {
        self.answer
    }
}

impl Task for Query<'_> {
    fn request(&self) -> Request<'_> {
        self.request
    }

    fn answer(&mut self, answer: Answer<'_>) -> Result<Next, HostError> {
        self.answer = answer.owned();
        Ok(Next::Done)
    }
}
