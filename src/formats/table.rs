//! Rows of text cells, however they were stored, become a pattern here: one place that knows what a column means.
//!
//! `header.rs` finds the header, `columns.rs` says what each column holds; here the rows are read by it.

use csv::StringRecord;
use glam::DVec2;

use super::areas;
use super::columns::Choice;
use super::declaration::Declared;
use super::error::{FormatError, Place, clip};
use super::guess::Guess;
use super::header::Header;
use super::note::counted;
use super::number::{self, Comma, is_missing};
use super::origin::Projection;
use super::{FileFormat, Note, ReadOptions, Reading, column_names};
use crate::pattern::{
    Attribute, Boundary, MAX_CLASSES, MAX_NAME_LENGTH, MAX_POINTS, PatternError, PointPattern, check_name,
};

/// Most columns of a table, skipped ones included.
pub(super) const MAX_COLUMNS: usize = 1024;
/// Rows beyond the points that may stand before them: titles, headers, units.
const MAX_LEADING_ROWS: usize = 32;
/// In front of an attribute's name in a header, it keeps the name from being taken for something else.
pub(super) const ATTRIBUTE_PREFIX: &str = "attribute:";
/// The class of points whose class is not told.
const UNKNOWN_CLASS: &str = "unknown";
/// The class of those that are beyond the cap.
const OTHER_CLASS: &str = "other";

/// Where a row stands.
#[derive(Clone, Copy, Debug)]
pub(super) enum RowPlace {
    Line(usize),
    /// An entry of a list, and in text the line and character it begins at.
    Entry(usize, Option<(usize, usize)>),
}

impl RowPlace {
    /// The place of the cell with index `column`, from 0.
    pub(super) fn cell(self, column: usize) -> Place {
        match self {
            Self::Line(line) => Place::Line { line, column: column + 1 },
            Self::Entry(entry, at) => Place::Entry { entry, value: column + 1, at },
        }
    }

    /// For a sentence.
    pub(super) fn name(self) -> String {
        match self {
            Self::Line(line) => format!("in line {line}"),
            Self::Entry(entry, _) => format!("entry {entry}"),
        }
    }

    /// The line, where there is one.
    pub(super) fn line(self) -> usize {
        match self {
            Self::Line(line) => line,
            Self::Entry(entry, at) => at.map_or(entry, |(line, _)| line),
        }
    }
}

/// One row as it was written.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) place: RowPlace,
    pub(super) cells: StringRecord,
}

impl Row {
    pub(super) fn new<T: AsRef<str>>(place: RowPlace, cells: impl IntoIterator<Item = T>) -> Self {
        let mut record = StringRecord::new();
        cells.into_iter().for_each(|cell| record.push_field(cell.as_ref()));
        Self { place, cells: record }
    }

    /// A cell without the blanks around it; nothing where the row has none.
    pub(super) fn cell(&self, column: usize) -> &str {
        self.cells.get(column).unwrap_or_default().trim()
    }

    fn is_blank(&self) -> bool {
        self.cells.iter().all(|cell| cell.trim().is_empty())
    }

    /// How many cells there are up to the last one that is not empty.
    pub(super) fn width(&self) -> usize {
        let empty = self.cells.iter().rev().take_while(|cell| cell.trim().is_empty()).count();
        self.cells.len() - empty
    }
}

/// A line that begins with `#`.
#[derive(Clone, Debug)]
pub(super) struct Comment {
    pub(super) line: usize,
    /// What stands behind the sign.
    pub(super) text: String,
    /// How many rows there are before it.
    pub(super) before: usize,
}

/// What a column holds.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Role {
    X,
    Y,
    /// Both, as in `POINT (1 2)`.
    Place,
    Class,
    Attribute(String),
    Skipped,
}

/// A name that can't be one.
pub(super) fn unfit_name(place: Place, what: &str, name: &str) -> FormatError {
    let allowed = format!("1 to {MAX_NAME_LENGTH} characters, none of them a control character");
    FormatError::Value { place, name: what.to_owned(), value: clip(name), allowed }
}

