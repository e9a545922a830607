//! 7 × 7 convolutions with stride 1 or 2, forward and with respect to their input, by Fourier transforms of tiles.
//!
//! `y[o] = Σ_k w[k] · x[stride · o + k − 3]` (Huang et al. 2022, §4.2; zero padding 3, or wrapping in a periodic
//! domain), for all pairs of channels. The input is cut into tiles of N × N pixels that overlap by 6 (overlap-save);
//! in the Fourier domain the sum over the kernel becomes one complex product of matrices per frequency. Against the
//! 49 products per output and channel pair of the direct sum that is 5.8 for N = 16 and 3.2 for N = 32.
//!
//! A strided convolution needs every second output only: folding the spectrum onto its lower half is subsampling, so
//! the inverse transform has N/2 points. Its gradient starts from zeros between samples, whose spectrum repeats: the
//! forward transform has N/2 points.
//!
//! Layouts: images `[height, width, channels]`, channels padded to [`LANES`]; transformed tiles
//! `[block of ROWS tiles, eight channels, frequency, tile of the block, re | im, channel]`, products
//! `[row of frequencies, tile, eight channels, column of frequencies, re | im, channel]`. Every parallel task thus
//! writes one contiguous piece; the product finds its left operand as it wants it, and the inverse transform finds a row
//! of frequencies in one piece.
//!
//! Long because: transform, product and inverse share their layouts and are inlined into one another; apart, an iteration
//! is slower.

#![expect(clippy::needless_range_loop, reason = "the index runs over several arrays at once, as in the formulas")]

use crate::pattern::Boundary;

use super::lanes::{self, Kernel, LANES, Lanes, padded};
use super::product::{self, LINE, Lines, PIECE, Pieces, ROWS};
use super::real::Real;
use super::scratch::Scratch;
use super::tile_fft::{self, Signal, Transform, Twiddles};
use crate::parallel::{for_each_chunk, threads};

/// Side of a kernel.
pub const KERNEL: usize = 7;
/// Pixels a kernel reaches to either side.
pub const REACH: usize = KERNEL / 2;

/// Side of a Fourier tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tile {
    /// 16 × 16 pixels, 10 × 10 of them new.
    Small,
    /// 32 × 32 pixels, 26 × 26 of them new.
    Large,
}

impl Tile {
    /// N.
    #[must_use]
    pub const fn side(self) -> usize {
        match self {
            Self::Small => 16,
            Self::Large => 32,
        }
    }

    /// Outputs of a tile along one side, before striding.
    #[must_use]
    pub const fn step(self) -> usize {
        self.side() - (KERNEL - 1)
    }

    /// Frequencies of a real tile: N rows of N/2 + 1.
    #[must_use]
    pub const fn frequencies(self) -> usize {
        self.side() * self.frequency_columns()
    }

    /// Columns of frequencies of a real tile: N/2 + 1.
    #[must_use]
    pub const fn frequency_columns(self) -> usize {
        self.side() / 2 + 1
    }

    /// The tile that needs less arithmetic for a layer of this shape.
    #[must_use]
    pub fn best(geometry: &Geometry, channels_in: usize, channels_out: usize) -> Self {
        let cost = |tile: Self| {
            let tiles = geometry.tiles(tile) as f64;
            let (c_in, c_out) = (padded(channels_in) as f64, padded(channels_out) as f64);
            let frequencies = tile.frequencies() as f64;
            // Every product streams all weights, which costs about as much as four rows of arithmetic.
            let product = frequencies * (tiles + 4.0) * c_in * c_out * 8.0;
            // A transform takes about 2.5 n log₂ n operations, at half the rate of the product.
            let samples = (tile.side() * tile.side()) as f64;
            let transform = 2.0 * 2.5 * samples * samples.log2() * tiles * (c_in + c_out);
            product + transform
        };
        if cost(Self::Small) <= cost(Self::Large) { Self::Small } else { Self::Large }
    }
}

/// Shape of one convolution's input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Geometry {
    /// Rows of the input.
    pub height: usize,
    /// Columns of the input.
    pub width: usize,
    /// 1 or 2.
    pub stride: usize,
    /// What lies beyond the border.
    pub boundary: Boundary,
}

