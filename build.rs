//! Puts the MUMPS build with the SCOTCH orderings in front of the default one, which has PORD only.
//! Link arguments of a dependency do not reach the binary, so they stand here and not in `ffi/build.rs`.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!(
        "cargo:rustc-link-arg=-Wl,--push-state,--no-as-needed,-l:libdmumps_ptscotch-5.5.so,-l:libmumps_common_ptscotch-5.5.so,--pop-state"
    );
}
