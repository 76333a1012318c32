//! Shape processing of the closed solid (\[WC13\] section 4.3).

mod embedding;
pub(super) mod shape;
