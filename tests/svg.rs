//! Drawings as programs write them: what a person sees is what is read, and the rest is said.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail loudly")]

use std::fmt::Write as _;

use glam::DVec2;
use pointweave::formats::{Note, NoteKind, ReadOptions, Reading, open};

/// Columns and rows of the places.
const COLUMNS: usize = 8;
const ROWS: usize = 5;
const PAGE: &str = "width='800' height='500' viewBox='0 0 800 500'";

/// Forty places on a page of 800 × 500: a grid that is shaken a little, with one decimal.
fn places() -> Vec<DVec2> {
    let mut state = 7_u64;
    let mut shake = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1_u64 << 31) as f64 * 50.0
    };
    let grid = (0..COLUMNS * ROWS).map(|i| DVec2::new((i % COLUMNS) as f64, (i / COLUMNS) as f64));
    grid.map(|cell| (cell * 100.0 + 25.0 + DVec2::new(shake(), shake())) * 10.0).map(|at| at.round() / 10.0).collect()
}

/// A drawing of one element a place.
fn drawing(attributes: &str, before: &str, element: impl Fn(usize, DVec2) -> String, after: &str) -> String {
    let mut text = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' {attributes}>{before}"
    );
    for (i, at) in places().into_iter().enumerate() {
        let _ = writeln!(text, "{}", element(i, at));
    }
    text + after + "</svg>"
}

#[track_caller]
fn opened(text: &str) -> Reading {
    open(text.as_bytes(), None, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}: {text:.600}"))
}

fn refusal(text: &str) -> String {
    open(text.as_bytes(), None, &ReadOptions::default()).unwrap_err().to_string()
}

/// The points are those of `expected`, in their order.
#[track_caller]
fn are(reading: &Reading, expected: &[DVec2], tolerance: f64) {
    let found = reading.pattern.positions();
    assert_eq!(found.len(), expected.len(), "{:?}", reading.notes);
    for (at, wanted) in found.iter().zip(expected) {
        assert!(at.distance(*wanted) <= tolerance, "{at} instead of {wanted}");
    }
}

/// All forty, where they should be, all alike.
#[track_caller]
fn are_all(reading: &Reading) {
    are(reading, &places(), 1e-6);
    assert_eq!(reading.pattern.attributes(), [], "{:?}", reading.notes);
    assert_eq!(reading.pattern.class_names().len(), 1);
}

#[track_caller]
fn noted(reading: &Reading, kind: NoteKind, part: &str) {
    let is_it = |note: &Note| note.kind == kind && note.text.contains(part);
    assert!(reading.notes.iter().any(is_it), "{:?} without {part:?}", reading.notes);
}

fn circle(at: DVec2) -> String {
    format!("<circle cx='{}' cy='{}' r='6'/>", at.x, at.y)
}

fn plain(attributes: &str, before: &str, after: &str) -> Reading {
    opened(&drawing(attributes, before, |_, at| circle(at), after))
}

#[test]
fn a_share_of_the_window_is_no_page() {
    for size in ["width='100%' height='100%'", "width='100%'", "", "width='50%' height='300'", "style='width:100%'"] {
        let reading = plain(size, "", "");
        are_all(&reading);
        // What the points suggest: a little more than they take up.
        let domain = reading.pattern.domain();
        assert!(domain.size().x < 800.0, "{size}: {domain:?}");
    }
    let page = plain("width='100%' height='100%' viewBox='-10 -20 900 600'", "", "").pattern.domain();
    assert_eq!((page.min(), page.size()), (DVec2::new(-10.0, -20.0), DVec2::new(900.0, 600.0)));
}

#[test]
fn a_page_shows_what_its_aspect_ratio_leaves() {
    // Half as high as the drawing: the middle fills it.
    let slice = plain("width='800' height='250' viewBox='0 0 800 500' preserveAspectRatio='xMidYMid slice'", "", "");
    let seen: Vec<DVec2> = places().into_iter().filter(|at| (125.0..=375.0).contains(&at.y)).collect();
    are(&slice, &seen, 1e-6);
    noted(&slice, NoteKind::LeftOut, "marks outside the page were left out");
    let top = plain("width='800' height='250' viewBox='0 0 800 500' preserveAspectRatio='xMinYMin slice'", "", "");
    assert_eq!(top.pattern.domain().min(), DVec2::ZERO);
    assert!(top.pattern.positions().iter().all(|at| at.y <= 250.0));
    // Stretched in one direction: in pixels, as one sees it.
    let stretched = plain("width='800' height='250' viewBox='0 0 800 500' preserveAspectRatio='none'", "", "");
    let half: Vec<DVec2> = places().into_iter().map(|at| at * DVec2::new(1.0, 0.5)).collect();
    are(&stretched, &half, 1e-6);
    assert_eq!(stretched.pattern.domain().size(), DVec2::new(800.0, 250.0));
    // As large as fits: in the drawing's own units.
    are_all(&plain("width='80mm' height='90mm' viewBox='0 0 800 500'", "", ""));
}

