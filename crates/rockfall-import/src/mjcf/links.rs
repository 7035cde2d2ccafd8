//! `<equality>` and `<contact>`: what connects bodies beside their joints.

use rockfall::glam::DVec3;

use super::Mjcf;
use crate::error::Result;
use crate::model::Loop;
use crate::xml::{Element, quoted};

impl Mjcf<'_> {
    fn named(&self, element: &Element, key: &str) -> Result<Option<usize>> {
        let Some(name) = element.attribute(key) else { return Ok(None) };
        let found = self.names.get(name).copied();
        found
            .map(Some)
            .ok_or_else(|| element.wrong(format!("no body has the name {}, expected the name of a body", quoted(name))))
    }

    /// Joints that close loops.
    pub(super) fn loops(&mut self, root: &Element) -> Result<Vec<Loop>> {
        let mut loops = Vec::new();
        for element in root.all("equality").flat_map(|section| &section.children) {
            let is_off = element.attribute("active") == Some("false");
            if is_off || !matches!(element.name.as_str(), "connect" | "weld") {
                let why = if is_off { "it is not active, so it is left out" } else { "it is left out" };
                self.notes.add(element, why);
                continue;
            }
            let Some(first) = self.named(element, "body1")? else {
                self.notes.add(element, "it connects sites, so it is left out");
                continue;
            };
            let second = self.named(element, "body2")?.unwrap_or(0);
            let ball_at = if element.name == "connect" {
                let anchor = element.vector("anchor")?.unwrap_or(DVec3::ZERO);
                Some(anchor)
            } else {
                None
            };
            if element.attribute("relpose").is_some() {
                self.notes.add(element, "relpose is not taken over: the bodies keep their places of the start");
            }
            let name = element.attribute("name").map_or_else(|| format!("{}{}", element.name, loops.len() + 1), str::to_owned);
            loops.push(Loop { name, element: element.alone(), links: [first, second], ball_at });
        }
        Ok(loops)
    }

    /// Pairs of bodies that never touch.
    pub(super) fn apart(&mut self, root: &Element) -> Result<Vec<[usize; 2]>> {
        let mut pairs = Vec::new();
        for element in root.all("contact").flat_map(|section| &section.children) {
            if element.name != "exclude" {
                self.notes.ignored(element);
                continue;
            }
            if let (Some(a), Some(b)) = (self.named(element, "body1")?, self.named(element, "body2")?) {
                pairs.push([a, b]);
            }
        }
        Ok(pairs)
    }
}
