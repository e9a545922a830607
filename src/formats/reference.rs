//! The text layout of the method's public reference implementation.
//!
//! One point a line, `class x y [attribute…]`, all whole numbers; positions and attributes are ten-thousandths of the
//! unit square's side. Several classes are announced by a first line `K id₁ … id_K`. A single attribute is the
//! disk's radius.

use super::declaration::Declared;
use super::error::{FormatError, clip};
use super::table::{Role, Row, RowPlace, Table};
use super::whitespace::split_comment;
use crate::pattern::{Domain, MAX_ATTRIBUTES, MAX_CLASSES, MAX_NAME_LENGTH};

/// What stands for 1.
const ONE: i64 = 10_000;

/// Reads `text` if it has this layout: with the announcing line and a first row that fits it, or with whole numbers
/// throughout, classes 1000, 2000, … first and positions in range.
pub(super) fn read(text: &str) -> Option<Result<Table, FormatError>> {
    let lines = || {
        text.lines()
            .enumerate()
            .map(|(index, line)| (index + 1, split_comment(line).0.split_whitespace().collect::<Vec<_>>()))
            .filter(|(_, cells)| !cells.is_empty())
    };
    let mut ahead = lines();
    let (line, first) = ahead.next()?;
    if let Some(ids) = announced(&first) {
        let (_, row) = ahead.next()?;
        if row.len() >= 3 && ids.contains(&row[0]) {
            if ids.len() > MAX_CLASSES {
                // The announced number comes before the ids.
                let place = RowPlace::Line(line).cell(MAX_CLASSES + 1);
                return Some(Err(FormatError::TooMany { place, what: "classes", max: MAX_CLASSES }));
            }
            return Some(table(lines().skip(1), &ids));
        }
    }
    let bare = lines().all(|(_, cells)| {
        let numbers: Option<Vec<i64>> = cells.iter().map(|cell| cell.parse().ok()).collect();
        numbers.is_some_and(|numbers| match numbers.as_slice() {
            [class, x, y, ..] => {
                class % 1000 == 0
                    && (1..=MAX_CLASSES as i64).contains(&(class / 1000))
                    && (0..=ONE).contains(x)
                    && (0..=ONE).contains(y)
            }
            _ => false,
        })
    });
    bare.then(|| table(lines(), &[]))
}

/// The class numbers of a line `K id₁ … id_K`.
fn announced<'a>(cells: &[&'a str]) -> Option<Vec<&'a str>> {
    let count: usize = cells.first()?.parse().ok()?;
    let ids = &cells[1..];
    if count == 0 || count != ids.len() {
        return None;
    }
    let is_id = |id: &str| id.len() <= MAX_NAME_LENGTH && id.parse::<i64>().is_ok();
    let distinct = ids.iter().enumerate().all(|(i, id)| !ids[..i].contains(id) && is_id(id));
    distinct.then(|| ids.to_vec())
}

fn table<'a>(lines: impl Iterator<Item = (usize, Vec<&'a str>)>, ids: &[&str]) -> Result<Table, FormatError> {
    let declared = Declared {
        domain: Some(Domain::UNIT),
        boundary: None,
        classes: ids.iter().map(|id| (*id).to_owned()).collect(),
    };
    let mut table = Table::new(declared);
    table.divisor = ONE as f64;
    for (line, cells) in lines {
        let place = RowPlace::Line(line);
        if cells.len() > 3 + MAX_ATTRIBUTES {
            let place = place.cell(3 + MAX_ATTRIBUTES);
            return Err(FormatError::TooMany { place, what: "attributes", max: MAX_ATTRIBUTES });
        }
        if table.roles.is_none() {
            table.roles = Some(roles(cells.len()));
        }
        if !ids.is_empty() && !ids.contains(&cells[0]) {
            let allowed = format!("one of the announced classes {}", ids.join(", "));
            let value = clip(cells[0]);
            return Err(FormatError::Value { place: place.cell(0), name: "class".to_owned(), value, allowed });
        }
        for (column, name) in [(1, "x"), (2, "y")] {
            if let Some(cell) = cells.get(column)
                && !cell.parse::<i64>().is_ok_and(|value| (0..=ONE).contains(&value))
            {
                let allowed = format!("a whole number from 0 to {ONE}");
                let (name, value) = (name.to_owned(), clip(cell));
                return Err(FormatError::Value { place: place.cell(column), name, value, allowed });
            }
        }
        table.push(Row::new(place, cells))?;
    }
    Ok(table)
}

fn roles(width: usize) -> Vec<Role> {
    let mut roles = vec![Role::Class, Role::X, Role::Y];
    match width.saturating_sub(roles.len()) {
        1 => roles.push(Role::Attribute(super::style::RADIUS_ATTRIBUTE.to_owned())),
        count => roles.extend((1..=count).map(|number| Role::Attribute(format!("attribute-{number}")))),
    }
    roles
}
