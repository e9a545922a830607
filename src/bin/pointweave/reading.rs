//! How files are read: what the person knows better, and what becomes of what a reader has to say.

use std::path::Path;

use clap::Args;
use pointweave::formats::{self, ColumnChoice, Note, Origin, ReadOptions, Reading};
use pointweave::pattern::Window;
use pointweave::{Boundary, Domain, PointPattern};

use crate::failure::Failure;
use crate::files;

/// What all commands that read files have in common.
#[derive(Debug, Default, Args)]
pub(crate) struct ReadArguments {
    /// Which columns hold what, as in x=easting,y=northing,class=species,radius=crown_m; by name, or by number from 1. class=
    /// alone is none; any other name makes an attribute, and then only those named do. May be repeated [default: by their names]
    #[arg(long, value_name = "WHAT=COLUMN,…", value_parser = parse_columns)]
    columns: Vec<Columns>,
    /// Take degrees of longitude and latitude as they are, instead of projecting them to metres about their middle
    #[arg(long)]
    no_projection: bool,
    /// Refuse files of which anything was left out, had to be guessed, or looks odd
    #[arg(long)]
    strict: bool,
}

/// The pairs of one `--columns`.
type Columns = Vec<(String, String)>;

fn parse_columns(text: &str) -> Result<Columns, String> {
    let pair = |word: &str| match word.split_once('=') {
        Some((what, column)) if !what.trim().is_empty() && (!column.trim().is_empty() || what.trim() == "class") => {
            Ok((what.trim().to_owned(), column.trim().to_owned()))
        }
        _ => Err(format!("{word:?} is not 'what=column', as in 'x=easting' or 'class=species'")),
    };
    text.split(',').map(pair).collect()
}

/// A pattern, and how its file named and placed things.
#[derive(Debug)]
pub(crate) struct Opened {
    pub(crate) pattern: PointPattern,
    pub(crate) origin: Origin,
    /// The outline within its domain that the file tells.
    pub(crate) window: Option<Window>,
    /// Its domain, where the file or the person told it.
    pub(crate) declared: Option<Domain>,
}

impl ReadArguments {
    /// Reads a file, `-` or `gallery:NAME`. What the reader has to say goes to standard error, unless `quiet`; with
    /// `--strict` it is an error.
    pub(crate) fn open(
        &self,
        input: &Path,
        domain: Option<Domain>,
        boundary: Option<Boundary>,
        quiet: bool,
    ) -> Result<Opened, Failure> {
        let options = ReadOptions { domain, boundary, columns: self.choice()?, keeps_degrees: self.no_projection };
        let reading = files::read(input, &options)?;
        // What the gallery holds is as it is meant to be.
        if !input.to_str().is_some_and(|name| name.starts_with("gallery:")) {
            let notes = [reading.notes.as_slice(), &formats::oddities(&reading.pattern)].concat();
            self.tell(&files::input_name(input), &notes, quiet)?;
        }
        let Reading { pattern, origin, window, is_domain_declared, .. } = reading;
        let declared = is_domain_declared.then(|| pattern.domain());
        Ok(Opened { pattern, origin, window, declared })
    }

    /// Says the notes, or refuses because of them.
    pub(crate) fn tell(&self, name: &str, notes: &[Note], quiet: bool) -> Result<(), Failure> {
        if self.strict && !notes.is_empty() {
            let said: Vec<&str> = notes.iter().map(|note| note.text.as_str()).collect();
            return Err(Failure::Run(format!("{name} is refused by --strict: {}", said.join(" "))));
        }
        if !quiet {
            notes.iter().for_each(|note| eprintln!("pointweave: {name}: {note}"));
        }
        Ok(())
    }

    /// The same for a file with columns of its own.
    pub(crate) fn without_columns(&self) -> Self {
        Self { columns: Vec::new(), ..*self }
    }

    fn choice(&self) -> Result<ColumnChoice, Failure> {
        let mut choice = ColumnChoice::default();
        for (what, column) in self.columns.iter().flatten() {
            let place = match what.as_str() {
                "x" => &mut choice.x,
                "y" => &mut choice.y,
                "class" => &mut choice.class,
                "radius" => &mut choice.radius,
                _ => {
                    choice.attributes.get_or_insert_with(Vec::new).push((what.clone(), column.clone()));
                    continue;
                }
            };
            if let Some(before) = place.replace(column.clone()) {
                let message = format!("--columns: '{what}' is both '{before}' and '{column}'; it can be one column");
                return Err(Failure::Usage(message));
            }
        }
        Ok(choice)
    }
}