impl Geometry {
    /// Rows and columns of the output: the input's divided by the stride, rounded up.
    #[must_use]
    pub fn output(&self) -> (usize, usize) {
        (self.height.div_ceil(self.stride), self.width.div_ceil(self.stride))
    }

    fn tile_grid(&self, tile: Tile) -> (usize, usize) {
        (self.height.div_ceil(tile.step()), self.width.div_ceil(tile.step()))
    }

    /// How many tiles cover the input.
    #[must_use]
    pub fn tiles(&self, tile: Tile) -> usize {
        let (rows, columns) = self.tile_grid(tile);
        rows * columns
    }
}

/// The filters of one layer, ready for use: their spectra, `[frequency, re | im, channels in, channels out]`.
#[derive(Debug)]
pub struct Filters<T> {
    channels_in: usize,
    channels_out: usize,
    tile: Tile,
    spectra: Vec<T>,
}

impl<T: Real> Filters<T> {
    /// Transforms weights `[channels out, channels in, 7, 7]` (row-major).
    ///
    /// The spectra also carry the scale that the transforms leave out: ½ for [`tile_fft::forward`], 1/N² for the
    /// unnormalised inverse (the fold of a strided layer and its smaller inverse come to the same).
    #[must_use]
    pub fn new(weights: &[f64], channels_in: usize, channels_out: usize, tile: Tile) -> Self {
        let (c_in, c_out) = (padded(channels_in), padded(channels_out));
        let mut filters = Self {
            channels_in: c_in,
            channels_out: c_out,
            tile,
            spectra: vec![T::ZERO; tile.frequencies() * 2 * c_in * c_out],
        };
        match tile {
            Tile::Small => filters.transform::<16>(weights, channels_in, channels_out),
            Tile::Large => filters.transform::<32>(weights, channels_in, channels_out),
        }
        filters
    }

    fn transform<const N: usize>(&mut self, weights: &[f64], channels_in: usize, channels_out: usize)
    where
        Signal<T, N>: Transform<T, N>,
    {
        let scale = 1.0 / (2 * N * N) as f64;
        let (c_in, c_out) = (self.channels_in, self.channels_out);
        // All kernels of one input channel are an image of 7 × 7 pixels, which goes the way of all images.
        let mut kernels = vec![T::ZERO; KERNEL * KERNEL * c_out];
        let mut spectrum = vec![T::ZERO; self.tile.frequencies() * 2 * c_out];
        let twiddles = Twiddles::new();
        let tiles = Tiles { first: 0, count: 1, columns: 1, step: 0, reach: 0 };
        for from in 0..channels_in {
            for to in 0..channels_out {
                let weights = &weights[(to * channels_in + from) * KERNEL * KERNEL..][..KERNEL * KERNEL];
                for (pixel, weight) in kernels.chunks_exact_mut(c_out).zip(weights) {
                    // Halved here: the transform gives twice what it should.
                    pixel[to] = T::rounded(0.5 * scale * weight);
                }
            }
            let image = Image {
                source: Source::Plain(&kernels),
                height: KERNEL,
                width: KERNEL,
                channels: c_out,
                boundary: Boundary::Open,
            };
            for group in (0..c_out).step_by(LANES) {
                let place = Place { frequency: 2 * c_out, part: c_out, tile: 0 };
                let out = &mut spectrum[group..];
                lanes::run(TransformFull::<T, N> { image, group, tiles, place, twiddles: &twiddles, out });
            }
            for (part, line) in spectrum.chunks_exact(c_out).enumerate() {
                self.spectra[(part * c_in + from) * c_out..][..c_out].copy_from_slice(line);
            }
        }
    }

    /// `[frequency, re | im, channels in, channels out]`, padded, with the scale said above.
    pub(crate) fn spectra(&self) -> &[T] {
        &self.spectra
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.spectra.len() * size_of::<T>()
    }

    /// Side of the tiles the spectra are for.
    #[must_use]
    pub fn tile(&self) -> Tile {
        self.tile
    }
}

/// What is convolved.
#[derive(Clone, Copy)]
pub enum Source<'a, T> {
    /// An image as it is.
    Plain(&'a [T]),
    /// The image after instance normalisation and ReLU, worked out on the way in.
    Activated {
        /// The image before both.
        image: &'a [T],
        /// Mean of every channel.
        mean: &'a [T],
        /// One over the standard deviation of every channel.
        inverse_deviation: &'a [T],
    },
}

