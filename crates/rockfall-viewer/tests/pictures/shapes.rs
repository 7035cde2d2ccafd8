//! Pictures of single objects: their pixels agree with the projection.

use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{Backend, Capsule, Cuboid, Polygon, Rod, Scene, Sphere, Spring, Tether};
use rockfall_viewer::camera::{Axes, Camera};
use rockfall_viewer::draw::{Background, ColourBy, Range};

use crate::common::{
    WIDTH, assert_covers, drawn_box, expected, is_drawn, outlines, picture, pixel, pixels, projected, simulation, take,
};

fn camera() -> Camera {
    Camera::new([2.0, 3.0, 7.0], [0.3, 0.4, 0.0])
}

fn scene<T>(fill: impl FnOnce(&mut Scene) -> T) -> Scene {
    let mut scene = Scene::new();
    fill(&mut scene);
    scene
}

fn meets_ball(centre: DVec3, radius: f64) -> impl Fn(DVec3, DVec3) -> bool {
    move |origin, direction| {
        let offset = centre - origin;
        offset.dot(direction) > 0.0 && offset.cross(direction).length() < radius
    }
}

/// Finds the least distance between a ray and a line segment by ternary search; the distance has one minimum.
fn meets_capsule(end1: DVec3, end2: DVec3, radius: f64) -> impl Fn(DVec3, DVec3) -> bool {
    move |origin, direction| {
        let away = |part: f64| (end1.lerp(end2, part) - origin).cross(direction).length();
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let [one, two] = [(2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0];
            if away(one) < away(two) { high = two } else { low = one }
        }
        away(low) < radius
    }
}

/// Returns the intersection of a ray and a plane, in multiples of two edges from a corner.
fn on_plane(corner: DVec3, edges: [DVec3; 2], origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
    let normal = edges[0].cross(edges[1]);
    let distance = (corner - origin).dot(normal) / direction.dot(normal);
    let at = origin + distance * direction - corner;
    let across = [edges[1].cross(normal), normal.cross(edges[0])];
    let part = |k: usize| at.dot(across[k]) / edges[k].dot(across[k]);
    (distance > 0.0).then(|| [part(0), part(1)])
}

fn is_within(parts: [f64; 2]) -> bool {
    parts.iter().all(|part| (0.0..1.0).contains(part))
}

#[test]
fn the_outline_of_a_sphere_is_an_ellipse() {
    let (camera, centre, radius) = (camera(), Vec3::new(1.4, 0.9, 1.0), 0.8);
    let picture = picture(scene(|scene| scene.add_sphere(Sphere::new(centre, radius)).unwrap()), &camera, &outlines());
    assert_covers(&picture, &camera, meets_ball(centre.as_dvec3(), radius.into()));

    // The tangent planes through the eye have the slopes (x z ± r sqrt(x² + z² - r²)) / (z² - r²), x aside, z ahead.
    let Axes { right, up, forward } = camera.axes();
    let offset = centre - camera.eye;
    let ahead = offset.dot(forward);
    let slopes = |aside: f32| {
        let root = radius * (aside * aside + ahead * ahead - radius * radius).sqrt();
        [-1.0, 1.0].map(|side| (aside * ahead + side * root) / (ahead * ahead - radius * radius))
    };
    let pixels = 0.5 * crate::common::HEIGHT as f32 / (0.5 * camera.field_of_view).tan();
    let [left, last] = slopes(offset.dot(right)).map(|slope| 0.5 * WIDTH as f32 + pixels * slope);
    let [low, top] = slopes(offset.dot(up)).map(|slope| 0.5 * crate::common::HEIGHT as f32 - pixels * slope);
    let found = drawn_box(&picture).map(|side| side as f32);
    let sides = [left.floor(), top.floor(), last.floor(), low.floor()];
    assert!(found.iter().zip(sides).all(|(found, side)| (found - side).abs() <= 1.0), "{found:?} {sides:?}");
}

