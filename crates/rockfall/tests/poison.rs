//! NaN, infinities, denormals, 0, negative, huge and tiny numbers in every field of every object, setting and edit: refused
//! with an error that names the field, or contained: no panic, no state that is not finite, and no bit of a body changes
//! that does not touch the poisoned one.

mod common;

#[path = "poison/contained.rs"]
mod contained;
#[path = "poison/edits.rs"]
mod edits;
#[path = "poison/fields.rs"]
mod fields;
#[path = "poison/settings.rs"]
mod settings;
#[path = "poison/text.rs"]
mod text;
