//! What each column of a table holds: places, classes, attributes, or something a pattern has no room for.

use std::collections::HashSet;

use super::column_names::{self, Sureness};
use super::error::{FormatError, clip};
use super::header::Header;
use super::number::is_missing;
use super::table::{ATTRIBUTE_PREFIX, Role, RowPlace, Table, unfit_name};
use super::{Column, ColumnRole, Note, Origin, ReadOptions};
use crate::pattern::{MAX_ATTRIBUTES, MAX_CLASSES, check_name};

/// Values of a column that a person sees before choosing.
const EXAMPLES: usize = 3;
/// Names that a note spells out.
const NAMED: usize = 8;

/// What the cells of a column are.
#[derive(Debug)]
pub(super) struct Survey {
    /// Cells that are numbers, that say there is no value, and all others.
    numbers: usize,
    missing: usize,
    words: usize,
    /// The first cell without a value, and the first one that is no number.
    first_missing: Option<RowPlace>,
    first_word: Option<(RowPlace, String)>,
    /// Whether all numbers are whole.
    is_whole: bool,
    /// Whether the cells are 0, 1, 2, … or 1, 2, 3, … .
    counts: bool,
    /// Different cells, at most one more than there may be classes.
    distinct: usize,
    /// Whether no cell is there twice.
    all_differ: bool,
    /// Whether every cell with a value is `POINT (1 2)`.
    is_points: bool,
    examples: Vec<String>,
}

impl Survey {
    fn of(table: &Table, column: usize) -> Self {
        let mut survey = Self {
            numbers: 0,
            missing: 0,
            words: 0,
            first_missing: None,
            first_word: None,
            is_whole: true,
            counts: true,
            distinct: 0,
            all_differ: true,
            is_points: true,
            examples: Vec::new(),
        };
        let mut seen: HashSet<&str> = HashSet::new();
        let mut begin = None;
        for (index, row) in table.rows.iter().enumerate() {
            let cell = row.cell(column);
            if survey.examples.len() < EXAMPLES && !cell.is_empty() {
                survey.examples.push(clip(cell));
            }
            match table.parse(cell) {
                Some(value) => {
                    survey.numbers += 1;
                    survey.is_whole &= value.fract() == 0.0;
                    let from = value - index as f64;
                    survey.counts &= (from == 0.0 || from == 1.0) && *begin.get_or_insert(from) == from;
                    survey.is_points = false;
                }
                None if is_missing(cell) => {
                    survey.missing += 1;
                    survey.first_missing = survey.first_missing.or(Some(row.place));
                    survey.counts = false;
                    continue;
                }
                None => {
                    survey.words += 1;
                    if survey.first_word.is_none() {
                        survey.first_word = Some((row.place, clip(cell)));
                    }
                    survey.counts = false;
                    survey.is_points &= is_empty_point(cell) || point_of(cell).is_some();
                }
            }
            survey.all_differ &= seen.insert(cell);
        }
        survey.distinct = seen.len();
        survey.is_points &= survey.words > 0;
        survey
    }

    fn is_numeric(&self) -> bool {
        self.words == 0 && self.numbers > 0
    }

    /// Words, or whole numbers, few enough to be classes.
    fn may_be_class(&self) -> bool {
        (2..=MAX_CLASSES).contains(&self.distinct) && (self.words > 0 || self.is_whole)
    }
}

/// What is read from which column.
#[derive(Debug)]
pub(super) struct Choice {
    pub(super) roles: Vec<Role>,
    pub(super) columns: Vec<Column>,
    pub(super) is_in_degrees: bool,
    pub(super) origin: Origin,
    pub(super) notes: Vec<Note>,
}

impl Choice {
    /// Of a format that fixes its columns.
    pub(super) fn fixed(roles: Vec<Role>) -> Self {
        Self { roles, columns: Vec::new(), is_in_degrees: false, origin: Origin::default(), notes: Vec::new() }
    }

