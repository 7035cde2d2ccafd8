//! Which bodies the camera follows, and which are plotted, in every scene that is opened.

use std::rc::Rc;

use rockfall::{Scene, SphereId};

/// Finds a sphere in a scene; `None` if the scene has none.
pub type Find = Rc<dyn Fn(&Scene) -> Option<SphereId>>;
