//! The page of `nagata report` in a browser without a screen, Chromium: nothing comes from outside, figures and their words
//! have room, nothing runs over the edge, and it prints. Where there is no Chromium it is passed over, with a word, but fails
//! under NAGATA_BROWSER=1, which scripts/test sets when it has installed it.

mod common;

use common::Bench;
use common::jobs::BLOCK_UNDER_PLATE;
use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Command;

const STEP: &str = r#"
[[step]]
name = "press-and-drag"
increments = 6
fix = [{ set = "block.bottom" }]
move = [{ target = "plate", by = [0.2, 0.0, -0.1] }]

[output]
history = ["block.bottom"]
"#;

/// What a page can measure of itself; the answer becomes its title.
const MEASURE: &str = r#"<script>
const box = (of) => of.getBoundingClientRect();
const inside = (a, b) => a.left > b.left - 1 && a.right < b.right + 1 && a.top > b.top - 1 && a.bottom < b.bottom + 1;
const figures = [...document.querySelectorAll("svg")];
const words = figures.flatMap((svg) => [...svg.querySelectorAll("text")].map((text) => [text, svg]));
document.title = JSON.stringify({
    loaded: performance.getEntriesByType("resource").map((entry) => entry.name).filter((name) => !name.startsWith("data:")),
    wide: document.documentElement.scrollWidth - document.documentElement.clientWidth,
    figures: figures.length,
    small: figures.filter((svg) => box(svg).width < 200 || box(svg).height < 100).length,
    words: words.length,
    cut: words.filter(([text, svg]) => !inside(box(text), box(svg))).map(([text]) => text.textContent),
    empty: words.filter(([text]) => box(text).width < 1).map(([text]) => text.textContent),
    pictures: [...document.images].filter((image) => image.naturalWidth > 0).length,
});
</script>"#;

fn chromium(folder: &Path, arguments: &[&str]) -> std::io::Result<String> {
    let profile = format!("--user-data-dir={}", folder.join("profile").display());
    let done = Command::new("timeout")
        .args(["60", "chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", &profile])
        .args(arguments)
        .output()?;
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    Ok(String::from_utf8_lossy(&done.stdout).into_owned())
}

/// What the page measures of itself in a window of this width.
fn measured(folder: &Path, page: &str, width: u32) -> Value {
    let copy = folder.join("measured.html");
    fs::write(&copy, page.replace("</body>", &format!("{MEASURE}</body>"))).unwrap();
    let address = format!("file://{}", copy.display());
    let shown = chromium(folder, &[&format!("--window-size={width},900"), "--dump-dom", &address]).unwrap();
    let title = shown.split("<title>").nth(1).unwrap().split("</title>").next().unwrap();
    serde_json::from_str(title).unwrap_or_else(|error| panic!("{error}: {title}"))
}

/// On how many pages it is printed.
fn pages(folder: &Path, page: &str) -> usize {
    let (copy, printed) = (folder.join("printed.html"), folder.join("printed.pdf"));
    fs::write(&copy, page).unwrap();
    let option = format!("--print-to-pdf={}", printed.display());
    chromium(folder, &[&option, "--no-pdf-header-footer", &format!("file://{}", copy.display())]).unwrap();
    let pdf = fs::read(printed).unwrap();
    assert!(pdf.starts_with(b"%PDF"));
    pdf.windows(12).filter(|w| w == b"/Type /Page\n" || w == b"/Type /Page/").count()
}

#[test]
fn a_page_stands_alone_fits_and_prints() {
    if Command::new("chromium").arg("--version").output().is_err() {
        let what = "the report has not been looked at: Chromium is not installed (apt-get install chromium)";
        assert!(std::env::var_os("NAGATA_BROWSER").is_none(), "{what}");
        // Past what captures the output of tests.
        let _ = writeln!(std::io::stderr(), "passed over: {what}");
        return;
    }
    let lines = "# The scene is printed, too.\n".repeat(200);
    let bench = Bench::new(&format!("title = 'A plate on a block'\n{BLOCK_UNDER_PLATE}{STEP}{lines}"));
    let out = bench.solve(1, &[]).out;
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/tutorial/clip.png"), out.join("view.png")).unwrap();
    let path = out.join("report.html");
    let arguments = ["report", out.to_str().unwrap()];
    assert_eq!(common::nagata(&bench.path(""), 1, &arguments, out.clone()).code, 0);
    let page = fs::read_to_string(&path).unwrap();
    for width in [1280, 600] {
        let found = measured(&bench.path(""), &page, width);
        let none = Value::Array(Vec::new());
        assert_eq!((&found["loaded"], &found["cut"], &found["empty"]), (&none, &none, &none), "{width}");
        assert!(found["wide"].as_i64().unwrap() <= 0, "{width}: {found}");
        assert!(found["figures"].as_u64().unwrap() >= 5 && found["small"] == 0, "{width}: {found}");
        assert!(found["words"].as_u64().unwrap() > 50 && found["pictures"] == 1, "{width}: {found}");
    }
    let whole = pages(&bench.path(""), &page);
    assert!((1..20).contains(&whole), "{whole} pages");
    let short = page.replace(&lines, "");
    assert!(short.len() < page.len() && whole > pages(&bench.path(""), &short) + 1, "the scene is not printed");
}
