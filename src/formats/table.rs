//! Rows of text cells, however they were stored, become a pattern here: one place that knows what a column means.

use glam::DVec2;

use super::declaration::Declared;
use super::error::{FormatError, Place, clip};
use super::guess::Guess;
use super::{FileFormat, ReadOptions, Reading};
use crate::pattern::{
    Attribute, Boundary, MAX_ATTRIBUTES, MAX_CLASSES, MAX_NAME_LENGTH, MAX_POINTS, PatternError, PointPattern,
    check_name,
};

/// Most columns of a table, skipped ones included.
const MAX_COLUMNS: usize = 64;
/// In front of an attribute's name in a header, it keeps the name from being taken for something else.
pub(super) const ATTRIBUTE_PREFIX: &str = "attribute:";

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
}

/// One row as it was written.
#[derive(Debug)]
pub(super) struct Row {
    pub(super) place: RowPlace,
    pub(super) cells: Vec<String>,
}

impl Row {
    fn is_blank(&self) -> bool {
        self.cells.iter().all(|cell| cell.trim().is_empty())
    }
}

/// What a column holds.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Role {
    X,
    Y,
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
    rows: Vec<Row>,
    /// Known beforehand where the format fixes the columns; read from the header or guessed otherwise.
    pub(super) roles: Option<Vec<Role>>,
    /// The names of the columns, where the format tells them in another way than by a first row.
    pub(super) header: Option<Vec<String>>,
    /// What the first columns hold, whatever they are called: x and y of GeoJSON.
    pub(super) fixed: Vec<Role>,
    /// `0,5` means one half.
    pub(super) decimal_comma: bool,
    /// Every number is divided by this.
    pub(super) divisor: f64,
}

impl Table {
    pub(super) fn new(declared: Declared) -> Self {
        Self {
            declared,
            rows: Vec::new(),
            roles: None,
            header: None,
            fixed: Vec::new(),
            decimal_comma: false,
            divisor: 1.0,
        }
    }

    /// Adds a row; blank ones are left out.
    pub(super) fn push(&mut self, row: Row) -> Result<(), FormatError> {
        if row.is_blank() {
            return Ok(());
        }
        if row.cells.len() > MAX_COLUMNS {
            return Err(FormatError::TooMany { place: row.place.cell(MAX_COLUMNS), what: "columns", max: MAX_COLUMNS });
        }
        // One row more than points: a header may be among them.
        if self.rows.len() > MAX_POINTS {
            return Err(FormatError::TooMany { place: row.place.cell(0), what: "points", max: MAX_POINTS });
        }
        self.rows.push(row);
        Ok(())
    }

    /// The pattern these rows describe.
    pub(super) fn into_reading(mut self, format: FileFormat, options: &ReadOptions) -> Result<Reading, FormatError> {
        let roles = match self.roles.take() {
            Some(roles) => roles,
            None => match self.take_header()? {
                Some(roles) => roles,
                None => self.guess_roles()?,
            },
        };
        if let Some(row) = self.rows.get(MAX_POINTS) {
            return Err(FormatError::TooMany { place: row.place.cell(0), what: "points", max: MAX_POINTS });
        }
        if self.rows.is_empty() {
            return Err(FormatError::NoPoints);
        }
        self.check_widths(&roles)?;

        let mut positions = vec![DVec2::ZERO; self.rows.len()];
        let mut classes = Vec::new();
        let mut class_names = std::mem::take(&mut self.declared.classes);
        if class_names.len() > MAX_CLASSES {
            let count = class_names.len();
            return Err(PatternError::TooMany { what: "classes", count, max: MAX_CLASSES }.into());
        }
        let mut attributes = Vec::new();
        for (column, role) in roles.into_iter().enumerate() {
            match role {
                Role::X => self.numbers(column, "x", |row, value| positions[row].x = value)?,
                Role::Y => self.numbers(column, "y", |row, value| positions[row].y = value)?,
                Role::Class => classes = self.classes(column, &mut class_names)?,
                Role::Attribute(name) => {
                    let mut values = Vec::with_capacity(self.rows.len());
                    self.numbers(column, &name, |_, value| values.push(value))?;
                    let attribute = Attribute { name, values };
                    if let Some((row, _)) = attribute.misfit() {
                        let row = &self.rows[row];
                        return Err(FormatError::Value {
                            place: row.place.cell(column),
                            name: clip(&attribute.name),
                            value: clip(row.cells[column].trim()),
                            allowed: "0 or more, for it is a size".to_owned(),
                        });
                    }
                    attributes.push(attribute);
                }
                Role::Skipped => {}
            }
        }

        let declared = options.domain.or(self.declared.domain);
        let guess = match declared {
            Some(domain) => Guess { domain, choices: Vec::new(), notes: Vec::new() },
            None => Guess::of(&positions)?,
        };
        let domain = guess.domain;
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
        reading.notes.extend(guess.notes);
        Ok(reading)
    }

