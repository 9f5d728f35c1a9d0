//! Error scopes, and when their answers are there.

use std::task::{Context, Poll, Waker};

/// An error scope that is asked in the call that opened it.
///
/// The device of a web page answers after the call. There no scope is opened, so that errors reach the scope around the call, as that of
/// [`Earth::create`](crate::Earth::create), or the device's handler of uncaptured errors, and are not lost.
pub(crate) struct ErrorScope(Option<wgpu::ErrorScopeGuard>);

impl ErrorScope {
    pub fn open(device: &wgpu::Device, filter: wgpu::ErrorFilter) -> Self {
        let answers = !cfg!(target_family = "wasm");
        Self(answers.then(|| device.push_error_scope(filter)))
    }

    /// Ends it. Answers the first error within.
    pub fn error(self) -> Option<wgpu::Error> {
        resolved(self.0?.pop())?
    }
}

/// Scopes around the making of an Earth.
pub(crate) struct CreationScopes {
    // In the order in which they must end.
    validation: wgpu::ErrorScopeGuard,
    memory: wgpu::ErrorScopeGuard,
}

/// The first error of each kind.
#[derive(Default)]
pub(crate) struct CreationErrors {
    pub rejected: Option<wgpu::Error>,
    pub out_of_memory: Option<wgpu::Error>,
}

impl CreationScopes {
    pub fn open(device: &wgpu::Device) -> Self {
        let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
        Self { validation, memory }
    }

    /// Ends them now, and answers when the device does.
    pub fn end(self) -> impl Future<Output = CreationErrors> {
        let (validation, memory) = (self.validation.pop(), self.memory.pop());
        async {
            CreationErrors {
                rejected: validation.await,
                out_of_memory: memory.await,
            }
        }
    }
}

/// The value of a future that is ready at once, as wgpu's error scopes are everywhere but on the web.
pub(crate) fn resolved<T>(future: impl Future<Output = T>) -> Option<T> {
    let mut context = Context::from_waker(Waker::noop());
    match std::pin::pin!(future).poll(&mut context) {
        Poll::Ready(value) => Some(value),
        Poll::Pending => None,
    }
}
