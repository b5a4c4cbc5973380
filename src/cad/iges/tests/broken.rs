//! Files that are wrong: each is told, none does harm.

use super::{EXAMPLE, PART, Row, file, message_of, read};
use crate::cad;
use proptest::prelude::*;

/// The example with a part of it replaced, once; lines keep their length.
fn broken(from: &str, to: &str) -> String {
    let at = EXAMPLE.find(from).unwrap_or_else(|| panic!("no '{from}'"));
    let mut text = EXAMPLE.to_string();
    text.replace_range(at..at + to.len(), to);
    message_of(&text)
}

fn expect(text: &str, parts: &[&str]) {
    assert!(parts.iter().all(|part| text.contains(part)), "{text}");
}

#[test]
fn the_frame_of_the_file() {
    expect(&message_of(""), &["the file has no terminate section (T)"]);
    expect(
        &message_of("solid die\n"),
        &["die.igs:1:1: not a line of IGES", "| solid die", "column 73 holds the section"],
    );
    let first = EXAMPLE.lines().next().unwrap();
    expect(&message_of(&first.replace("S      1", "C      1")), &["compressed and binary IGES files are not read"]);
    let without =
        |k: usize| EXAMPLE.lines().enumerate().filter(|line| line.0 != k).map(|line| line.1).collect::<Vec<_>>();
    let count = EXAMPLE.lines().count();
    expect(&message_of(&without(count - 1).join("\n")), &["no terminate section (T)", "seems cut off"]);
    expect(&message_of(&without(count - 2).join("\n")), &["section P has 22 lines, not 23"]);
    expect(&message_of(&without(20).join("\n")), &["die.igs:21:1: this is line 14 of section D, not '15'"]);
    let lines: Vec<&str> = EXAMPLE.lines().collect();
    expect(
        &message_of(&[&lines[4..7], &lines[..4], &lines[7..]].concat().join("\n")),
        &["a section that is over goes on here"],
    );
    expect(&broken("P      5", "Q      5"), &["not a line of IGES"]);
    expect(&broken("P      5", "P      6"), &["this is line 5 of section P, not '6'"]);
    expect(&broken("S      4G      3", "S      4G      2"), &["section G has 3 lines, not 2"]);
    expect(&broken("11,0,;", "11,0, "), &["global section: there is no ';' at the end"]);
    expect(&broken("16Hflanged-hole.igs", "999Hflanged-hole.ig"), &["a string is to have 999 characters"]);
    let line = |kind: u32, form: u32| file(&[(kind, form, 0, 0, "0")]);
    let odd: Vec<String> =
        line(116, 0).lines().filter(|line| !line.ends_with("D      2")).map(str::to_string).collect();
    expect(&message_of(&odd.join("\n").replace("D      2P", "D      1P")), &["the directory ends within an entity"]);
}

#[test]
fn the_directory() {
    let entry = "     120      13       0       0       0       0";
    expect(&broken(entry, "     xyz"), &["expected the type of an entity in columns 1 to 8, found 'xyz'"]);
    expect(&broken(entry, "     122"), &["the line before has an entity of type 122, this another"]);
    expect(
        &broken(entry, "     120      99"),
        &[
            "surface of revolution (120) at D17: its parameters are said to be 1 lines from P99 on",
            "section P has 23 lines",
        ],
    );
    expect(&broken(entry, "     120      -1"), &["lines from P-1 on"]);
    expect(&broken(entry, "     120      14"), &["its parameters belong to D19 according to this line"]);
    expect(
        &broken(entry, &format!("{entry}      99")),
        &["D99, which is to transform it, is no transformation matrix (124)"],
    );
    expect(&broken(entry, &format!("{entry}       1")), &["D1, which is to transform it, is no"]);
    // The matrix at D19 transforms itself.
    let matrix = "     124      14       0       0       0       0";
    expect(&broken(matrix, &format!("{matrix}      19")), &["more than 32 matrices transform it", "circle"]);
}

