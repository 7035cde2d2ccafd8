//! Problems with answers from nature: closed forms and conservation.

mod flight;
mod impact;
mod rest;
mod scene;
