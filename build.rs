//! Puts the MUMPS build with the SCOTCH orderings in front of the default one, which has PORD only.
//! Link arguments of a dependency do not reach the binary, so they stand here and not in `ffi/build.rs`.

use std::process::exit;
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let architecture = env::var("CARGO_CFG_TARGET_ARCH").unwrap_or_default();
    let folders = [format!("/usr/lib/{architecture}-linux-gnu"), "/usr/lib64".into(), "/usr/lib".into()];
    let found = folders.iter().map(|folder| versions(folder)).find(|found| !found.is_empty()).unwrap_or_default();
    let [version] = &found[..] else {
        let what = match &found[..] {
            [] => "is not installed".into(),
            several => format!("is there in several versions, {}: leave that of PETSc", several.join(", ")),
        };
        println!("cargo:warning=MUMPS with the SCOTCH orderings {what}");
        println!("cargo:warning=on Debian 12 and Ubuntu 24.04 scripts/setup installs it");
        exit(1)
    };
    let libraries = format!("-l:libdmumps_ptscotch-{version}.so,-l:libmumps_common_ptscotch-{version}.so");
    println!("cargo:rustc-link-arg=-Wl,--push-state,--no-as-needed,{libraries},--pop-state");
}

/// Those by which programs find the library when they start, such as 5.5; the files themselves are called 5.5.0.
fn versions(folder: &str) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let version = |name: String| Some(name.strip_prefix("libdmumps_ptscotch-")?.strip_suffix(".so")?.to_string());
    names.filter_map(version).filter(|version| version.split('.').count() == 2).collect()
}