    /// By the choice of a person, else by the names, else by what the cells are.
    pub(super) fn of(table: &Table, header: Option<&Header>, options: &ReadOptions) -> Result<Self, FormatError> {
        let width = match header {
            Some(header) => header.names.len(),
            None => {
                // A separator at the end of every row parts nothing.
                let widest = table.rows.iter().map(super::table::Row::width).max().unwrap_or_default();
                table.rows.first().map_or(0, |row| row.cells.len().min(widest))
            }
        };
        let surveys: Vec<Survey> = (0..width).map(|column| Survey::of(table, column)).collect();
        let names: Vec<String> = match header {
            Some(header) => header.names.clone(),
            None => vec![String::new(); width],
        };
        let mut chooser =
            Chooser { table, header, names, surveys, options, roles: vec![Role::Skipped; width], notes: Vec::new() };
        let outcome = chooser.choose();
        let columns = chooser.columns();
        let Chooser { roles, notes, .. } = chooser;
        match outcome {
            Ok((is_in_degrees, origin)) => Ok(Self { roles, columns, is_in_degrees, origin, notes }),
            Err(error) => Err(error.with_columns(&columns)),
        }
    }
}

struct Chooser<'a> {
    table: &'a Table,
    header: Option<&'a Header>,
    /// One a column, empty where there is none.
    names: Vec<String>,
    surveys: Vec<Survey>,
    options: &'a ReadOptions,
    roles: Vec<Role>,
    notes: Vec<Note>,
}

