//! Finds OpenVDB and compiles the bridge.

fn main() {}
