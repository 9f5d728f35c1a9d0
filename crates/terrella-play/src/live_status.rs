//! Status in the window when a simulator controls the time.

/// Status of simulators.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LiveStatus {
    /// The satellite whose simulator gives the time.
    pub name: String,
    /// How fast its time goes.
    pub pace: String,
    /// Lines of the panel, for every live satellite: what, and how it is.
    pub rows: Vec<(&'static str, String)>,
    /// An important notice: nothing has arrived yet, or nothing arrives any longer.
    pub notice: Option<String>,
}
