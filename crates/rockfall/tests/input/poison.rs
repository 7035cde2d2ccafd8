//! Special numbers ("poisons") in every field of every object, setting and edit: NaN, infinities, denormals, 0,
//! negative, huge and tiny numbers. Each is either rejected with an error that names the field, or accepted without
//! harm: no panic, no non-finite state, and bodies that do not touch the poisoned one are bitwise unchanged.

mod contained;
mod edits;
mod fields;
mod rigid;
mod settings;
mod text;