#[test]
fn rods_and_capsules_cover_the_points_within_their_radius() {
    let camera = camera();
    let (end1, end2) = (Vec3::new(-1.5, 0.2, -0.5), Vec3::new(1.6, 1.2, 1.5));
    let meets = || meets_capsule(end1.as_dvec3(), end2.as_dvec3(), 0.3);
    let rod = scene(|scene| {
        let ends = [end1, end2].map(|end| scene.add_sphere(Sphere::new(end, 1e-3)).unwrap());
        scene.add_rod(Rod::new(ends[0], ends[1], 0.3)).unwrap();
    });
    assert_covers(&picture(rod, &camera, &outlines()), &camera, meets());
    let capsule = scene(|scene| scene.add_capsule(Capsule::new(end1, end2, 0.3)).unwrap());
    assert_covers(&picture(capsule, &camera, &outlines()), &camera, meets());
}

#[test]
fn boxes_cover_their_six_faces() {
    let camera = camera();
    let (i, j) = (Vec3::new(1.5, 0.3, 0.0), Vec3::new(-0.2, 1.0, 0.0));
    let cuboid = Cuboid::new([-0.6, -0.4, -0.5], i, j, [0.0, 0.0, 1.2]);
    let corner = cuboid.corner.as_dvec3();
    let edges = cuboid.edges.map(|edge| edge.as_dvec3());
    let faces = move |origin, direction| {
        (0..6).any(|face: usize| {
            let (through, a, b) = (edges[face / 2], edges[(face / 2 + 1) % 3], edges[(face / 2 + 2) % 3]);
            let corner = corner + if face % 2 == 1 { through } else { DVec3::ZERO };
            on_plane(corner, [a, b], origin, direction).is_some_and(is_within)
        })
    };
    let boxed = scene(|scene| scene.add_box(cuboid).unwrap());
    assert_covers(&picture(boxed, &camera, &outlines()), &camera, faces);
}

#[test]
fn polygons_are_opaque_and_darker_on_the_side_that_is_not_solid() {
    let camera = camera();
    let (corner, left, right) = (Vec3::new(-1.0, -0.2, 0.0), Vec3::new(2.0, 0.2, 0.1), Vec3::new(0.2, 1.3, -0.3));
    let edges = [left.as_dvec3(), right.as_dvec3()];
    let meets = move |origin, direction| on_plane(corner.as_dvec3(), edges, origin, direction).is_some_and(is_within);
    let shown = |left, right| {
        picture(scene(|scene| scene.add_polygon(Polygon::new(corner, left, right)).unwrap()), &camera, &outlines())
    };
    // left x right points towards the camera.
    assert!(left.cross(right).dot(camera.eye - corner) > 0.0);
    let [front, back] = [shown(left, right), shown(right, left)];
    assert_covers(&front, &camera, meets);
    assert_covers(&back, &camera, meets);
    let [x, y] = projected(&camera, corner + 0.5 * (left + right)).map(|at| at as u32);
    let [front, back] = [front, back].map(|picture| f64::from(pixel(&picture, x, y)[0]));
    assert!((0.8..0.95).contains(&(back / front)), "{back} {front}");
}

#[test]
fn polygons_whose_corners_differ_by_rounding_have_no_gaps() {
    let camera = camera();
    // Pixels of which a part shows the background.
    let gaps = |gap: f32| {
        let shown = |background: [u8; 3]| {
            let strips = scene(|scene| {
                for k in 0..40 {
                    let corner = Vec3::new(-2.0 + 0.1 * k as f32, -1.0 + 0.01 * k as f32, 0.0);
                    scene.add_polygon(Polygon::new(corner, [0.1 - gap, 0.01, 0.0], [0.013, 2.0, 0.4])).unwrap();
                }
            });
            let mut style = outlines();
            style.background = Background { horizon: background, zenith: background };
            picture(strips, &camera, &style)
        };
        let [white, black] = [shown([255; 3]), shown([0; 3])];
        let inside = pixels().filter(|(x, y)| (100..220).contains(x) && (100..140).contains(y));
        inside.filter(|(x, y)| pixel(&white, *x, *y) != pixel(&black, *x, *y)).count()
    };
    assert_eq!(gaps(0.0002), 0);
    assert!(gaps(0.05) > 1000);
}

/// Returns the number of separate drawn intervals along a line in the picture.
fn drawn_intervals(picture: &rockfall_viewer::picture::Picture, from: [f32; 2], to: [f32; 2]) -> usize {
    const PLACES: u32 = 2000;
    let drawn: Vec<bool> = (0..=PLACES)
        .map(|k| {
            let part = k as f32 / PLACES as f32;
            let [x, y] = [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]));
            is_drawn(picture, x as u32, y as u32)
        })
        .collect();
    usize::from(drawn[0]) + drawn.windows(2).filter(|pair| !pair[0] && pair[1]).count()
}

