//! Colours on the command line.

use rockfall::Scene;
use rockfall_viewer::draw::Style;
use rockfall_viewer::palette::{KINDS, Rgb};

use super::camera::body;
use crate::failure::Failure;

/// Names of colours, as in CSS.
const NAMES: [(&str, Rgb); 14] = [
    ("black", [0, 0, 0]),
    ("blue", [0x2f, 0x6f, 0xd0]),
    ("brown", [0x8b, 0x5a, 0x2b]),
    ("cyan", [0x2a, 0xb7, 0xca]),
    ("green", [0x2e, 0x9b, 0x4f]),
    ("grey", [0x80, 0x80, 0x80]),
    ("magenta", [0xc0, 0x3f, 0xa8]),
    ("navy", [0x14, 0x24, 0x4c]),
    ("orange", [0xee, 0x8a, 0x1d]),
    ("pink", [0xf2, 0x8f, 0xb5]),
    ("purple", [0x7a, 0x4a, 0xb5]),
    ("red", [0xd6, 0x2f, 0x2f]),
    ("white", [0xff, 0xff, 0xff]),
    ("yellow", [0xf2, 0xc9, 0x2c]),
];

/// Parses a colour: a name or six hexadecimal digits.
pub(super) fn colour(text: &str) -> Result<Rgb, String> {
    let digits = text.strip_prefix('#').unwrap_or(text);
    let is_hex = digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    let hex = is_hex.then(|| u32::from_str_radix(digits, 16).ok()).flatten();
    let hex = hex.map(|bits| [(bits >> 16) as u8, (bits >> 8) as u8, bits as u8]);
    let named = || NAMES.iter().find(|(name, _)| name.eq_ignore_ascii_case(text)).map(|(_, colour)| *colour);
    hex.or_else(named).ok_or_else(|| {
        let names: Vec<&str> = NAMES.iter().map(|(name, _)| *name).collect();
        format!("{text}: expected a colour as six hexadecimal digits, as in ff8800, or one of: {}", names.join(" "))
    })
}

/// Colours of the background: at the horizon and straight up.
pub(super) fn background(text: &str) -> Result<[Rgb; 2], String> {
    match text.split_once(',') {
        Some((horizon, zenith)) => Ok([colour(horizon)?, colour(zenith)?]),
        None => colour(text).map(|colour| [colour; 2]),
    }
}

/// A `--colour` argument.
#[derive(Clone, Copy, Debug)]
pub(super) struct Paint {
    what: Painted,
    colour: Rgb,
}

#[derive(Clone, Copy, Debug)]
enum Painted {
    Kind(usize),
    /// Spheres with these numbers.
    Spheres(u32, u32),
}

/// Parses `WHAT=COLOUR`.
pub(super) fn paint(text: &str) -> Result<Paint, String> {
    let expected = || {
        let kinds = KINDS.map(|kind| kind.name.replace(' ', "-")).join(" ");
        format!("expected WHAT=COLOUR, where WHAT is the number of a sphere, a range of numbers as in 1-9, or one of: {kinds}")
    };
    let (what, value) = text.split_once('=').ok_or_else(expected)?;
    let kind = KINDS.iter().position(|kind| kind.name.replace(' ', "-") == what);
    let what = match (kind, what.split_once('-')) {
        (Some(kind), _) => Painted::Kind(kind),
        (None, Some((from, to))) => {
            let ends = from.parse().ok().zip(to.parse().ok()).filter(|(from, to)| from <= to);
            ends.map(|(from, to)| Painted::Spheres(from, to)).ok_or_else(expected)?
        }
        (None, None) => what.parse().map(|number| Painted::Spheres(number, number)).map_err(|_| expected())?,
    };
    Ok(Paint { what, colour: colour(value)? })
}

/// Applies colours to the kinds of a style, and returns those of single spheres by insertion index.
pub(super) fn apply(paints: &[Paint], scene: &Scene, style: &mut Style) -> Result<Vec<Option<Rgb>>, Failure> {
    let mut spheres = Vec::new();
    for Paint { what, colour } in paints {
        let (from, to) = match *what {
            Painted::Kind(kind) => {
                style.kinds[kind] = *colour;
                continue;
            }
            Painted::Spheres(from, to) => (from, to),
        };
        spheres.resize(scene.counts().spheres, None);
        if from == to {
            // A single number must exist; a range may have gaps.
            let sphere = body(scene, from)?;
            let index = scene.sphere_ids().position(|id| id == sphere);
            index.into_iter().for_each(|index| spheres[index] = Some(*colour));
            continue;
        }
        for (index, id) in scene.sphere_ids().enumerate() {
            if (from..=to).contains(&scene.reference(id).unwrap_or(index as u32)) {
                spheres[index] = Some(*colour);
            }
        }
    }
    Ok(spheres)
}
