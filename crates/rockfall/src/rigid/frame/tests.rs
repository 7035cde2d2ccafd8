//! Problems with answers from nature: closed forms and conservation.

mod flight;
mod rest;
mod scene;
