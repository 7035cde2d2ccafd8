//! Default classes.

use std::collections::HashMap;

use rockfall::glam::DVec3;

use crate::error::Result;
use crate::xml::{Element, quoted};

/// Greatest number of classes.
const MOST: usize = 10_000;
/// Greatest depth of classes.
const DEEPEST: usize = 100;

/// The classes of a file. The first one is that of all elements without a class.
#[derive(Debug)]
pub(super) struct Defaults {
    classes: Vec<Class>,
    names: HashMap<String, usize>,
}

#[derive(Debug)]
struct Class {
    parent: Option<usize>,
    /// By tag.
    elements: HashMap<String, Element>,
}

/// The attributes of an element, with those of its class where it has none.
#[derive(Clone, Copy)]
pub(super) struct Attributes<'a> {
    pub(super) element: &'a Element,
    class: usize,
    defaults: &'a Defaults,
}

impl Defaults {
    pub(super) const MAIN: usize = 0;

    pub(super) fn of(root: &Element) -> Result<Self> {
        let main = Class { parent: None, elements: HashMap::new() };
        let mut defaults = Self { classes: vec![main], names: HashMap::from([("main".to_owned(), 0)]) };
        for section in root.all("default") {
            if let Some(name) = section.attribute("class") {
                defaults.names.insert(name.to_owned(), Self::MAIN);
            }
            defaults.fill(Self::MAIN, section, 0)?;
        }
        Ok(defaults)
    }

    fn fill(&mut self, class: usize, section: &Element, depth: usize) -> Result<()> {
        if depth > DEEPEST {
            return Err(section.wrong(format!("classes are nested deeper than {DEEPEST}")));
        }
        for child in &section.children {
            if child.name != "default" {
                let elements = &mut self.classes[class].elements;
                elements.entry(child.name.clone()).or_insert_with(|| child.alone()).overlay(child);
                continue;
            }
            if self.classes.len() >= MOST {
                return Err(child.wrong(format!("more than {MOST} classes")));
            }
            let name = child.needed("class")?;
            let number = self.classes.len();
            self.classes.push(Class { parent: Some(class), elements: HashMap::new() });
            if self.names.insert(name.to_owned(), number).is_some() {
                return Err(child.wrong("another class has this name, expected names that differ"));
            }
            self.fill(number, child, depth + 1)?;
        }
        Ok(())
    }

    /// The class that an attribute names.
    pub(super) fn class(&self, element: &Element, key: &str) -> Result<Option<usize>> {
        let Some(name) = element.attribute(key) else { return Ok(None) };
        let class = self.names.get(name).copied();
        class.map(Some).ok_or_else(|| element.wrong(format!("no default class has the name {}, expected one", quoted(name))))
    }

    /// The attributes of an element among elements with a class.
    pub(super) fn attributes<'a>(&'a self, element: &'a Element, around: usize) -> Result<Attributes<'a>> {
        let class = self.class(element, "class")?.unwrap_or(around);
        Ok(Attributes { element, class, defaults: self })
    }
}

impl<'a> Attributes<'a> {
    pub(super) fn get(&self, key: &str) -> Option<&'a str> {
        self.element.attribute(key).or_else(|| {
            let mut next = Some(self.class);
            while let Some(class) = next.map(|class| &self.defaults.classes[class]) {
                if let Some(value) = class.elements.get(&self.element.name).and_then(|element| element.attribute(key)) {
                    return Some(value);
                }
                next = class.parent;
            }
            None
        })
    }

    pub(super) fn number(&self, key: &str) -> Result<Option<f64>> {
        self.get(key).map(|text| self.element.one(key, text)).transpose()
    }

    /// The first of several numbers.
    pub(super) fn first(&self, key: &str) -> Result<Option<f64>> {
        Ok(self.list(key)?.and_then(|numbers| numbers.first().copied()))
    }

    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>> {
        self.get(key).map(|text| self.element.numbers(key, text)).transpose()
    }

    pub(super) fn vector(&self, key: &str) -> Result<Option<DVec3>> {
        Ok(self.numbers::<3>(key)?.map(DVec3::from_array))
    }

    pub(super) fn list(&self, key: &str) -> Result<Option<Vec<f64>>> {
        self.get(key).map(|text| self.element.list(key, text, 20)).transpose()
    }

    /// A whole number that is not negative.
    pub(super) fn bits(&self, key: &str) -> Result<Option<u32>> {
        let Some(text) = self.get(key) else { return Ok(None) };
        let wrong = || self.element.wrong(format!("{key}={} is no whole number, expected one from 0", quoted(text)));
        text.trim().parse().map(Some).map_err(|_| wrong())
    }

    /// The two numbers of a range.
    pub(super) fn range(&self, key: &str) -> Result<Option<[f64; 2]>> {
        let Some([least, greatest]) = self.numbers::<2>(key)? else { return Ok(None) };
        if least > greatest {
            let message = format!("{key}: {least} is greater than {greatest}, expected ascending numbers");
            return Err(self.element.wrong(message));
        }
        Ok(Some([least, greatest]))
    }

    /// Whether a range holds: as `limited` says, otherwise if there is a range.
    pub(super) fn is_limited(&self, key: &str, has_range: bool, autolimits: bool) -> bool {
        match self.get(key) {
            Some("true") => true,
            Some("false") => false,
            _ => has_range && autolimits,
        }
    }
}
