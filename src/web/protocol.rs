//! The messages between the page and its worker.
//!
//! The page pulls: it sends a [`Request`] and waits for the one [`Response`] to it. A run moves only while the page
//! asks for [`Request::Run`], so pause, cancel and back-pressure need no flags.
//!
//! Coordinates in messages are in exemplar units from the lower corner of their domain, as 32-bit floats `x, y, x, y,
//! …`: they are for drawing. Exact coordinates leave through [`Request::Export`].

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::pattern_data::PatternData;
use crate::pattern::Boundary;
use crate::run::{DEFAULT_METHOD, Event, Progress, Tool};

/// What the page asks: an object whose `type` is one of these in kebab case.
///
/// Here the variants are keys, and whoever reads a request puts its `type` there: told apart by a member among others,
/// they would have to be buffered first, at the cost of 15 kB on the wire.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", rename_all_fields = "camelCase")]
pub enum Request {
    /// What this build can do: presets, ranges, engine. Answered by [`Response::Description`].
    Describe {},
    /// Chooses what computes from now on, also for the run at hand. Answered by [`Response::Engine`].
    Engine {
        /// What the person wants.
        choice: EngineChoice,
        /// What the browser tells about its adapter; the worker fills this in.
        #[serde(default)]
        adapter: Option<AdapterView>,
    },
    /// The built-in exemplars. Answered by [`Response::Gallery`].
    Gallery {},
    /// Reads an exemplar without starting anything. Answered by [`Response::Opened`].
    Open {
        /// Where it comes from.
        exemplar: Source,
    },
    /// Prepares a run and replaces the one before; if it is refused, the one before stays. Answered by
    /// [`Response::Started`].
    Start {
        /// What to learn from.
        exemplar: Source,
        /// Name of a method.
        #[serde(default = "default_method")]
        method: String,
        /// Name of a preset.
        preset: String,
        /// Parameters that differ from the preset, under their names in files and links.
        #[serde(default)]
        overrides: Map<String, Value>,
    },
    /// Works on the run until the time is up, enough iterations are complete or everything is done, whichever comes
    /// first. Answered by [`Response::Batch`].
    Run {
        /// How long to work, in milliseconds. One piece of work is never cut short, so it may take a little longer.
        budget_ms: f64,
        /// How many iterations to complete at most; 1 is a single step.
        max_iterations: u32,
    },
    /// Moves points, holds them where they are or lets them go; points are named by their ids. Answered by
    /// [`Response::Batch`].
    Touch {
        /// Which points.
        #[serde(with = "typed_array::ids")]
        points: Vec<u32>,
        /// Where to, `x, y, x, y, …` in exemplar units; none: they stay where they are.
        #[serde(with = "typed_array::doubles")]
        positions: Vec<f64>,
        /// Whether they are held from now on.
        pinned: bool,
    },
    /// Erases what lies in a region and does it again while the rest stays. Answered by [`Response::Batch`].
    Resynthesize {
        /// Corners of a polygon, `x, y, x, y, …` in exemplar units.
        #[serde(with = "typed_array::doubles")]
        region: Vec<f64>,
    },
    /// Goes on with other parameters from the points as they are; if it is refused, the run stays as it is. Answered by
    /// [`Response::Started`].
    Continue {
        /// Name of the run's method.
        #[serde(default = "default_method")]
        method: String,
        /// Name of a preset.
        preset: String,
        /// Parameters that differ from the preset, under their names in files and links.
        #[serde(default)]
        overrides: Map<String, Value>,
    },
    /// How well the output as it stands reproduces the exemplar, in curves, numbers and words. Answered by
    /// [`Response::Analyzed`].
    Analyze {},
    /// The output to the last digit. Answered by [`Response::Exported`].
    Export {},
    /// Everything needed to continue later. Answered by [`Response::Saved`].
    Save {},
    /// Continues from a saved state. Answered by [`Response::Started`].
    Resume {
        /// What [`Response::Saved`] held.
        state: String,
    },
}

fn default_method() -> String {
    DEFAULT_METHOD.to_owned()
}

