//! Contacts judged by nature.