/// Rows, what is declared about them, and how their numbers are to be read.
#[derive(Debug)]
pub(super) struct Table {
    pub(super) declared: Declared,
    pub(super) rows: Vec<Row>,
    pub(super) comments: Vec<Comment>,
    /// Known beforehand where the format fixes the columns; read from the header or guessed otherwise.
    pub(super) roles: Option<Vec<Role>>,
    /// The names of the columns, where the format tells them in another way than by a first row.
    pub(super) header: Option<Vec<String>>,
    /// What the first columns hold, whatever they are called: x and y of GeoJSON.
    pub(super) fixed: Vec<Role>,
    /// What parts columns, where it is not blanks.
    pub(super) delimiter: Option<u8>,
    pub(super) comma: Comma,
    /// Every number is divided by this.
    pub(super) divisor: f64,
    /// Whether places are degrees of longitude and latitude: known of GeoJSON, read from names otherwise.
    pub(super) is_in_degrees: bool,
    /// The projection that a file of ours tells; otherwise it is about the middle of the places.
    pub(super) projection: Option<Projection>,
    /// How far beyond the border of the declared domain rounding may have put a point, as a share of the domain's longer side.
    pub(super) rounding: f64,
    /// The closed lines of each area in the file: the smallest one around the points is the window.
    pub(super) rings: Vec<Vec<Vec<DVec2>>>,
    pub(super) notes: Vec<Note>,
}

