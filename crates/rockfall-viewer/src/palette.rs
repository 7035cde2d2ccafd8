//! Colours that can be told apart with any kind of colour vision.
//!
//! The colours of the kinds have the hues of Okabe and Ito, *Color Universal Design* (2008), with less saturation because
//! they fill large areas. The colour scale is viridis (van der Walt and Smith 2015), whose lightness rises evenly. Colours
//! are sRGB, 0 to 255. The scale of tensions has two hues, blue and orange, with grey between.

/// A colour in sRGB.
pub type Rgb = [u8; 3];

/// A kind of object and its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Name of the kind, in the plural.
    pub name: &'static str,
    /// Colour of the kind.
    pub colour: Rgb,
}

const fn kind(name: &'static str, colour: Rgb) -> Kind {
    Kind { name, colour }
}

/// All kinds, in the order of the `KIND_` constants of the shaders.
pub const KINDS: [Kind; 8] = [
    kind("spheres", [0x3f, 0x94, 0xc9]),
    kind("fixed spheres", [0x6d, 0x75, 0x7e]),
    kind("rods", [0xe2, 0x9a, 0x1c]),
    kind("capsules", [0x1a, 0x93, 0x70]),
    kind("springs", [0xd0, 0x6a, 0x2c]),
    kind("tethers", [0xb9, 0x6a, 0x98]),
    kind("boxes", [0xd3, 0xcf, 0xc6]),
    kind("polygons", [0xd9, 0xcf, 0x8e]),
];

/// Viridis at 0, 1/8, ... 1.
pub const SCALE: [Rgb; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2d, 0x7b],
    [0x3b, 0x52, 0x8b],
    [0x2c, 0x72, 0x8e],
    [0x21, 0x91, 0x8c],
    [0x28, 0xae, 0x80],
    [0x5e, 0xc9, 0x62],
    [0xad, 0xdc, 0x30],
    [0xfd, 0xe7, 0x25],
];

/// Blue for the greatest push, grey for no force, orange and red for the greatest pull.
pub const TENSIONS: [Rgb; 9] = [
    [0x12, 0x35, 0x8c],
    [0x1d, 0x5f, 0xbd],
    [0x4c, 0x90, 0xd6],
    [0x8a, 0xac, 0xc9],
    [0xa8, 0xa8, 0xa8],
    [0xd0, 0xa0, 0x7c],
    [0xe4, 0x80, 0x3c],
    [0xcf, 0x4f, 0x14],
    [0x8f, 0x24, 0x08],
];

/// Converts a colour to linear light (IEC 61966-2-1).
pub fn linear(colour: Rgb) -> [f32; 3] {
    colour.map(|channel| {
        let encoded = f32::from(channel) / 255.0;
        if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    })
}
