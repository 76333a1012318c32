//! The promises of the module, on analytic surfaces and on random lattices.

mod analytic;
mod fields;
mod liars;
mod random;
mod sharp;