    /// Takes the first row off when it is a header: it names `x` and `y`, or its first two cells are both words.
    fn take_header(&mut self) -> Result<Option<Vec<Role>>, FormatError> {
        let Some(first) = self.rows.first() else { return Ok(None) };
        let names: Vec<&str> = first.cells.iter().map(|cell| cell.trim()).collect();
        let named = |wanted: &str| names.iter().any(|name| name.eq_ignore_ascii_case(wanted));
        let wordy = names.len() >= 2 && names.iter().take(2).all(|name| self.parse(name).is_none() && !name.is_empty());
        let is_header = wordy || (named("x") && named("y"));
        if !is_header {
            return Ok(None);
        }
        let mut roles: Vec<Role> = Vec::with_capacity(names.len());
        for (column, cell) in first.cells.iter().enumerate() {
            let name = cell.trim();
            let role = if name.is_empty() {
                Role::Skipped
            } else if name.eq_ignore_ascii_case("x") {
                Role::X
            } else if name.eq_ignore_ascii_case("y") {
                Role::Y
            } else if name.eq_ignore_ascii_case("class") {
                Role::Class
            } else {
                Role::Attribute(cell.strip_prefix(ATTRIBUTE_PREFIX).unwrap_or(name).to_owned())
            };
            if let Role::Attribute(name) = &role {
                if check_name(name).is_err() {
                    return Err(unfit_name(first.place.cell(column), "the column's name", name));
                }
                let attributes = roles.iter().filter(|role| matches!(role, Role::Attribute(_))).count();
                if attributes >= MAX_ATTRIBUTES && !roles.contains(&role) {
                    let place = first.place.cell(column);
                    return Err(FormatError::TooMany { place, what: "attributes", max: MAX_ATTRIBUTES });
                }
            }
            if role != Role::Skipped && roles.contains(&role) {
                return Err(FormatError::DuplicateColumn { place: first.place.cell(column), name: clip(name) });
            }
            roles.push(role);
        }
        for (name, role) in [("x", Role::X), ("y", Role::Y)] {
            if !roles.contains(&role) {
                let line = match first.place {
                    RowPlace::Line(line) => line,
                    RowPlace::Entry(entry, at) => at.map_or(entry, |(line, _)| line),
                };
                return Err(FormatError::MissingColumn { line, name, found: clip(&names.join(", ")) });
            }
        }
        self.rows.remove(0);
        Ok(Some(roles))
    }

    /// Without a header: x, y, then a class or an attribute, then attributes.
    fn guess_roles(&self) -> Result<Vec<Role>, FormatError> {
        let Some(first) = self.rows.first() else { return Ok(Vec::new()) };
        let width = first.cells.len();
        if width < 2 {
            return Err(FormatError::Columns {
                place: first.place.cell(0),
                found: width,
                expected: "at least 2 (x and y)".to_owned(),
            });
        }
        let mut roles = vec![Role::X, Role::Y];
        let classes = width > 2 && self.third_column_is_class();
        if classes {
            roles.push(Role::Class);
        }
        for number in 1..=width - roles.len() {
            roles.push(Role::Attribute(format!("attribute-{number}")));
        }
        if width - 2 - usize::from(classes) > MAX_ATTRIBUTES {
            return Err(FormatError::TooMany {
                place: first.place.cell(width - 1),
                what: "attributes",
                max: MAX_ATTRIBUTES,
            });
        }
        Ok(roles)
    }

    /// Words are classes; so are whole numbers, as long as there are no more different ones than classes allowed.
    fn third_column_is_class(&self) -> bool {
        let cells = || self.rows.iter().filter_map(|row| row.cells.get(2)).map(|cell| cell.trim());
        if cells().any(|cell| !cell.is_empty() && self.parse(cell).is_none()) {
            return true;
        }
        let mut distinct: Vec<&str> = Vec::new();
        for cell in cells() {
            if cell.parse::<i64>().is_err() {
                return false;
            }
            if !distinct.contains(&cell) {
                distinct.push(cell);
            }
            if distinct.len() > MAX_CLASSES {
                return false;
            }
        }
        true
    }

    fn check_widths(&self, roles: &[Role]) -> Result<(), FormatError> {
        for row in &self.rows {
            let found = row.cells.len();
            // Spreadsheets pad short tables with empty cells.
            let surplus = row.cells.iter().skip(roles.len()).any(|cell| !cell.trim().is_empty());
            if found < roles.len() || surplus {
                return Err(FormatError::Columns {
                    place: row.place.cell(found.min(roles.len())),
                    found,
                    expected: roles.len().to_string(),
                });
            }
        }
        Ok(())
    }

    fn parse(&self, cell: &str) -> Option<f64> {
        if self.decimal_comma && cell.contains(',') && !cell.contains('.') {
            return cell.replacen(',', ".", 1).parse().ok();
        }
        cell.parse().ok()
    }

    fn numbers(&self, column: usize, name: &str, mut store: impl FnMut(usize, f64)) -> Result<(), FormatError> {
        for (index, row) in self.rows.iter().enumerate() {
            let cell = row.cells[column].trim();
            match self.parse(cell).filter(|value| value.is_finite()) {
                Some(value) => store(index, value / self.divisor),
                None => {
                    return Err(FormatError::Value {
                        place: row.place.cell(column),
                        name: clip(name),
                        value: clip(cell),
                        allowed: "a finite number".to_owned(),
                    });
                }
            }
        }
        Ok(())
    }

    /// Class index of every row; new names are added to `names` as they appear.
    fn classes(&self, column: usize, names: &mut Vec<String>) -> Result<Vec<u16>, FormatError> {
        let mut classes = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            let written = &row.cells[column];
            // A declared name may have blanks at its ends; otherwise they are taken for alignment.
            let name = if names.contains(written) { written.as_str() } else { written.trim() };
            let refuse = |allowed: String| {
                Err(FormatError::Value {
                    place: row.place.cell(column),
                    name: "class".to_owned(),
                    value: clip(name),
                    allowed,
                })
            };
            if name.is_empty() {
                return refuse("a word or a number".to_owned());
            }
            let class = match names.iter().position(|known| known == name) {
                Some(class) => class,
                None if names.len() >= MAX_CLASSES => {
                    return refuse(format!("one of the {MAX_CLASSES} classes before it; more are not allowed"));
                }
                None if check_name(name).is_err() => return Err(unfit_name(row.place.cell(column), "class", name)),
                None => {
                    names.push(name.to_owned());
                    names.len() - 1
                }
            };
            // Below MAX_CLASSES.
            classes.push(class as u16);
        }
        Ok(classes)
    }
}