impl Table {
    pub(super) fn new(declared: Declared) -> Self {
        Self {
            declared,
            rows: Vec::new(),
            comments: Vec::new(),
            roles: None,
            header: None,
            fixed: Vec::new(),
            delimiter: None,
            comma: Comma::None,
            divisor: 1.0,
            is_in_degrees: false,
            projection: None,
            rounding: 0.0,
            rings: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Adds a row; blank ones are left out.
    pub(super) fn push(&mut self, row: Row) -> Result<(), FormatError> {
        if row.is_blank() { Ok(()) } else { self.push_even_blank(row) }
    }

    /// Adds a row also where it has no value: an entry of a list is one all the same.
    pub(super) fn push_even_blank(&mut self, row: Row) -> Result<(), FormatError> {
        if row.cells.len() > MAX_COLUMNS && row.width() > MAX_COLUMNS {
            return Err(FormatError::TooMany { place: row.place.cell(MAX_COLUMNS), what: "columns", max: MAX_COLUMNS });
        }
        if self.rows.len() >= MAX_POINTS + MAX_LEADING_ROWS {
            return Err(self.too_many_points());
        }
        self.rows.push(row);
        Ok(())
    }

    fn too_many_points(&self) -> FormatError {
        let place = self.rows.get(MAX_POINTS).map_or(Place::Line { line: 1, column: 1 }, |row| row.place.cell(0));
        FormatError::TooMany { place, what: "points", max: MAX_POINTS }
    }

    /// Takes in one comment line, without its `#`.
    pub(super) fn comment(&mut self, line: usize, text: &str) -> Result<(), FormatError> {
        if !self.declared.comment(line, text)? && !text.trim().is_empty() && self.comments.len() < MAX_POINTS {
            self.comments.push(Comment { line, text: text.to_owned(), before: self.rows.len() });
        }
        Ok(())
    }

    /// The number in a cell.
    pub(super) fn parse(&self, cell: &str) -> Option<f64> {
        number::parse(cell, self.comma)
    }

    /// The pattern these rows describe.
    pub(super) fn into_reading(mut self, format: FileFormat, options: &ReadOptions) -> Result<Reading, FormatError> {
        let header = if self.roles.is_some() { None } else { self.take_header(options) };
        if self.rows.len() > MAX_POINTS {
            return Err(self.too_many_points());
        }
        if self.rows.is_empty() {
            return Err(FormatError::NoPoints);
        }
        let choice = match self.roles.take() {
            Some(roles) => Choice::fixed(roles),
            None => Choice::of(&self, header.as_ref(), options)?,
        };
        let columns = choice.columns.clone();
        self.read(format, header.as_ref(), choice, options).map_err(|error| error.with_columns(&columns))
    }

    fn read(
        mut self,
        format: FileFormat,
        header: Option<&Header>,
        choice: Choice,
        options: &ReadOptions,
    ) -> Result<Reading, FormatError> {
        let Choice { roles, columns, is_in_degrees, origin, notes } = choice;
        self.notes.extend(notes);
        self.check_widths(&roles)?;
        let mut positions = self.places(&roles)?;
        let chosen = options.columns.attributes.is_some() || options.columns.radius.is_some();
        if chosen {
            self.leave_out_gaps(&roles, &mut positions);
        }
        if positions.is_empty() {
            return Err(FormatError::NoPoints);
        }

        let mut classes = Vec::new();
        let mut class_names = std::mem::take(&mut self.declared.classes);
        if class_names.len() > MAX_CLASSES {
            let count = class_names.len();
            return Err(PatternError::TooMany { what: "classes", count, max: MAX_CLASSES }.into());
        }
        let mut attributes = Vec::new();
        for (column, role) in roles.into_iter().enumerate() {
            match role {
                Role::Class => classes = self.classes(column, &mut class_names)?,
                Role::Attribute(name) => attributes.push(self.attribute(column, name)?),
                Role::X | Role::Y | Role::Place | Role::Skipped => {}
            }
        }

        if let Some(list) = &options.columns.attributes {
            attributes.sort_by_key(|attribute: &Attribute| list.iter().position(|(name, _)| *name == attribute.name));
        }

        let mut origin = origin;
        let mut declared = self.declared.domain;
        if is_in_degrees && let Some(projection) = self.projection(&positions, options) {
            positions.iter_mut().for_each(|point| *point = projection.project(*point));
            declared = declared.map(|domain| projection.project_domain(domain)).transpose()?;
            let project = |corner: &mut DVec2| *corner = projection.project(*corner);
            self.rings.iter_mut().flatten().flatten().for_each(project);
            origin.projection = Some(projection);
        }
        let window = areas::window(std::mem::take(&mut self.rings), &positions, &mut self.notes);
        let outline = window.as_ref().and_then(|window| areas::around(window, &positions));
        let declared = options.domain.or(declared).or(outline);
        let guess = match declared {
            Some(domain) => Guess::told(domain),
            None => Guess::of(&positions)?,
        };
        let domain = guess.domain;
        let slack = self.rounding * domain.size().max_element();
        for point in positions.iter_mut().filter(|point| slack > 0.0 && !domain.contains(**point)) {
            let nearest = point.clamp(domain.min(), domain.max());
            if (nearest - *point).abs().max_element() <= slack {
                *point = nearest;
            }
        }
        if let Some(index) = positions.iter().position(|&point| !domain.contains(point)) {
            return Err(FormatError::Outside {
                place: self.rows[index].place.cell(0),
                at: positions[index].into(),
                min: domain.min().into(),
                max: domain.max().into(),
            });
        }
        let boundary = options.boundary.or(self.declared.boundary).unwrap_or(Boundary::Open);
        let mut pattern = PointPattern::new(domain, positions)?.with_boundary(boundary);
        if !classes.is_empty() {
            pattern = pattern.with_classes(classes, class_names)?;
        }
        for attribute in attributes {
            pattern = pattern.with_attribute(attribute)?;
        }
        let mut reading = Reading::new(format, pattern);
        reading.is_domain_declared = declared.is_some();
        reading.domains = guess.choices;
        reading.columns = columns;
        // An outline that is the whole rectangle says no more than that.
        reading.window = window.filter(|window| !areas::is_rectangle(window) || areas::around(window, &[]) != outline);
        if header.is_some() {
            reading.origin = origin;
        }
        reading.notes = self.notes;
        reading.notes.extend(guess.notes);
        Ok(reading)
    }

    /// Positions of the rows; rows without a place are taken off.
    fn places(&mut self, roles: &[Role]) -> Result<Vec<DVec2>, FormatError> {
        let column = |wanted: Role| roles.iter().position(|role| *role == wanted);
        let mut positions = Vec::with_capacity(self.rows.len());
        let mut without: Vec<bool> = Vec::with_capacity(self.rows.len());
        let mut first: Option<RowPlace> = None;
        for row in &self.rows {
            let position = match (column(Role::X), column(Role::Y), column(Role::Place)) {
                (Some(x), Some(y), _) => [self.coordinate(row, x, "x")?, self.coordinate(row, y, "y")?],
                (_, _, Some(place)) => {
                    let cell = row.cell(place);
                    if is_missing(cell) || super::columns::is_empty_point(cell) {
                        [None, None]
                    } else {
                        let [x, y] = super::columns::point_of(cell).ok_or_else(|| FormatError::Value {
                            place: row.place.cell(place),
                            name: "the place".to_owned(),
                            value: clip(cell),
                            allowed: "a point, as in 'POINT (1 2)'".to_owned(),
                        })?;
                        [Some(x), Some(y)]
                    }
                }
                _ => [None, None],
            };
            match position {
                [Some(x), Some(y)] => {
                    positions.push(DVec2::new(x, y) / self.divisor);
                    without.push(false);
                }
                _ => {
                    first = first.or(Some(row.place));
                    without.push(true);
                }
            }
        }
        if let Some(first) = first {
            if positions.is_empty() {
                let column = column(Role::X).or(column(Role::Place)).unwrap_or_default();
                let value = self.rows.first().map(|row| clip(row.cell(column))).unwrap_or_default();
                let allowed = "a finite number in at least one row".to_owned();
                return Err(FormatError::Value { place: first.cell(column), name: "x".to_owned(), value, allowed });
            }
            self.drop_rows(&without, first, "without a place");
        }
        Ok(positions)
    }

    /// `None` where the cell says that there is no value.
    fn coordinate(&self, row: &Row, column: usize, name: &str) -> Result<Option<f64>, FormatError> {
        let cell = row.cell(column);
        match self.parse(cell) {
            Some(value) => Ok(Some(value)),
            None if is_missing(cell) => Ok(None),
            None => Err(self.no_number(row, column, name)),
        }
    }

    fn no_number(&self, row: &Row, column: usize, name: &str) -> FormatError {
        let cell = row.cell(column);
        let is_ambiguous = self.comma == Comma::None && number::parse(cell, Comma::Decimal).is_some();
        let hint =
            if is_ambiguous { "; its comma may be a decimal point or part thousands: write it without" } else { "" };
        FormatError::Value {
            place: row.place.cell(column),
            name: clip(name),
            value: clip(cell),
            allowed: format!("a finite number{hint}"),
        }
    }

    /// Takes off the rows that are marked, and says so.
    fn drop_rows(&mut self, marked: &[bool], first: RowPlace, why: &str) {
        let mut marks = marked.iter();
        let before = self.rows.len();
        self.rows.retain(|_| marks.next() == Some(&false));
        let rows = counted(before - self.rows.len(), "One row", "rows");
        let was = if before - self.rows.len() == 1 { "was" } else { "were" };
        let first = first.name();
        self.notes.push(Note::left_out(format!(
            "{rows} {why} {was} left out, the first of them {first}. Fill in what is missing if the points are needed."
        )));
    }

    /// Of attributes that a person chose: rows that lack one are taken off.
    fn leave_out_gaps(&mut self, roles: &[Role], positions: &mut Vec<DVec2>) {
        let has_gap = |row: &Row| {
            let mut chosen = roles.iter().enumerate().filter(|(_, role)| matches!(role, Role::Attribute(_)));
            chosen.any(|(column, _)| is_missing(row.cell(column)))
        };
        let gaps: Vec<bool> = self.rows.iter().map(has_gap).collect();
        if let Some(first) = gaps.iter().position(|&gap| gap) {
            let first = self.rows[first].place;
            let mut marks = gaps.iter();
            positions.retain(|_| marks.next() == Some(&false));
            self.drop_rows(&gaps, first, "without a value of a chosen attribute");
        }
    }

    fn attribute(&self, column: usize, name: String) -> Result<Attribute, FormatError> {
        let mut values = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            let value = self.parse(row.cell(column)).ok_or_else(|| self.no_number(row, column, &name))?;
            values.push(value / self.divisor);
        }
        let attribute = Attribute { name, values };
        if let Some((row, _)) = attribute.misfit() {
            let row = &self.rows[row];
            return Err(FormatError::Value {
                place: row.place.cell(column),
                name: clip(&attribute.name),
                value: clip(row.cell(column)),
                allowed: "0 or more, for it is a size".to_owned(),
            });
        }
        Ok(attribute)
    }

    fn check_widths(&self, roles: &[Role]) -> Result<(), FormatError> {
        // Columns at the end that nothing is read from may be missing.
        let needed = roles.iter().rposition(|role| *role != Role::Skipped).map_or(0, |last| last + 1);
        for row in &self.rows {
            // Spreadsheets pad short tables with empty cells.
            if row.cells.len() < needed || row.width() > roles.len() {
                return Err(FormatError::Columns {
                    place: row.place.cell(row.cells.len().min(roles.len())),
                    found: row.cells.len(),
                    expected: roles.len().to_string(),
                });
            }
        }
        Ok(())
    }

    /// The projection of degrees, where these are degrees of one place on a plane, and are not to be kept.
    fn projection(&mut self, positions: &[DVec2], options: &ReadOptions) -> Option<Projection> {
        let (projection, note) = Projection::decide(positions, options.keeps_degrees);
        self.notes.extend(note);
        projection.map(|own| self.projection.unwrap_or(own))
    }

    /// Class index of every row; new names are added to `names` as they appear, up to the cap.
    fn classes(&mut self, column: usize, names: &mut Vec<String>) -> Result<Vec<u16>, FormatError> {
        let declared = names.len();
        // Names in the order they appear in, beyond the cap too, with how often they do.
        let mut counts: Vec<(String, usize)> = names.drain(..).map(|name| (name, 0)).collect();
        let mut indices: std::collections::HashMap<String, usize> =
            counts.iter().enumerate().map(|(index, (name, _))| (name.clone(), index)).collect();
        let mut classes = Vec::with_capacity(self.rows.len());
        let mut unknown = 0;
        for row in &self.rows {
            let written = row.cells.get(column).unwrap_or_default();
            // A declared name may have blanks at its ends or another form; otherwise blanks are taken for alignment.
            let index = match indices.get(written) {
                Some(&index) => index,
                None => {
                    let mut name = column_names::normalized(written.trim());
                    if is_missing(&name)
                        && !matches!(name.as_str(), "-" | "--" | "?")
                        && !name.eq_ignore_ascii_case("none")
                    {
                        unknown += 1;
                        name = UNKNOWN_CLASS.to_owned();
                    }
                    match indices.get(&name) {
                        Some(&index) => index,
                        None if check_name(&name).is_err() => {
                            return Err(unfit_name(row.place.cell(column), "class", &name));
                        }
                        None => {
                            indices.insert(name.clone(), counts.len());
                            counts.push((name, 0));
                            counts.len() - 1
                        }
                    }
                }
            };
            counts[index].1 += 1;
            classes.push(index);
        }
        if unknown > 0 {
            let points = counted(unknown, "One point has", "points have");
            self.notes.push(Note::changed(format!(
                "{points} no class, and got the class '{UNKNOWN_CLASS}'. Fill in the class, or take the rows out."
            )));
        }
        let places = self.gather(&counts, declared);
        names.extend(places.names);
        // Below MAX_CLASSES.
        Ok(classes.into_iter().map(|index| places.of[index] as u16).collect())
    }

    /// Within the cap all names stay; beyond it the most frequent ones and those that were declared, and one for the rest.
    fn gather(&mut self, counts: &[(String, usize)], declared: usize) -> Gathered {
        let name = |index: usize| counts[index].0.clone();
        if counts.len() <= MAX_CLASSES {
            return Gathered { names: (0..counts.len()).map(name).collect(), of: (0..counts.len()).collect() };
        }
        let mut order: Vec<usize> = (0..counts.len()).filter(|&index| counts[index].0 != OTHER_CLASS).collect();
        // Stable: of equally frequent ones the first.
        order.sort_by_key(|&index| (index >= declared, std::cmp::Reverse(counts[index].1)));
        let mut kept: Vec<usize> = order[..MAX_CLASSES - 1].to_vec();
        kept.sort_unstable();
        let mut of = vec![MAX_CLASSES - 1; counts.len()];
        kept.iter().enumerate().for_each(|(class, &index)| of[index] = class);
        let gathered: usize = (0..counts.len()).filter(|&i| of[i] == MAX_CLASSES - 1).map(|i| counts[i].1).sum();
        self.notes.push(Note::changed(format!(
            "There are {} classes, and a pattern may have {MAX_CLASSES}: the {} most frequent ones stay, and the \
             others, {} altogether, \
             became the class '{OTHER_CLASS}'. Put classes together in the file if others matter.",
            counts.len(),
            MAX_CLASSES - 1,
            counted(gathered, "one point", "points"),
        )));
        let names = kept.into_iter().map(name).chain([OTHER_CLASS.to_owned()]).collect();
        Gathered { names, of }
    }
}

/// Classes within the cap.
struct Gathered {
    names: Vec<String>,
    /// Of every name that was there, its class now.
    of: Vec<usize>,
}
