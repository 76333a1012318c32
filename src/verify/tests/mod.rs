//! Planted defects are found, clean meshes pass, and closed forms are met.

pub(crate) mod audit;
mod defects;
mod figures;
mod oracle;
mod pairs;
