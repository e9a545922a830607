//! Tables as people have them: one test a kind of trouble, each with a table of its own.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may stop at the first surprise")]

#[path = "common/readings.rs"]
mod readings;

use std::fmt::Write as _;

use glam::DVec2;
use pointweave::formats::{
    ColumnChoice, ColumnRole, FormatError, NoteKind, ReadOptions, Reading, open, write_csv_like,
};
use readings::{has_places, noted, places};

/// A line a place.
fn rows(line: impl Fn(usize, DVec2) -> String) -> String {
    places().into_iter().enumerate().fold(String::new(), |mut text, (i, place)| {
        let _ = writeln!(text, "{}", line(i, place));
        text
    })
}

fn with(options: &ReadOptions, bytes: impl AsRef<[u8]>) -> Result<Reading, FormatError> {
    open(bytes.as_ref(), Some("table.csv"), options)
}

#[track_caller]
fn opened(bytes: impl AsRef<[u8]>) -> Reading {
    let shown = String::from_utf8_lossy(bytes.as_ref()).chars().take(200).collect::<String>();
    with(&ReadOptions::default(), bytes).unwrap_or_else(|error| panic!("{shown:?}: {error}"))
}

fn refused(bytes: impl AsRef<[u8]>) -> String {
    with(&ReadOptions::default(), bytes).map(|reading| reading.pattern.len()).unwrap_err().to_string()
}

/// The places are the table's, and these are its attributes and its number of classes.
#[track_caller]
fn is_whole(reading: &Reading, attributes: &[&str], classes: usize) {
    has_places(reading, attributes);
    assert_eq!(reading.pattern.class_names().len(), classes, "{:?}", reading.pattern.class_names());
}

#[track_caller]
fn silent(reading: &Reading) {
    assert!(reading.notes.is_empty(), "{:#?}", reading.notes);
}

fn comma(value: f64) -> String {
    value.to_string().replace('.', ",")
}

#[test]
fn a_first_line_names_the_separator() {
    for (sign, name) in [(';', "sep=;"), (',', "sep=,"), ('\t', "sep=\t"), ('|', "SEP=|"), (';', "\"sep=;\"")] {
        let body = rows(|_, place| format!("{}{sign}{}", place.x, place.y));
        let reading = opened(format!("{name}\r\nx{sign}y\r\n{}", body.replace('\n', "\r\n")));
        is_whole(&reading, &[], 1);
        silent(&reading);
    }
    let wrong = refused(format!("sep=;\nx;y\n{}1;oops\n", rows(|_, place| format!("{};{}", place.x, place.y))));
    assert!(wrong.contains("line 43, column 2"), "the named line counts: {wrong}");
}

#[test]
fn separators_at_the_ends_part_nothing() {
    for text in [
        rows(|_, place| format!("{},{},", place.x, place.y)),
        format!("x,y,\n{}", rows(|_, place| format!("{},{},", place.x, place.y))),
        format!("x,y,,,\n{}", rows(|_, place| format!("{},{}", place.x, place.y))),
        format!("x;y\n{}", rows(|_, place| format!("{};{};;", place.x, place.y))),
    ] {
        let reading = opened(text);
        is_whole(&reading, &[], 1);
        silent(&reading);
    }
}

#[test]
fn decimal_commas() {
    for text in [
        format!("x y\n{}", rows(|_, place| format!("{} {}", comma(place.x), comma(place.y)))),
        rows(|_, place| format!("  {}   {}", comma(place.x), comma(place.y))),
        format!("\"x\",\"y\"\n{}", rows(|_, place| format!("\"{}\",\"{}\"", comma(place.x), comma(place.y)))),
        format!("x\ty\n{}", rows(|_, place| format!("{}\t{}", comma(place.x), comma(place.y)))),
    ] {
        let reading = opened(text);
        is_whole(&reading, &[], 1);
        silent(&reading);
    }
    // Thousands leave no doubt beside a decimal point; alone they do.
    let reading = opened("x,y\n\"1,234.5\",\"2,000\"\n\"1,500\",\"3,000.25\"\n");
    assert_eq!(reading.pattern.positions(), [DVec2::new(1234.5, 2000.0), DVec2::new(1500.0, 3000.25)]);
    let doubtful = refused("x,y\n\"1,234\",\"2,000\"\n\"1,500\",\"3,000\"\n");
    assert!(doubtful.contains("line 2, column 1") && doubtful.contains("may be a decimal point"), "{doubtful}");
}

