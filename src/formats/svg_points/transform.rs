//! `transform`, as an attribute and as CSS writes it, with units.

use glam::{DAffine2, DMat2, DVec2};
use svgtypes::{Angle, Length, Transform};

use super::canvas::pixels;

/// The transform of an attribute; `viewport` is what percentages refer to. Programs write CSS there, too.
pub(super) fn attribute(text: &str, viewport: DVec2) -> Option<DAffine2> {
    match text.parse::<Transform>() {
        Ok(Transform { a, b, c, d, e, f }) => Some(matrix([a, b, c, d, e, f])),
        Err(_) => css(text, viewport),
    }
}

/// `translate(10px, 50%) rotate(0.25turn) …`: what of CSS stays in the plane.
pub(super) fn css(text: &str, viewport: DVec2) -> Option<DAffine2> {
    let mut whole = DAffine2::IDENTITY;
    let mut rest = text.trim();
    if rest == "none" {
        return Some(whole);
    }
    while !rest.is_empty() {
        let (name, after) = rest.split_once('(')?;
        let (inner, after) = after.split_once(')')?;
        whole *= function(name.trim(), &words(inner), viewport)?;
        rest = after.trim_start_matches(|c: char| c == ',' || c.is_ascii_whitespace());
    }
    Some(whole)
}

/// The properties `translate`, `rotate` and `scale`, which come before `transform`.
pub(super) fn property(name: &str, value: &str, viewport: DVec2) -> Option<DAffine2> {
    match value.trim() {
        "none" => Some(DAffine2::IDENTITY),
        value => function(name, &words(value), viewport),
    }
}

/// `transform-origin` in a box of this size.
pub(super) fn origin(text: &str, size: DVec2) -> Option<DVec2> {
    let words = words(text);
    let (mut across, mut down) = match words[..] {
        [one] => (one, "center"),
        [across, down] | [across, down, _] => (across, down),
        _ => return None,
    };
    if matches!(across, "top" | "bottom") || matches!(down, "left" | "right") {
        (across, down) = (down, across);
    }
    let place = |word: &str, whole: f64| match word {
        "left" | "top" => Some(0.0),
        "center" => Some(whole / 2.0),
        "right" | "bottom" => Some(whole),
        _ => word.parse::<Length>().ok().map(|length| pixels(length, whole)),
    };
    Some(DVec2::new(place(across, size.x)?, place(down, size.y)?))
}

fn words(text: &str) -> Vec<&str> {
    text.split(|c: char| c == ',' || c.is_ascii_whitespace()).filter(|word| !word.is_empty()).collect()
}

fn matrix(numbers: [f64; 6]) -> DAffine2 {
    DAffine2::from_cols_array(&numbers)
}

fn function(name: &str, words: &[&str], viewport: DVec2) -> Option<DAffine2> {
    let length = |word: &str, whole: f64| word.parse::<Length>().ok().map(|length| pixels(length, whole));
    let number = |word: &str| match word.strip_suffix('%') {
        Some(share) => share.parse::<svgtypes::Number>().ok().map(|share| share.0 / 100.0),
        None => word.parse::<svgtypes::Number>().ok().map(|number| number.0),
    };
    let angle = |word: &str| word.parse::<Angle>().ok().map(|angle| angle.to_degrees().to_radians());
    let shift = |x, y| DAffine2::from_translation(DVec2::new(x, y));
    let stretch = |x, y| DAffine2::from_scale(DVec2::new(x, y));
    let skew = |x: f64, y: f64| DAffine2::from_mat2(DMat2::from_cols_array(&[1.0, y.tan(), x.tan(), 1.0]));
    let (x, y) = (viewport.x, viewport.y);
    Some(match (name, words) {
        ("matrix", &[a, b, c, d, e, f]) => {
            matrix([number(a)?, number(b)?, number(c)?, number(d)?, length(e, x)?, length(f, y)?])
        }
        ("translate" | "translateX", &[right]) => shift(length(right, x)?, 0.0),
        ("translateY", &[down]) => shift(0.0, length(down, y)?),
        // The third goes out of the plane.
        ("translate", &[right, down]) | ("translate3d" | "translate", &[right, down, _]) => {
            shift(length(right, x)?, length(down, y)?)
        }
        ("translateZ", &[_]) => DAffine2::IDENTITY,
        ("scale", &[both]) => stretch(number(both)?, number(both)?),
        ("scale", &[across, down]) | ("scale3d" | "scale", &[across, down, _]) => {
            stretch(number(across)?, number(down)?)
        }
        ("scaleX", &[across]) => stretch(number(across)?, 1.0),
        ("scaleY", &[down]) => stretch(1.0, number(down)?),
        ("rotate" | "rotateZ", &[by]) => DAffine2::from_angle(angle(by)?),
        ("skew", &[by]) | ("skewX", &[by]) => skew(angle(by)?, 0.0),
        ("skew", &[across, down]) => skew(angle(across)?, angle(down)?),
        ("skewY", &[by]) => skew(0.0, angle(by)?),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_apply_from_the_right() {
        let at = |text: &str| {
            let place = |own: DAffine2| own.transform_point2(DVec2::new(1.0, 2.0)).round();
            attribute(text, DVec2::new(200.0, 100.0)).map(place)
        };
        let is = |text: &str, x: f64, y: f64| assert_eq!(at(text), Some(DVec2::new(x, y)), "{text}");
        is("translate(10) scale(2,3)", 12.0, 6.0);
        is("rotate(90)", -2.0, 1.0);
        is("rotate(90, 1 1),translate(0,0)", 0.0, 1.0);
        is("matrix(1 0 0 1 5 -5)", 6.0, -3.0);
        is("translate(10-5.75)translate(.25.25)", 11.0, -4.0);
        is("skewX(45)", 3.0, 2.0);
        is("translate(10px, 1in)", 11.0, 98.0);
        is("translate(50%,50%)", 101.0, 52.0);
        is("rotate(0.25turn)", -2.0, 1.0);
        is("rotate(100grad) translateX(3px)", -2.0, 4.0);
        is("rotate(1.5707963rad)", -2.0, 1.0);
        is("scaleY(-1) translateY(4)", 1.0, -6.0);
        is("translate3d(1px, 2px, 3px) scale(200%)", 3.0, 6.0);
        is("skew(45deg, 0)", 3.0, 2.0);
        is("none", 1.0, 2.0);
        for wrong in
            ["spin(1)", "scale(1", "scale()", "matrix(1 2 3)", "scale(x)", "perspective(3px)", "translate(1em2)"]
        {
            assert_eq!(at(wrong), None, "{wrong}");
        }
        for (text, x, y) in [
            ("center", 10.0, 4.0),
            ("top", 10.0, 0.0),
            ("right bottom", 20.0, 8.0),
            ("bottom left", 0.0, 8.0),
            ("25% 3px", 5.0, 3.0),
            ("1 2 0", 1.0, 2.0),
        ] {
            assert_eq!(origin(text, DVec2::new(20.0, 8.0)), Some(DVec2::new(x, y)), "{text}");
        }
        let own = |name, value| property(name, value, DVec2::ONE).map(|own| own.transform_point2(DVec2::X).round());
        assert_eq!(own("translate", "3px 4px"), Some(DVec2::new(4.0, 4.0)));
        assert_eq!(own("rotate", "90deg"), Some(DVec2::Y));
        assert_eq!(own("scale", "2"), Some(DVec2::new(2.0, 0.0)));
    }
}