impl Chooser<'_> {
    /// Fills in the roles; tells whether the places are degrees, and what things were called.
    fn choose(&mut self) -> Result<(bool, Origin), FormatError> {
        let chosen = &self.options.columns;
        for (column, role) in self.table.fixed.iter().enumerate().take(self.roles.len()) {
            let is_chosen = match role {
                Role::X => chosen.x.is_some(),
                Role::Y => chosen.y.is_some(),
                _ => false,
            };
            if !is_chosen {
                self.roles[column] = role.clone();
            }
        }
        let is_in_degrees = self.choose_places()?;
        self.choose_class()?;
        self.choose_attributes()?;
        Ok((is_in_degrees, self.origin(is_in_degrees)))
    }

    /// What a person calls a column.
    fn called(&self, column: usize) -> String {
        match self.names.get(column).map(|name| name.trim()) {
            Some(name) if !name.is_empty() => name.to_owned(),
            _ => (column + 1).to_string(),
        }
    }

    fn columns(&self) -> Vec<Column> {
        let role = |role: &Role| match role {
            Role::X => ColumnRole::X,
            Role::Y => ColumnRole::Y,
            Role::Place => ColumnRole::Place,
            Role::Class => ColumnRole::Class,
            Role::Attribute(name) => ColumnRole::Attribute(name.clone()),
            Role::Skipped => ColumnRole::LeftOut,
        };
        let describe = |(column, survey): (usize, &Survey)| Column {
            name: self.called(column),
            role: role(&self.roles[column]),
            examples: survey.examples.clone(),
            is_numeric: survey.is_numeric(),
        };
        // What the format fixes is nothing to choose from.
        self.surveys.iter().enumerate().skip(self.table.fixed.len()).map(describe).collect()
    }

    /// The column that a person means: by its name, by its name without the unit, or by its number.
    fn find(&self, wanted: &str) -> Result<usize, FormatError> {
        let wanted = column_names::normalized(wanted.trim());
        // A property may be called as what the format fixes is, and only the property can be meant.
        let fixed = self.table.fixed.len();
        let position = |same: &dyn Fn(&str) -> bool| {
            let free = self.names.iter().skip(fixed).position(|name| same(name.trim())).map(|at| fixed + at);
            free.or_else(|| self.names.iter().position(|name| same(name.trim())))
        };
        position(&|name| name == wanted)
            .or_else(|| position(&|name| name.eq_ignore_ascii_case(&wanted)))
            .or_else(|| {
                position(&|name| !name.is_empty() && column_names::split_unit(name).0.eq_ignore_ascii_case(&wanted))
            })
            .or_else(|| wanted.parse::<usize>().ok()?.checked_sub(1).filter(|&column| column < self.names.len()))
            .ok_or_else(|| FormatError::NoColumn { name: clip(&wanted), found: self.list_of(0..self.names.len()) })
    }

    fn list_of(&self, columns: impl Iterator<Item = usize>) -> String {
        let name = |column: usize| match self.names[column].trim() {
            "" => format!("column {}", column + 1),
            name => clip(name),
        };
        list(&columns.map(name).collect::<Vec<_>>())
    }

    fn place(&self, column: usize) -> super::Place {
        let row = self.header.map(|header| header.place).or(self.table.rows.first().map(|row| row.place));
        row.unwrap_or(RowPlace::Line(1)).cell(column)
    }

    fn set(&mut self, column: usize, role: Role) -> Result<(), FormatError> {
        if !matches!(self.roles[column], Role::Skipped) {
            let name = clip(&self.called(column));
            return Err(FormatError::ColumnTwice { name });
        }
        self.roles[column] = role;
        Ok(())
    }

    fn has(&self, role: &Role) -> bool {
        self.roles.contains(role)
    }

    /// Whether the name says that the column is an attribute, whatever it is called.
    fn is_marked(&self, column: usize) -> bool {
        self.names[column].starts_with(ATTRIBUTE_PREFIX)
    }

    fn choose_places(&mut self) -> Result<bool, FormatError> {
        let chosen = &self.options.columns;
        if let Some(x) = &chosen.x {
            let column = self.find(x)?;
            if self.surveys[column].is_points && chosen.y.as_ref().is_none_or(|y| self.find(y) == Ok(column)) {
                self.set(column, Role::Place)?;
                return Ok(false);
            }
            self.set(column, Role::X)?;
        }
        if let Some(y) = &chosen.y {
            self.set(self.find(y)?, Role::Y)?;
        }
        if self.has(&Role::X) && self.has(&Role::Y) {
            let names = [Role::X, Role::Y].map(|role| self.roles.iter().position(|known| *known == role));
            let is_degrees = |column: Option<usize>| {
                column
                    .and_then(|column| column_names::place_name(&self.names[column]))
                    .is_some_and(|place| place.sureness == Sureness::Degrees)
            };
            let are_fixed = self.table.is_in_degrees && self.roles.starts_with(&self.table.fixed);
            return Ok(are_fixed || names.into_iter().all(is_degrees));
        }
        if self.header.is_none() {
            self.guess_places()?;
            return Ok(false);
        }
        let visible: Vec<&str> = (0..self.names.len())
            // A column that is taken, marked as an attribute or holds no number is no place.
            .map(|column| match self.roles[column] {
                Role::Skipped if !self.is_marked(column) => self.names[column].trim(),
                _ => "",
            })
            .collect();
        self.refuse_twice(&visible)?;
        if let Some(([x, y], sureness)) = column_names::place_columns(&visible)
            && !self.has(&Role::X)
            && !self.has(&Role::Y)
        {
            // Words with an x may be anything; a column of places as text is surer.
            let geometry = self.geometry();
            if sureness <= Sureness::Degrees || geometry.is_none() {
                self.roles[x] = Role::X;
                self.roles[y] = Role::Y;
                if sureness > Sureness::Degrees {
                    let (x, y) = (self.called(x), self.called(y));
                    self.notes.push(Note::changed(format!(
                        "The places were read from the columns '{x}' and '{y}'. If others are meant, choose them in the import \
                         dialog or with --columns x=…,y=…."
                    )));
                }
                return Ok(sureness == Sureness::Degrees);
            }
        }
        if let Some(column) = self.geometry().filter(|_| !self.has(&Role::X) && !self.has(&Role::Y)) {
            self.roles[column] = Role::Place;
            return Ok(false);
        }
        self.refuse_missing(&visible)
    }

    /// Two columns of one name, of which one would have to be chosen.
    fn refuse_twice(&self, names: &[&str]) -> Result<(), FormatError> {
        for wanted in ["x", "y"] {
            let mut same = (0..names.len()).filter(|&column| names[column].eq_ignore_ascii_case(wanted));
            if let (Some(_), Some(second)) = (same.next(), same.next()) {
                return Err(FormatError::DuplicateColumn { place: self.place(second), name: clip(names[second]) });
            }
        }
        Ok(())
    }

    fn refuse_missing(&self, visible: &[&str]) -> Result<bool, FormatError> {
        let named = |wanted: &str| visible.iter().any(|name| name.eq_ignore_ascii_case(wanted));
        let name = if named("x") || self.has(&Role::X) { "y" } else { "x" };
        let line = self.header.map_or(1, |header| header.place.line());
        Err(FormatError::MissingColumn { line, name, found: self.list_of(0..self.names.len()) })
    }

    /// The column of places as text.
    fn geometry(&self) -> Option<usize> {
        let free = |column: &usize| self.roles[*column] == Role::Skipped && self.surveys[*column].is_points;
        let mut columns = (0..self.names.len()).filter(free);
        let first = columns.next()?;
        Some(columns.chain([first]).find(|&column| column_names::is_geometry(&self.names[column])).unwrap_or(first))
    }

    /// Without a header: the first two columns, or the first two of numbers behind a column of words.
    fn guess_places(&mut self) -> Result<(), FormatError> {
        if let Some(column) = self.geometry() {
            self.roles[column] = Role::Place;
            return Ok(());
        }
        if self.roles.len() < 2 {
            let found = self.roles.len();
            let expected = "at least 2 (x and y)".to_owned();
            return Err(FormatError::Columns { place: self.place(0), found, expected });
        }
        let is_free = |column: &usize| self.roles[*column] == Role::Skipped;
        let mut free: Vec<usize> = (0..self.roles.len()).filter(is_free).collect();
        let is_tag = |column: usize| self.surveys[column].words > 0 && self.surveys[column].numbers == 0;
        if let [tag, x, y, ..] = free[..]
            && is_tag(tag)
            && self.surveys[tag].words > 1
            && self.surveys[x].is_numeric()
            && self.surveys[y].is_numeric()
        {
            free.remove(0);
        }
        let mut free = free.into_iter();
        for role in [Role::X, Role::Y] {
            if !self.has(&role)
                && let Some(column) = free.next()
            {
                self.roles[column] = role;
            }
        }
        Ok(())
    }

    fn choose_class(&mut self) -> Result<(), FormatError> {
        match self.options.columns.class.as_deref() {
            Some("") => return Ok(()),
            Some(name) => return self.set(self.find(name)?, Role::Class),
            None => {}
        }
        let is_free = |column: &usize| self.roles[*column] == Role::Skipped && !self.is_marked(*column);
        let free: Vec<usize> = (0..self.roles.len()).filter(is_free).collect();
        if self.header.is_none() {
            if let Some(column) = self.unnamed_class(&free) {
                self.roles[column] = Role::Class;
            }
            return Ok(());
        }
        let mut named: Vec<(usize, usize)> =
            free.iter().filter_map(|&column| Some((column_names::class_rank(&self.names[column])?, column))).collect();
        named.sort_unstable();
        if let [(0, first), (0, second), ..] = named[..] {
            let name = clip(self.names[second].trim());
            return Err(FormatError::DuplicateColumn { place: self.place(second.max(first)), name });
        }
        // Many different numbers are a quantity, whatever they are called.
        let may_be = |column: usize| self.surveys[column].words > 0 || self.surveys[column].distinct <= MAX_CLASSES;
        let by_name =
            named.into_iter().find(|&(rank, column)| rank == 0 && may_be(column) || self.is_class(column, true));
        let found = by_name.map(|(_, column)| column).or_else(|| {
            let is_text = |&column: &usize| self.surveys[column].words > 0 && self.is_class(column, false);
            free.iter().copied().find(is_text)
        });
        if let Some(column) = found {
            self.roles[column] = Role::Class;
        }
        Ok(())
    }

    /// Whether a column whose name does not settle it holds classes.
    fn is_class(&self, column: usize, is_named: bool) -> bool {
        let survey = &self.surveys[column];
        if survey.is_points || survey.words + survey.numbers < 2 || survey.words > 0 && self.is_unfit(column) {
            return false;
        }
        if is_named && survey.words > 0 {
            // More than there may be are gathered, but names that are all different tell no class.
            return survey.distinct >= 2 && (survey.distinct <= MAX_CLASSES || 2 * survey.distinct <= survey.words);
        }
        survey.may_be_class() && 2 * survey.distinct <= survey.words + survey.numbers
    }

    /// Whether a cell can't be the name of a class.
    fn is_unfit(&self, column: usize) -> bool {
        let mut cells = self.table.rows.iter().map(|row| row.cell(column));
        cells.any(|cell| !is_missing(cell) && check_name(&column_names::normalized(cell)).is_err())
    }

    /// The third column holds classes when there is a word in it, or only a few different whole numbers.
    fn unnamed_class(&self, free: &[usize]) -> Option<usize> {
        let tag =
            free.iter().copied().find(|&column| column == 0 && self.surveys[0].words > 1 && self.is_class(0, true));
        let third = free.iter().copied().find(|&column| column > 0);
        let is_class = |column: usize| {
            let survey = &self.surveys[column];
            survey.words > 0
                || survey.is_whole && survey.numbers > 0 && survey.missing == 0 && survey.distinct <= MAX_CLASSES
        };
        third.filter(|&column| is_class(column)).or(tag)
    }

    fn choose_attributes(&mut self) -> Result<(), FormatError> {
        let chosen = &self.options.columns;
        if let Some(radius) = &chosen.radius {
            let name = crate::pattern::RADIUS_ATTRIBUTE.to_owned();
            self.set(self.find(radius)?, Role::Attribute(name))?;
        }
        if let Some(list) = &chosen.attributes {
            for (name, column) in list {
                let column = self.find(column)?;
                if check_name(name).is_err() {
                    return Err(unfit_name(self.place(column), "the attribute's name", name));
                }
                self.set(column, Role::Attribute(name.clone()))?;
            }
            return self.cap_chosen();
        }
        let mut text = Vec::new();
        let mut numbers_of_rows = Vec::new();
        let mut gaps = Vec::new();
        let mut beyond = Vec::new();
        let mut unnamed = 0;
        let places = self.roles.iter().position(|role| matches!(role, Role::X | Role::Place)).unwrap_or_default();
        for column in 0..self.roles.len() {
            let survey = &self.surveys[column];
            // A column without a value holds nothing that could be lost.
            if self.roles[column] != Role::Skipped || survey.numbers + survey.words == 0 {
                continue;
            }
            let name = self.names[column].trim();
            let marked = self.is_marked(column);
            if self.header.is_some() && name.is_empty() && survey.counts {
                continue;
            }
            if survey.words > 0 {
                // A typing error among numbers is worth a place.
                match &survey.first_word {
                    Some((place, word)) if survey.numbers > survey.words => {
                        gaps.push(format!("'{}' ({word:?} {})", clip(&self.called(column)), place.name()));
                    }
                    _ => text.push(column),
                }
                continue;
            }
            let counts = survey.counts && self.table.rows.len() > 2;
            let is_identifier = column_names::is_identifier(name) && survey.is_whole && survey.all_differ
                || counts && (name.is_empty() || column < places);
            if !marked && self.header.is_some() && is_identifier && self.table.rows.len() > 1 {
                numbers_of_rows.push(column);
                continue;
            }
            if self.header.is_some() && name.is_empty() {
                text.push(column);
                continue;
            }
            if let Some(place) = survey.first_missing {
                let count = super::note::counted(survey.missing, "none", "values missing, the first");
                gaps.push(format!("'{}' ({count} {})", clip(&self.called(column)), place.name()));
                continue;
            }
            if self.attributes() >= MAX_ATTRIBUTES {
                beyond.push(column);
                continue;
            }
            let name = if self.header.is_none() {
                unnamed += 1;
                format!("attribute-{unnamed}")
            } else {
                self.attribute_name(column)
            };
            if check_name(&name).is_err() {
                return Err(unfit_name(self.place(column), "the column's name", &name));
            }
            if self.has(&Role::Attribute(name.clone())) {
                return Err(FormatError::DuplicateColumn { place: self.place(column), name: clip(&name) });
            }
            self.roles[column] = Role::Attribute(name);
        }
        self.say_what_is_left_out(&text, &numbers_of_rows, &gaps, &beyond);
        Ok(())
    }

    fn attributes(&self) -> usize {
        self.roles.iter().filter(|role| matches!(role, Role::Attribute(_))).count()
    }

    fn cap_chosen(&mut self) -> Result<(), FormatError> {
        if self.attributes() > MAX_ATTRIBUTES {
            return Err(FormatError::TooMany { place: self.place(0), what: "attributes", max: MAX_ATTRIBUTES });
        }
        Ok(())
    }

    /// The header as it stands, but for names that mean something: those lose their unit.
    fn attribute_name(&self, column: usize) -> String {
        let name = &self.names[column];
        match name.strip_prefix(ATTRIBUTE_PREFIX) {
            Some(rest) => rest.to_owned(),
            None => match column_names::split_unit(name) {
                (base, Some(_)) if let Some(special) = column_names::special(base) => special.to_owned(),
                _ => name.trim().to_owned(),
            },
        }
    }

    fn say_what_is_left_out(&mut self, text: &[usize], numbers: &[usize], gaps: &[String], beyond: &[usize]) {
        let names = |columns: &[usize]| self.list_of(columns.iter().copied());
        let plural = |count: usize, one: &str, many: &str| super::note::counted(count, one, many);
        let mut notes = Vec::new();
        if !text.is_empty() {
            let what = plural(text.len(), "One column was", "columns were");
            notes.push(format!(
                "{what} left out, as a pattern has no room for text: {}. One with few different words can be the class: choose \
                 it in the import dialog or with --columns class=….",
                names(text)
            ));
        }
        if !numbers.is_empty() {
            let what = plural(numbers.len(), "One column of running numbers was", "columns of running numbers were");
            notes.push(format!(
                "{what} left out: {}. If they measure something, choose them as attributes.",
                names(numbers)
            ));
        }
        if !gaps.is_empty() {
            let what = plural(gaps.len(), "One column was", "columns were");
            notes.push(format!(
                "{what} left out, as not every row has a number there: {}. Fill in the values; or choose the column as an \
                 attribute, and the rows without a value are left out instead.",
                list(gaps)
            ));
        }
        if !beyond.is_empty() {
            let what = plural(beyond.len(), "One more column of numbers was", "more columns of numbers were");
            notes.push(format!(
                "{what} left out, as a pattern has at most {MAX_ATTRIBUTES} attributes: {}. Choose the ones that matter in the \
                 import dialog or with --columns name=….",
                names(beyond)
            ));
        }
        self.notes.extend(notes.into_iter().map(Note::left_out));
    }

    /// What the columns were called, and in which units they are.
    fn origin(&mut self, is_in_degrees: bool) -> Origin {
        let mut origin = Origin::default();
        let Some(header) = self.header else { return origin };
        let unit = |column: usize| -> Option<String> {
            let by_row = header.units.get(column).filter(|unit| !unit.is_empty());
            by_row.cloned().or_else(|| column_names::split_unit(&header.names[column]).1.map(str::to_owned))
        };
        let mut axes: [Option<usize>; 2] = [None; 2];
        for (column, role) in self.roles.iter().enumerate() {
            match role {
                Role::X => axes[0] = Some(column),
                Role::Y => axes[1] = Some(column),
                Role::Class => {
                    origin.class = Some(self.names[column].trim().to_owned()).filter(|name| !name.is_empty())
                }
                Role::Attribute(name) => {
                    let header = self.names[column].trim();
                    if header != name && !header.is_empty() && !header.starts_with(ATTRIBUTE_PREFIX) {
                        origin.attributes.push((name.clone(), header.to_owned()));
                    }
                }
                Role::Place | Role::Skipped => {}
            }
        }
        if let [Some(x), Some(y)] = axes {
            let names = [x, y].map(|column| self.names[column].trim().to_owned());
            if self.table.fixed.is_empty() && names != ["x", "y"] && names.iter().all(|name| !name.is_empty()) {
                origin.axes = Some(names);
            }
            let units = [unit(x), unit(y)];
            if let [Some(first), Some(second)] = &units
                && first != second
            {
                self.notes.push(Note::odd(format!(
                    "x is in {}, y in {}: distances mean something only when both have one unit.",
                    clip(first),
                    clip(second)
                )));
            }
            let [first, second] = units;
            origin.unit = if is_in_degrees { None } else { first.or(second) };
            if let Some(length) = &origin.unit {
                let radius =
                    self.roles.iter().position(|role| matches!(role, Role::Attribute(name) if name == "radius"));
                if let Some(own) = radius.and_then(unit).filter(|own| own != length) {
                    self.notes.push(Note::odd(format!(
                        "The radius is in {}, the places are in {}: disks are drawn as if both were the same. Convert the radii.",
                        clip(&own),
                        clip(length)
                    )));
                }
            }
        }
        origin
    }
}

