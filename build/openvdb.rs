//! Finds OpenVDB and compiles the bridge to it.
//!
//! Debian's package has no pkg-config file, so the version is read from `openvdb/version.h`, under
//! `OPENVDB_ROOT` if that is set and under the usual prefixes otherwise.

use std::path::{Path, PathBuf};

/// The versions that the bridge is written for. Before 10 the version header and the leaf buffers
/// differ; after 13 nobody has tried.
const MAJORS: std::ops::RangeInclusive<u32> = 10..=13;

/// The first version whose headers want C++20 instead of C++17.
const FIRST_WITH_CPP20: u32 = 13;

/// Versions whose headers include boost's UUID, which Debian's OpenVDB package does not depend on.
const LAST_WITH_BOOST: u32 = 11;

const INSTALL: &str = "install it (Debian and Ubuntu: apt install libopenvdb-dev libtbb-dev libboost-dev) \
                       or set OPENVDB_ROOT to the prefix of an installation";

/// An installation of OpenVDB.
struct OpenVdb {
    include: PathBuf,
    libraries: PathBuf,
    major: u32,
}

/// Compiles the bridge and says what to link, or why that cannot be.
pub fn build() {
    println!("cargo:rerun-if-env-changed=OPENVDB_ROOT");
    println!("cargo:rerun-if-env-changed=DOCS_RS");
    for file in ["build/openvdb.rs", "src/vdb/bridge.rs", "cpp"] {
        println!("cargo:rerun-if-changed={file}");
    }
    // docs.rs has no OpenVDB, and documentation needs none: nothing is linked.
    if std::env::var_os("DOCS_RS").is_some() {
        return;
    }
    match find() {
        Ok(openvdb) => compile(&openvdb),
        Err(sentence) => println!("cargo::error={sentence}"),
    }
}

fn compile(openvdb: &OpenVdb) {
    let standard = if openvdb.major >= FIRST_WITH_CPP20 { "c++20" } else { "c++17" };
    let mut build = cxx_build::bridge("src/vdb/bridge.rs");
    // Naming a directory that the compiler searches anyway would change the order of its search.
    if !openvdb.include.starts_with("/usr") {
        build.flag(format!("-isystem{}", openvdb.include.display()));
    }
    build.files(["cpp/vdb.cc", "cpp/check.cc"]);
    if cfg!(feature = "cli") {
        build.file("cpp/peer.cc");
    }
    build
        .std(standard)
        .flag_if_supported("-Wno-deprecated-declarations")
        // The same in all profiles. Without optimisation the level-set checks, which are templates, are a
        // hundred times slower. With more, the compiler takes twice as long, and nothing is faster: most
        // of the work is done inside of the library.
        .opt_level(1)
        .debug(false)
        .define("NDEBUG", None)
        .compile("exocarp_vdb");

    println!("cargo:rustc-link-search=native={}", openvdb.libraries.display());
    println!("cargo:rustc-link-lib=openvdb");
    println!("cargo:rustc-link-lib=tbb");
    // OpenVDB has its own half type where it was built without Imath, so this one is linked if there.
    if let Some(name) = ["Imath-3_1", "Imath-3_2", "Imath"]
        .into_iter()
        .find(|name| openvdb.libraries.join(format!("lib{name}.so")).exists())
    {
        println!("cargo:rustc-link-lib={name}");
    }
}

/// The installation to use, or the sentence that says why there is none.
fn find() -> Result<OpenVdb, String> {
    let prefixes: Vec<PathBuf> = match std::env::var_os("OPENVDB_ROOT") {
        Some(root) if !root.is_empty() => vec![root.into()],
        _ => ["/usr/local", "/usr", "/opt/homebrew"].map(PathBuf::from).to_vec(),
    };
    let places = prefixes.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", ");
    let found = prefixes.iter().find_map(|p| {
        let header = p.join("include/openvdb/version.h");
        std::fs::read_to_string(&header).ok().map(|text| (p, header, text))
    });
    let Some((prefix, header, text)) = found else {
        return Err(format!(
            "exocarp needs OpenVDB {} to {}, and there is no include/openvdb/version.h under {places}: {INSTALL}.",
            MAJORS.start(),
            MAJORS.end()
        ));
    };
    println!("cargo:rerun-if-changed={}", header.display());

    let Some(major) = define(&text, "OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER") else {
        return Err(format!("{} names no version of OpenVDB: {INSTALL}.", header.display()));
    };
    if !MAJORS.contains(&major) {
        return Err(format!(
            "{} is of OpenVDB {major}, and exocarp needs {} to {}: {INSTALL}.",
            header.display(),
            MAJORS.start(),
            MAJORS.end()
        ));
    }
    let Some(libraries) = library_path(prefix) else {
        return Err(format!(
            "the headers of OpenVDB {major} are under {}, but not libopenvdb and libtbb: {INSTALL}.",
            prefix.display()
        ));
    };
    let include = prefix.join("include");
    let boost = [&include, Path::new("/usr/include"), Path::new("/usr/local/include")]
        .iter()
        .any(|p| p.join("boost/uuid/uuid.hpp").exists());
    if major <= LAST_WITH_BOOST && !boost {
        return Err(format!("OpenVDB {major} needs the headers of boost, and they are missing: {INSTALL}."));
    }
    Ok(OpenVdb { include, libraries, major })
}

/// The value of `#define name value` in a header.
fn define(header: &str, name: &str) -> Option<u32> {
    header.lines().find_map(|line| {
        let mut words = line.split_whitespace();
        (words.next() == Some("#define") && words.next() == Some(name)).then(|| words.next())??.parse().ok()
    })
}

/// The directory under `prefix` that holds libopenvdb.
fn library_path(prefix: &Path) -> Option<PathBuf> {
    let arch = std::env::var("CARGO_CFG_TARGET_ARCH").unwrap_or_default();
    ["lib".to_owned(), "lib64".to_owned(), format!("lib/{arch}-linux-gnu")]
        .into_iter()
        .map(|dir| prefix.join(dir))
        .find(|dir| ["so", "dylib", "a"].iter().any(|ext| dir.join(format!("libopenvdb.{ext}")).exists()))
}
