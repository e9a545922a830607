//! What the names of columns say: the words of programs and surveys for places, classes and running numbers.

/// Names that hold a class, the likeliest first.
const CLASSES: [&str; 13] = [
    "class",
    "classes",
    "species",
    "category",
    "kind",
    "type",
    "group",
    "marks",
    "mark",
    "classification",
    "label",
    "cluster",
    "genus",
];
/// Words beside an x or y that leave no doubt.
const PLACE_WORDS: [&str; 29] = [
    "centroid",
    "center",
    "centre",
    "centroids",
    "coord",
    "coords",
    "coordinate",
    "coordinates",
    "position",
    "positions",
    "pos",
    "location",
    "loc",
    "place",
    "point",
    "points",
    "pt",
    "mean",
    "utm",
    "map",
    "grid",
    "spatial",
    "global",
    "local",
    "axis",
    "stage",
    "wcs",
    "image",
    "m",
];
/// Units that stand at the end of a name.
const UNITS: [&str; 24] = [
    "µm",
    "um",
    "micron",
    "microns",
    "micrometer",
    "micrometers",
    "nm",
    "mm",
    "cm",
    "dm",
    "m",
    "km",
    "px",
    "pixel",
    "pixels",
    "pix",
    "in",
    "inch",
    "ft",
    "feet",
    "deg",
    "degrees",
    "meter",
    "meters",
];
/// Running numbers by name: without blanks and signs, in small letters.
const IDENTIFIERS: [&str; 25] = [
    "id",
    "fid",
    "oid",
    "gid",
    "uid",
    "uuid",
    "ogcfid",
    "objectid",
    "globalid",
    "index",
    "idx",
    "row",
    "rowid",
    "rownames",
    "rownumber",
    "unnamed",
    "unnamed0",
    "no",
    "nr",
    "num",
    "number",
    "serial",
    "pointid",
    "featureid",
    "sno",
];

/// The one spelling of a name that may be written in several Unicode forms.
pub(super) fn normalized(name: &str) -> String {
    if name.is_ascii() { name.to_owned() } else { composed(name) }
}

/// Unicode's normalisation form C. A browser has it built in; natively a library brings its tables, which would be an eighth of
/// what a page loads to read files.
#[cfg(target_arch = "wasm32")]
fn composed(name: &str) -> String {
    js_sys::JsString::from(name).normalize("NFC").into()
}

#[cfg(not(target_arch = "wasm32"))]
fn composed(name: &str) -> String {
    unicode_normalization::UnicodeNormalization::nfc(name).collect()
}

/// A name without its unit, and the unit: `x [µm]`, `Area (mm²)`, `Centroid X µm`, `height_m`.
pub(super) fn split_unit(name: &str) -> (&str, Option<&str>) {
    let name = name.trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}')] {
        if let Some(inner) = name.strip_suffix(close)
            && let Some((base, unit)) = inner.rsplit_once(open)
            && !base.trim().is_empty()
            && !unit.trim().is_empty()
        {
            return (base.trim_end_matches([' ', '_', '/']), Some(unit.trim()));
        }
    }
    if let Some((base, unit)) = name.rsplit_once([' ', '_', '/', ','])
        && is_unit(unit)
        && !base.trim().is_empty()
    {
        return (base.trim_end_matches([' ', '_', '/', ',']), Some(unit));
    }
    (name, None)
}

/// Whether a word is a unit of length, of an area or of an angle.
pub(super) fn is_unit(word: &str) -> bool {
    // Two signs are micro: U+00B5 and U+03BC.
    let word = word.trim().trim_matches(['[', ']', '(', ')']).replace('\u{3bc}', "µ").to_lowercase();
    let plain = word.trim_end_matches(['²', '³', '2', '3', '^']);
    UNITS.contains(&plain) || word == "°"
}

/// Words of a name in small letters: parted at signs, before capitals that follow a small letter, and before digits.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut last = ' ';
    for c in name.chars() {
        if !c.is_alphanumeric() {
            last = ' ';
            continue;
        }
        let begins = !last.is_alphanumeric()
            || (c.is_uppercase() && last.is_lowercase())
            || (c.is_numeric() != last.is_numeric());
        if begins {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut() {
            word.extend(c.to_lowercase());
        }
        last = c;
    }
    words
}

/// Which coordinate a name is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    X,
    Y,
}

/// How sure a name is, the surest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sureness {
    /// `x`, and nothing else but a unit.
    Plain,
    /// `centroid-x`.
    Usual,
    /// `easting`.
    Grid,
    /// `lon`: degrees.
    Degrees,
    /// `nucleus_x`.
    Likely,
    /// `axis-1` and `axis-0`: the last axis is x.
    Array,
    /// `column` and `row`.
    Matrix,
}

