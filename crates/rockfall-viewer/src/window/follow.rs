//! Which body the camera follows in every scene that is opened.

use std::rc::Rc;

use rockfall::{Scene, SphereId};

/// Finds the sphere to follow in a scene; `None` if the scene has none.
pub type Find = Rc<dyn Fn(&Scene) -> Option<SphereId>>;