#[test]
fn parameters() {
    let wall = "120,13,15,0.,6.283185307179586;";
    expect(
        &broken(wall, "122,13,15,0.,6.283185307179586;"),
        &["die.igs:50:1: surface of revolution (120) at D17: its parameters are those of a type 122"],
    );
    expect(
        &broken(wall, "120,13,15,0.,6.2831853071795x6;"),
        &["expected an angle as parameter 4, found '6.2831853071795x6'"],
    );
    expect(&broken(wall, "120,13,15,0.,1e999            ;"), &["expected an angle as parameter 4"]);
    expect(&broken(wall, "120,13,15,0.,nan              ;"), &["expected an angle as parameter 4"]);
    expect(&broken(wall, "120,13,15,0.,6.283185307179586,"), &["there is no ';' at the end of the parameters"]);
    expect(&broken(wall, "120,13,15,0.                  ;"), &["the parameters end where an angle is expected"]);
    expect(
        &broken(wall, "120,13,1.,0.,6.283185307179586;"),
        &["expected the curve to be turned as parameter 2, found '1.'"],
    );
    expect(
        &broken(wall, "120,13,12,0.,6.283185307179586;"),
        &["D12 as the curve to be turned is no entity", "odd numbers up to 29"],
    );
    expect(&broken(wall, "120,13,99,0.,6.283185307179586;"), &["D99 as the curve to be turned is no entity"]);
    expect(&broken(wall, "120,13,0 ,0.,6.283185307179586;"), &["expected the curve to be turned, found none"]);
    expect(
        &broken(wall, "120,13,17,0.,6.283185307179586;"),
        &["surface of revolution (120) at D17: not a curve that can be read"],
    );
    expect(&broken(wall, "120,3,15 ,0.,6.283185307179586;"), &["circular arc (100) at D3: not a line (110)"]);
    expect(&broken(wall, "120,13,15,7.,6.283185307179586;"), &["the angles run from 7.0 to 6.283185307179586 radians"]);
    expect(&broken(wall, "120,13,15,-1,6.283185307179586;"), &["by a full turn at most"]);
    expect(&broken("110,0.,0.,0.,0.,0.,1.", "110,0.,0.,0.,0.,0.,0."), &["the axis of a surface of revolution needs"]);
    expect(&broken("128,1,1,1,1", "128,9,1,1,1"), &["rational B-spline surface (128) at D1: knot"]);
    expect(&broken("128,1,1,1,1", "128,-1,1,1"), &["the upper index of the first sum is -1, but"]);
    expect(&broken("128,1,1,1,1", "128,1,1,0,1"), &["the degree is 0"]);
    expect(
        &broken("128,1,1,1,1", "128,999,1,1"),
        &["the upper index of the first sum is 999, but 35 parameters follow"],
    );
    expect(&broken("1.,1.,1.,1.,", "1.,1.,-1.,1,"), &["weight 3 is -1, but must be positive"]);
    expect(
        &broken("-100.,100.,-100.,100.;", "-100.,100.,-900.,100.;"),
        &["the parameter -900 to 100 leaves the knots", "allow -100 to 100"],
    );
    expect(&broken("-100.,100.,-100.,100.;", "-100.,100.,50.,-100.0;"), &["the parameter is to run from 50 to -100"]);
    expect(
        &broken("100,0.,0.,0.,10.", "100,0.,0.,0.,19."),
        &["circular arc (100) at D21: its ends are 19 and 10 away from its centre"],
    );
    expect(&broken("100,0.,0.,0.,10.,0.,0.,10.", "100,0.,0.,0.,0.,0.,0.,0.  "), &["its ends are 0 and 0 away"]);
    expect(
        &broken("124,-1.,0.,0.,60.,", "124,0.,0.,0.,60., "),
        &["transformation matrix (124) at D19: the matrix maps space on a plane"],
    );
    expect(&broken("122,27,100.,106.,-6.;", "122,27,-100.,106.,-6;"), &["the curve is moved by nothing"]);
    expect(&broken("144,1,0,1,0,9;", "144,1,2,1,0,9;"), &["2 for the outer boundary"]);
    expect(&broken("144,1,0,1,0,9;", "144,1,1,1,0,9;"), &["it has no outer boundary"]);
    expect(&broken("144,1,0,1,0,9;", "144,1,0,-1,0,;"), &["the number of inner boundaries is -1"]);
    expect(&broken("144,1,0,1,0,9;", "144,1,0,1,0,3;"), &["circular arc (100) at D3: not a curve on a surface (142)"]);
    expect(
        &broken("144,1,0,1,0,9;", "144,11,0,1,,9;"),
        &["trimmed surface (144) at D11: not a surface with parameters"],
    );
    expect(&broken("142,3,1,7,0,1;", "142,3,17,7,,1;"), &["it lies on D17, but bounds a part of D1"]);
    expect(
        &broken("142,3,1,7,0,1;", "142,3,1,9,0,1;"),
        &["curve on a surface (142) at D9: not a curve that can be read"],
    );
    expect(&broken("142,3,1,7,0,1;", "142,3,1,0,0,1;"), &["expected a curve in space, found none"]);
}

