//! What hostile files and links may take of memory, whatever they hold and claim.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail loudly")]

#[path = "common/decoders.rs"]
mod decoders;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use pointweave::formats::link::read_link;
use pointweave::formats::{MAX_BYTES, ReadOptions, open};

static NOW: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

struct Counting;

#[expect(unsafe_code, reason = "an allocator that counts has to pass on to the system's")]
// SAFETY: every call is passed on unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = NOW.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        PEAK.fetch_max(now, Ordering::Relaxed);
        // SAFETY: the caller's promise is the system allocator's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What the largest file may take: a browser gives a page several times as much.
const MOST: usize = 400_000_000;

/// Most bytes in use at once while something runs, beyond those before it.
fn peak(run: impl FnOnce()) -> usize {
    let before = NOW.load(Ordering::Relaxed);
    PEAK.store(before, Ordering::Relaxed);
    run();
    PEAK.load(Ordering::Relaxed) - before
}

/// Repeated up to a length that a file may just have.
fn filled(start: &str, piece: &str, end: &str, length: usize) -> Vec<u8> {
    let count = (length - start.len() - end.len()) / piece.len();
    [start, &piece.repeat(count), end].concat().into_bytes()
}

/// As many rules as there may be, for as many elements.
fn rules_for_all() -> Vec<u8> {
    let sheet = filled("<svg><style>", "* > * g, * + g{r:1}", "</style>", 50_000);
    filled(&String::from_utf8(sheet).unwrap(), "<g/>", "</svg>", 1_600_000)
}

/// A path of the most bytes that is shown as often as may be.
fn shown_again() -> Vec<u8> {
    let start = "<svg><defs><path id='a' d='M0 0";
    let path = filled(start, "h1v1c1 1 1 1 1 1z", "'/></defs>", 1_000_000);
    filled(&String::from_utf8(path).unwrap(), "<use href='#a'/>", "</svg>", 6_000_000)
}

/// A clip path of a megabyte, and as many marks as there may be that are cut by it.
fn clipped(start: &str, piece: &str, end: &str) -> Vec<u8> {
    let clip = filled(&format!("<svg>{start}"), piece, end, 1_000_000);
    let clip = String::from_utf8(clip).unwrap();
    filled(&format!("{clip}<g clip-path='url(#c)'>"), "<circle cx='2' cy='3' r='1'/>", "</g></svg>", 6_000_000)
}

fn npy(shape: &str) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), &[0; 64]].concat()
}

/// A PNG that claims to be this large and holds nothing.
fn png(width: u32, height: u32) -> Vec<u8> {
    let chunk = |kind: &[u8], data: &[u8]| {
        let body = [kind, data].concat();
        let mut crc = u32::MAX;
        for &byte in &body {
            crc ^= u32::from(byte);
            for _ in 0..8 {
                crc = crc >> 1 ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 };
            }
        }
        [&(data.len() as u32).to_be_bytes()[..], &body, &(!crc).to_be_bytes()].concat()
    };
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[8, 6, 0, 0, 0]].concat();
    let data = miniz_oxide::deflate::compress_to_vec_zlib(&[0; 1000], 9);
    [b"\x89PNG\r\n\x1a\n", &chunk(b"IHDR", &header)[..], &chunk(b"IDAT", &data), &chunk(b"IEND", &[])].concat()
}

/// An archive of lists of 20 000 single bytes: more cells than any other array has.
fn lists(count: usize) -> Vec<u8> {
    let header = "{'descr': '|u1', 'fortran_order': False, 'shape': (20000,), }";
    let list =
        [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), &[200; 20_000]].concat();
    let names: Vec<String> = (0..count)
        .map(|i| ["x".to_owned(), "y".to_owned()].get(i).cloned().unwrap_or(format!("a{i}")) + ".npy")
        .collect();
    let files: Vec<(&str, &[u8])> = names.iter().map(|name| (name.as_str(), &list[..])).collect();
    decoders::zip::zip(&files, decoders::zip::Packed::Deflated)
}

/// An archive of one array of zeros, whose directory says this of its size.
fn bomb(length: usize, claimed: u32) -> Vec<u8> {
    let header = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({}, 2), }}", length / 2);
    let zeros = vec![0; length];
    let array = [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), &zeros].concat();
    let mut bytes = decoders::zip::zip(&[("points.npy", &array)], decoders::zip::Packed::Deflated);
    let size = bytes.len() - 22 - "points.npy".len() - 46 + 24;
    bytes[size..size + 4].copy_from_slice(&claimed.to_le_bytes());
    bytes
}

