//! Colours of objects, by name and by number.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result, nearest, quoted};

/// A colour in sRGB. As text it is a name of [`Colour::NAMES`] or `#` with six hexadecimal digits, such as `#ff8800`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Colour(
    /// Red, green and blue, from 0 to 255.
    pub [u8; 3],
);

impl Colour {
    /// The names of colours, in alphabetical order.
    pub const NAMES: [&str; 14] = [
        "black", "blue", "brown", "cyan", "green", "grey", "magenta", "navy", "orange", "pink", "purple", "red", "white",
        "yellow",
    ];

    /// The colours of [`Colour::NAMES`].
    const NAMED: [[u8; 3]; 14] = [
        [0, 0, 0],
        [0x2f, 0x6f, 0xd0],
        [0x8b, 0x5a, 0x2b],
        [0x2a, 0xb7, 0xca],
        [0x2e, 0x9b, 0x4f],
        [0x80, 0x80, 0x80],
        [0xc0, 0x3f, 0xa8],
        [0x14, 0x24, 0x4c],
        [0xee, 0x8a, 0x1d],
        [0xf2, 0x8f, 0xb5],
        [0x7a, 0x4a, 0xb5],
        [0xd6, 0x2f, 0x2f],
        [0xff, 0xff, 0xff],
        [0xf2, 0xc9, 0x2c],
    ];
}

/// Whether a word is `#` with six hexadecimal digits.
pub(crate) fn is_hexadecimal(word: &str) -> bool {
    word.strip_prefix('#').is_some_and(|digits| digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit()))
}

impl FromStr for Colour {
    type Err = Error;

    /// Reads a name, in any case, or six hexadecimal digits, with or without `#`.
    fn from_str(text: &str) -> Result<Self> {
        if let Some(found) = Self::NAMES.iter().position(|name| name.eq_ignore_ascii_case(text)) {
            return Ok(Self(Self::NAMED[found]));
        }
        let digits = text.strip_prefix('#').unwrap_or(text);
        if is_hexadecimal(&format!("#{digits}"))
            && let Ok(bits) = u32::from_str_radix(digits, 16)
        {
            return Ok(Self([(bits >> 16) as u8, (bits >> 8) as u8, bits as u8]));
        }
        let near = nearest(text, &Self::NAMES).map_or(String::new(), |near| format!(" (did you mean {near}?)"));
        Err(Error::Invalid {
            field: "colour",
            value: quoted(text) + &near,
            expected: "six hexadecimal digits, as in #ff8800, or one of black, blue, brown, cyan, green, grey, magenta, navy, \
                       orange, pink, purple, red, white, yellow",
        })
    }
}

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self([red, green, blue]) = *self;
        match Self::NAMED.iter().position(|colour| *colour == self.0) {
            Some(found) => f.write_str(Self::NAMES[found]),
            None => write!(f, "#{red:02x}{green:02x}{blue:02x}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_read_back() {
        for (text, written) in
            [("red", "red"), ("Red", "red"), ("#FF8800", "#ff8800"), ("ff8800", "#ff8800"), ("d62f2f", "red")]
        {
            let colour: Colour = text.parse().unwrap();
            assert_eq!(colour.to_string(), written);
            assert_eq!(written.parse::<Colour>().unwrap(), colour);
        }
    }

    #[test]
    fn an_unknown_colour_is_an_error_with_all_names() {
        let error = "yelow".parse::<Colour>().unwrap_err().to_string();
        let names = Colour::NAMES.join(", ");
        let expected = format!("expected six hexadecimal digits, as in #ff8800, or one of {names}");
        assert_eq!(error, format!("colour: 'yelow' (did you mean yellow?) is not allowed, {expected}"));
        for text in ["", "#ff88", "#ff88000", "#gg8800", "##f8800", "+f8800"] {
            assert!(text.parse::<Colour>().is_err(), "{text}");
        }
    }
}