#[test]
fn surfaces_that_are_not_read() {
    let solids: [&[Row]; 5] = [
        &[(114, 0, 0, 0, "1")],
        &[(140, 0, 0, 0, "0,0,1,2.,1")],
        &[(186, 0, 0, 0, "3,1,0"), (514, 1, PART, 0, "1,5,1"), (510, 1, PART, 0, "7,0"), (192, 0, PART, 0, "1")],
        &[(308, 0, 20200, 0, "0,3Hpin,1,3"), (196, 0, PART, 0, "1,1.5"), (408, 0, 0, 0, "1,0,0,0,1")],
        &[(108, 0, 0, 0, "0,0,1,0,0")],
    ];
    let told = [
        "parametric spline surface (114) at D1: surfaces of this type are not read\n  help: write the surfaces as NURBS",
        "offset surface (140) at D1: surfaces of this type are not read",
        "manifold solid (186) at D1: surfaces of this type are not read",
        "instance of a subfigure (408) at D5: surfaces of this type",
        "plane (108) at D1: a plane without bounds is not read",
    ];
    for (entities, part) in solids.into_iter().zip(told) {
        let (cad, faults) = read("die.igs", file(entities).as_bytes()).unwrap();
        assert!(cad.faces.is_empty() && faults.len() == 1, "{part}: {}", faults.len());
        expect(&faults[0].to_string(), &[part]);
    }
    let path = [(106, 12, PART, 0, "2,3,0,0,0,1,0,0,1,1,0"), (106, 12, PART, 0, "2,3,0,0,5,1,0,5,1,1,5")];
    let text = message_of(&file(&[path[0], path[1], (118, 0, 0, 0, "1,3,0,0")]));
    expect(&text, &["ruled surface (118) at D5: no NURBS surface is exactly this one"]);
    assert_eq!(message_of(&file(&[path[0], path[1], (118, 1, 0, 0, "1,3,0,0")])), "");
    let chain = [
        path[0],
        (102, 0, PART, 0, "2,1,1"),
        (122, 0, PART, 0, "3,0,0,1."),
        (142, 0, PART, 0, "0,5,1,0,1"),
        (144, 0, 0, 0, "5,1,0,7"),
    ];
    expect(
        &message_of(&file(&chain)),
        &["tabulated cylinder (122) at D5 is made of a chain of curves and cannot be trimmed"],
    );
    let nested = [path[0], (102, 0, PART, 0, "1,5"), (102, 0, PART, 0, "1,3"), (122, 0, 0, 0, "3,0,0,1.")];
    expect(&message_of(&file(&nested)), &["a composite curve is part of another"]);
    expect(&message_of(&file(&[(102, 0, PART, 0, "0"), (122, 0, 0, 0, "1,0,0,1.")])), &["it has no curves"]);
}