#[test]
fn no_file_and_no_link_takes_more_than_its_share() {
    let long = MAX_BYTES;
    for (name, bytes) in [
        ("commas", filled("", ",", "", 9_000)),
        ("rows", filled("x,y\n", "1,2\n", "", long)),
        ("columns", filled("", "1 ", "", 9_000)),
        ("wide rows", filled("", &format!("{}1\n", "1,".repeat(900)), "", long)),
        ("wide words", filled("", &format!("a{}\n", " a".repeat(900)), "", long)),
        ("distinct words", {
            let rows: String = (0..).map(|i| format!("{i:08x},")).take(long / 9 - 3000).collect();
            let cells: Vec<&str> = rows.split_inclusive(',').collect();
            cells.chunks(1000).take(19_000).map(|row| row.concat() + "\n").collect::<String>().into_bytes()
        }),
        ("UTF-16", [b"\xff\xfe".to_vec(), filled("", "1\0,\0\x32\0\n\0", "", long - 2)].concat()),
        ("Latin-1", [filled("x,y,class\n", "1,2,a\n", "", long - 8), b"1,2,\xe9".to_vec()].concat()),
        ("commented rows", filled("t,x,y\n", "#a,1,2\n", "", long)),
        ("blank rows", filled("", "\n", "", long)),
        ("quotes", filled("x,y\n\"", "\n", "", long)),
        ("lists", filled("[", "[],", "0]", long)),
        ("numbers", filled("[", "0,", "0]", long)),
        ("nested lists", filled("", "[", "", long)),
        ("points", filled("[", "[0,1],", "[0,1]]", long)),
        ("objects", filled("[", "{\"x\":1},", "{}]", long)),
        ("positions", filled("{\"positions\":[", "[0,1],", "[0,1]]}", long)),
        ("values", filled("", "1\n", "", long)),
        ("features", filled("{\"type\":\"FeatureCollection\",\"features\":[", "{\"\":{}},", "0]}", long)),
        // As many as are looked at, of the dearest kinds.
        ("most lists", filled("[", "[],", "0]", 8_999_000)),
        ("most points", filled("[", "[0,1],", "[0,1]]", 8_999_000)),
        ("most positions", filled("{\"positions\":[", "[0,1],", "[0,1]]}", 8_999_000)),
        ("most objects", filled("[", "{\"x\":1},", "{}]", 1_590_000)),
        ("most features", filled("{\"type\":\"FeatureCollection\",\"features\":[", "{\"\":{}},", "0]}", 790_000)),
        ("lines of objects", filled("", "{\"x\":1}\n", "", long)),
        ("lines of points", filled("", "[0,1]\n", "", 8_999_000)),
        ("separators", filled("", "\u{1e}", "", long)),
        ("members", {
            let records = (0..19_000).map(|i| format!("{{\"x\":1,\"y\":{i},\"m{i}\":1}}\n"));
            records.collect::<String>().into_bytes()
        }),
        ("polygons", {
            let polygon = "{\"type\":\"Polygon\",\"coordinates\":[[[-9,-9],[9,-9],[9,9],[-9,9]]]}\n";
            filled("", polygon, "{\"type\":\"Point\",\"coordinates\":[1,2]}", long)
        }),
        ("corners", {
            let points =
                (0..9000).map(|i| format!("{{\"type\":\"Point\",\"coordinates\":[{i},1]}}\n")).collect::<String>();
            let ring = "[0,0],[9000,0],[9000,9],[0,9],".repeat(2400);
            let polygon = format!("{{\"type\":\"Polygon\",\"coordinates\":[[{ring}[0,0]]]}}\n");
            (points + &polygon.repeat(40)).into_bytes()
        }),
        ("elements", filled("<svg>", "<g/>", "</svg>", long)),
        ("circles", filled("<svg>", "<circle r='1'/>", "</svg>", long)),
        ("texts", filled("<svg>", "a<a/>", "</svg>", long)),
        ("attributes", filled("<svg>", "<g a='' b='' c='' d=''/>", "</svg>", long)),
        ("rules", filled("<svg><style>", ".a{r:1}", "</style></svg>", long)),
        ("selectors", filled("<svg><style>", ".a,", "b{r:1}</style></svg>", long)),
        ("selectors for all", filled("<svg><style>", "* *,", "b{r:1}</style><g><g/></g></svg>", long)),
        (
            "deep selectors",
            filled("<svg><style>g g g g g g g g g g{r:1}</style>", "<g><g><g/></g></g>", "</svg>", 2_200_000),
        ),
        ("rules for all", rules_for_all()),
        ("most elements", filled("<svg>", "<g/>", "</svg>", 1_590_000)),
        ("most circles", filled("<svg>", "<circle r='1'/>", "</svg>", 5_990_000)),
        ("most texts", filled("<svg>", "a<a/>", "</svg>", 990_000)),
        ("most attributes", filled("<svg>", "<g a='' b='' c='' d=''/>", "</svg>", 9_590_000)),
        ("path", filled("<svg><path d='M0 0", "h0l1 1c1 1 1 1 1 1z", "'/></svg>", long)),
        ("dots", filled("<svg><path stroke='red' stroke-linecap='round' d='", "M1 1z", "'/></svg>", long)),
        ("arcs", filled("<svg><path d='M0 0", "a9e9 9e9 0 1 1 1 1", "z'/></svg>", long)),
        ("polygon", filled("<svg><polygon points='", "1,2 ", "'/></svg>", long)),
        ("path shown again", shown_again()),
        ("clip path", clipped("<clipPath id='c'><path d='M0 0", "c1 1 1 1 1 9", "z'/></clipPath>")),
        ("clip paths", clipped("<clipPath id='c' clip-path='url(#c)'>", "<circle r='9'/>", "</clipPath>")),
        (
            "gradients",
            filled("<svg>", "<linearGradient id='a' href='#a'/><circle fill='url(#a)' r='1'/>", "</svg>", long),
        ),
        (
            "stops",
            filled(
                "<svg><circle fill='url(#a)' r='1'/><radialGradient id='a'>",
                "<stop/>",
                "</radialGradient></svg>",
                2_500_000,
            ),
        ),
        ("entities", filled("<!DOCTYPE svg [<!ENTITY a 'bbbbbbbbbbbbbbbbbbbbbbbbbbb'>]><svg>", "&a;", "</svg>", long)),
        ("long entity", filled("<!DOCTYPE svg [<!ENTITY a '", "b", "'>]><svg>&a;&a;&a;</svg>", long)),
        ("entity in entity", filled("<!DOCTYPE svg [<!ENTITY a 'b'><!ENTITY c '", "&a;", "'>]><svg>&c;</svg>", long)),
        ("declarations", filled("<!DOCTYPE svg [", "<!ENTITY a 'b'>", "]><svg>&a;</svg>", long)),
        ("comments", filled("<svg><style>", "/**/", "</style></svg>", long)),
        ("npz lists", lists(64)),
        ("npz entries", decoders::zip::zip(&vec![("a", &b""[..]); 9_000], decoders::zip::Packed::Stored)),
        ("npz arrays", decoders::zip::zip(&vec![("a.npy", &b""[..]); 9_000], decoders::zip::Packed::Stored)),
        ("npz many entries", decoders::zip::zip(&vec![("a.npy", &b""[..]); 60_000], decoders::zip::Packed::Stored)),
        ("npz bomb", bomb(100_000_000, 19_999_999)),
    ] {
        let start = std::time::Instant::now();
        let used = peak(|| drop(open(&bytes, None, &ReadOptions::default())));
        println!("{name:<18}{:>10} bytes{used:>12} of memory{:>8.2} s", bytes.len(), start.elapsed().as_secs_f64());
        assert!(used <= MOST, "{name}: {used} bytes of memory for {}", bytes.len());
    }
    // What claims to be large and is not.
    for (name, bytes) in [
        ("NumPy rows", npy("(18446744073709551615, 2)")),
        ("NumPy columns", npy("(1, 4611686018427387904)")),
        ("NumPy turned", npy("(2, 4611686018427387904)")),
        ("NumPy axes", npy(&format!("({})", "4294967295, ".repeat(700)))),
        ("npz honest bomb", bomb(100_000_000, 100_000_087)),
        ("npz lying bomb", bomb(100_000_000, 100)),
        ("PNG sides", png(u32::MAX >> 1, u32::MAX >> 1)),
        ("PNG width", png(u32::MAX >> 1, 1)),
    ] {
        let used = peak(|| drop(open(&bytes, None, &ReadOptions::default())));
        println!("{name:<16}{:>10} bytes{used:>12} of memory", bytes.len());
        assert!(used < 1_000_000, "{name}: {used} bytes of memory");
    }
    // The longest link, of what deflate makes the most of.
    let zeros = miniz_oxide::deflate::compress_to_vec(&vec![0; 20_000_000], 9);
    for (name, points) in
        [("zeros", decoders::base64url(&zeros[..24_000.min(zeros.len())])), ("letters", "A".repeat(32_000))]
    {
        let fragment = format!("v=1&points={points}");
        let used = peak(|| drop(read_link(&fragment)));
        println!("{name:<16}{:>10} bytes{used:>12} of memory", fragment.len());
        assert!(used < 2_000_000, "{name}: {used} bytes of memory");
    }
    let million = peak(|| drop(std::hint::black_box(vec![1_u8; 1_000_000])));
    assert!(million >= 1_000_000, "what is counted is counted");
}