/// What a person wants to compute with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EngineChoice {
    /// The GPU where there is one that computes correctly, else the processor.
    #[default]
    Auto,
    /// The processor.
    Cpu,
    /// The GPU, even one that is only emulated.
    Gpu,
}

/// What a browser tells about its WebGPU adapter. Modules can't ask.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct AdapterView {
    /// Maker and model, as far as the browser says.
    pub name: String,
    /// Whether a processor only plays a GPU.
    pub software: bool,
}

/// Where an exemplar comes from.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "SourceMembers")]
pub enum Source {
    /// A built-in exemplar.
    Gallery {
        /// Its name.
        name: String,
    },
    /// What the person opened or drew, as numbers.
    Pattern(Box<PatternData>),
}

/// [`Source`] as the page writes it.
#[derive(Deserialize)]
struct SourceMembers {
    source: SourceKind,
    /// Of an exemplar in the gallery; what the page calls a pattern is not looked at.
    #[serde(default)]
    name: String,
    #[serde(default)]
    pattern: Option<Box<PatternData>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum SourceKind {
    Gallery,
    Pattern,
}

impl TryFrom<SourceMembers> for Source {
    type Error = &'static str;
    fn try_from(members: SourceMembers) -> Result<Self, &'static str> {
        match members.source {
            SourceKind::Gallery => Ok(Self::Gallery { name: members.name }),
            SourceKind::Pattern => members.pattern.map(Self::Pattern).ok_or("the source has no 'pattern'"),
        }
    }
}

/// What the worker answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", rename_all_fields = "camelCase")]
pub enum Response {
    /// What this build can do.
    Description {
        /// Version of the crate.
        version: String,
        /// What computes.
        engine: EngineView,
        /// The methods, in the order in which they are offered.
        methods: Vec<MethodView>,
        /// What points can be drawn as.
        glyphs: Vec<GlyphView>,
    },
    /// What computes from now on.
    Engine {
        /// What computes.
        engine: EngineView,
        /// One sentence when it is not what was wanted.
        note: Option<String>,
    },
    /// The built-in exemplars, in the order they are shown.
    Gallery {
        /// One entry an exemplar.
        entries: Vec<GalleryEntryView>,
    },
    /// An exemplar was read.
    Opened {
        /// What it holds.
        exemplar: PatternView,
        /// The same to the last digit.
        pattern: Box<PatternData>,
    },
    /// A run is ready; nothing has moved yet.
    Started {
        /// Name of the method.
        method: String,
        /// What it learns from.
        exemplar: PatternView,
        /// The points as they are now.
        output: Box<PatternView>,
        /// All parameters of the run.
        parameters: Map<String, Value>,
        /// Where the run stands.
        progress: Progress,
    },
    /// What happened since the last batch.
    Batch {
        /// What there is to tell, oldest first.
        events: Vec<Event>,
        /// Where the run stands.
        progress: Progress,
        /// The points, if they moved.
        points: Option<Points>,
        /// Iterations a second of work, on this scale, smoothed.
        iterations_per_second: Option<f64>,
        /// Seconds of work left if no scale stops early.
        seconds_left: Option<f64>,
        /// What computes now, if that has changed.
        engine: Option<EngineView>,
        /// Why it has changed, in one sentence.
        note: Option<String>,
        /// Whether there is nothing left to do.
        finished: bool,
    },
    /// The output against its exemplar. Lengths are in mean spacings d of the exemplar, frequencies in cycles per d.
    Analyzed {
        /// The exemplar's curves.
        exemplar: CurvesView,
        /// The output's, at the same distances.
        output: CurvesView,
        /// The periodograms of both sides.
        periodogram: PeriodogramView,
        /// Distances at which the pair correlations are sampled.
        #[serde(with = "typed_array::floats")]
        distance: Vec<f32>,
        /// Width of an interval of the histograms, which begin at 0.
        interval: f64,
        /// How good it is.
        quality: QualityView,
        /// What is wrong with it.
        defects: DefectsView,
        /// The same in two to four sentences.
        verdict: String,
        /// How many iterations the output has seen.
        iterations: u64,
        /// Milliseconds of work the answer took, without what is prepared once for a run: the page asks no oftener than
        /// it can afford.
        work_ms: f64,
    },
    /// The output to the last digit.
    Exported {
        /// In the exemplar's own unit.
        pattern: Box<PatternData>,
    },
    /// Everything needed to continue later.
    Saved {
        /// For [`Request::Resume`].
        state: String,
        /// Where the run stood.
        progress: Progress,
    },
    /// The request was refused; everything is as it was before.
    Error {
        /// One sentence for a person.
        message: String,
        /// Where in the file, when it is about a file.
        place: Option<Place>,
    },
}