#[test]
fn minus_as_typesetters_write_it() {
    let reading = opened("x,y\n\u{2212}43.14,\u{2212}25\n\u{2212}1.5e\u{2212}1,7\n");
    assert_eq!(reading.pattern.positions(), [DVec2::new(-43.14, -25.0), DVec2::new(-0.15, 7.0)]);
    silent(&reading);
}

#[test]
fn line_ends_of_any_kind_and_mixed() {
    let text = format!("x y\n{}", rows(|_, place| format!("{} {}", place.x, place.y)));
    let last = text.trim_end();
    for text in [
        format!("{}\n", last.replace('\n', "\r")),
        text.replace('\n', "\r\n"),
        text.replacen('\n', "\r", 7).replacen('\n', "\r\n", 9),
    ] {
        is_whole(&opened(text), &[], 1);
    }
}

#[test]
fn codes_of_text() {
    let text = format!("x\ty\tclass\n{}", rows(|i, p| format!("{}\t{}\t{}", p.x, p.y, ["Érable", "Chêne"][i % 2])));
    let words = |order: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(order).collect::<Vec<u8>>();
    let (little, big) = (words(u16::to_le_bytes), words(u16::to_be_bytes));
    let marked = [b"\xff\xfe".to_vec(), little.clone()].concat();
    for bytes in [text.clone().into_bytes(), marked, little, big] {
        let reading = opened(bytes);
        is_whole(&reading, &[], 2);
        silent(&reading);
    }
    let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
    let reading = opened(latin);
    is_whole(&reading, &[], 2);
    assert_eq!(reading.pattern.class_names(), ["Érable", "Chêne"]);
    noted(&reading, NoteKind::Changed, &["0xc9", "line 2", "Windows-1252", "UTF-8"]);
}

#[test]
fn places_under_other_names() {
    for (header, swapped) in [
        ("id,Centroid X µm,Centroid Y µm", false),
        ("fid,easting,northing", false),
        ("OBJECTID,POINT_X,POINT_Y", false),
        ("tree_id,x_coord,y_coord", false),
        ("index,axis-0,axis-1", true),
        ("nr,Y [mm],X [mm]", true),
        ("Unnamed: 0,pos_x,pos_y", false),
    ] {
        let [first, second] = if swapped { [1, 0] } else { [0, 1] };
        let body = rows(|i, place| format!("{},{},{}", i + 1, place[first], place[second]));
        is_whole(&opened(format!("{header}\n{body}")), &[], 1);
    }
    let reading = opened(format!("WKT,fid\n{}", rows(|i, place| format!("\"POINT ({} {})\",{i}", place.x, place.y))));
    is_whole(&reading, &[], 1);
    // What could mean anything is not guessed.
    let words = refused("width,height\n1,2\n3,4\n");
    assert!(words.contains("width, height") && words.contains("--columns x="), "{words}");
}