#[test]
fn springs_of_any_length_have_six_turns_between_the_surfaces() {
    let camera = Camera::new([0.0, 0.0, 6.0], [0.0, 0.0, 0.0]);
    for apart in [2.0, 3.2] {
        let ends = [Vec3::new(-0.5 * apart, 0.0, 0.0), Vec3::new(0.5 * apart, 0.0, 0.0)];
        let sprung = scene(|scene| {
            let ends = ends.map(|end| scene.add_sphere(Sphere::new(end, 0.4)).unwrap());
            scene.add_spring(Spring::new(ends[0], ends[1], 10.0, 2.0)).unwrap();
        });
        let picture = picture(sprung, &camera, &outlines());
        // Every turn crosses the axis twice, in front of it and behind it.
        let on_axis = |x: f32| projected(&camera, Vec3::new(x, 0.0, 0.0));
        let crossings = drawn_intervals(&picture, on_axis(-0.5 * apart + 0.43), on_axis(0.5 * apart - 0.43));
        assert!((11..=13).contains(&crossings), "{crossings} crossings of 6 turns, {apart} apart");
        // No part of the spring is farther from the axis than the spheres.
        let [_, top, _, low] = drawn_box(&picture);
        let reach = projected(&camera, Vec3::new(0.0, 0.4, 0.0))[1];
        assert!((top as f32 - reach).abs() < 2.0 && (low as f32 - (240.0 - reach)).abs() < 2.0);
    }
}

#[test]
fn a_far_spring_is_a_thin_line() {
    // The turns are 2.7 pixels apart, with a radius of 2.8 pixels.
    let camera = Camera::new([0.0, 0.0, 100.0], [0.0, 0.0, 0.0]);
    let sprung = |stiffness: Option<f32>| {
        scene(|scene| {
            let ends = [-4.0, 4.0].map(|x| scene.add_sphere(Sphere::new([x, 0.0, 0.0], 2.0)).unwrap());
            if let Some(stiffness) = stiffness {
                scene.add_spring(Spring::new(ends[0], ends[1], stiffness, 8.0)).unwrap();
            }
        })
    };
    let [with, without] = [Some(1.0), None].map(|spring| picture(sprung(spring), &camera, &outlines()));
    let changed: Vec<(u32, u32)> = pixels().filter(|(x, y)| pixel(&with, *x, *y) != pixel(&without, *x, *y)).collect();
    let rows = changed.iter().map(|(_, y)| *y);
    let height = rows.clone().max().unwrap() + 1 - rows.min().unwrap();
    assert!(height <= 2 && changed.len() >= 10, "{height} rows, {} pixels", changed.len());
}

#[test]
fn walls_before_a_body_are_translucent() {
    let camera = Camera::new([0.0, 0.5, 10.0], [0.0, 0.5, 0.0]);
    let style = rockfall_viewer::draw::Style::default();
    let shown = |fill: &dyn Fn(&mut Scene)| {
        let scene = scene(|scene| {
            scene.add_sphere(Sphere::new([0.0, 0.5, 0.0], 0.5)).unwrap();
            scene.add_box(Cuboid::between([-9.0, -0.5, -9.0], [9.0, 0.0, 9.0])).unwrap();
            fill(scene);
        });
        picture(scene, &camera, &style)
    };
    let free = shown(&|_| ());
    let wall: [&dyn Fn(&mut Scene); 2] = [
        &|scene| {
            scene.add_box(Cuboid::between([-1.5, 0.0, 2.0], [1.5, 1.6, 2.5])).unwrap();
        },
        &|scene| {
            scene.add_polygon(Polygon::new([-1.5, 0.0, 2.0], [3.0, 0.0, 0.0], [0.0, 1.6, 0.0])).unwrap();
        },
    ];
    for (name, wall) in [("box", wall[0]), ("polygon", wall[1])] {
        let behind = shown(wall);
        for point in [Vec3::new(0.0, 0.5, 0.5), Vec3::new(0.0, 0.05, 0.2), Vec3::new(0.8, 0.5, 0.0)] {
            let [x, y] = projected(&camera, point).map(|place| place as u32);
            let pair = pixel(&behind, x, y).into_iter().zip(pixel(&free, x, y));
            let change = pair.map(|(one, other)| one.abs_diff(other)).max().unwrap_or(0);
            assert!((4..80).contains(&change), "{name}: {point} is behind something opaque or nothing: {change}");
        }
        // The upper edge of the side of the body is a dark line, and the edge on the side of the eye is not drawn.
        let darkest = |z: f32| {
            let [x, y] = projected(&camera, Vec3::new(0.4, 1.6, z));
            let row = |picture: &_, y: u32| pixel(picture, x as u32, y).map(u32::from).iter().sum::<u32>();
            (y as u32 - 1..=y as u32 + 1).map(|y| row(&free, y).saturating_sub(row(&behind, y))).max().unwrap()
        };
        let [near, far] = [2.5, 2.0].map(darkest);
        assert!(far > 30 && near < 10, "{name}: {far} {near}");
    }
    // A wall beside the body is whole.
    let beside = shown(&|scene| {
        scene.add_box(Cuboid::between([1.5, 0.0, 2.0], [3.0, 1.6, 2.5])).unwrap();
    });
    let [x, y] = projected(&camera, Vec3::new(2.2, 0.8, 2.5)).map(|place| place as u32);
    assert_ne!(pixel(&beside, x, y), pixel(&free, x, y));
}

