//! `<include file="..."/>`.

use std::path::Path;

use crate::error::Result;
use crate::xml::{Element, Reader, beside};

/// Replaces every include by the children of the root element of its file. Paths are relative to the first file.
pub(super) fn expand(root: &mut Element, path: &Path) -> Result<()> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut reader = Reader::default();
    within(root, folder, &mut reader, 1)
}

fn within(element: &mut Element, folder: &Path, reader: &mut Reader, depth: usize) -> Result<()> {
    let mut expanded = Vec::with_capacity(element.children.len());
    for mut child in std::mem::take(&mut element.children) {
        if child.name == "include" {
            let path = beside(&child, folder, child.needed("file")?)?;
            // The depth counts the elements around it, so a file that includes itself ends.
            let mut included = reader.read_at(&path, depth).map_err(|error| match error {
                crate::Error::File { .. } => child.wrong(error.to_string()),
                error => error,
            })?;
            within(&mut included, folder, reader, depth + 1)?;
            expanded.append(&mut included.children);
        } else {
            within(&mut child, folder, reader, depth + 1)?;
            expanded.push(child);
        }
    }
    element.children = expanded;
    Ok(())
}