#[test]
fn degrees_by_name_become_metres() {
    let text = format!("lat,lon\n{}", rows(|_, p| format!("{},{}", 60.0 + p.y * 1e-5, 10.0 + p.x * 1e-5)));
    let reading = opened(&text);
    noted(&reading, NoteKind::Changed, &["metres", "60.000", "N", "10.000", "E", "--no-projection"]);
    let extent = |reading: &Reading| {
        let low = reading.pattern.positions().iter().copied().fold(DVec2::INFINITY, DVec2::min);
        reading.pattern.positions().iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max) - low
    };
    let size = extent(&reading);
    // Half as long a degree of longitude as one of latitude, at 60° north.
    let degrees = with(&ReadOptions { keeps_degrees: true, ..ReadOptions::default() }, &text).unwrap();
    noted(&degrees, NoteKind::Changed, &["Degrees were taken as they are"]);
    let kept = extent(&degrees);
    assert!(((size.x / size.y) / (kept.x / kept.y) - 0.501).abs() < 0.002, "{size} {kept}");
    // What is written of the metres is in degrees again, at the same places.
    let again = opened(write_csv_like(&reading.pattern, &reading.origin));
    for (i, (before, after)) in reading.pattern.positions().iter().zip(again.pattern.positions()).enumerate() {
        assert!((*before - *after).length() < 1e-3, "point {i}: {before} {after}");
    }
    assert!(write_csv_like(&reading.pattern, &reading.origin).contains("\nlon,lat\n"));
    // No degrees: too far apart, or off the earth.
    silent(&opened("lon,lat\n500000,5300000\n500010,5300010\n500020,5300000\n"));
    noted(&opened("lon,lat\n-100,20\n100,50\n0,0\n"), NoteKind::Changed, &["span 200 degrees", "as they are"]);
}

#[test]
fn two_rows_of_names_and_titles_and_units() {
    let cells = rows(|i, place| format!("1,{},8{i},{},{}", i + 1, place.x, place.y));
    let reading = opened(format!(
        "Image,Image,Nuclei,Nuclei,Nuclei\nImageNumber,ObjectNumber,Area,Location_Center_X,Location_Center_Y\n{cells}"
    ));
    is_whole(&reading, &["ImageNumber", "Area"], 1);
    noted(&reading, NoteKind::LeftOut, &["line 1", "header"]);

    let body = rows(|_, place| format!("{};{};2", place.x, place.y));
    let reading = opened(format!("Plot 7, north\nx;y;height\nmm;mm;m\n{body}"));
    is_whole(&reading, &["height"], 1);
    assert_eq!(reading.origin.unit.as_deref(), Some("mm"));
    noted(&reading, NoteKind::LeftOut, &["line 1"]);

    // TrackMate: names, names for people, short names, units.
    let below = "X;Y;Height\nX;Y;h\n(µm);(µm);(m)";
    let reading = opened(format!("POSITION_X;POSITION_Y;HEIGHT\n{below}\n{body}"));
    is_whole(&reading, &["HEIGHT"], 1);
    assert_eq!(reading.origin.unit.as_deref(), Some("µm"));
    noted(&reading, NoteKind::LeftOut, &["line 2", "second header", "X, Y, Height"]);
    noted(&reading, NoteKind::LeftOut, &["line 3", "X, Y, h"]);

    let reading = opened(format!("x;y;height\nfirst;second;third\n{body}"));
    is_whole(&reading, &["height"], 1);
    noted(&reading, NoteKind::LeftOut, &["line 2", "second header", "first, second, third"]);
}

#[test]
fn files_that_were_put_together() {
    let half = |first: bool| rows(|i, p| if (i < 20) == first { format!("{},{}", p.x, p.y) } else { String::new() });
    let reading = opened(format!("x,y\n{}x,y\n{}", half(true), half(false)));
    is_whole(&reading, &[], 1);
    noted(&reading, NoteKind::LeftOut, &["repeats the header", "line 42"]);
}

#[test]
fn more_numbers_than_there_may_be_attributes() {
    let names: String = (0..15).map(|i| format!(",m{i}")).collect();
    let text = format!(" ,X,Y{names}\n{}", rows(|i, p| format!("{},{},{}{}", i + 1, p.x, p.y, ",1.5".repeat(15))));
    let reading = opened(&text);
    is_whole(&reading, &["m0", "m1", "m2", "m3", "m4", "m5", "m6", "m7"], 1);
    noted(&reading, NoteKind::LeftOut, &["7 more columns", "at most 8 attributes", "m8, m9", "m14"]);
    let chosen = vec![("b".to_owned(), "m14".to_owned()), ("a".to_owned(), "4".to_owned())];
    let columns = ColumnChoice { attributes: Some(chosen), ..ColumnChoice::default() };
    is_whole(&with(&ReadOptions { columns, ..ReadOptions::default() }, &text).unwrap(), &["b", "a"], 1);
}

