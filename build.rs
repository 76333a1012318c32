//! Compiles the bridge to OpenVDB, where the feature `openvdb` asks for it.

#[cfg(feature = "openvdb")]
#[path = "build/openvdb.rs"]
mod openvdb;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    #[cfg(feature = "openvdb")]
    openvdb::build();
}
