//! The whole run on one page: `overview.svg`.