#[test]
fn row_names_and_text() {
    let word = |i: usize| ["off", "on"][i % 2];
    // R's data frame as CSV, and by write.table, whose header lacks the name of the row names.
    for text in [
        format!(
            "\"\",\"x\",\"y\",\"marks\"\n{}",
            rows(|i, p| format!("\"{}\",{},{},\"{}\"", i + 1, p.x, p.y, word(i)))
        ),
        format!("\"x\" \"y\" \"marks\"\n{}", rows(|i, p| format!("\"{}\" {} {} \"{}\"", i + 1, p.x, p.y, word(i)))),
    ] {
        let reading = opened(text);
        is_whole(&reading, &[], 2);
        assert_eq!(reading.pattern.class_names(), ["off", "on"]);
        silent(&reading);
    }
    let named = opened(format!("x y marks\n{}", rows(|i, p| format!("tree{i} {} {} {}", p.x, p.y, word(i)))));
    is_whole(&named, &[], 2);
    noted(&named, NoteKind::LeftOut, &["column 1", "text"]);
    // Of several columns of text the one that is called so is the class, and the others are named.
    let text =
        format!("name,x,y,remark,species,dbh\n{}", rows(|i, p| format!("t{i},{},{},good,{},3{i}", p.x, p.y, word(i))));
    let reading = opened(&text);
    is_whole(&reading, &["dbh"], 2);
    assert_eq!(reading.origin.class.as_deref(), Some("species"));
    noted(&reading, NoteKind::LeftOut, &["2 columns", "name, remark", "--columns class="]);
    let columns = ColumnChoice { class: Some(String::new()), ..ColumnChoice::default() };
    let none = with(&ReadOptions { columns, ..ReadOptions::default() }, &text).unwrap();
    is_whole(&none, &["dbh"], 1);
    noted(&none, NoteKind::LeftOut, &["name, remark, species"]);
}

#[test]
fn running_numbers_are_no_measurements() {
    for name in ["fid", "OBJECTID", "Unnamed: 0", "GlobalNo", "tree_id"] {
        let reading =
            opened(format!("x,y,{name},dbh\n{}", rows(|i, p| format!("{},{},{},3{i}", p.x, p.y, 1000 + 3 * i))));
        is_whole(&reading, &["dbh"], 1);
        noted(&reading, NoteKind::LeftOut, &["running numbers", name]);
    }
    // A column that only counts, before the places; behind them it may measure something.
    for first in [0, 1] {
        let reading = opened(format!("k,x,y\n{}", rows(|i, p| format!("{},{},{}", i + first, p.x, p.y))));
        is_whole(&reading, &[], 1);
        noted(&reading, NoteKind::LeftOut, &["running numbers", "k"]);
    }
    is_whole(&opened(format!("x,y,k\n{}", rows(|i, p| format!("{},{},{i}", p.x, p.y)))), &["k"], 1);
    is_whole(&opened(format!(",0,1\n{}", rows(|i, p| format!("{i},{},{}", p.x, p.y)))), &[], 1);
}