/// Which way a convolution is applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From input to output.
    Forward,
    /// From the gradient with respect to the output to that with respect to the input.
    Gradient,
}

/// The work space of all convolutions: transformed tiles, products, and what each thread needs for itself.
#[derive(Debug)]
pub struct Workspace<T> {
    tiles: Vec<T>,
    products: Vec<T>,
    operands: Scratch<T>,
}

/// Numbers in the products of one row of frequencies.
const fn product_row_len(tile: Tile, tiles: usize, channels: usize) -> usize {
    tiles * (channels / LANES) * tile.frequency_columns() * LINE
}

/// Numbers a work space must hold: transformed tiles, products, and one thread's operands.
fn workspace_lens(geometry: &Geometry, tile: Tile, channels_in: usize, channels_out: usize) -> [usize; 3] {
    let (c_in, c_out) = (padded(channels_in), padded(channels_out));
    let groups = c_in.max(c_out) / LANES;
    let (tiles, frequencies) = (geometry.tiles(tile), tile.frequencies());
    let transformed = tiles.div_ceil(ROWS) * groups * frequencies * PIECE;
    [transformed, tile.side() * product_row_len(tile, tiles, groups * LANES), 2 * c_in * c_out]
}

impl<T: Real> Workspace<T> {
    /// Space enough for each of these layers: shape of the input, tile, channels in and out.
    #[must_use]
    pub fn new(layers: &[(Geometry, Tile, usize, usize)]) -> Self {
        let mut most = [0; 3];
        for (geometry, tile, channels_in, channels_out) in layers {
            let lens = workspace_lens(geometry, *tile, *channels_in, *channels_out);
            most = std::array::from_fn(|part| most[part].max(lens[part]));
        }
        Self { tiles: vec![T::ZERO; most[0]], products: vec![T::ZERO; most[1]], operands: Scratch::new(most[2]) }
    }

    /// Bytes that [`Self::new`] would allocate for these layers.
    #[must_use]
    pub fn bytes_for(layers: &[(Geometry, Tile, usize, usize)]) -> usize {
        let most = |part: usize| layers.iter().map(|&(g, tile, i, o)| workspace_lens(&g, tile, i, o)[part]).max();
        let [tiles, products, operands] = [0, 1, 2].map(|part| most(part).unwrap_or(0));
        (tiles + products + operands * (threads() + 1)) * size_of::<T>()
    }
}

/// One convolution of a network at one size. The three steps are apart so that a caller can stop between them.
#[derive(Debug)]
pub struct Convolution {
    /// Shape of the input.
    pub geometry: Geometry,
    tile: Tile,
    channels_in: usize,
    channels_out: usize,
}

impl Convolution {
    /// A convolution with these filters of inputs of this shape.
    #[must_use]
    pub fn new<T: Real>(filters: &Filters<T>, geometry: Geometry) -> Self {
        Self { geometry, tile: filters.tile, channels_in: filters.channels_in, channels_out: filters.channels_out }
    }

    /// Channels of the input of a direction.
    fn inner(&self, direction: Direction) -> usize {
        if direction == Direction::Forward { self.channels_in } else { self.channels_out }
    }

    /// Channels of the output of a direction.
    fn outer(&self, direction: Direction) -> usize {
        if direction == Direction::Forward { self.channels_out } else { self.channels_in }
    }

    /// Rows of frequencies of a tile: what [`Self::multiply`] runs over.
    #[must_use]
    pub fn frequency_rows(&self) -> usize {
        self.tile.side()
    }

    /// Operations (multiplications and additions) of the product over all frequencies.
    #[must_use]
    pub fn operations(&self) -> f64 {
        8.0 * (self.tile.frequencies() * self.geometry.tiles(self.tile) * self.channels_in * self.channels_out) as f64
    }

    /// Step 1: transforms the tiles of the input.
    pub fn transform<T: Real>(&self, source: Source<T>, direction: Direction, workspace: &mut Workspace<T>) {
        match self.tile {
            Tile::Small => self.transform_tiles::<T, 16, 8>(source, direction, workspace),
            Tile::Large => self.transform_tiles::<T, 32, 16>(source, direction, workspace),
        }
    }