/// What a name says of a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PlaceName {
    pub(super) axis: Axis,
    pub(super) sureness: Sureness,
    /// What both names of a pair have in common.
    pub(super) rest: String,
}

/// What a name says of a place, if it does; of arrays' axes nothing, as that depends on the others.
pub(super) fn place_name(name: &str) -> Option<PlaceName> {
    let (base, _) = split_unit(name);
    let mut words = words(base);
    // `x_um` as well as `x [µm]` and `um_x`.
    if words.len() > 1 {
        words.retain(|word| !(is_unit(word) && word != "m" && word != "in"));
    }
    let joined = words.concat();
    let found = |axis, sureness, rest: String| Some(PlaceName { axis, sureness, rest });
    let by_word = [
        (Sureness::Grid, &["easting", "eastings", "east", "e", "rechtswert", "ostwert", "estingx"][..], Axis::X),
        (Sureness::Grid, &["northing", "northings", "north", "n", "hochwert", "nordwert", "nordingy"], Axis::Y),
        (
            Sureness::Degrees,
            &["lon", "long", "lng", "longitude", "decimallongitude", "gpslongitude", "gpslon"],
            Axis::X,
        ),
        (Sureness::Degrees, &["lat", "latitude", "decimallatitude", "gpslatitude", "gpslat"], Axis::Y),
        (Sureness::Matrix, &["column", "col", "columns", "cols"], Axis::X),
        (Sureness::Matrix, &["row", "rows"], Axis::Y),
    ];
    for (sureness, names, axis) in by_word {
        if names.contains(&joined.as_str()) {
            return found(axis, sureness, String::new());
        }
        // `start_lon`, `utm easting`: but a single letter says nothing beside others.
        if let Some(at) = words.iter().position(|word| word.len() > 2 && names.contains(&word.as_str()))
            && sureness != Sureness::Matrix
        {
            words.remove(at);
            return found(axis, sureness.max(Sureness::Likely), words.join(" "));
        }
    }
    for (axis, letter) in [(Axis::X, "x"), (Axis::Y, "y")] {
        if joined == letter {
            return found(axis, Sureness::Plain, String::new());
        }
        if let Some(at) = words.iter().position(|word| word == letter) {
            words.remove(at);
            let usual =
                words.iter().all(|word| PLACE_WORDS.contains(&word.as_str()) || word.chars().all(char::is_numeric));
            return found(axis, if usual { Sureness::Usual } else { Sureness::Likely }, words.join(" "));
        }
        // `xcoord`, `posx`.
        let rest = joined.strip_prefix(letter).or_else(|| joined.strip_suffix(letter));
        if let Some(rest) = rest.filter(|rest| PLACE_WORDS.contains(rest)) {
            return found(axis, Sureness::Usual, rest.to_owned());
        }
    }
    None
}

/// The columns of x and y by their names, and how sure that is. Of equally sure pairs it is the first.
pub(super) fn place_columns<T: AsRef<str>>(names: &[T]) -> Option<([usize; 2], Sureness)> {
    let mut places: Vec<(usize, PlaceName)> = Vec::new();
    // Of napari and numpy: the last axis is x, the one before it y.
    let mut axes: Vec<(u32, usize)> = Vec::new();
    for (column, name) in names.iter().enumerate() {
        if let Some(place) = place_name(name.as_ref()) {
            places.push((column, place));
        } else if let [axis, number] = &words(name.as_ref())[..]
            && is_array_axis(axis)
            && let Ok(number) = number.parse()
        {
            axes.push((number, column));
        }
    }
    axes.sort_unstable();
    let mut best: Option<([usize; 2], Sureness)> = None;
    if let [.., (_, y), (_, x)] = axes[..] {
        best = Some(([x, y], Sureness::Array));
    }
    for (x, place) in places.iter().filter(|(_, place)| place.axis == Axis::X) {
        let partner = places
            .iter()
            .find(|(_, other)| other.axis == Axis::Y && other.sureness == place.sureness && other.rest == place.rest);
        if let Some((y, _)) = partner
            && best.is_none_or(|(_, sureness)| place.sureness < sureness)
        {
            best = Some(([*x, *y], place.sureness));
        }
    }
    best
}

/// What stands before the number of an array's axis: napari's and numpy's axes, scikit-image's centroids.
fn is_array_axis(word: &str) -> bool {
    matches!(word, "axis" | "dim" | "centroid")
}

