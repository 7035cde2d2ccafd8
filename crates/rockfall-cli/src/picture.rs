//! A side view of a scene, drawn with characters.

use rockfall::Scene;
use rockfall::glam::Vec3;

mod left;

pub(crate) use left::Left;

/// Largest size of the picture in characters. A character is about twice as high as wide.
const WIDTH: usize = 72;
const HEIGHT: usize = 24;

/// Draws the scene as seen along -z, with x to the right and y up. Spheres are `O`, `o` or `.`, from near to far. Rods are `-`.
/// Boxes that cross the plane z = 0 are `#`, behind everything else. Bodies that left the others are not
/// drawn. The picture is empty for a scene without spheres.
pub(crate) fn side_view(scene: &Scene, left: &Left) -> String {
    let Some(frame) = Frame::around(scene, left) else {
        return String::new();
    };
    let mut cells = vec![vec![b' '; frame.columns]; frame.rows];
    let mut nearest = vec![vec![f32::NEG_INFINITY; frame.columns]; frame.rows];
    for (row, line) in cells.iter_mut().enumerate() {
        for (column, cell) in line.iter_mut().enumerate() {
            let [x, y] = frame.point(column, row);
            if scene.boxes().iter().any(|cuboid| covers(cuboid, x, y)) {
                *cell = b'#';
            }
        }
    }
    let mut dot = |point: Vec3, radius: f32, sign: Option<u8>| {
        frame.each_cell(point, radius, |column, row| {
            if point.z > nearest[row][column] {
                nearest[row][column] = point.z;
                let depth = (point.z - frame.back) / (frame.front - frame.back).max(1e-6);
                cells[row][column] = sign.unwrap_or(match depth {
                    d if d > 0.66 => b'O',
                    d if d > 0.33 => b'o',
                    _ => b'.',
                });
            }
        });
    };
    let is_shown = |point: Vec3| point.cmpge(frame.low).all() && point.cmple(frame.high).all();
    for rod in scene.rods() {
        let [Ok(a), Ok(b)] = [rod.end1, rod.end2].map(|id| scene.sphere(id).map(|sphere| sphere.position)) else {
            continue;
        };
        if !is_shown(a) || !is_shown(b) {
            continue;
        }
        // Enough points that no cell between the ends is skipped.
        let points = (a.distance(b) / frame.size).clamp(1.0, WIDTH as f32) as usize * 2;
        for part in 0..=points {
            dot(a.lerp(b, part as f32 / points as f32), rod.radius, Some(b'-'));
        }
    }
    for sphere in left.others(scene) {
        // Slightly in front of the rods that end in it.
        dot(sphere.position + Vec3::Z * 1e-3 * frame.size, sphere.radius, None);
    }
    let lines = cells.into_iter().map(|line| String::from_utf8_lossy(&line).trim_end().to_owned() + "\n");
    lines.collect()
}

/// Whether a box covers a point of the picture. A rotated box is drawn as its axis-aligned bounds.
fn covers(cuboid: &rockfall::Cuboid, x: f32, y: f32) -> bool {
    let [low, high] = [Vec3::min, Vec3::max].map(|pick| {
        let zero = Vec3::ZERO;
        cuboid.corner + cuboid.edges.into_iter().map(|edge| pick(edge, zero)).sum::<Vec3>()
    });
    // Boxes in front of or behind the plane z = 0 are left out: such a wall would cover the whole picture.
    let crosses_plane = high.x - low.x > 0.0 && high.z > 0.0 && low.z < 0.0;
    crosses_plane && (low.x..=high.x).contains(&x) && (low.y..=high.y).contains(&y)
}

/// Part of the world that the picture shows.
struct Frame {
    left: f32,
    top: f32,
    back: f32,
    front: f32,
    /// Bounds of the spheres that are shown.
    low: Vec3,
    high: Vec3,
    /// Width of a character, in units; its height is twice that.
    size: f32,
    columns: usize,
    rows: usize,
}

impl Frame {
    fn around(scene: &Scene, left: &Left) -> Option<Self> {
        let mut bounds: Option<(Vec3, Vec3)> = None;
        for sphere in left.others(scene).filter(|sphere| sphere.position.is_finite()) {
            let (low, high) = (sphere.position - sphere.radius, sphere.position + sphere.radius);
            let (lowest, highest) = bounds.unwrap_or((low, high));
            bounds = Some((lowest.min(low), highest.max(high)));
        }
        let (low, high) = bounds?;
        // Leaves a margin of one character on each side. Gives up where the size is near the limits of f32.
        let (wide, tall) = (high.x - low.x, high.y - low.y);
        let size = (wide / (WIDTH - 2) as f32).max(tall / (2 * (HEIGHT - 2)) as f32);
        if !(1e-20..1e20).contains(&size) {
            return None;
        }
        Some(Self {
            left: low.x - size,
            top: high.y + 2.0 * size,
            back: low.z,
            front: high.z,
            low,
            high,
            size,
            columns: ((wide / size).ceil() as usize + 2).min(WIDTH),
            rows: ((tall / (2.0 * size)).ceil() as usize + 2).min(HEIGHT),
        })
    }

    /// Position of the centre of a character cell.
    fn point(&self, column: usize, row: usize) -> [f32; 2] {
        let x = self.left + (column as f32 + 0.5) * self.size;
        let y = self.top - (row as f32 + 0.5) * 2.0 * self.size;
        [x, y]
    }

    /// Calls `call` with every cell whose centre lies in a disc, and with the cell that contains the centre of the disc.
    fn each_cell(&self, centre: Vec3, radius: f32, mut call: impl FnMut(usize, usize)) {
        let cell = |at: f32, size: f32, count: usize| (at / size).clamp(0.0, (count - 1) as f32) as usize;
        let column = |x: f32| cell(x - self.left, self.size, self.columns);
        let row = |y: f32| cell(self.top - y, 2.0 * self.size, self.rows);
        for r in row(centre.y + radius)..=row(centre.y - radius) {
            for c in column(centre.x - radius)..=column(centre.x + radius) {
                let [x, y] = self.point(c, r);
                let own = c == column(centre.x) && r == row(centre.y);
                if own || (x - centre.x).hypot(y - centre.y) <= radius {
                    call(c, r);
                }
            }
        }
    }
}
