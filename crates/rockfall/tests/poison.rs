//! Special numbers ("poisons") in every field of every object, setting and edit: NaN, infinities, denormals, 0,
//! negative, huge and tiny numbers. Each is either rejected with an error that names the field, or accepted without
//! harm: no panic, no non-finite state, and bodies that do not touch the poisoned one are bitwise unchanged.

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