#[test]
fn symbols_and_drawings_within_have_boxes() {
    let symbol = "<symbol id='dot' viewBox='0 0 100 100'><circle cx='50' cy='50' r='40'/></symbol>";
    let with_symbol = |symbol: &str, size: &str, shift: DVec2| {
        opened(&drawing(
            PAGE,
            symbol,
            |_, at| {
                let at = at - shift;
                format!("<use href='#dot' x='{}' y='{}' {size}/>", at.x, at.y)
            },
            "",
        ))
    };
    are_all(&with_symbol(symbol, "width='20' height='20'", DVec2::splat(10.0)));
    // In the middle of a wider box, at its left, at its right.
    are_all(&with_symbol(symbol, "width='40' height='20'", DVec2::new(20.0, 10.0)));
    let left = symbol.replace("viewBox", "preserveAspectRatio='xMinYMid' viewBox");
    are_all(&with_symbol(&left, "width='40' height='20'", DVec2::splat(10.0)));
    let slice = symbol.replace("viewBox", "preserveAspectRatio='xMaxYMax slice' viewBox");
    are_all(&with_symbol(&slice, "width='20' height='20'", DVec2::splat(10.0)));
    // A box cuts off what lies outside it, unless it is open.
    let outside = "<symbol id='dot'><circle cx='-5' cy='1' r='4'/><circle cx='6' cy='6' r='4'/></symbol>";
    let cut = with_symbol(outside, "width='20' height='20'", DVec2::splat(6.0));
    are_all(&cut);
    noted(&cut, NoteKind::LeftOut, "40 marks outside clip paths or the boxes of nested drawings");
    let open = outside.replace("id=", "overflow='visible' id=");
    assert_eq!(with_symbol(&open, "width='20' height='20'", DVec2::splat(6.0)).pattern.len(), 80);

    let nested = |attributes: &str, scale: DVec2| {
        let before = format!("<svg {attributes}>");
        let element = |_, at: DVec2| format!("<circle cx='{}' cy='{}' r='0.01'/>", at.x / scale.x, at.y / scale.y);
        opened(&drawing(PAGE, &before, element, "</svg>"))
    };
    let unit = DVec2::new(800.0, 500.0);
    let moved: Vec<DVec2> =
        places().into_iter().map(|at| DVec2::new(100.0, 50.0) + at * DVec2::new(0.75, 0.8)).collect();
    let none = "x='100' y='50' width='600' height='400' viewBox='0 0 1 1' preserveAspectRatio='none'";
    are(&nested(none, unit), &moved, 1e-6);
    // Stretched disks keep one size.
    assert_eq!(nested(none, unit).pattern.attributes(), []);
    let middle: Vec<DVec2> = places().into_iter().map(|at| DVec2::new(200.0, 50.0) + at / unit * 400.0).collect();
    are(&nested("x='100' y='50' width='600' height='400' viewBox='0 0 1 1'", unit), &middle, 1e-6);
    let percent: Vec<DVec2> = places().into_iter().map(|at| DVec2::new(400.0, 0.0) + at / unit * 400.0).collect();
    are(&nested("x='50%' width='50%' height='80%' viewBox='0 0 1 1'", unit), &percent, 1e-6);
    assert!(refusal(&drawing(PAGE, "<svg width='0' height='9'>", |_, at| circle(at), "</svg>")).contains("no circles"));
}

