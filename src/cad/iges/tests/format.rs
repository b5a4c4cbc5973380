//! What the fixed ASCII format allows.

use super::{EXAMPLE, PART, edited, file, message_of, read, read_all};
use crate::surface::Face;

fn same(a: &[Face], b: &[Face]) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert_eq!((&a.surface, &a.loops), (&b.surface, &b.loops));
    }
}

#[test]
fn ends_of_lines_and_numbers_may_differ() {
    let faces = read_all(EXAMPLE);
    for end in ["\r\n", "\r"] {
        same(&read_all(&EXAMPLE.replace('\n', end)), &faces);
    }
    let short: Vec<&str> = EXAMPLE.lines().map(|line| &line[..73]).collect();
    same(&read_all(&(short.join("\n") + "\n\n  \n")), &faces);
    let long: Vec<String> = EXAMPLE.lines().map(|line| format!("{line} and more")).collect();
    same(&read_all(&long.join("\n")), &faces);
    for (from, to) in [
        ("110,50.,0.,-60.,50.,0.,-10.;", "110 , 5D1, , -6.d+01,  +50., ,-1.0E1 ;"),
        ("110,50.,0.,-60.,50.,0.,-10.;", "110,50,,-60,50.00,0,-.1e2;"),
        ("100,0.,0.,0.,10.,0.,0.,10.;", "100,,,,10.,,,10.;"),
        ("142,3,1,7,0,1;", "142,,1,7,;"),
    ] {
        same(&read_all(&edited(from, to)), &faces);
    }
}

#[test]
fn delimiters_are_declared() {
    let faces = read_all(EXAMPLE);
    let lines = EXAMPLE.lines().map(|line| match line.as_bytes()[72] {
        b'G' | b'P' => {
            format!("{}{}", line[..64].replace("1H,,1H;", "1H/?1H$").replace(',', "/").replace(';', "$"), &line[64..])
        }
        _ => line.to_string(),
    });
    let other: Vec<String> = lines.map(|line| line.replace("1H/?", "1H//")).collect();
    same(&read_all(&other.join("\n")), &faces);
    let implied = edited("1H,,1H;,12Hflanged hole,", ",,12Hflanged hole,");
    same(&read_all(&implied), &faces);
    for (given, text) in [("1H1,1H;", "'1' and ';' cannot end"), ("1H;;1H;", "';' and ';' cannot end")] {
        assert!(message_of(&edited("1H,,1H;", given)).contains(text));
    }
}

#[test]
fn strings_hold_delimiters_over_lines() {
    // The name of the file goes over the end of the line and has both delimiters in it.
    let faces = read_all(EXAMPLE);
    let first =
        edited("16Hflanged-hole.igs,11Htext editor,4Hnone,32,", "20Hwith , and ; and more,22Htext editor, that is");
    let text = first.replace("308,15,308,15,12Hflanged hole,", "v,4Hno,n,32,8,6,8,15,,        ");
    assert_eq!(read("a", text.as_bytes()).unwrap().0.unit.as_deref(), Some("mm"));
    same(&read_all(&text), &faces);
}

#[test]
fn units_have_names() {
    let unit = |text: &str| read("a", edited("2,2HMM", text).as_bytes()).unwrap().0.unit;
    assert_eq!(unit("1,1HX").as_deref(), Some("inch"));
    assert_eq!(unit("6,1HM").as_deref(), Some("m"));
    assert_eq!(unit("3,2HFM").as_deref(), Some("FM"));
    assert_eq!(unit(",").as_deref(), Some("inch"));
    assert_eq!(unit("99,").as_deref(), None);
    assert!(message_of(&edited("2,2HMM", "x,")).contains("parameter 14 is not the flag of a unit"));
}

#[test]
fn what_is_no_surface_is_passed_over() {
    let group = [
        (110, 0, PART, 0, "0,0,0,1,0,0"),
        (122, 0, PART, 0, "1,0,0,3."),
        (314, 0, 0, 0, "100.,0.,0.,3Hred"),
        (402, 7, 0, 0, "1,3"),
        (116, 0, 0, 0, "1,2,3"),
        (212, 0, 10100, 0, "1,4,1.,1.,1,0.,0.,0,0,1,2,3,4Htext"),
        (108, 0, PART, 0, "0,0,1,0,0,0,0,0,0"),
        (308, 0, 20200, 0, "0,5Hbolt;,1,11"),
        (408, 0, 0, 0, "15,0,0,0,1"),
        (0, 0, 0, 0, "0"),
    ];
    let faces = read_all(&file(&group));
    assert_eq!(faces.iter().map(|face| face.name.as_str()).collect::<Vec<_>>(), ["tabulated cylinder (122) at D3"]);
}