/// What computes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct EngineView {
    /// Whether it is a GPU.
    pub gpu: bool,
    /// `CPU`, or the name of the adapter.
    pub name: String,
    /// One sentence about it.
    pub meaning: String,
}

/// A preset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct PresetView {
    /// Its name in files, links and requests.
    pub name: String,
    /// What the button says.
    pub title: String,
    /// One sentence on what to expect.
    pub meaning: String,
    /// The numbers behind it, for an exemplar that asks for nothing special.
    pub parameters: Map<String, Value>,
}

/// A method in its own words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct MethodView {
    /// Its name in files, links and requests.
    pub name: String,
    /// What the page calls it.
    pub title: String,
    /// One or two sentences on what it does.
    pub meaning: String,
    /// Quickest first.
    pub presets: Vec<PresetView>,
    /// In the order in which the page shows them within their groups.
    pub parameters: Vec<ParameterView>,
    /// What hands can do to its results.
    pub tools: Vec<Tool>,
    /// The terms of its loss.
    pub losses: Vec<LossView>,
}

/// A parameter in its own words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ParameterView {
    /// Its name in files, links and requests.
    pub name: String,
    /// What the page calls it.
    pub title: String,
    /// One sentence on what it does.
    pub meaning: String,
    /// Where on the page.
    pub place: PlaceView,
    /// The heading it stands under.
    pub group: String,
    /// Which values it may have.
    pub kind: KindView,
}

/// Where a parameter stands on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlaceView {
    /// Always in sight.
    Main,
    /// Under *Advanced*.
    Advanced,
}

/// Which values a parameter may have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum KindView {
    /// A number.
    Number {
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
        /// Whether it must be a whole number.
        whole: bool,
    },
    /// A word.
    Choice {
        /// The words.
        options: Vec<OptionView>,
    },
}

/// One of the words that a parameter may be.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OptionView {
    /// The word in files, links and requests.
    pub name: String,
    /// What the page calls it.
    pub title: String,
    /// One sentence on what it does.
    pub meaning: String,
}

/// A term of the loss.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LossView {
    /// Its name in events.
    pub name: String,
    /// What the page calls it.
    pub title: String,
}

/// A built-in exemplar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct GalleryEntryView {
    /// Its name in requests.
    pub name: String,
    /// What the page calls it.
    pub title: String,
    /// One line on what it teaches.
    pub caption: String,
    /// Its points.
    pub pattern: PatternView,
}

/// What points can be drawn as.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GlyphView {
    /// Its name in requests.
    pub name: String,
    /// Its outline as SVG path data of `M`, `L`, `C` and `Z` with absolute coordinates, in radii, y downwards. Empty for
    /// the disk and the ring, which are circles of radius 1.
    pub outline: String,
}

/// How a class looks, nothing else being chosen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClassLookView {
    /// Name of its glyph.
    pub glyph: String,
    /// Which of the eight colours.
    pub color: usize,
}

/// A pattern as the page draws it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct PatternView {
    /// Its points.
    pub points: Points,
    /// Names of the classes.
    pub class_names: Vec<String>,
    /// Their looks.
    pub looks: Vec<ClassLookView>,
    /// Width and height in exemplar units.
    pub size: [f64; 2],
    /// Lower corner in the pattern's own unit.
    pub min: [f64; 2],
    /// Length of an exemplar unit in the pattern's own unit.
    pub unit: f64,
    /// Whether it is a window or a tile.
    pub boundary: Boundary,
    /// Mean distance to the nearest neighbour in exemplar units, when there is one.
    pub spacing: Option<f64>,
}