#[test]
fn css_moves_shapes_as_attributes_do() {
    let moved = |element: &dyn Fn(DVec2) -> String| {
        let style = "<style>.far{transform:translate(1000px,0)} g.back{transform:translateX(-1000px)}</style>";
        are_all(&opened(&drawing(PAGE, style, |_, at| element(at), "")));
    };
    moved(&|at| format!("<circle r='6' style='transform: translate({}px, {}px); fill: #246'/>", at.x, at.y));
    moved(&|at| format!("<circle r='6' style='transform: translateX({}px) translateY({}px)'/>", at.x, at.y));
    moved(&|at| format!("<circle r='6' style='translate: {}px {}px'/>", at.x, at.y));
    moved(&|at| {
        format!("<circle r='6' transform='translate(-5)' style='transform: matrix(1, 0, 0, 1, {}, {})'/>", at.x, at.y)
    });
    moved(&|at| format!("<circle cx='{}' cy='{}' r='6' style='transform: rotate(90deg)'/>", at.y, -at.x));
    moved(&|at| format!("<circle cx='{}' cy='{}' r='6' style='transform: rotate(0.5turn)'/>", -at.x, -at.y));
    moved(&|at| format!("<circle cx='{}' cy='{}' r='6' style='rotate: 3.141592653589793rad'/>", -at.x, -at.y));
    moved(&|at| format!("<circle cx='{}' cy='{}' r='6' style='transform: scaleY(-1)'/>", at.x, -at.y));
    moved(&|at| format!("<g class='back'><circle class='far' cx='{}' cy='{}' r='6'/></g>", at.x, at.y));
    // Tight lists of numbers.
    moved(&|at| format!("<circle cy='{}' r='6' transform='translate({}-{})'/>", 2.0 * at.y, at.x, at.y));
    moved(&|at| format!("<circle r='6' transform='matrix(1 0-0 1.0,{} {})translate(.0.0)'/>", at.x, at.y));
    // About the page's middle, the shape's own, and a place.
    moved(&|at| {
        let at = DVec2::new(800.0, 500.0) - at;
        format!(
            "<circle cx='{}' cy='{}' r='6' style='transform: rotate(180deg); transform-origin: center'/>",
            at.x, at.y
        )
    });
    moved(&|at| {
        let style = "transform: rotate(77deg) scale(3); transform-box: fill-box; transform-origin: 50% 50%";
        format!("<circle cx='{}' cy='{}' r='2' style='{style}'/>", at.x, at.y)
    });
    moved(&|at| {
        let style = "transform: scale(-1); transform-origin: 7px 9px";
        format!("<circle cx='{}' cy='{}' r='2' style='{style}'/>", 14.0 - at.x, 18.0 - at.y)
    });
    let group =
        "<g style='transform: rotate(90deg); transform-box: fill-box; transform-origin: center'><circle r='1'/></g>";
    noted(&plain(PAGE, group, ""), NoteKind::Odd, "One group turns about its own box");
    let wrong = drawing(PAGE, "", |_, _| "<circle r='6' style='transform: perspective(3px)'/>".to_owned(), "");
    assert!(refusal(&wrong).contains("\"perspective(3px)\" is not a transform"));
}