#[test]
fn comments_that_are_headers_and_rows() {
    let reading = opened(format!("# id x y\n{}", rows(|i, p| format!("{}.00 {} {}", i + 1, p.x, p.y))));
    is_whole(&reading, &[], 1);
    let reading = opened(format!("# made by hand\n#x,y,height\n{}", rows(|_, p| format!("{},{},2.5", p.x, p.y))));
    is_whole(&reading, &["height"], 1);
    silent(&reading);
    // Tags and colours begin with the sign of a comment.
    let reading = opened(format!("tag,x,y\n{}", rows(|i, p| format!("#{},{},{}", 100 + i, p.x, p.y))));
    is_whole(&reading, &[], 1);
    let reading = opened(rows(|i, p| format!("#{},{},{}", ["f00", "0f0"][i % 2], p.x, p.y)));
    is_whole(&reading, &[], 2);
    let mixed = rows(|i, p| format!("{},{},{}", if i % 3 == 0 { "#t" } else { "t" }, p.x, p.y));
    is_whole(&opened(format!("colour,x,y\n{mixed}")), &[], 2);
    // A row that was taken out by the sign stays out, and that is said.
    let reading = opened(format!("x,y\n#1,2\n{}", rows(|_, p| format!("{},{}", p.x, p.y))));
    is_whole(&reading, &[], 1);
    noted(&reading, NoteKind::LeftOut, &["One row begins with #", "line 2"]);
}

#[test]
fn files_may_begin_with_how_many_points_there_are() {
    let reading = opened(format!("40\n{}", rows(|_, place| format!("{} {}", place.x, place.y))));
    is_whole(&reading, &[], 1);
    noted(&reading, NoteKind::Changed, &["40", "line 1", "number of points"]);
    let reading = opened(format!("55\n{}", rows(|_, place| format!("{} {}", place.x, place.y))));
    noted(&reading, NoteKind::Changed, &["55", "there are 40 rows"]);
}

#[test]
fn missing_values() {
    let absent = ["NA", "NaN", "", "null", "#N/A"];
    // Without a place a row is no point.
    let text = format!("x,y,class\n{}", rows(|i, p| format!("{},{},oak\n{},{},oak", p.x, p.y, absent[i % 5], p.y)));
    let reading = opened(text);
    is_whole(&reading, &[], 1);
    noted(&reading, NoteKind::LeftOut, &["40 rows without a place", "line 3"]);
    // An attribute with gaps is left out, or else the rows are.
    let text =
        format!("x,y,dbh,h\n{}", rows(|i, p| format!("{},{},{},1", p.x, p.y, if i % 20 == 6 { "NA" } else { "3.5" })));
    let reading = opened(&text);
    is_whole(&reading, &["h"], 1);
    noted(&reading, NoteKind::LeftOut, &["'dbh'", "2 values missing", "line 8"]);
    let chosen = Some(vec![("dbh".to_owned(), "dbh".to_owned())]);
    let columns = ColumnChoice { attributes: chosen, ..ColumnChoice::default() };
    let reading = with(&ReadOptions { columns, ..ReadOptions::default() }, &text).unwrap();
    assert_eq!((reading.pattern.len(), reading.pattern.attributes().len()), (38, 1));
    noted(&reading, NoteKind::LeftOut, &["2 rows without a value", "line 8"]);
    // A class that is not known is a class.
    let class = |i: usize| if i % 20 == 3 { "NA" } else { ["oak", "elm"][i % 2] };
    let reading = opened(format!("x,y,species\n{}", rows(|i, p| format!("{},{},{}", p.x, p.y, class(i)))));
    assert_eq!(reading.pattern.class_names(), ["oak", "elm", "unknown"]);
    noted(&reading, NoteKind::Changed, &["2 points have no class", "'unknown'"]);
    // A typing error in a place is none of these.
    let wrong = refused("x,y\n1,2\n3,4o\n5,6\n");
    assert!(wrong.contains("line 3, column 2") && wrong.contains("\"4o\""), "{wrong}");
}

#[test]
fn more_classes_than_there_may_be() {
    let text = format!("x,y,class\n{}", rows(|i, p| format!("{},{},c{}", p.x, p.y, if i < 20 { i } else { i % 15 })));
    let reading = opened(text);
    is_whole(&reading, &[], 16);
    assert_eq!(reading.pattern.class_names().last().map(String::as_str), Some("other"));
    assert_eq!(reading.pattern.classes().iter().filter(|&&class| class == 15).count(), 5);
    noted(&reading, NoteKind::Changed, &["20 classes", "16", "15 most frequent", "5 points", "'other'"]);
}