/// Whether a column of this name holds places as `POINT (1 2)`.
pub(super) fn is_geometry(name: &str) -> bool {
    matches!(
        words(name).concat().as_str(),
        "wkt" | "geom" | "thegeom" | "geometry" | "wktgeom" | "shape" | "wktgeometry"
    )
}

/// How likely a column of this name holds classes, 0 the likeliest; `None` when the name says nothing of it.
pub(super) fn class_rank(name: &str) -> Option<usize> {
    let (base, _) = split_unit(name);
    CLASSES.iter().position(|class| base.eq_ignore_ascii_case(class))
}

/// Whether a column of this name holds running numbers.
pub(super) fn is_identifier(name: &str) -> bool {
    let words = words(name);
    IDENTIFIERS.contains(&words.concat().as_str())
        || words.last().is_some_and(|word| matches!(word.as_str(), "id" | "no" | "nr" | "fid" | "uuid" | "index"))
}

/// Whether a column of this name would be taken for something else than an attribute of this very name.
pub(super) fn is_telling(name: &str) -> bool {
    place_name(name).is_some()
        || words(name).first().is_some_and(|word| is_array_axis(word))
        || is_geometry(name)
        || class_rank(name).is_some()
        || is_identifier(name)
        || normalized(name) != name
        || (split_unit(name).1.is_some() && special(split_unit(name).0).is_some())
}

/// Attributes whose name means something, in the one spelling they have without a unit.
pub(super) fn special(base: &str) -> Option<&'static str> {
    use crate::pattern::{ORIENTATION_ATTRIBUTE, RADIUS_ATTRIBUTE, SCALE_ATTRIBUTE};
    [RADIUS_ATTRIBUTE, ORIENTATION_ATTRIBUTE, SCALE_ATTRIBUTE]
        .into_iter()
        .find(|name| base.trim().eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_by_name() {
        for (names, columns) in [
            (&["id", "x", "y"][..], Some([1, 2])),
            (&["Y", "X"], Some([1, 0])),
            (&["x [µm]", "y [µm]"], Some([0, 1])),
            (&["Centroid X µm", "Centroid Y µm", "Nucleus: Area µm^2"], Some([0, 1])),
            (&["AreaShape_Area", "Location_Center_X", "Location_Center_Y"], Some([1, 2])),
            (&["POINT_X", "POINT_Y"], Some([0, 1])),
            (&["xcoord", "ycoord"], Some([0, 1])),
            (&["PosX", "PosY", "PosZ"], Some([0, 1])),
            (&["XM", "YM", "X", "Y"], Some([2, 3])),
            (&["easting", "northing"], Some([0, 1])),
            (&["Latitude", "Longitude"], Some([1, 0])),
            (&["decimalLatitude", "decimalLongitude"], Some([1, 0])),
            (&["index", "axis-0", "axis-1"], Some([2, 1])),
            (&["axis-0", "axis-1", "axis-2"], Some([2, 1])),
            (&["label", "centroid-0", "centroid-1"], Some([2, 1])),
            (&["row", "column"], Some([1, 0])),
            (&["nucleus_x", "nucleus_y"], Some([0, 1])),
            (&["x_um", "y_um"], Some([0, 1])),
            (&["cell_x", "nucleus_y"], None),
            (&["x", "z"], None),
            (&["species", "height"], None),
        ] {
            assert_eq!(place_columns(names).map(|(columns, _)| columns), columns, "{names:?}");
        }
    }

    #[test]
    fn units_part_from_names() {
        assert_eq!(split_unit("x [µm]"), ("x", Some("µm")));
        assert_eq!(split_unit("Area (mm²)"), ("Area", Some("mm²")));
        assert_eq!(split_unit("Centroid X µm"), ("Centroid X", Some("µm")));
        assert_eq!(split_unit("crown_m"), ("crown", Some("m")));
        assert_eq!(split_unit("axis-1"), ("axis-1", None));
        assert_eq!(split_unit("[x]"), ("[x]", None));
        assert!(is_unit("μm") && is_unit("[mm]") && is_unit("m²") && !is_unit("oak"));
    }

    #[test]
    fn running_numbers_by_name() {
        for name in ["fid", "OBJECTID", "tree_id", "Unnamed: 0", "GlobalNo", "index", "ogc_fid"] {
            assert!(is_identifier(name), "{name}");
        }
        for name in ["dbh", "width", "casino", "nodes", "height"] {
            assert!(!is_identifier(name), "{name}");
        }
    }

    #[test]
    fn one_form_of_a_name() {
        assert_eq!(normalized("E\u{301}rable"), "Érable");
    }
}
