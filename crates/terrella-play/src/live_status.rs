//! What the window reports where a simulator gives the time.

/// What the window reports of simulators.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LiveStatus {
    /// The satellite whose simulator gives the time.
    pub name: String,
    /// How fast its time goes.
    pub pace: String,
    /// Lines of the panel, for every live satellite: what, and how it is.
    pub rows: Vec<(&'static str, String)>,
    /// What must not be overlooked: nothing has come yet, or nothing comes any more.
    pub notice: Option<String>,
}