#[test]
fn incomplete_files_are_read_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let load = |name: &str, text: &str, incomplete: bool| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        cad::read(&path, incomplete)
    };
    let good = [(110, 0, PART, 0, "0,0,0,1,0,0"), (122, 0, 0, 0, "1,0,0,3.")];
    let bad = [
        (114, 0, 0, 0, "1"),
        (120, 0, 0, 0, "1,1,0.,0."),
        (196, 0, 0, 0, "1"),
        (198, 0, 0, 0, "1"),
        (160, 0, 0, 0, "1"),
    ];
    let text = file(&[&good[..], &bad].concat());
    expect(
        &load("a.iges", &text, false).unwrap_err().to_string(),
        &[
            "parametric spline surface (114) at D5: surfaces of this type are not read; also not read: surface of \
             revolution (120) at D7, spherical surface (196) at D9, toroidal surface (198) at D11 and 1 more",
            "incomplete = true leaves out what cannot be read",
        ],
    );
    let cad = load("a.Igs", &text, true).unwrap();
    assert_eq!((cad.faces.len(), cad.skipped.len()), (1, 5));
    assert_eq!(cad.skipped[1], "surface of revolution (120) at D7: the angles run from 0.0 to 0.0 radians");
    let nothing = load("b.igs", &file(&bad), true).unwrap_err().to_string();
    assert!(nothing.contains("(114) at D1") && !nothing.contains("incomplete"), "{nothing}");
    expect(&load("c.igs", &file(&good[..1]), true).unwrap_err().to_string(), &["c.igs: the file has no surfaces"]);
    expect(&load("c.step", "", true).unwrap_err().to_string(), &["IGES (.igs, .iges) and Bézier patch (.bpt) files"]);
    let missing = cad::read(&folder.path().join("d.igs"), false).unwrap_err().to_string();
    expect(&missing, &["cannot read the CAD file '"]);
}

#[test]
fn entities_that_share_others_without_end_are_refused() {
    // Each of 200 surfaces moves a chain of 3000 times the same line.
    let mut entities = vec![(110, 0, PART, 0, "0,0,0,1,0,0")];
    let chain = format!("3000{}", ",1".repeat(3000));
    entities.push((102, 0, PART, 0, &chain));
    entities.extend([(122, 0, 0, 0, "3,0,0,3."); 200]);
    let (cad, faults) = read("die.igs", file(&entities).as_bytes()).unwrap();
    assert!(cad.faces.len() < 30_000);
    expect(&faults[0].to_string(), &["the entities of this file refer to each other too often"]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn mutations_do_no_harm(
        changes in proptest::collection::vec((0_usize..EXAMPLE.len(), any::<u8>(), 0_usize..4), 1..8),
        keep in 0_usize..2 * EXAMPLE.len(),
    ) {
        let mut bytes = EXAMPLE.as_bytes().to_vec();
        for (place, byte, way) in changes {
            let place = place % bytes.len().max(1);
            match way {
                0 => bytes[place] = byte,
                // Digits and delimiters leave more of the file to be understood.
                1 => bytes[place] = b"0123456789-,;. DH"[byte as usize % 17],
                2 => bytes.insert(place, byte),
                _ => drop(bytes.remove(place)),
            }
        }
        bytes.truncate(keep.max(1));
        let _ = read("die.igs", &bytes);
    }

    #[test]
    fn other_numbers_do_no_harm(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), "[0-9]{1,3}|-1|1e308|-1e308|1e-320|0|"), 1..6),
    ) {
        // Numbers of the parameters change while the frame stays whole.
        let mut lines: Vec<String> = EXAMPLE.lines().map(str::to_string).collect();
        let data: Vec<usize> = (0..lines.len()).filter(|&k| lines[k].as_bytes()[72] == b'P').collect();
        for (index, number) in changes {
            let line = &mut lines[data[index.index(data.len())]];
            let mut words: Vec<&str> = line[..64].split(',').collect();
            let place = index.index(words.len());
            words[place] = &number;
            let text = words.join(",");
            *line = format!("{:64}{}", &text[..text.len().min(64)], &line[64..]);
        }
        let _ = read("die.igs", lines.join("\n").as_bytes());
    }
}