    fn transform_tiles<T: Real, const N: usize, const HALF: usize>(
        &self,
        source: Source<T>,
        direction: Direction,
        workspace: &mut Workspace<T>,
    ) where
        Signal<T, N>: Transform<T, N>,
        Signal<T, HALF>: Transform<T, HALF>,
    {
        let decimated = direction == Direction::Gradient && self.geometry.stride == 2;
        let (height, width) = if direction == Direction::Forward {
            (self.geometry.height, self.geometry.width)
        } else {
            self.geometry.output()
        };
        let channels = self.inner(direction);
        let groups = channels / LANES;
        let count = self.geometry.tiles(self.tile);
        let columns = self.geometry.tile_grid(self.tile).1;
        let image = Image { source, height, width, channels, boundary: self.geometry.boundary };
        let len = self.tile.frequencies() * PIECE;
        let place = Place { frequency: PIECE, part: LANES, tile: LINE };
        let full = Twiddles::<T, N>::new();
        let half = Twiddles::<T, HALF>::new();
        let pieces = &mut workspace.tiles[..count.div_ceil(ROWS) * groups * len];
        for_each_chunk(pieces, len, |index, out| {
            let (first, group) = (index / groups * ROWS, index % groups * LANES);
            let (step, reach) = if decimated { (self.tile.step() / 2, 1) } else { (self.tile.step(), REACH) };
            let tiles = Tiles { first, count: ROWS.min(count - first), columns, step, reach };
            if decimated {
                let (twiddles, shift) = (&half, &full);
                lanes::run(TransformDecimated::<T, N, HALF> { image, group, tiles, place, twiddles, shift, out });
            } else {
                lanes::run(TransformFull::<T, N> { image, group, tiles, place, twiddles: &full, out });
            }
        });
    }

    /// Step 2: multiplies these rows of frequencies.
    pub fn multiply<T: Real>(
        &self,
        filters: &Filters<T>,
        direction: Direction,
        rows: std::ops::Range<usize>,
        workspace: &mut Workspace<T>,
    ) {
        let tiles = self.geometry.tiles(self.tile);
        let (inner, outer) = (self.inner(direction), self.outer(direction));
        let Workspace { tiles: transformed, products, operands } = workspace;
        let transformed = &transformed[..];
        let columns = self.tile.frequency_columns();
        let len = product_row_len(self.tile, tiles, outer);
        let w_len = 2 * self.channels_in * self.channels_out;
        let first = rows.start;
        for_each_chunk(&mut products[first * len..rows.end * len], len, |offset, out| {
            let mut operands = operands.mine();
            for column in 0..columns {
                let frequency = (first + offset) * columns + column;
                let data = &transformed[frequency * PIECE..];
                lanes::run(Multiply {
                    x: Pieces { data, stride: self.tile.frequencies() * PIECE, rows: tiles, inner },
                    filters: &filters.spectra[frequency * w_len..(frequency + 1) * w_len],
                    direction,
                    outer,
                    transposed: &mut operands[..w_len],
                    out: Lines { data: &mut out[column * LINE..], stride: columns * LINE },
                });
            }
        });
    }

    /// Step 3: transforms the products back into an image.
    pub fn inverse<T: Real>(&self, direction: Direction, workspace: &Workspace<T>, out: &mut [T]) {
        match self.tile {
            Tile::Small => self.inverse_tiles::<T, 16, 8>(direction, workspace, out),
            Tile::Large => self.inverse_tiles::<T, 32, 16>(direction, workspace, out),
        }
    }

    fn inverse_tiles<T: Real, const N: usize, const HALF: usize>(
        &self,
        direction: Direction,
        workspace: &Workspace<T>,
        out: &mut [T],
    ) where
        Signal<T, N>: Transform<T, N>,
        Signal<T, HALF>: Transform<T, HALF>,
    {
        let channels = self.outer(direction);
        let tiles = self.geometry.tiles(self.tile);
        let columns = self.geometry.tile_grid(self.tile).1;
        let decimated = direction == Direction::Forward && self.geometry.stride == 2;
        let step = (N - KERNEL + 1) / if decimated { 2 } else { 1 };
        let (height, width) = if direction == Direction::Forward {
            self.geometry.output()
        } else {
            (self.geometry.height, self.geometry.width)
        };
        let products = &workspace.products[..];
        for_each_chunk(&mut out[..height * width * channels], step * width * channels, |row, rows| {
            let product = Product { products, tile: self.tile, tiles, channels, first_tile: row * columns, columns };
            if decimated {
                lanes::run(InverseDecimated::<T, N, HALF> { product, step, width, rows });
            } else {
                let first = if direction == Direction::Forward { 0 } else { KERNEL - 1 };
                lanes::run(InverseFull::<T, N> { product, step, first, width, rows });
            }
        });
    }
}