#[test]
fn entities_of_a_dtd_are_read() {
    let dtd = "<?xml version='1.0'?>\n<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\" \"svg11.dtd\" [\n\
               \t<!ENTITY ns_svg \"http://www.w3.org/2000/svg\">\n\t<!ENTITY st0 'fill:#1D71B8;'>\n\t<!ENTITY x SYSTEM 'file:///etc/hostname'>\n]>\n";
    let svg = drawing(PAGE, "", |_, at| circle(at).replace("r=", "style='&st0;' r="), "");
    let svg = svg.replacen("http://www.w3.org/2000/svg", "&ns_svg;", 1);
    are_all(&opened(&format!("{dtd}{svg}")));
    // What is outside the file is not fetched.
    let outside = format!("{dtd}{}", svg.replacen("<circle", "<title>&x;</title><circle", 1));
    assert!(
        open(outside.as_bytes(), None, &ReadOptions::default()).is_ok_and(|reading| reading.pattern.len() == 40)
            || refusal(&outside).contains("unknown entity reference")
    );
    for (dtd, words) in [
        ("<!ENTITY a 'b'><!ENTITY c '&a;&a;'>", "refer to each other"),
        (&format!("<!ENTITY a '{}'>", "b".repeat(100_000)), "make it too long"),
        (&"<!ENTITY a 'b'>".repeat(300), "too many entities"),
    ] {
        let message = refusal(&format!("<!DOCTYPE svg [{dtd}]><svg>{}</svg>", "&a;".repeat(20)));
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn what_is_cut_off_is_not_seen() {
    let left: Vec<DVec2> = places().into_iter().filter(|at| at.x <= 400.0).collect();
    let clipped =
        |clip: &str, group: &str| opened(&drawing(PAGE, &format!("{clip}<g {group}>"), |_, at| circle(at), "</g>"));
    let rect = "<clipPath id='c'><rect width='400' height='500'/></clipPath>";
    let reading = clipped(rect, "clip-path='url(#c)'");
    are(&reading, &left, 1e-6);
    noted(&reading, NoteKind::LeftOut, &format!("{} marks outside clip paths", 40 - left.len()));
    for (clip, group) in [
        (rect, "style='clip-path: url(\"#c\")'"),
        ("<defs><clipPath id='c'><path d='M0 0h400v500H0z'/></clipPath></defs>", "clip-path='url(#c)'"),
        ("<clipPath id='c'><polygon points='0,0 400,0 400,500 0,500'/></clipPath>", "clip-path='url(#c)'"),
        (
            "<clipPath id='c' transform='scale(2)'><rect width='400' height='500' transform='scale(.5)'/></clipPath>",
            "clip-path='url(#c)'",
        ),
        (
            "<rect id='r' width='200' height='500'/><clipPath id='c'><use href='#r'/><use href='#r' x='200'/></clipPath>",
            "clip-path='url(#c)'",
        ),
        (
            "<clipPath id='d'><rect width='400' height='500'/></clipPath><clipPath id='c' clip-path='url(#d)'><rect width='800' height='500'/></clipPath>",
            "clip-path='url(#c)'",
        ),
        (
            "<clipPath id='d'><rect width='400' height='500'/></clipPath><clipPath id='c'><rect width='800' height='500' clip-path='url(#d)'/></clipPath>",
            "clip-path='url(#c)'",
        ),
        (
            "<clipPath id='c'><path clip-rule='evenodd' d='M0 0h800v500H0zM400 0h400v500h-400z'/></clipPath>",
            "clip-path='url(#c)'",
        ),
    ] {
        are(&clipped(clip, group), &left, 1e-6);
    }
    // Round, by curves.
    let round: Vec<DVec2> = places().into_iter().filter(|at| at.distance(DVec2::new(400.0, 250.0)) <= 200.0).collect();
    let disk = "<clipPath id='c'><circle cx='400' cy='250' r='200'/></clipPath>";
    are(&clipped(disk, "clip-path='url(#c)'"), &round, 1e-6);
    // In the box of each mark: only the middle counts.
    let halves = drawing(
        PAGE,
        "<clipPath id='c' clipPathUnits='objectBoundingBox'><rect width='.6' height='1'/></clipPath>\
         <clipPath id='d' clipPathUnits='objectBoundingBox'><rect width='.4' height='1'/></clipPath>",
        |i, at| circle(at).replace("/>", if i < 20 { " clip-path='url(#c)'/>" } else { " clip-path='url(#d)'/>" }),
        "",
    );
    are(&opened(&halves), &places()[..20], 1e-6);
    // What is not understood is said, and what is not there does nothing.
    noted(&clipped("", "style='clip-path: inset(10px)'"), NoteKind::Odd, "One clip (by a function");
    are_all(&clipped("", "clip-path='url(#nothing)'"));
    // Of two with one id the first is meant.
    are(&clipped(&format!("{rect}<clipPath id='c'/>"), "clip-path='url(#c)'"), &left, 1e-6);
    let masked = clipped("<mask id='m'><rect width='400' height='500'/></mask>", "mask='url(#m)'");
    are_all(&masked);
    noted(&masked, NoteKind::Odd, "40 marks lie under masks");
}

#[test]
fn what_is_transparent_or_hidden_is_not_seen() {
    let target = |at: DVec2, how: &str| format!("{}<circle cx='{}' cy='{}' r='20' {how}/>", circle(at), at.x, at.y);
    for how in [
        "opacity='0'",
        "style='opacity: 0%'",
        "fill-opacity='0'",
        "fill='transparent'",
        "fill='rgba(9, 9, 9, 0)'",
        "fill='#12345600'",
        "fill='none' stroke='red' stroke-opacity='0'",
        "opacity='1e-6'",
        "opacity='.05' fill-opacity='.05'",
        "fill='url(#clear)'",
    ] {
        let before = "<linearGradient id='clear'><stop stop-opacity='0'/></linearGradient>";
        let reading = opened(&drawing(PAGE, before, |_, at| target(at, how), ""));
        are_all(&reading);
        noted(&reading, NoteKind::LeftOut, "40 shapes are transparent");
    }
    for how in ["visibility='hidden'", "style='display:none'", "class='off'"] {
        let before = "<style>.off{visibility:collapse}</style>";
        let reading = opened(&drawing(PAGE, before, |_, at| target(at, how), ""));
        are_all(&reading);
        noted(&reading, NoteKind::LeftOut, "40 hidden shapes were left out. To keep them, show their layer.");
    }
    let unpainted = opened(&drawing(PAGE, "", |_, at| target(at, "fill='none'"), ""));
    noted(&unpainted, NoteKind::LeftOut, "40 shapes without fill and stroke");
    // Of groups, too; what is half transparent is seen.
    let groups = "<g opacity='.1'><g opacity='.01'><circle cx='9' cy='9' r='6'/></g></g>";
    are_all(&plain(PAGE, groups, ""));
    are_all(&opened(&drawing(PAGE, "<g opacity='.5'>", |_, at| circle(at), "</g>")));
}

#[test]
fn of_a_switch_the_first_that_fits_is_shown() {
    let svg = drawing(
        PAGE,
        "<switch><foreignObject requiredExtensions='http://ns.adobe.com/x'/>\
         <g systemLanguage='de'><circle r='1'/></g><g>",
        |_, at| circle(at),
        "</g><g><circle cx='9' cy='9' r='6'/></g></switch>",
    );
    are_all(&opened(&svg));
}

#[test]
fn selectors_of_groups_give_classes() {
    let style = "<style>.oaks circle { fill: #2a6 } .firs > circle { fill: #a62 } #late circle + circle { fill: blue }\
                 .oaks .x:hover { fill: red } circle:nth-of-type(3n) { fill: red }</style>";
    let svg = drawing(
        PAGE,
        style,
        |i, at| {
            let group = |class: &str| format!("<g class='{class}'>{}</g>", circle(at));
            if i < 25 { group("wood oaks") } else { group("firs") }
        },
        "",
    );
    let reading = opened(&svg);
    are(&reading, &places(), 1e-6);
    assert_eq!(reading.pattern.class_names(), ["#22aa66", "#aa6622"]);
    assert_eq!(reading.pattern.classes().iter().filter(|class| **class == 0).count(), 25);
    noted(&reading, NoteKind::LeftOut, "One rule of its style sheets");
}

#[test]
fn colours_are_told_apart_by_value() {
    let same =
        ["red", "#f00", "#FF0000", "rgb(255,0,0)", "rgb(100%, 0%, 0%)", "hsl(0, 100%, 50%)", "#f00f", "currentColor"];
    let svg = |own: &str| {
        drawing(
            PAGE,
            "<g color='red'>",
            |i, at| circle(at).replace("r=", &format!("fill='{}' r=", if i % 9 == 8 { own } else { same[i % 9] })),
            "</g>",
        )
    };
    are_all(&opened(&svg("#ff0000")));
    assert_eq!(opened(&svg("rebeccapurple")).pattern.class_names(), ["#ff0000", "#663399"]);
    assert_eq!(opened(&svg("hsl(120, 100%, 25%)")).pattern.class_names(), ["#ff0000", "#008000"]);
}

#[test]
fn gradients_are_told_apart_by_their_stops() {
    let gradients = |stops: &dyn Fn(usize) -> String| {
        drawing(
            PAGE,
            "<linearGradient id='base'><stop stop-color='#fff'/><stop offset='1' style='stop-color:#27a'/></linearGradient>",
            |i, at| {
                let gradient = format!(
                    "<radialGradient id='g{i}' cx='{}' gradientUnits='userSpaceOnUse' {}</radialGradient>",
                    at.x,
                    stops(i)
                );
                gradient + &circle(at).replace("r=", &format!("style='fill:url(#g{i})' r="))
            },
            "",
        )
    };
    let one = opened(&gradients(&|_| "xlink:href='#base'>".to_owned()));
    are_all(&one);
    let copies = opened(&gradients(&|i| {
        let white = if i % 2 == 0 { "white" } else { "#ffffff" };
        format!("><stop stop-color='{white}'/><stop offset='1' stop-color='#2277aa'/>")
    }));
    are_all(&copies);
    let chain =
        opened(&gradients(&|i| format!("href='#{}'>", if i == 0 { "base".to_owned() } else { format!("g{}", i - 1) })));
    are_all(&chain);
    let two = opened(&gradients(&|i| {
        if i < 20 {
            "href='#base'>".to_owned()
        } else {
            "><stop stop-color='#fff'/><stop stop-color='red'/>".to_owned()
        }
    }));
    assert_eq!(two.pattern.class_names(), ["#ffffff-#2277aa", "#ffffff-#ff0000"]);
}

#[test]
fn circles_that_became_paths_are_circles() {
    let arcs = |at: DVec2| format!("<path d='M{} {}a6 6 0 1 1 -12 0a6 6 0 1 1 12 0Z'/>", at.x + 6.0, at.y);
    let k = 6.0 * 0.552_284_75;
    let curves = |at: DVec2| {
        format!(
            "<path transform='translate({} {})' d='M6 0C6 {k} {k} 6 0 6S-6 {k} -6 0-{k} -6 0-6 6-{k} 6 0Z'/>",
            at.x, at.y
        )
    };
    let rounded = |at: DVec2| format!("<rect x='{}' y='{}' width='12' height='12' rx='6'/>", at.x - 6.0, at.y - 6.0);
    let combined = |at: DVec2| {
        format!("<path d='M{0} {1}A6 6 0 0 1 {2} {1}A6 6 0 0 1 {0} {1}M0 0'/>", at.x - 6.0, at.y, at.x + 6.0)
    };
    for path in [&arcs as &dyn Fn(DVec2) -> String, &curves, &rounded, &combined] {
        let half = opened(&drawing(PAGE, "", |i, at| if i % 2 == 0 { circle(at) } else { path(at) }, ""));
        are_all(&half);
        noted(&half, NoteKind::Changed, "20 paths in the form of circles were taken as circles");
        let all = opened(&drawing(
            PAGE,
            "<rect width='800' height='500' fill='#eee'/>",
            |_, at| path(at),
            "<path d='M0 480H800' stroke='red'/>",
        ));
        are_all(&all);
        noted(&all, NoteKind::LeftOut, "One shape that is too large or unlike the marks");
        noted(&all, NoteKind::LeftOut, "One line was left out");
    }
    // All in one path.
    let data: String =
        places().iter().map(|at| format!("M{} {}a6,6 0 1,1-12,0a6,6 0 1,1 12,0z", at.x + 6.0, at.y)).collect();
    are_all(&opened(&format!("<svg {PAGE}><path d='{data}'/></svg>")));
    // A large one is not like the circles.
    let large = plain(PAGE, "<path d='M600 250A200 200 0 0 1 200 250A200 200 0 0 1 600 250Z'/>", "");
    are_all(&large);
    noted(&large, NoteKind::LeftOut, "One shape that is too large");
}

#[test]
fn a_rim_around_the_circles_is_no_mark() {
    let dish = plain(PAGE, "<circle cx='400' cy='250' r='240' fill='none' stroke='red'/>", "");
    are_all(&dish);
    noted(&dish, NoteKind::LeftOut, "One shape that is too large");
    // A disk of a few large ones is one of them.
    let disks =
        "<circle cx='200' cy='250' r='210'/><circle cx='600' cy='250' r='30'/><circle cx='600' cy='50' r='30'/>";
    assert_eq!(opened(&format!("<svg {PAGE}>{disks}</svg>")).pattern.len(), 3);
}

#[test]
fn marks_of_matplotlib_are_paths_in_defs() {
    // A circle rounded to six digits, as matplotlib writes it, and letters of its axes.
    let mark = "M 0 3 C 0.795609 3 1.55874 2.683901 2.12132 2.12132 C 2.683901 1.55874 3 0.795609 3 0 C 3 -0.795609 2.683901 -1.55874 2.12132 -2.12132 \
                C 1.55874 -2.683901 0.795609 -3 0 -3 C -0.795609 -3 -1.55874 -2.683901 -2.12132 -2.12132 C -2.683901 -1.55874 -3 -0.795609 -3 0 \
                C -3 0.795609 -2.683901 1.55874 -2.12132 2.12132 C -1.55874 2.683901 -0.795609 3 0 3 z";
    let before = format!(
        "<g id='patch_1'><path d='M 0 500 L 800 500 L 800 0 L 0 0 z' style='fill: #ffffff'/></g>\
         <defs><path id='tick' d='M 0 0 L 0 3.5' style='stroke: #000000'/></defs><use xlink:href='#tick' x='90' y='480'/>\
         <g id='text_1'><g transform='translate(9 9) scale(0.1 -0.1)'><defs><path id='DejaVuSans-30' d='M 9 9L 90 9L 90 90z'/></defs><use xlink:href='#DejaVuSans-30'/></g></g>\
         <defs><path id='m1' d='{mark}'/><clipPath id='p'><rect width='800' height='500'/></clipPath></defs><g clip-path='url(#p)'>"
    );
    let element = |_, at: DVec2| {
        format!("<use xlink:href='#m1' x='{}' y='{}' style='fill: #1f77b4; stroke: #1f77b4'/>", at.x, at.y)
    };
    let reading = opened(&drawing(PAGE, &before, element, "</g>"));
    are_all(&reading);
    noted(&reading, NoteKind::Changed, "40 paths in the form of circles");
    noted(&reading, NoteKind::LeftOut, "One text was left out");
    noted(&reading, NoteKind::LeftOut, "One line was left out");
    let squares = before.replace(mark, "M -3 3 L 3 3 L 3 -3 L -3 -3 z");
    let reading = opened(&drawing(PAGE, &squares, element, "</g>"));
    are_all(&reading);
    noted(&reading, NoteKind::Changed, "40 small shapes were taken as points at their centroids");
}

#[test]
fn strokes_without_length_are_dots() {
    let stroke = "fill='none' stroke='black' stroke-width='3' stroke-linecap='round'";
    for element in [
        &|at: DVec2| format!("<path d='M{} {}h0'/>", at.x, at.y) as String,
        &|at: DVec2| format!("<path d='M {} {} l 0 0'/>", at.x, at.y),
        &|at: DVec2| format!("<path d='M {} {} z'/>", at.x, at.y),
        &|at: DVec2| format!("<path d='M{0},{1}L{0},{1}'/>", at.x, at.y),
        &|at: DVec2| format!("<path d='M{} {}h.02'/>", at.x - 0.01, at.y),
        &|at: DVec2| format!("<line x1='{0}' y1='{1}' x2='{0}' y2='{1}'/>", at.x, at.y),
        &|at: DVec2| format!("<polyline points='{0},{1} {0},{1}'/>", at.x, at.y),
    ] as [&dyn Fn(DVec2) -> String; 7]
    {
        let reading = opened(&drawing(PAGE, &format!("<g {stroke}>"), |_, at| element(at), "</g>"));
        are_all(&reading);
        noted(&reading, NoteKind::Changed, "40 lines without a length were taken as dots");
    }
    // Dots of two widths have radii.
    let wide = |i: usize| if i == 0 { 6 } else { 3 };
    let element = |i, at: DVec2| format!("<path stroke-width='{}' d='M{} {}h0'/>", wide(i), at.x, at.y);
    let reading = opened(&drawing(PAGE, &format!("<g {stroke}>"), element, "</g>"));
    assert_eq!(reading.pattern.attributes()[0].values[..2], [3.0, 1.5]);
    // All in one path, beside circles.
    let data: String = places()[..20].iter().map(|at| format!("M{} {}h0", at.x, at.y)).collect();
    let circles: String = places()[20..].iter().map(|at| circle(*at).replace("r='6'", "r='1.5'")).collect();
    are_all(&opened(&format!("<svg {PAGE}><path d='{data}' {stroke}/>{circles}</svg>")));
}

#[test]
fn circles_without_a_radius_are_points() {
    for element in ["r='0' stroke='black'", "r='0'", "", "r='-1'"] {
        let svg = drawing(PAGE, "", |_, at| circle(at).replace("r='6'", element), "");
        let reading = opened(&svg);
        are_all(&reading);
        noted(
            &reading,
            NoteKind::Changed,
            "40 circles or lines without a size were taken as points. They have no radii.",
        );
    }
    let butt = |_, at: DVec2| format!("<path stroke='red' d='M{} {}h0'/>", at.x, at.y);
    are_all(&opened(&drawing(PAGE, "", butt, "")));
    let mixed = plain(PAGE, "<circle cx='9' cy='9' r='0'/>", "");
    are_all(&mixed);
    noted(&mixed, NoteKind::LeftOut, "One circle or line without a size was left out");
}

#[test]
fn small_shapes_are_marks_where_there_are_no_circles() {
    let furniture = "<rect width='800' height='500' fill='white'/><rect x='5' y='5' width='790' height='490' fill='none' stroke='black'/>\
                     <path d='M5 400H795M50 5V495' stroke='gray'/><rect x='5' y='398' width='700' height='2'/><text x='9' y='9'>a title</text>\
                     <image width='9' height='9' href='x.png'/>";
    let square = |at: DVec2| format!("<rect x='{}' y='{}' width='8' height='8'/>", at.x - 4.0, at.y - 4.0);
    let triangle = |at: DVec2| {
        format!(
            "<polygon points='{},{} {},{} {},{}'/>",
            at.x - 4.0,
            at.y + 2.0,
            at.x + 4.0,
            at.y + 2.0,
            at.x,
            at.y - 4.0
        )
    };
    let blob = |at: DVec2| {
        format!(
            "<path transform='translate({} {})' d='M-4-4C0-6 0-6 4-4C6 0 6 0 4 4C0 2 0 2-4 4C-2 0-2 0-4-4z'/>",
            at.x, at.y
        )
    };
    for (element, tolerance) in [(&square as &dyn Fn(DVec2) -> String, 1e-6), (&triangle, 1e-6), (&blob, 1.5)] {
        let reading = opened(&drawing(PAGE, furniture, |_, at| element(at), ""));
        are(&reading, &places(), tolerance);
        assert_eq!(reading.pattern.attributes(), []);
        noted(&reading, NoteKind::Changed, "40 small shapes were taken as points");
        noted(&reading, NoteKind::LeftOut, "2 shapes that are too large or unlike the marks were left out");
        noted(&reading, NoteKind::LeftOut, "lines were left out");
        noted(&reading, NoteKind::LeftOut, "One text was left out");
        noted(&reading, NoteKind::LeftOut, "One picture in it was left out");
    }
    // Disks, squares and triangles of one chart; the three swatches of its key are none.
    let mixed = |i: usize, at: DVec2| match i % 3 {
        0 => circle(at).replace("r='6'", "r='4'"),
        1 => square(at),
        _ => triangle(at),
    };
    are(&opened(&drawing(PAGE, furniture, mixed, "")), &places(), 1e-6);
    let key = "<rect x='700' y='10' width='9' height='9'/><rect x='700' y='30' width='9' height='9'/><rect x='700' y='50' width='9' height='9'/>";
    are_all(&plain(PAGE, key, ""));
    let nothing = refusal(&format!("<svg {PAGE}>{furniture}</svg>"));
    assert!(
        nothing.contains("no circles, dots or small shapes") && nothing.contains("One text was left out"),
        "{nothing}"
    );
}

#[test]
fn markers_and_what_lies_outside_the_page_are_said() {
    let marker = "<marker id='k'><circle r='1'/></marker><polyline marker-mid='url(#k)' points='1,1 50,60 99,1' fill='none' stroke='red'/>";
    let reading = plain(PAGE, marker, "<circle cx='900' cy='9' r='6'/>");
    are_all(&reading);
    noted(&reading, NoteKind::LeftOut, "One line has markers");
    noted(&reading, NoteKind::LeftOut, "One mark outside the page was left out. To keep them, enlarge the page");
}

/// As LightBurn writes it: millimetres, a page that begins elsewhere, y turned round by each circle's matrix.
#[test]
fn pages_in_millimetres_keep_their_units() {
    let page = "width='100mm' height='62.5mm' viewBox='174 -290 100 62.5'";
    let to_page = |at: DVec2| DVec2::new(174.0 + at.x / 8.0, -227.5 - at.y / 8.0);
    let element = |_, at: DVec2| {
        let at = to_page(at);
        format!("<circle transform='matrix(1,0,0,-1,{},{})' r='0.6' style='stroke:#004754;fill:none'/>", at.x, at.y)
    };
    let reading = opened(&drawing(page, "", element, ""));
    are(&reading, &places().into_iter().map(to_page).collect::<Vec<_>>(), 1e-6);
    assert_eq!(reading.pattern.domain().min(), DVec2::new(174.0, -290.0));
}

#[test]
fn elements_of_other_namespaces_are_not_drawn() {
    let other = "<x:circle xmlns:x='http://example.org/x' cx='9' cy='9' r='6'/><circle xmlns='' cx='99' cy='9' r='6'/>";
    are_all(&plain(PAGE, other, ""));
}
