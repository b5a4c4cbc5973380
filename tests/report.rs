//! `nagata report` and `run --report`: what the page says is what stands in the folders, and it needs nothing else.

mod common;

use common::jobs::BLOCK_UNDER_PLATE;
use common::{Bench, Run, nagata};
use std::fs::{self, File};

const STEPS: &str = r#"
[[step]]
name = "press"
increments = 4
fix = [{ set = "block.bottom" }]
move = [{ target = "plate", by = [0.0, 0.0, -0.1] }]

[[step]]
name = "drag"
increments = 4
fix = [{ set = "block.bottom" }]
move = [{ target = "plate", by = [0.2, 0.0, 0.0] }]

[output]
history = ["block.bottom"]
"#;

fn bench() -> Bench {
    Bench::new(&format!("title = 'A <b>plate</b> & \"block\"'\n{BLOCK_UNDER_PLATE}{STEPS}"))
}

fn report(bench: &Bench, arguments: &[&str]) -> Run {
    let all: Vec<&str> = ["report"].iter().chain(arguments).copied().collect();
    nagata(&bench.path(""), 1, &all, bench.path(""))
}

/// Fails unless the tags of a page close, each within the one that it stands in, and none of them leads out of the page.
#[track_caller]
fn stands_alone(page: &str) {
    let mut open: Vec<&str> = Vec::new();
    for piece in page.split('<').skip(1) {
        let (tag, text) = piece.split_once('>').unwrap_or_else(|| panic!("`<{piece}` does not end"));
        assert!(!text.contains('>'), "`>{text}` is not escaped");
        let name = tag.split_whitespace().next().unwrap().trim_end_matches('/');
        match tag.strip_prefix('/') {
            Some(end) => assert_eq!(open.pop(), Some(end)),
            None if tag.ends_with('/') || ["!DOCTYPE", "meta", "img"].contains(&name) => {}
            None => open.push(name),
        }
        for key in ["src=\"", "href=\""] {
            let links = tag.split(key).skip(1);
            links.for_each(|link| assert!(link.starts_with('#') || link.starts_with("data:image/png"), "{tag}"));
        }
        assert!(!["script", "link", "iframe", "object"].contains(&name), "{tag}");
    }
    assert!(open.is_empty(), "{open:?}");
    assert!(!page.contains("url(") && !page.contains("@import"));
    for link in page.split("http").skip(1) {
        assert!(link.starts_with("://www.w3.org/2000/svg\""), "http{}", &link[..40]);
    }
}

/// Six significant digits, as pages have them.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap();
    let text = format!("{rounded:?}");
    text.strip_suffix(".0").unwrap_or(&text).to_string()
}

/// The numbers of the table row that begins with `head`, up to its end.
#[track_caller]
fn row(page: &str, head: &str) -> Vec<String> {
    let start = format!("<tr><th scope=\"row\">{head}</th>");
    let row = page.split(&start).nth(1).unwrap_or_else(|| panic!("no row `{head}`"));
    let cells = row.split("</tr>").next().unwrap().split("<td>").skip(1);
    cells.map(|cell| cell.split("</td>").next().unwrap().to_string()).collect()
}