#[test]
fn one_name_in_two_unicode_forms_is_one_class() {
    let reading = opened(format!(
        "x,y,class\n{}",
        rows(|i, p| format!("{},{},{}", p.x, p.y, ["\u{c9}rable", "E\u{301}rable", "Hêtre"][i % 3]))
    ));
    is_whole(&reading, &[], 2);
    assert_eq!(reading.pattern.class_names(), ["Érable", "Hêtre"]);
}

#[test]
fn units_stay_with_their_columns() {
    let text = format!("x [µm],y [µm],area [µm²],radius [µm]\n{}", rows(|i, p| format!("{},{},5{i},0.5", p.x, p.y)));
    let reading = opened(text);
    is_whole(&reading, &["area [µm²]", "radius"], 1);
    assert_eq!(reading.origin.unit.as_deref(), Some("µm"));
    silent(&reading);
    let written = write_csv_like(&reading.pattern, &reading.origin);
    assert!(written.contains("\n\"x [µm]\",\"y [µm]\",\"area [µm²]\",\"radius [µm]\"\n"), "{written}");
    let again = opened(written);
    assert_eq!((&again.pattern, &again.origin), (&reading.pattern, &reading.origin));

    let mixed = opened(format!("x [m],y [m],radius [cm]\n{}", rows(|_, p| format!("{},{},9", p.x, p.y))));
    noted(&mixed, NoteKind::Odd, &["radius is in cm", "places are in m"]);
    let mixed = opened(format!("x [m],y [mm]\n{}", rows(|_, p| format!("{},{}", p.x, p.y))));
    noted(&mixed, NoteKind::Odd, &["x is in m, y in mm"]);
}

#[test]
fn columns_are_listed_and_chosen() {
    let text = format!("tree,east,up,kind\n{}", rows(|i, p| format!("t{i},{},{},{}", p.x, p.y, ["a", "b"][i % 2])));
    let refusal = with(&ReadOptions::default(), &text).unwrap_err();
    let columns: Vec<(&str, bool)> =
        refusal.columns().iter().map(|column| (column.name.as_str(), column.is_numeric)).collect();
    assert_eq!(columns, [("tree", false), ("east", true), ("up", true), ("kind", false)]);
    assert_eq!(refusal.columns()[3].examples, ["a", "b", "a"]);
    let choose = |x: &str, y: &str, class: &str| {
        let choice = ColumnChoice {
            x: Some(x.to_owned()),
            y: Some(y.to_owned()),
            class: Some(class.to_owned()),
            ..ColumnChoice::default()
        };
        with(&ReadOptions { columns: choice, ..ReadOptions::default() }, &text)
    };
    let reading = choose("east", "3", "kind").unwrap();
    is_whole(&reading, &[], 2);
    assert_eq!(reading.columns[1].role, ColumnRole::X);
    assert_eq!(reading.columns[0].role, ColumnRole::LeftOut);
    for (x, y, class, words) in [
        ("west", "up", "", &["\"west\"", "tree, east, up, kind"][..]),
        ("east", "east", "", &["\"east\"", "twice"]),
        ("tree", "up", "", &["line 2, column 1", "\"t0\"", "finite number"]),
        ("east", "5", "", &["\"5\""]),
    ] {
        let error = choose(x, y, class).unwrap_err();
        assert!(words.iter().all(|word| error.to_string().contains(word)), "{error} without {words:?}");
        assert_eq!(error.columns().len(), 4, "the columns are there to choose others");
    }
    // Without a header columns have numbers.
    let bare = rows(|i, p| format!("7.5,{},{},{i}.5", p.x, p.y));
    let columns = ColumnChoice {
        x: Some("2".to_owned()),
        y: Some("3".to_owned()),
        radius: Some("4".to_owned()),
        ..ColumnChoice::default()
    };
    let reading = with(&ReadOptions { columns, ..ReadOptions::default() }, bare).unwrap();
    is_whole(&reading, &["attribute-1", "radius"], 1);
}
