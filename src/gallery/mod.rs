//! Built-in exemplars, each a seeded generator.
//!
//! Where the process allows it an exemplar is one tile of a torus ([`Boundary::Periodic`](crate::Boundary)), so that
//! its statistics have no empty margin to learn. Only the phyllotaxis disk and the concentric circles, which have one
//! centre each, are windows.
//!
//! A link may name an entry and a seed instead of carrying points. What an entry generates is therefore fixed for
//! ever; a better picture is a new entry.

mod dashes;
mod disks;
mod figures;
mod lattices;
mod radial;
mod sample;
mod scatter;
mod things;

use glam::DVec2;

use crate::pattern::{Attribute, Domain, PointPattern};
use sample::Sample;

/// One exemplar of the gallery.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// What links, files and the command line call it, in kebab-case.
    pub name: &'static str,
    /// What a person reads.
    pub title: &'static str,
    /// One line on what it teaches.
    pub caption: &'static str,
    /// The seed of the picture shown.
    pub seed: u64,
    generate: fn(u64) -> Sample,
}

impl Entry {
    /// The exemplar for a seed; the same seed gives the same points on every machine.
    #[must_use]
    #[expect(
        clippy::expect_used,
        reason = "generators take nothing but a seed, end in Sample::tile or Sample::window, and so stay in their \
            rectangle; that their names and lists fit together is tested for every entry"
    )]
    pub fn generate(&self, seed: u64) -> PointPattern {
        let Sample { size, boundary, points, classes, attributes } = (self.generate)(seed);
        let domain = Domain::new(DVec2::ZERO, size).expect("a generator's rectangle is valid");
        let mut pattern = PointPattern::new(domain, points).expect("a generator's points are valid");
        if !classes.is_empty() {
            let names = classes.iter().map(|(name, _)| (*name).to_owned()).collect();
            let numbers = classes.iter().zip(0..).flat_map(|(&(_, count), class)| std::iter::repeat_n(class, count));
            pattern = pattern.with_classes(numbers.collect(), names).expect("a generator's classes are valid");
        }
        for (name, values) in attributes {
            let attribute = Attribute { name: name.to_owned(), values };
            pattern = pattern.with_attribute(attribute).expect("a generator's attributes are valid");
        }
        pattern.with_boundary(boundary)
    }

    /// The exemplar for the entry's own seed.
    #[must_use]
    pub fn exemplar(&self) -> PointPattern {
        self.generate(self.seed)
    }
}

/// All exemplars, in the order of the gallery: structured, stochastic, regular, then those of several classes or with
/// attributes.
#[must_use]
pub fn entries() -> &'static [Entry] {
    ENTRIES
}

/// The exemplar of this name.
#[must_use]
pub fn find(name: &str) -> Option<&'static Entry> {
    ENTRIES.iter().find(|entry| entry.name == name)
}

