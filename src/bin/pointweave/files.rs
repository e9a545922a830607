//! Patterns from files, standard input and the gallery, and back to files and standard output.

use std::fs::{self, File};
use std::io::{self, IsTerminal as _, Read as _, Write as _};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use pointweave::formats::style::{Look, Palette};
use pointweave::formats::{self, Glyph, Origin, PngStyle, ReadOptions, Reading, SvgStyle};
use pointweave::{PointPattern, gallery};

use crate::failure::Failure;

/// What a pattern is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Comma-separated values that read back without loss.
    Csv,
    /// JSON that reads back without loss.
    Json,
    /// A picture of lines and circles.
    Svg,
    /// A picture of pixels.
    Png,
    /// A NumPy array of doubles: x, y, the class's number where there are several, attributes.
    Npy,
    /// GeoJSON points, in the coordinates and under the names of the exemplar's file.
    Geojson,
}

/// How an SVG or PNG shows the points.
#[derive(Debug, Default, Args)]
pub(crate) struct LookArguments {
    /// In an SVG or PNG, the shape of a class's points: disk, ring, square, triangle, diamond, tree, house, star, arrow,
    /// or path: and SVG path data; may be repeated [default: what the class's name says]
    #[arg(long = "glyph", value_name = "CLASS=NAME", value_parser = parse_glyph)]
    glyphs: Vec<(String, Glyph)>,
    /// In an SVG or PNG, the colours of the classes: okabe-ito, bright or ink
    #[arg(long, default_value = "okabe-ito", value_parser = parse_palette)]
    palette: Palette,
}

fn parse_glyph(text: &str) -> Result<(String, Glyph), String> {
    match text.split_once('=') {
        Some((class, name)) if !class.is_empty() => match Glyph::from_name(name) {
            Ok(glyph) => Ok((class.to_owned(), glyph)),
            Err(error) => Err(error.to_string()),
        },
        _ => Err("'class=name' is needed, as in 'oak=tree' or 'oak=path:M0 0L9 0L9 9Z'".to_owned()),
    }
}

fn parse_palette(text: &str) -> Result<Palette, String> {
    let names = Palette::ALL.map(Palette::name).join(", ");
    Palette::from_name(text).ok_or_else(|| format!("there are {names}"))
}

impl LookArguments {
    /// Refuses a glyph for a class that the pattern does not have.
    pub(crate) fn check(&self, pattern: &PointPattern) -> Result<(), Failure> {
        let names = pattern.class_names();
        match self.glyphs.iter().find(|(class, _)| !names.contains(class)) {
            Some((class, _)) => {
                let known = names.join("', '");
                Err(Failure::Usage(format!("--glyph: the pattern has no class '{class}'; it has '{known}'")))
            }
            None => Ok(()),
        }
    }

    fn look(&self) -> Look {
        Look { palette: self.palette, glyphs: self.glyphs.clone(), ..Look::default() }
    }
}

/// Where a pattern goes, settled before any work is done.
#[derive(Debug)]
pub(crate) struct Output {
    /// `None` is standard output.
    path: Option<PathBuf>,
    format: Format,
    png_size: u32,
    look: Look,
}

impl Output {
    /// Settles the format, and refuses what is sure to fail later.
    pub(crate) fn new(
        path: Option<&Path>,
        format: Option<Format>,
        png_size: u32,
        look: &LookArguments,
    ) -> Result<Self, Failure> {
        let path = path.filter(|path| path.as_os_str() != "-");
        let extension = path.and_then(Path::extension).and_then(|extension| extension.to_str());
        let by_name = extension.and_then(|extension| Format::from_str(extension, true).ok());
        let format = match (format.or(by_name), path) {
            (Some(format), _) => format,
            (None, None) => Format::Csv,
            (None, Some(path)) => {
                return Err(Failure::Usage(format!(
                    "'{}' does not end in .csv, .json, .geojson, .svg, .png or .npy; name it so or add --format",
                    path.display()
                )));
            }
        };
        if matches!(format, Format::Png | Format::Npy) && path.is_none() && io::stdout().is_terminal() {
            return Err(Failure::Usage("such bytes do not belong on a terminal; add -o FILE".to_owned()));
        }
        if let Some(path) = path {
            check_writable(path)?;
        }
        Ok(Self { path: path.map(Path::to_owned), format, png_size, look: look.look() })
    }

    /// Where it goes, for a person.
    pub(crate) fn name(&self) -> String {
        self.path.as_ref().map_or("standard output".to_owned(), |path| path.display().to_string())
    }