#[test]
fn tethers_have_six_turns_between_the_sphere_and_their_anchor() {
    let camera = Camera::new([0.0, 0.0, 6.0], [0.0, 0.0, 0.0]);
    let tethered = scene(|scene| {
        let ball = scene.add_sphere(Sphere::new([-1.0, 0.0, 0.0], 0.4)).unwrap();
        scene.add_tether(Tether::new(ball, [1.2, 0.0, 0.0], 10.0).length(1.5)).unwrap();
    });
    let picture = picture(tethered, &camera, &outlines());
    let [left, _, right, _] = drawn_box(&picture).map(|side| side as f32);
    let ends = [-1.4, 1.2].map(|x| projected(&camera, Vec3::new(x, 0.0, 0.0))[0]);
    // The ball at the anchor is no wider than a quarter of the sphere.
    assert!((left - ends[0]).abs() < 2.0 && right > ends[1] && right < ends[1] + 6.0, "{left} {right} {ends:?}");
    let on_axis = |x: f32| projected(&camera, Vec3::new(x, 0.0, 0.0));
    let crossings = drawn_intervals(&picture, on_axis(-0.57), on_axis(1.09));
    assert!((11..=13).contains(&crossings), "{crossings}");
}

#[test]
fn the_visible_part_of_a_sphere_in_a_box_is_correct() {
    let camera = camera();
    let (centre, radius) = (Vec3::new(0.3, 0.5, 0.4), 0.7);
    let sunk = scene(|scene| {
        scene.add_sphere(Sphere::new(centre, radius).fixed()).unwrap();
        scene.add_box(Cuboid::between([-3.0, -1.0, -3.0], [3.0, 0.5, 3.0])).unwrap();
    });
    let picture = take(&mut simulation(sunk, Backend::Cpu), &camera, &outlines());
    let mut counts = [0, 0];
    for (x, y) in pixels() {
        // The upper half of the ball is above the box; a ray hits either that half or the box.
        let meets = |origin: DVec3, direction: DVec3| {
            let offset = origin - centre.as_dvec3();
            let along = offset.dot(direction);
            let root = along * along - offset.length_squared() + f64::from(radius * radius);
            root > 0.0 && (origin + (-along - root.sqrt()) * direction).y > 0.5
        };
        let [r, _, b] = pixel(&picture, x, y);
        if let Some(ball) = expected(&camera, x, y, meets).filter(|_| is_drawn(&picture, x, y)) {
            // The ball is violet, the box is sand-coloured.
            assert_eq!(b > r, ball, "{x} {y}: {:?}", pixel(&picture, x, y));
            counts[usize::from(ball)] += 1;
        }
    }
    assert!(counts[0] > 10_000 && counts[1] > 1_000, "{counts:?}");
}

