//! Generates the table of functions of a file driver from the headers of the installed HDF5.

use std::env;
use std::path::PathBuf;
use std::process::exit;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let mut config = pkg_config::Config::new();
    // `hdf5-sys` links it.
    let library = match config.cargo_metadata(false).probe("hdf5") {
        Ok(library) => library,
        Err(error) => stop(&format!("pkg-config does not find `hdf5`: {error}")),
    };
    let bindings = bindgen::builder()
        .header_contents("driver.h", "#include <hdf5.h>")
        .clang_args(library.include_paths.iter().map(|path| format!("-I{}", path.display())))
        .allowlist_type("H5FD_class_t")
        .allowlist_function("H5FDregister")
        .allowlist_var("H5FD_FEAT_(AGGREGATE_(METADATA|SMALLDATA)|ACCUMULATE_METADATA_(READ|WRITE)|DATA_SIEVE)")
        .default_enum_style(bindgen::EnumVariation::Consts)
        .prepend_enum_name(false)
        .generate_comments(false)
        .layout_tests(false);
    let folder = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let written = bindings
        .generate()
        .map_err(|error| error.to_string())
        .and_then(|bindings| bindings.write_to_file(folder.join("driver.rs")).map_err(|error| error.to_string()));
    if let Err(error) = written {
        stop(&format!("bindings of HDF5's drivers: {error}"));
    }
}

fn stop(what: &str) -> ! {
    println!("cargo:warning=journal: {what}");
    println!(
        "cargo:warning=journal: on Debian: apt-get install pkg-config libhdf5-openmpi-dev libclang1-14 libclang-common-14-dev"
    );
    exit(1)
}
