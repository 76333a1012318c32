//! The promises of the module, on analytic surfaces and on random lattices.

mod adversarial_surface;
mod analytic;
mod fields;
mod random;
mod sharp;
