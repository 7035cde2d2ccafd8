//! Plots beside pictures and films, and what pictures show of the past.

use super::*;

const CAMERA: &str = "--plain --camera 3,3,6 --look-at 0,1,0";
/// The colour of the first body in plots.
const BLUE: [u8; 3] = [0x00, 0x72, 0xb2];

/// The part of a picture that is `width` pixels wide, from column `left` on.
fn columns([full, _]: [u32; 2], pixels: &[u8], left: u32, width: u32) -> Vec<u8> {
    let [full, left, width] = [full, left, width].map(|count| count as usize);
    pixels.chunks(3 * full).flat_map(|row| row[3 * left..3 * (left + width)].to_vec()).collect()
}

fn blue(pixels: &[u8]) -> usize {
    pixels.chunks(3).filter(|pixel| pixel.iter().zip(BLUE).all(|(a, b)| a.abs_diff(b) < 30)).count()
}

#[test]
fn a_plot_is_beside_the_picture_and_shows_the_time_before_it() {
    let folder = Folder::new();
    // 64 % of the width remain for the scene.
    folder.render(&format!("--out scene.png --at 30 --size 256x200 {CAMERA}"), 0);
    let (scene, [width, _]) = folder.picture("scene.png");
    let mut lines = Vec::new();
    for at in [0, 30] {
        folder.render(&format!("--out plot.png --at {at} --size 400x200 --plot height:1 {CAMERA}"), 0);
        let (plot, size) = folder.picture("plot.png");
        if at == 30 {
            assert!(columns(size, &plot, 0, width) == scene, "the scene is drawn as without a plot");
        }
        lines.push(blue(&columns(size, &plot, width, size[0] - width)));
    }
    assert!(lines[1] > 2 * lines[0], "{lines:?}");
}

#[test]
fn a_plot_grows_with_the_film_on_axes_that_stay() {
    let folder = Folder::new();
    folder.render(&format!("--out film/ --steps 50 --fps 5 --size 400x200 --plot height:1 {CAMERA}"), 0);
    let parts = (0..6).map(|number| {
        let (pixels, size) = folder.picture(&format!("film/{number:04}.png"));
        // The numbers beside the vertical axis, and the whole plot.
        (columns(size, &pixels, 256, 17), blue(&columns(size, &pixels, 256, 144)))
    });
    let parts: Vec<_> = parts.collect();
    assert!(parts.windows(2).all(|pair| pair[0].0 == pair[1].0), "the axis is the same in all pictures");
    assert!(parts.windows(2).all(|pair| pair[0].1 < pair[1].1), "{:?}", parts.iter().map(|part| part.1).collect::<Vec<_>>());
    // The film of a trajectory has the same plot.
    folder.rockfall("run scene.txt --backend cpu --steps 50 --every 1 --out run.npz", 0);
    folder.rockfall(&format!("render run.npz --out recorded/ --fps 5 --size 400x200 --plot height:1 {CAMERA}"), 0);
    let recorded = blue(&folder.picture("recorded/0005.png").0);
    assert!(recorded.abs_diff(parts[5].1) < parts[5].1 / 4, "{recorded} {}", parts[5].1);
}

#[test]
fn plots_of_what_the_scene_lacks_are_refused() {
    let folder = Folder::new();
    for (plot, message) in [
        ("hight:1", "expected one of: energy, kinetic, potential, momentum, contacts, x, y, z, height, speed, vx"),
        ("height", "expected names or numbers of bodies, as in height:left,right"),
        ("energy:1", "expected no bodies"),
        ("height:left", "--plot left: no object has the name 'left'"),
        ("height:7", "there is no sphere 7"),
    ] {
        let err = folder.render(&format!("--out a.png --plot {plot}"), 2);
        assert!(err.contains(message), "{plot}: {err}");
    }
    assert!(folder.names().is_empty());
}

/// Trails begin before the picture.
#[test]
fn a_picture_has_the_trails_of_the_steps_before_it() {
    let folder = Folder::new();
    let pictures = ["", "--trails 1"].map(|trails| {
        folder.render(&format!("--out a.png --at 100 --size 96x64 {CAMERA} {trails}"), 0);
        folder.picture("a.png").0
    });
    let changed = pictures[0].chunks(3).zip(pictures[1].chunks(3)).filter(|(without, with)| without != with).count();
    assert!(changed > 20, "{changed}");
}

#[test]
fn letters_that_the_font_lacks_are_named() {
    let folder = Folder::new();
    fs::write(folder.path("scene.txt"), "@label 球\nS 1 0 1 0 0 0 0 0 0 0 1 0.5\n").unwrap();
    let out = "--out a.png --size 64x48";
    assert_eq!(folder.render(&format!("{out} --title Größe_λ"), 0).find("letters"), None);
    let err = folder.render(&format!("{out} --label --title 日本日"), 0);
    assert!(err.contains("warning: the built-in font lacks the letters 日本球, which are drawn as boxes\n"), "{err}");
}

/// A picture of a scene that begins without bodies shows its last step, if no step is given.
#[test]
fn a_scene_that_begins_without_bodies_is_drawn_at_its_end() {
    let folder = Folder::new();
    let inlet = "@inlet box=-1,2,-1,1,3,1 rate=20 radius=0.2";
    fs::write(folder.path("scene.txt"), format!("@run dt=0.01 steps=100\n{inlet}\nB -2 -1 -2 4 0 0 0 1 0 0 0 4\n")).unwrap();
    let [usual, end, start] = ["", "--at 100", "--at 0"].map(|at| {
        folder.render(&format!("--out a.png --size 96x64 {CAMERA} {at}"), 0);
        folder.picture("a.png").0
    });
    assert!(usual == end && usual != start);
}
