//! Some random scenes, each told in several ways that must give the same forces, and held to laws: the seeds that
//! `scripts/studies/random-scenes.py` begins with. It takes any others.

use std::path::Path;
use std::process::Command;

#[test]
fn random_scenes_agree_with_themselves() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let run = Command::new(root.join("scripts/studies/random-scenes.py"))
        .args(["--seeds", "1..4", "--limit", "600", "--binary", env!("CARGO_BIN_EXE_nagata")])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success() && said.contains("4: "), "{said}\n{}", String::from_utf8_lossy(&run.stderr));
}