/// Whether a sphere seen from +z has the first tone at a point of the equator; `aside` is the x coordinate of the point.
fn is_first_tone(orientation: Quat, aside: f32) -> bool {
    let camera = Camera::new([0.0, 0.0, 8.0], [0.0, 0.0, 0.0]);
    let mut style = outlines();
    style.colour_by = ColourBy::Kind;
    let ball = scene(|scene| scene.add_sphere(Sphere::new([0.0, 0.0, 0.0], 1.0).orientation(orientation)).unwrap());
    let shown = picture(ball, &camera, &style);
    let [x, y] = projected(&camera, Vec3::new(aside, 0.0, (1.0 - aside * aside).sqrt()));
    let [r, _, b] = pixel(&shown, x as u32, y as u32);
    b > r.saturating_add(40)
}

#[test]
fn the_pattern_turns_with_the_body() {
    let turned = |axis: Vec3, degrees: f32| Quat::from_axis_angle(axis, degrees.to_radians());
    // The sector around +z is 60 degrees wide; the next one has the second tone.
    assert!(is_first_tone(Quat::IDENTITY, 0.0));
    assert!(!is_first_tone(turned(Vec3::Y, 60.0), 0.0));
    assert!(is_first_tone(turned(Vec3::Y, 120.0), 0.0));
    // Its right edge, 60 degrees from +x, moves to the right when the body rotates that way.
    let place = 51.0_f32.to_radians().cos();
    assert!(!is_first_tone(Quat::IDENTITY, place));
    assert!(is_first_tone(turned(Vec3::Y, 20.0), place));
    assert!(!is_first_tone(turned(Vec3::Y, -20.0), place));
    // Each cap at a pole has one tone.
    assert!(!is_first_tone(turned(Vec3::X, 90.0), 0.0));
    assert!(is_first_tone(turned(Vec3::X, -90.0), 0.0));
}

/// A spring that pulls, one that pushes, one at rest, and a tether that pulls: orange, blue, grey and orange.
#[test]
fn springs_and_tethers_have_the_colours_of_their_tensions() {
    let (camera, mut style) = (Camera::new([0.0, 2.0, 9.0], [0.0, 2.0, 0.0]), outlines());
    style.colour_by = ColourBy::Tension;
    style.range = Range::Auto;
    let mut scene = Scene::new();
    // The rod takes the first place among the values.
    let ends = [-4.0, -3.5].map(|x| scene.add_sphere(Sphere::new([x, 2.0, 0.0], 0.1).fixed()).unwrap());
    scene.add_rod(Rod::new(ends[0], ends[1], 0.05)).unwrap();
    let places = [-2.0, -0.5, 1.0, 2.5];
    for (x, rest) in places.into_iter().zip([1.0, 3.0, 2.0]) {
        let ends = [1.0, 3.0].map(|y| scene.add_sphere(Sphere::new([x, y, 0.0], 0.3).fixed()).unwrap());
        scene.add_spring(Spring::new(ends[0], ends[1], 10.0, rest)).unwrap();
    }
    let top = scene.add_sphere(Sphere::new([places[3], 3.0, 0.0], 0.3).fixed()).unwrap();
    scene.add_tether(Tether::new(top, [places[3], 1.0, 0.0], 10.0).length(1.0)).unwrap();
    let mut simulation = simulation(scene, Backend::Cpu);
    let mut renderer = crate::common::renderer();
    renderer.update(&mut simulation, &style).unwrap();
    let made = crate::common::canvas().take(&mut renderer, &camera, &style).unwrap();
    assert_eq!(renderer.range(&style), [-10.0, 10.0]);
    // Red minus blue of what is drawn between the ends.
    let warmth = |x: f32| {
        let [left, top] = projected(&camera, Vec3::new(x - 0.2, 2.4, 0.0)).map(|side| side as u32);
        let [right, bottom] = projected(&camera, Vec3::new(x + 0.2, 1.6, 0.0)).map(|side| side as u32);
        let inside = (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y)));
        let drawn: Vec<[u8; 3]> = inside.filter(|(x, y)| is_drawn(&made, *x, *y)).map(|(x, y)| pixel(&made, x, y)).collect();
        assert!(drawn.len() > 20, "{x}: {} pixels", drawn.len());
        drawn.iter().map(|[red, _, blue]| f32::from(*red) - f32::from(*blue)).sum::<f32>() / drawn.len() as f32
    };
    let [pulls, pushes, rests, tether] = places.map(warmth);
    assert!(pulls > 25.0 && pushes < -25.0 && rests.abs() < 10.0 && tether > 25.0, "{pulls} {pushes} {rests} {tether}");
}