/// An image and what lies beyond its border.
#[derive(Clone, Copy)]
struct Image<'a, T> {
    source: Source<'a, T>,
    height: usize,
    width: usize,
    channels: usize,
    boundary: Boundary,
}

/// Where index `i` of a line of `len` pixels lies, if anywhere.
#[inline(always)]
fn locate(i: isize, len: usize, boundary: Boundary) -> Option<usize> {
    if i >= 0 && (i as usize) < len {
        return Some(i as usize);
    }
    match boundary {
        Boundary::Open => None,
        Boundary::Periodic => Some(i.rem_euclid(len as isize) as usize),
    }
}

impl<T: Real> Image<'_, T> {
    /// Fills an `N × N` tile with eight channels of the image, from `origin` (row, column) on.
    #[inline(always)]
    fn fill<const N: usize>(&self, origin: [isize; 2], channel: usize, tile: &mut [Lanes<T>]) {
        let columns: [Option<usize>; N] =
            std::array::from_fn(|x| locate(origin[1] + x as isize, self.width, self.boundary));
        for (y, line) in tile.chunks_exact_mut(N).enumerate() {
            let Some(row) = locate(origin[0] + y as isize, self.height, self.boundary) else {
                line.fill(Lanes::ZERO);
                continue;
            };
            let base = row * self.width * self.channels + channel;
            match self.source {
                Source::Plain(image) => {
                    for (pixel, column) in line.iter_mut().zip(&columns) {
                        *pixel = column.map_or(Lanes::ZERO, |x| Lanes::load(&image[base + x * self.channels..]));
                    }
                }
                Source::Activated { image, mean, inverse_deviation } => {
                    let mean = Lanes::load(&mean[channel..]);
                    let inverse = Lanes::load(&inverse_deviation[channel..]);
                    for (pixel, column) in line.iter_mut().zip(&columns) {
                        *pixel = column.map_or(Lanes::ZERO, |x| {
                            let value = (Lanes::load(&image[base + x * self.channels..]) - mean) * inverse;
                            Lanes(value.0.map(|v| if v > T::ZERO { v } else { T::ZERO }))
                        });
                    }
                }
            }
        }
    }
}

/// Some tiles of an image, row by row.
#[derive(Clone, Copy)]
struct Tiles {
    first: usize,
    count: usize,
    /// Tiles in a row of them.
    columns: usize,
    /// Pixels from one tile to the next.
    step: usize,
    /// Pixels a tile begins before the first that is its own.
    reach: usize,
}

impl Tiles {
    /// Row and column of the image at which each begins.
    #[inline(always)]
    fn origins(self) -> impl Iterator<Item = [isize; 2]> {
        (self.first..self.first + self.count).map(move |tile| {
            [tile / self.columns, tile % self.columns].map(|at| (at * self.step) as isize - self.reach as isize)
        })
    }
}

/// Where a transformed value goes: how far it is from one frequency, part (real, imaginary) and tile to the next.
#[derive(Clone, Copy)]
struct Place {
    frequency: usize,
    part: usize,
    tile: usize,
}

/// Transforms eight channels of some tiles.
struct TransformFull<'a, T, const N: usize> {
    image: Image<'a, T>,
    group: usize,
    tiles: Tiles,
    place: Place,
    twiddles: &'a Twiddles<T, N>,
    out: &'a mut [T],
}

impl<T: Real, const N: usize> Kernel for TransformFull<'_, T, N>
where
    Signal<T, N>: Transform<T, N>,
{
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let mut tile = [[Lanes::<T>::ZERO; N]; N];
        let mut spectrum = [Signal::<T, N>::ZERO; N];
        for (index, origin) in self.tiles.origins().enumerate() {
            self.image.fill::<N>(origin, self.group, tile.as_flattened_mut());
            tile_fft::forward(tile.as_flattened(), &mut spectrum, self.twiddles);
            for ky in 0..N {
                for (kx, column) in spectrum[..=N / 2].iter().enumerate() {
                    let at = (ky * (N / 2 + 1) + kx) * self.place.frequency + index * self.place.tile;
                    column.re[ky].store(&mut self.out[at..]);
                    column.im[ky].store(&mut self.out[at + self.place.part..]);
                }
            }
        }
    }
}