/// Names for a sentence, not too many of them.
fn list(names: &[String]) -> String {
    let shown = &names[..names.len().min(NAMED)];
    let more = if names.len() > NAMED { format!(" and {} more", names.len() - NAMED) } else { String::new() };
    shown.join(", ") + &more
}

/// The position in well-known text, as in `POINT (1 2)`, `POINT Z (1 2 3)` and `SRID=4326;POINT(1 2)`.
pub(super) fn point_of(cell: &str) -> Option<[f64; 2]> {
    let text = cell.rsplit(';').next()?.trim();
    let head = text.get(..5).filter(|head| head.eq_ignore_ascii_case("point"))?;
    let (dimensions, numbers) = text.get(head.len()..)?.split_once('(')?;
    if !matches!(dimensions.trim().to_ascii_uppercase().as_str(), "" | "Z" | "M" | "ZM") {
        return None;
    }
    let mut numbers = numbers.strip_suffix(')')?.split_whitespace().map(|word| word.parse::<f64>().ok());
    let [x, y] = [numbers.next()??, numbers.next()??];
    (x.is_finite() && y.is_finite()).then_some([x, y])
}

/// Whether a cell is a point without a place: `POINT EMPTY`.
pub(super) fn is_empty_point(cell: &str) -> bool {
    let text = cell.rsplit(';').next().unwrap_or_default().trim();
    let mut words = text.split_whitespace();
    words.next().is_some_and(|word| word.eq_ignore_ascii_case("point"))
        && words.last().is_some_and(|word| word.eq_ignore_ascii_case("empty"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn well_known_points() {
        for (cell, point) in [
            ("POINT (1 2)", Some([1.0, 2.0])),
            ("Point(1.5 -2e1)", Some([1.5, -20.0])),
            ("SRID=4326;POINT Z (1 2 3)", Some([1.0, 2.0])),
            ("POINT EMPTY", None),
            ("LINESTRING (1 2, 3 4)", None),
            ("POINT (1)", None),
            ("point", None),
            ("éééé", None),
        ] {
            assert_eq!(point_of(cell), point, "{cell}");
        }
        assert!(is_empty_point("POINT EMPTY") && is_empty_point("point z empty") && !is_empty_point("POINT (1 2)"));
    }
}
