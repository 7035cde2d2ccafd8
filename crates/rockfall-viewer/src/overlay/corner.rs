//! The corner of a picture in which a legend covers the least.

use rockfall::glam::Vec3;

use super::Overlay;
use super::projection::Projection;
use crate::camera::{Axes, Camera};
use crate::legend::{Corner, Legend};
use crate::pixels::Picture;
use crate::survey::Survey;

impl Overlay {
    /// Returns the corner of a picture of this size in which a legend covers the fewest bodies of a survey, and none of the text.
    pub fn corner(&self, legend: &Legend, survey: &Survey, camera: &Camera, size: [u32; 2]) -> Corner {
        let projection = Projection::new(camera, size.map(|side| side as f32));
        let points = outlines(survey, camera).filter_map(|point| projection.place(point));
        let points: Vec<[f32; 2]> = points.filter(|[x, y]| *x >= 0.0 && *y >= 0.0).collect();
        let has_keys = self.scale_bar || self.arrows.is_some();
        let corners = [None, Some(self.room_above(size))].map(|below| [false, true].map(|right| Corner { right, below }));
        let is_free = |corner: &Corner| !(has_keys && *corner == Corner { right: true, below: None });
        let free = corners.into_iter().flatten().filter(is_free);
        free.min_by_key(|corner| covered(legend, *corner, size, &points)).unwrap_or_default()
    }
}

/// The number of points that a legend covers.
fn covered(legend: &Legend, corner: Corner, [width, height]: [u32; 2], points: &[[f32; 2]]) -> usize {
    let mut picture = Picture { width, height, pixels: vec![[0; 4]; width as usize * height as usize] };
    if legend.draw_at(corner, &mut picture).is_err() {
        return 0;
    }
    let is_covered = |[x, y]: &&[f32; 2]| {
        let index = (*x < width as f32).then_some(*y as usize * width as usize + *x as usize);
        index.and_then(|index| picture.pixels.get(index)).is_some_and(|pixel| *pixel != [0; 4])
    };
    points.iter().filter(is_covered).count()
}

/// The middle and some points of the outline of every body.
fn outlines(survey: &Survey, camera: &Camera) -> impl Iterator<Item = Vec3> {
    let Axes { right, up, .. } = camera.axes();
    let aside =
        [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (0.7, 0.7), (-0.7, 0.7), (0.7, -0.7), (-0.7, -0.7)];
    let points = move |(place, radius): (Vec3, f32)| aside.map(|(x, y)| place + radius * (x * right + y * up));
    survey.balls().into_iter().flat_map(points)
}