/// Where points are and what they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Points {
    /// Names of the points, which stay theirs while others come and go; a `Uint32Array` on the page.
    #[serde(with = "typed_array::ids")]
    pub ids: Vec<u32>,
    /// `x, y, x, y, …` in exemplar units; a `Float32Array` on the page.
    #[serde(with = "typed_array::floats")]
    pub positions: Vec<f32>,
    /// Class of every point; a `Uint16Array` on the page.
    #[serde(with = "typed_array::words")]
    pub classes: Vec<u16>,
    /// Radius of every point in exemplar units; empty when the pattern gives none.
    #[serde(with = "typed_array::floats")]
    pub radii: Vec<f32>,
    /// Size of every point against the exemplar's mean; empty when the pattern gives none.
    #[serde(with = "typed_array::floats")]
    pub scales: Vec<f32>,
    /// Degrees every point is turned by, counter-clockwise as one sees it; empty when the pattern gives none.
    #[serde(with = "typed_array::floats")]
    pub turns: Vec<f32>,
    /// How far behind every point stands; empty when the pattern gives none.
    #[serde(with = "typed_array::floats")]
    pub depths: Vec<f32>,
    /// Ids of the points that are held where they are; a `Uint32Array` on the page.
    #[serde(with = "typed_array::ids")]
    pub pinned: Vec<u32>,
}

/// The statistics of one side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct CurvesView {
    /// g at each distance; 1 is chance.
    #[serde(with = "typed_array::floats")]
    pub pair_correlation: Vec<f32>,
    /// Share of the points whose nearest neighbour lies in each interval.
    #[serde(with = "typed_array::floats")]
    pub nearest: Vec<f32>,
    /// Mean distance to the nearest neighbour.
    pub spacing: f64,
    /// Frequencies of the rings of the periodogram: a larger rectangle has more.
    #[serde(with = "typed_array::floats")]
    pub frequency: Vec<f32>,
    /// Mean power of each ring; 1 is chance.
    #[serde(with = "typed_array::floats")]
    pub power: Vec<f32>,
    /// Relative radius ρ.
    pub relative_radius: f64,
}

/// The periodograms of both sides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeriodogramView {
    /// The exemplar's.
    pub exemplar: SpectrumView,
    /// The output's; a larger rectangle has closer frequencies.
    pub output: SpectrumView,
}

/// How strong every wave is, by its frequencies along x and y.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpectrumView {
    /// Columns; the middle one is the frequency 0 along x.
    pub width: usize,
    /// Rows, from the lowest frequency along y on; the middle one is 0.
    pub height: usize,
    /// Power, row after row; 1 is chance, and 0 stands in the middle.
    #[serde(with = "typed_array::floats")]
    pub power: Vec<f32>,
    /// The highest frequencies along x and y, in cycles per d.
    pub reach: [f64; 2],
}

/// [`Quality`](crate::analysis::Quality): 0 is chance, 1 the exemplar tiled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct QualityView {
    /// Mean of the three parts.
    pub score: f64,
    /// Whether pairs of points lie as in the exemplar.
    pub arrangement: f64,
    /// Whether what is there should be.
    pub detail: f64,
    /// Whether what should be is there.
    pub variety: f64,
    /// What an independent sample of a random exemplar's process would score.
    pub independent: f64,
}

/// [`Defects`](crate::analysis::Defects).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DefectsView {
    /// Share of the points that lie on others, beyond the exemplar's own.
    pub stacked: f64,
    /// Width of the largest hole over that of the exemplar's.
    pub holes: f64,
    /// Share of the points too many along an open border.
    pub border: Option<f64>,
}

/// A place in a file, both counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Place {
    /// The line.
    pub line: u64,
    /// The column, when one is known.
    pub column: Option<u64>,
}

