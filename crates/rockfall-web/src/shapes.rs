//! The shapes of a scene as flat arrays, for programs that draw it themselves. They change only when objects are added or
//! removed.

use std::collections::HashMap;

use rockfall::SphereId;
use wasm_bindgen::prelude::*;

use crate::simulation::Simulation;

#[wasm_bindgen]
impl Simulation {
    /// The radii of all spheres in insertion order, in units.
    pub fn radii(&self) -> Vec<f32> {
        self.inner.scene().spheres().iter().map(|sphere| sphere.radius).collect()
    }

    /// Whether each sphere is fixed: 1 or 0.
    pub fn fixed(&self) -> Vec<u8> {
        self.inner.scene().spheres().iter().map(|sphere| u8::from(sphere.fixed)).collect()
    }

    /// The two spheres of every rod, as indices in insertion order. A capsule is a rod with its two ends.
    pub fn rods(&self) -> Vec<u32> {
        let (index, scene) = (self.indices(), self.inner.scene());
        scene.rods().iter().flat_map(|rod| [index[&rod.end1], index[&rod.end2]]).collect()
    }

    /// The radii of all rods, in units.
    #[wasm_bindgen(js_name = rodRadii)]
    pub fn rod_radii(&self) -> Vec<f32> {
        self.inner.scene().rods().iter().map(|rod| rod.radius).collect()
    }

    /// The two spheres of every spring, as indices in insertion order.
    pub fn springs(&self) -> Vec<u32> {
        let (index, scene) = (self.indices(), self.inner.scene());
        scene.springs().iter().flat_map(|spring| [index[&spring.a], index[&spring.b]]).collect()
    }

    /// All static boxes: a corner and three edge vectors of each, 12 numbers, in units.
    pub fn boxes(&self) -> Vec<f32> {
        let numbers = |cuboid: &rockfall::Cuboid| {
            let [i, j, k] = cuboid.edges;
            [cuboid.corner, i, j, k].into_iter().flat_map(|vector| vector.to_array()).collect::<Vec<_>>()
        };
        self.inner.scene().boxes().iter().flat_map(numbers).collect()
    }

    /// All polygons: the vertices of each in order, 12 numbers, in units. The last two vertices of a triangle are equal.
    pub fn polygons(&self) -> Vec<f32> {
        let numbers = |polygon: &rockfall::Polygon| {
            let last = polygon.corner + polygon.right;
            let vertices = polygon.vertices().chain([last]).take(4);
            vertices.flat_map(|vector| vector.to_array()).collect::<Vec<_>>()
        };
        self.inner.scene().polygons().iter().flat_map(numbers).collect()
    }

    fn indices(&self) -> HashMap<SphereId, u32> {
        self.inner.scene().sphere_ids().zip(0..).collect()
    }
}
