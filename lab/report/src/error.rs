//! Errors of a report.

/// Reason why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A document, a scene or a machine is refused.
    #[error("{0}")]
    Refused(String),
    /// A measurement, a table or a figure failed.
    #[error("{0}")]
    Failed(String),
}