/// Lists of numbers that become typed arrays on the page: a plain array would cost one call a number.
pub(super) mod typed_array {
    macro_rules! typed {
        ($module:ident, $number:ty, $array:ident) => {
            pub(in crate::web) mod $module {
                #[cfg(not(target_arch = "wasm32"))]
                use serde::Deserialize;
                use serde::{Deserializer, Serializer};

                #[cfg(target_arch = "wasm32")]
                pub(crate) fn serialize<S: Serializer>(list: &[$number], serializer: S) -> Result<S::Ok, S::Error> {
                    serde_wasm_bindgen::preserve::serialize(&js_sys::$array::from(list), serializer)
                }

                #[cfg(not(target_arch = "wasm32"))]
                pub(crate) fn serialize<S: Serializer>(list: &[$number], serializer: S) -> Result<S::Ok, S::Error> {
                    serializer.collect_seq(list)
                }

                #[cfg(target_arch = "wasm32")]
                pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
                    deserializer: D,
                ) -> Result<Vec<$number>, D::Error> {
                    serde_wasm_bindgen::preserve::deserialize(deserializer).map(|array: js_sys::$array| array.to_vec())
                }

                #[cfg(not(target_arch = "wasm32"))]
                pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
                    deserializer: D,
                ) -> Result<Vec<$number>, D::Error> {
                    Vec::deserialize(deserializer)
                }
            }
        };
    }
    typed!(floats, f32, Float32Array);
    typed!(doubles, f64, Float64Array);
    typed!(words, u16, Uint16Array);
    typed!(ids, u32, Uint32Array);
}

#[cfg(test)]
pub(super) mod tests {
    #![allow(clippy::unwrap_used, clippy::panic, reason = "a test may stop at the first surprise")]

    use serde::de::DeserializeOwned;
    use serde_json::json;

    use super::*;

    /// serde lists every tag of a union when it meets one that is not there: a list that can't go stale.
    pub(in crate::web) fn tags<T: DeserializeOwned>() -> Vec<String> {
        let Err(error) = serde_json::from_value::<T>(json!({ "type": "?" })) else { panic!("'?' is a tag") };
        let message = error.to_string();
        message.split('`').skip(3).step_by(2).map(str::to_owned).collect()
    }

    #[test]
    fn the_page_knows_every_message() {
        let typedefs = include_str!("../../www/common/messages.js");
        let (requests, responses) = (tags::<Request>(), tags::<Response>());
        assert!(requests.contains(&"describe".to_owned()) && requests.contains(&"resume".to_owned()), "{requests:?}");
        assert!(responses.contains(&"batch".to_owned()) && responses.contains(&"error".to_owned()), "{responses:?}");
        for tag in requests.iter().chain(&responses) {
            assert!(typedefs.contains(&format!("type: '{tag}'")), "no typedef for the message '{tag}'");
        }
        let known = requests.len() + responses.len();
        assert_eq!(typedefs.matches("@property").count(), 0, "write members inline, the test reads them there");
        let events = tags::<Event>().len() - 3; // The page never sees `working`, `waiting` and `engine-changed`.
        assert_eq!(typedefs.matches("type: '").count(), known + events, "a typedef for a message that does not exist");
    }

    #[test]
    fn fields_are_camel_case_and_tags_kebab_case() {
        let request: Request =
            serde_json::from_value(json!({ "run": { "type": "run", "budgetMs": 40, "maxIterations": 1 } })).unwrap();
        assert_eq!(request, Request::Run { budget_ms: 40.0, max_iterations: 1 });
        let request: Request = serde_json::from_value(json!({
            "start": { "exemplar": { "source": "gallery", "name": "rings" }, "preset": "fast" },
        }))
        .unwrap();
        let Request::Start { overrides, .. } = request else { panic!("not a start") };
        assert!(overrides.is_empty());
        let place = Some(Place { line: 3, column: None });
        let response = serde_json::to_value(Response::Error { message: "no".to_owned(), place }).unwrap();
        assert_eq!(response, json!({ "type": "error", "message": "no", "place": { "line": 3, "column": null } }));
    }

    #[test]
    fn an_unknown_request_is_refused() {
        assert!(serde_json::from_value::<Request>(json!({ "format-disk": {} })).is_err());
        assert!(serde_json::from_value::<Request>(json!({ "run": {} })).is_err());
    }
}
