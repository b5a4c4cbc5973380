//! Generates the bindings from the headers of the installed PETSc and links it.

use std::env;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::process::exit;

/// What the crate binds: vectors, matrices, solvers, and the run time with its options, errors and log.
const FUNCTIONS: &str =
    "Petsc(Init|Final|PushError|PopError|Error|Options|Object|Log|GetVersion).*|(Vec|Mat|KSP|PC|SNES|IS)[A-Z].*";

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let petsc = library("petsc", "libpetsc-real-dev");
    let mpi = library("ompi-c", "libopenmpi-dev");
    let includes = petsc.include_paths.iter().chain(&mpi.include_paths).map(|path| format!("-I{}", path.display()));

    let bindings = bindgen::builder()
        .header_contents("petsc-bindings.h", "#include <petscsnes.h>")
        .clang_args(includes)
        .allowlist_function(FUNCTIONS)
        .allowlist_var("PETSC_COMM_WORLD|PETSC_ERR_.*|PETSC_DECIDE|PETSC_DETERMINE|petsc_i?send_(ct|len)")
        // One MPI_Comm type serves rsmpi and PETSc.
        .blocklist_type("MPI_.*|ompi_.*")
        .raw_line("use mpi::ffi::*;")
        .default_enum_style(bindgen::EnumVariation::Consts)
        .prepend_enum_name(false)
        .generate_comments(false)
        .layout_tests(false);
    let bindings = match catch_unwind(AssertUnwindSafe(|| bindings.generate())) {
        Ok(Ok(bindings)) => bindings,
        Ok(Err(error)) => stop(&format!("bindgen cannot read PETSc's headers: {error}"), CLANG),
        Err(_) => stop("bindgen cannot load libclang", CLANG),
    };

    let folder = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    if let Err(error) = bindings.write_to_file(folder.join("petsc.rs")) {
        stop(&format!("the bindings cannot be written: {error}"), "(disk full?)");
    }
}

const CLANG: &str = "libclang1-14 libclang-common-14-dev, on Ubuntu 24.04 those of 18";

/// Finds a library by pkg-config, which also tells cargo how to link it.
fn library(name: &str, package: &str) -> pkg_config::Library {
    match pkg_config::probe_library(name) {
        Ok(library) => library,
        Err(error) => stop(&format!("pkg-config does not find `{name}`: {error}"), &format!("pkg-config {package}")),
    }
}

/// Ends the build with what is wrong and the Debian packages that cure it.
fn stop(what: &str, packages: &str) -> ! {
    println!("cargo:warning=petsc: {}", what.lines().next().unwrap_or_default());
    println!("cargo:warning=petsc: on Debian: apt-get install {packages}");
    eprintln!("{what}\non Debian: apt-get install {packages}");
    exit(1)
}
