//! The promises of the module, on analytic surfaces and on random lattices.

mod analytic;
pub(crate) mod audit;
mod audit_cases;
mod fields;
mod random;