    /// Writes the pattern, as the exemplar's file named and placed things where the format has names and places.
    pub(crate) fn write(&self, pattern: &PointPattern, origin: &Origin, title: &str) -> Result<(), Failure> {
        let bytes = match self.format {
            Format::Csv => formats::write_csv_like(pattern, origin).into_bytes(),
            Format::Geojson => formats::write_geojson(pattern, origin).into_bytes(),
            Format::Json => formats::write_json(pattern).into_bytes(),
            Format::Npy => formats::write_npy(pattern),
            Format::Svg => {
                let style = SvgStyle { title: title.to_owned(), look: self.look.clone(), ..SvgStyle::default() };
                formats::write_svg(pattern, &style).into_bytes()
            }
            Format::Png => {
                let style = PngStyle { size_px: self.png_size, look: self.look.clone() };
                formats::write_png(pattern, &style).map_err(|error| Failure::Run(error.to_string()))?
            }
        };
        match &self.path {
            Some(path) => write_file(path, &bytes),
            None => write_stdout(&bytes),
        }
    }
}

/// Writes to standard output. A reader that has seen enough (`| head`) is no failure.
pub(crate) fn write_stdout(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::Run(format!("standard output can't be written: {error}")))
        }
        _ => Ok(()),
    }
}

/// Refuses a path that can't become a file: better now than after the work.
pub(crate) fn check_writable(path: &Path) -> Result<(), Failure> {
    let refuse = |reason: &str| Err(Failure::Run(format!("'{}' can't be written: {reason}", path.display())));
    if path.is_dir() {
        return refuse("it is a folder");
    }
    if !folder(path).is_dir() {
        return refuse("its folder does not exist");
    }
    Ok(())
}

/// Writes a whole file or nothing: into a new file beside it, which then takes its place.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let failed = |error: io::Error| Failure::Run(format!("'{}' can't be written: {error}", path.display()));
    // A link is followed, so that the link itself stays; a device or pipe can only be written in place.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let existing = fs::metadata(&target).ok();
    if existing.as_ref().is_some_and(|metadata| !metadata.is_file()) {
        return fs::write(&target, bytes).map_err(failed);
    }
    if existing.as_ref().is_some_and(|metadata| metadata.permissions().readonly()) {
        return Err(failed(io::ErrorKind::PermissionDenied.into()));
    }
    let mut name = std::ffi::OsString::from(".");
    name.push(target.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    let part = folder(&target).join(name);
    let written = (|| {
        let mut file = File::create(&part)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        if let Some(metadata) = existing {
            fs::set_permissions(&part, metadata.permissions())?;
        }
        fs::rename(&part, &target)
    })();
    written.map_err(|error| {
        // Whatever the cause was, it is what the person has to know; a part that can't be removed comes second.
        let _ = fs::remove_file(&part);
        failed(error)
    })
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// What `IN` names, a file, `-` or `gallery:NAME`, and all that its reader tells.
pub(crate) fn read(input: &Path, options: &ReadOptions) -> Result<Reading, Failure> {
    let name = input_name(input);
    if let Some(entry) = input.to_str().and_then(|text| text.strip_prefix("gallery:")) {
        let pattern = find_entry(entry)?.exemplar();
        // Through a format, so that the one rule about domains holds here too.
        let options = ReadOptions {
            domain: options.domain,
            boundary: options.boundary.or(Some(pattern.boundary())),
            ..ReadOptions::default()
        };
        return formats::open(formats::write_json(&pattern).as_bytes(), None, &options)
            .map_err(|error| Failure::Run(format!("{name} can't be used: {error}")));
    }
    let bytes = read_bytes(input, formats::MAX_BYTES as u64 + 1)?;
    formats::open(&bytes, input.to_str(), options)
        .map_err(|error| Failure::Run(format!("{name} can't be read: {error}")))
}

/// What a person calls an input in a sentence.
pub(crate) fn input_name(input: &Path) -> String {
    if input.as_os_str() == "-" { "standard input".to_owned() } else { format!("'{}'", input.display()) }
}

/// At most `limit` bytes of a file or, for `-`, of standard input.
pub(crate) fn read_bytes(input: &Path, limit: u64) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let (name, outcome) = if input.as_os_str() == "-" {
        ("standard input".to_owned(), io::stdin().lock().take(limit).read_to_end(&mut bytes))
    } else {
        let outcome = File::open(input).and_then(|file| file.take(limit).read_to_end(&mut bytes));
        (format!("'{}'", input.display()), outcome)
    };
    outcome.map_err(|error| Failure::Run(format!("{name} can't be read: {error}")))?;
    Ok(bytes)
}

/// The gallery's entry of that name.
pub(crate) fn find_entry(name: &str) -> Result<&'static gallery::Entry, Failure> {
    gallery::find(name).ok_or_else(|| {
        let names: Vec<&str> = gallery::entries().iter().map(|entry| entry.name).collect();
        Failure::Usage(format!("the gallery has no '{name}'; it has {}", names.join(", ")))
    })
}
