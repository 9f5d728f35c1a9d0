//! Error scopes, and when their results are available.

use std::task::{Context, Poll, Waker};

/// An error scope that ends in the call that opened it.
///
/// The device of a web page returns errors only after the call. There no scope is opened, so that errors reach the enclosing scope, such as that of
/// [`Earth::create`](crate::Earth::create), or the device's handler of uncaptured errors, and are not lost.
pub(crate) struct ErrorScope(Option<wgpu::ErrorScopeGuard>);

impl ErrorScope {
    pub fn open(device: &wgpu::Device, filter: wgpu::ErrorFilter) -> Self {
        let answers = !cfg!(target_family = "wasm");
        Self(answers.then(|| device.push_error_scope(filter)))
    }

    /// Ends the scope. Returns the first error within it.
    pub fn error(self) -> Option<wgpu::Error> {
        resolved(self.0?.pop())?
    }
}

/// Scopes around the creation of an Earth.
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

    /// Ends the scopes now. The future is ready when the device has answered.
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