static ENTRIES: &[Entry] = &[
    Entry {
        name: "rings",
        title: "Rings",
        caption: "Closed rings of seven to ten points: can a synthesis close every circle it begins?",
        seed: 1,
        generate: figures::rings,
    },
    Entry {
        name: "chevrons",
        title: "Flying geese",
        caption: "Every V points the same way, so the statistics must tell up from down.",
        seed: 1,
        generate: figures::chevrons,
    },
    Entry {
        name: "nested-grids",
        title: "Nested squares",
        caption: "Order within order: squares on a grid, a dot in each, two spacings at once.",
        seed: 1,
        generate: figures::nested_grids,
    },
    Entry {
        name: "stripes",
        title: "Stripes",
        caption: "Crowded and sparse bands take turns: density itself is the structure.",
        seed: 1,
        generate: scatter::stripes,
    },
    Entry {
        name: "maze",
        title: "Maze",
        caption: "Short walls, across or upright by chance: only where they meet is there a rule.",
        seed: 1,
        generate: dashes::maze,
    },
    Entry {
        name: "parquet",
        title: "Parquet",
        caption: "Pairs of bars that change direction from tile to tile, as in a basket weave.",
        seed: 1,
        generate: dashes::parquet,
    },
    Entry {
        name: "bricks",
        title: "Bricks",
        caption: "Long courses and staggered joints: one direction runs on, the other is broken.",
        seed: 1,
        generate: dashes::bricks,
    },
    Entry {
        name: "waves",
        title: "Waves",
        caption: "Curved lines that never end: continuity beyond the reach of one neighbourhood.",
        seed: 1,
        generate: dashes::waves,
    },
    Entry {
        name: "triangles",
        title: "Triangles",
        caption: "Corners and straight sides at every angle: a shape told apart from its direction.",
        seed: 1,
        generate: figures::triangles,
    },
    Entry {
        name: "crosses",
        title: "Crosses",
        caption: "Crossing strokes in staggered rows: points with two, three and four neighbours.",
        seed: 1,
        generate: figures::crosses,
    },
    Entry {
        name: "concentric",
        title: "Concentric circles",
        caption: "A picture with one centre: a stationary method can copy its arcs, not its middle.",
        seed: 1,
        generate: radial::concentric,
    },
    Entry {
        name: "phyllotaxis",
        title: "Phyllotaxis",
        caption: "A sunflower's seeds: one rule, the golden angle, and spirals nobody drew.",
        seed: 1,
        generate: radial::phyllotaxis,
    },
    Entry {
        name: "blue-noise",
        title: "Blue noise",
        caption: "Even but without order: no two points close, no direction preferred.",
        seed: 1,
        generate: scatter::blue_noise,
    },
    Entry {
        name: "poisson-disk",
        title: "Poisson disk",
        caption: "Chance with elbow room: random darts, each refused that lands too near another.",
        seed: 1,
        generate: scatter::poisson_disk_darts,
    },
    Entry {
        name: "cluster",
        title: "Clusters",
        caption: "Children scattered about unseen parents: more close neighbours than chance allows.",
        seed: 1,
        generate: scatter::cluster,
    },
    Entry {
        name: "pairs",
        title: "Pairs",
        caption: "Even from afar, coupled up close: two scales with opposite manners.",
        seed: 1,
        generate: scatter::pairs,
    },
    Entry {
        name: "jittered-grid",
        title: "Jittered grid",
        caption: "A grid shaken until its rows are only just there: order with a known dose of chance.",
        seed: 1,
        generate: lattices::jittered_grid,
    },
    Entry {
        name: "white-noise",
        title: "White noise",
        caption: "Pure chance, the yardstick: gaps and clumps without any cause.",
        seed: 1,
        generate: scatter::uniform,
    },
    Entry {
        name: "hex",
        title: "Hexagonal lattice",
        caption: "The densest packing: six neighbours at one distance, the hardest order to get exactly right.",
        seed: 1,
        generate: lattices::hex,
    },
    Entry {
        name: "square-grid",
        title: "Square grid",
        caption: "Rows and columns: four neighbours, two directions, and every error shows.",
        seed: 1,
        generate: lattices::square_grid,
    },
    Entry {
        name: "honeycomb",
        title: "Honeycomb",
        caption: "Walls around empty cells: the holes are as regular as the points.",
        seed: 1,
        generate: lattices::honeycomb,
    },
    Entry {
        name: "attracting",
        title: "Flowers and bees",
        caption: "Two classes that attract: wherever there is a flower, two or three bees are not far.",
        seed: 1,
        generate: things::attracting,
    },
    Entry {
        name: "repelling",
        title: "Rival nests",
        caption: "Two classes that repel: one's own kind may live next door, the other kind keeps away.",
        seed: 1,
        generate: things::repelling,
    },
    Entry {
        name: "houses",
        title: "Houses among trees",
        caption: "Rows of houses, trees by chance between them: one class regular, the other not, neither alone.",
        seed: 1,
        generate: things::houses,
    },
    Entry {
        name: "grove",
        title: "Grove",
        caption: "Every tree has its size: the old keep their distance, the young gather around them.",
        seed: 1,
        generate: things::grove,
    },
    Entry {
        name: "boats",
        title: "Boats",
        caption: "Every boat turns as its river does, every second river runs back: direction goes with place.",
        seed: 1,
        generate: things::boats,
    },
    Entry {
        name: "meadow",
        title: "Meadow",
        caption: "Four classes with scale and depth: what is near is larger and stands in front.",
        seed: 1,
        generate: things::meadow,
    },
    Entry {
        name: "graded-disks",
        title: "Graded disks",
        caption: "Sizes swell and shrink from left to right: a value that depends on its place.",
        seed: 1,
        generate: disks::graded,
    },
    Entry {
        name: "packed-disks",
        title: "Packed disks",
        caption: "A few large disks, many small ones in the gaps, none overlapping: places must suit sizes.",
        seed: 1,
        generate: disks::packed,
    },
    Entry {
        name: "necklaces",
        title: "Necklaces",
        caption: "Rings of beads, each a tenth in its two neighbours, and no other overlap.",
        seed: 1,
        generate: disks::necklaces,
    },
];