#[test]
fn a_page_says_what_the_folders_say() {
    let bench = bench();
    let first = bench.solve(2, &["--report"]);
    let page = fs::read_to_string(first.out.join("report.html")).unwrap();
    assert!(first.stdout.contains("report.html"), "{}", first.stdout);
    stands_alone(&page);
    assert!(page.contains("<h1>A &lt;b&gt;plate&lt;/b&gt; &amp; &quot;block&quot;</h1>"));
    assert!(page.contains("8 elements, 27 nodes, 1 tool, 1 contact on 2 ranks\nbody `block`: hex8, neo-hookean"));
    assert!(page.contains("fix = [{ set = &quot;block.bottom&quot; }]"), "no text of the scene");
    let (history, summary) = (first.history(), first.summary());
    assert_eq!(row(&page, "state"), ["converged"]);
    assert_eq!(row(&page, "increments"), ["8"]);
    for (head, key) in [("unknowns", "dofs"), ("factorizations", "factorizations"), ("wall time, s", "wall_s")] {
        assert_eq!(row(&page, head), [summary[key].to_string()], "{head}");
    }
    assert_eq!(row(&page, "predicted, MB"), [summary["predicted"]["memory_mb"].to_string()]);
    for column in ["plate.fx", "plate.fz", "block.bottom.fz", "top.active", "top.slip"] {
        let (values, times) = (history.column(column), history.column("time"));
        let at = |better: fn(&f64, &f64) -> bool| {
            (1..values.len()).fold(0, |best, k| if better(&values[k], &values[best]) { k } else { best })
        };
        let (least, most) = (at(|a, b| a < b), at(|a, b| a > b));
        let [least_cell, _, most_cell, at_most, last] = &row(&page, column)[..] else { panic!("{column}") };
        assert_eq!(*least_cell, digits(values[least]), "{column}");
        assert_eq!([most_cell, at_most].map(String::as_str), [digits(values[most]), digits(times[most])], "{column}");
        assert_eq!(*last, digits(*values.last().unwrap()), "{column}");
    }
    assert!(page.contains("aria-label=\"Curve of plate.fx over plate.ux"));

    // A run that fails, over the first; a picture, and a column that the first does not have.
    let second = bench.run(1, &["--report", "--set", "step.drag.move.0.by=[0.0, 0.0, -3.0]"]);
    assert_eq!(second.code, 1, "{}", second.stderr);
    let page = fs::read_to_string(second.out.join("report.html")).unwrap();
    stands_alone(&page);
    assert_eq!(row(&page, "state"), ["failed"]);
    let why = second.stderr.trim().trim_start_matches("error: ");
    assert!(page.contains(&format!("<pre>{why}</pre>")), "not why: {why}");
    fs::write(second.out.join("view.png"), b"\x89PNG\r\n").unwrap();
    let read = fs::read_to_string(second.out.join("history.csv")).unwrap();
    let widened: Vec<String> = (read.lines().enumerate())
        .map(|(k, line)| if k == 0 { format!("{line},probe.t") } else { format!("{line},{k}") })
        .collect();
    fs::write(second.out.join("history.csv"), widened.join("\n") + "\n").unwrap();
    let [a, b] = [&first.out, &second.out].map(|out| out.to_str().unwrap());
    let both = report(&bench, &[a, b, "--out", "both.html"]);
    assert_eq!(both.code, 0, "{}", both.stderr);
    let page = fs::read_to_string(bench.path("both.html")).unwrap();
    stands_alone(&page);
    assert_eq!(row(&page, "state"), ["converged", "failed"]);
    assert_eq!(row(&page, "<code>step.drag.move.0.by</code>"), ["[0.2, 0.0, 0.0]", "[0.0, 0.0, -3.0]"]);
    assert!(page.contains("src=\"data:image/png;base64,iVBORw0K\""));
    let own = page.split("<strong>probe.t</strong>").nth(1).unwrap().split("</figcaption>").next().unwrap();
    assert!(own.contains(", only of") && own.contains(b) && !own.contains(a), "{own}");
}

/// What is no run, or half of one, is refused with its name; only while a run goes on may a row be half there.
#[test]
fn half_written_folders_are_told_from_running_ones() {
    let bench = bench();
    let run = bench.solve(1, &["--steps", "1"]);
    let out = run.out.to_str().unwrap();
    let history = fs::read_to_string(run.out.join("history.csv")).unwrap();
    let summary = fs::read_to_string(run.out.join("summary.json")).unwrap();
    fs::create_dir(bench.path("empty")).unwrap();
    let refused = |arguments: &[&str], words: &str| {
        let run = report(&bench, arguments);
        assert_eq!(run.code, 2, "{words}: {}", run.stderr);
        assert!(run.stderr.contains(words) && run.stderr.contains("help: "), "{}", run.stderr);
    };
    refused(&["nowhere"], "nowhere: does not exist");
    refused(&["empty"], "empty: holds no results of a run: there is no history.csv");
    refused(&[out, "--out", "history.csv"], "history.csv is not named like one");
    let half = &history[..history.len() - 9];
    fs::write(run.out.join("history.csv"), half).unwrap();
    refused(&[out], "history.csv: ends within a row");
    fs::write(run.out.join("history.csv"), history.replacen("press,2,", "press,two,", 1)).unwrap();
    refused(&[out], "history.csv: line 3: `two` is not a number");
    fs::write(run.out.join("summary.json"), &summary[..99]).unwrap();
    refused(&[out], "summary.json: ");
    assert!(!run.out.join("report.html").exists());

    fs::write(run.out.join("history.csv"), half).unwrap();
    fs::remove_file(run.out.join("summary.json")).unwrap();
    let states = [true, false].map(|runs| {
        let lock = File::create(run.out.join(".lock")).unwrap();
        if runs {
            lock.lock().unwrap();
        }
        assert_eq!(report(&bench, &[out]).code, 0);
        let page = fs::read_to_string(run.out.join("report.html")).unwrap();
        assert_eq!(row(&page, "increments"), ["3"]);
        row(&page, "state").join("")
    });
    assert_eq!(states[0], "runs: step press, 100%");
    assert!(states[1].starts_with("ended without a summary"), "{}", states[1]);
}
