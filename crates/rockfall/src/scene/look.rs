//! Looks of objects: the patterns and materials that pictures show them with.

use std::fmt;
use std::str::FromStr;

use super::Colour;
use crate::error::{Error, Result, nearest, quoted};

/// How the surface of an object is drawn. As text it is a name of [`Look::NAMES`]. No result depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Look {
    /// One colour without a pattern.
    Plain,
    /// Stripes of two tones: the pattern of a beach ball on spheres.
    Striped,
    /// Rings and grain in shades of the colour.
    Wood,
    /// Mottled in shades of the colour, and matt.
    Stone,
    /// See-through with clear edges. It casts a light shadow.
    Glass,
}

impl Look {
    /// All looks, in the order of [`Look::NAMES`].
    pub const ALL: [Self; 5] = [Self::Plain, Self::Striped, Self::Wood, Self::Stone, Self::Glass];

    /// The names of looks.
    pub const NAMES: [&str; 5] = ["plain", "striped", "wood", "stone", "glass"];

    /// The colour of objects with this look that have no colour of their own; `None` for that of their kind.
    pub fn colour(self) -> Option<Colour> {
        match self {
            Self::Plain | Self::Striped => None,
            Self::Wood => Some(Colour([0xb0, 0x7d, 0x4b])),
            Self::Stone => Some(Colour([0x9a, 0x97, 0x91])),
            Self::Glass => Some(Colour([0xbf, 0xdf, 0xdc])),
        }
    }
}

impl FromStr for Look {
    type Err = Error;

    /// Reads a name, in any case.
    fn from_str(text: &str) -> Result<Self> {
        if let Some(found) = Self::NAMES.iter().position(|name| name.eq_ignore_ascii_case(text)) {
            return Ok(Self::ALL[found]);
        }
        let near = nearest(text, &Self::NAMES).map_or(String::new(), |near| format!(" (did you mean {near}?)"));
        let expected = "one of plain, striped, wood, stone, glass";
        Err(Error::Invalid { field: "look", value: quoted(text) + &near, expected })
    }
}

impl fmt::Display for Look {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(Self::NAMES[*self as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_read_back() {
        for look in Look::ALL {
            assert_eq!(look.to_string().to_uppercase().parse::<Look>().unwrap(), look);
        }
    }

    #[test]
    fn an_unknown_look_is_an_error_with_all_names() {
        let error = "glas".parse::<Look>().unwrap_err().to_string();
        let expected = format!("expected one of {}", Look::NAMES.join(", "));
        assert_eq!(error, format!("look: 'glas' (did you mean glass?) is not allowed, {expected}"));
    }
}