/// The tile has samples at odd places only: the image's pixels, one zero between each two.
struct TransformDecimated<'a, T, const N: usize, const HALF: usize> {
    image: Image<'a, T>,
    group: usize,
    tiles: Tiles,
    place: Place,
    twiddles: &'a Twiddles<T, HALF>,
    shift: &'a Twiddles<T, N>,
    out: &'a mut [T],
}

impl<T: Real, const N: usize, const HALF: usize> Kernel for TransformDecimated<'_, T, N, HALF>
where
    Signal<T, HALF>: Transform<T, HALF>,
{
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let mut tile = [[Lanes::<T>::ZERO; HALF]; HALF];
        let mut spectrum = [Signal::<T, HALF>::ZERO; HALF];
        for (index, origin) in self.tiles.origins().enumerate() {
            self.image.fill::<HALF>(origin, self.group, tile.as_flattened_mut());
            tile_fft::forward(tile.as_flattened(), &mut spectrum, self.twiddles);
            for ky in 0..N {
                for kx in 0..=N / 2 {
                    // The small spectrum repeats; its right half is the mirrored conjugate of its left one.
                    let (y, x) = (ky % HALF, kx % HALF);
                    let (re, im) = if x <= HALF / 2 {
                        (spectrum[x].re[y], spectrum[x].im[y])
                    } else {
                        let (y, x) = ((HALF - y) % HALF, HALF - x);
                        (spectrum[x].re[y], spectrum[x].im[y].negate())
                    };
                    // The samples sit at odd places: a shift by one pixel each way.
                    let turn = (ky + kx) % N;
                    let (wr, wi) = (self.shift.re[turn], self.shift.im[turn]);
                    let at = (ky * (N / 2 + 1) + kx) * self.place.frequency + index * self.place.tile;
                    (re.scale(wr) - im.scale(wi)).store(&mut self.out[at..]);
                    (re.scale(wi) + im.scale(wr)).store(&mut self.out[at + self.place.part..]);
                }
            }
        }
    }
}

/// Multiplies one frequency.
struct Multiply<'a, T> {
    x: Pieces<'a, T>,
    filters: &'a [T],
    direction: Direction,
    outer: usize,
    transposed: &'a mut [T],
    out: Lines<'a, T>,
}

impl<T: Real> Kernel for Multiply<'_, T> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { x, outer, mut out, .. } = self;
        if self.direction == Direction::Forward {
            // Correlation, not convolution: the conjugate of the filter's spectrum.
            product::complex::<T, true, FMA>(x, self.filters, outer, &mut out);
        } else {
            let plane = x.inner * outer;
            for (from, to) in self.filters.chunks_exact(plane).zip(self.transposed.chunks_exact_mut(plane)) {
                transpose(from, to, outer, x.inner);
            }
            product::complex::<T, false, FMA>(x, self.transposed, outer, &mut out);
        }
    }
}

/// Transposes `rows × columns` numbers; both are multiples of [`LANES`].
#[inline(always)]
fn transpose<T: Real>(from: &[T], to: &mut [T], rows: usize, columns: usize) {
    if T::faster_transpose(from, to, rows, columns) {
        return;
    }
    for row in (0..rows).step_by(LANES) {
        for column in (0..columns).step_by(LANES) {
            let block: [Lanes<T>; LANES] = std::array::from_fn(|i| Lanes::load(&from[(row + i) * columns + column..]));
            for i in 0..LANES {
                let line: [T; LANES] = std::array::from_fn(|j| block[j].0[i]);
                Lanes(line).store(&mut to[(column + i) * rows + row..]);
            }
        }
    }
}

/// Where the products of one row of tiles lie.
#[derive(Clone, Copy)]
struct Product<'a, T> {
    products: &'a [T],
    tile: Tile,
    tiles: usize,
    channels: usize,
    first_tile: usize,
    columns: usize,
}

impl<T: Real> Product<'_, T> {
    /// Real and imaginary part of eight channels of a tile at the frequency of row `ky` and column `kx`.
    #[inline(always)]
    fn at(&self, [ky, kx]: [usize; 2], tile: usize, group: usize) -> (Lanes<T>, Lanes<T>) {
        let index = (self.first_tile + tile) * (self.channels / LANES) + group / LANES;
        let at = ky * product_row_len(self.tile, self.tiles, self.channels);
        let line = &self.products[at + (index * self.tile.frequency_columns() + kx) * LINE..][..LINE];
        (Lanes::load(line), Lanes::load(&line[LANES..]))
    }
}

struct InverseFull<'a, T, const N: usize> {
    product: Product<'a, T>,
    step: usize,
    /// First row and column of the tile that holds a valid output.
    first: usize,
    width: usize,
    rows: &'a mut [T],
}

impl<T: Real, const N: usize> Kernel for InverseFull<'_, T, N>
where
    Signal<T, N>: Transform<T, N>,
{
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let channels = self.product.channels;
        let twiddles = Twiddles::<T, N>::new();
        let mut tile = [[Lanes::<T>::ZERO; N]; N];
        let mut spectrum = [Signal::<T, N>::ZERO; N];
        let height = self.rows.len() / (self.width * channels);
        for column in 0..self.product.columns {
            let left = column * self.step;
            let across = self.step.min(self.width - left);
            for group in (0..channels).step_by(LANES) {
                for ky in 0..N {
                    for (kx, signal) in spectrum[..=N / 2].iter_mut().enumerate() {
                        (signal.re[ky], signal.im[ky]) = self.product.at([ky, kx], column, group);
                    }
                }
                tile_fft::inverse(&mut spectrum, tile.as_flattened_mut(), self.first, self.first + height, &twiddles);
                for y in 0..height {
                    for x in 0..across {
                        let at = (y * self.width + left + x) * channels + group;
                        tile[self.first + y][self.first + x].store(&mut self.rows[at..]);
                    }
                }
            }
        }
    }
}

struct InverseDecimated<'a, T, const N: usize, const HALF: usize> {
    product: Product<'a, T>,
    step: usize,
    width: usize,
    rows: &'a mut [T],
}

impl<T: Real, const N: usize, const HALF: usize> Kernel for InverseDecimated<'_, T, N, HALF>
where
    Signal<T, HALF>: Transform<T, HALF>,
{
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let channels = self.product.channels;
        let twiddles = Twiddles::<T, HALF>::new();
        let mut tile = [[Lanes::<T>::ZERO; HALF]; HALF];
        let mut spectrum = [Signal::<T, HALF>::ZERO; HALF];
        let height = self.rows.len() / (self.width * channels);
        for column in 0..self.product.columns {
            let left = column * self.step;
            let across = self.step.min(self.width - left);
            for group in (0..channels).step_by(LANES) {
                for ky in 0..HALF {
                    for kx in 0..=HALF / 2 {
                        let (mut re, mut im) = self.product.at([ky, kx], column, group);
                        let (r, i) = self.product.at([ky + HALF, kx], column, group);
                        re = re + r;
                        im = im + i;
                        // The right half of the large spectrum is the mirrored conjugate of the left one.
                        for y in [(N - ky) % N, HALF - ky] {
                            let (r, i) = self.product.at([y, HALF - kx], column, group);
                            re = re + r;
                            im = im - i;
                        }
                        spectrum[kx].re[ky] = re;
                        spectrum[kx].im[ky] = im;
                    }
                }
                tile_fft::inverse(&mut spectrum, tile.as_flattened_mut(), 0, height, &twiddles);
                for y in 0..height {
                    for x in 0..across {
                        let at = (y * self.width + left + x) * channels + group;
                        tile[y][x].store(&mut self.rows[at..]);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<T: Real>(rows: usize, columns: usize) {
        let from: Vec<T> = (0..rows * columns).map(|i| T::rounded(i as f64)).collect();
        let mut to = vec![T::ZERO; from.len()];
        transpose(&from, &mut to, rows, columns);
        for row in 0..rows {
            for column in 0..columns {
                assert_eq!(to[column * rows + row], from[row * columns + column], "{rows} × {columns}");
            }
        }
    }

    #[test]
    fn transpositions_exchange_rows_and_columns() {
        for (rows, columns) in [(8, 8), (8, 24), (32, 16)] {
            check::<f32>(rows, columns);
            check::<f64>(rows, columns);
        }
    }
}
