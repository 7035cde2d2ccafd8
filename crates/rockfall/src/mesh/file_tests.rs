use std::fmt::Write as _;

use super::mesh_tests::cube;
use super::{Mesh, MeshFormat};

use MeshFormat::{Obj, Ply, Stl};

/// The quads of the cube of [`cube`], whose fans are its triangles.
fn quads() -> Vec<[u32; 4]> {
    cube().triangles.chunks(2).map(|pair| [pair[0][0], pair[0][1], pair[0][2], pair[1][2]]).collect()
}

fn stl_text() -> String {
    let mut text = "solid a cube, facet by facet\n".to_owned();
    let (mesh, count) = (cube(), cube().triangles.len());
    for (number, triangle) in mesh.triangles.iter().enumerate() {
        if number == count / 2 {
            text += "endsolid a cube\n\n\tSOLID\n";
        }
        text += "\tfacet normal nan 0 -nan(ind)\r\n  Outer LOOP\n";
        for [x, y, z] in triangle.map(|at| mesh.vertices[at as usize]) {
            writeln!(text, "vertex\t{x:e} +{y} {z:.3}").unwrap();
        }
        text += "endloop endfacet\n";
    }
    text + "endsolid"
}

fn obj(face: impl Fn([u32; 4]) -> String) -> Vec<u8> {
    let mut text = "# a cube\nmtllib cube.mtl\no cube\n".to_owned();
    for [x, y, z] in cube().vertices {
        writeln!(text, "v {x} {y} {z} 1.0").unwrap();
    }
    text += "vn 0 0 1\nvt 0 0\ng side\ns off\n";
    for quad in quads() {
        writeln!(text, "f {}", face(quad)).unwrap();
    }
    text.into_bytes()
}

fn words(quad: [u32; 4], word: impl Fn(u32) -> String) -> String {
    quad.map(word).join(" ")
}

/// The header of a PLY file with other properties and elements around those that are read.
fn ply_header(encoding: &str) -> String {
    format!(
        "ply\nformat {encoding} 1.0\ncomment a cube\nelement vertex 8\nproperty uchar red\nproperty float x\nproperty double y\n\
         property list uchar short weights\nproperty int z\nelement edge 2\nproperty int a\nproperty list uint float b\n\
         element nothing 5\nelement face 6\nproperty float quality\nproperty list uchar uint vertex_indices\nend_header\n"
    )
}

fn ply_text() -> String {
    let mut text = ply_header("ascii");
    for [x, y, z] in cube().vertices {
        writeln!(text, "7 {x} {y} 2 -1 -2 {z}").unwrap();
    }
    text += "1 0\n2 3 0.5 1 nan\n";
    for quad in quads() {
        writeln!(text, "0.5 4 {}", words(quad, |at| at.to_string())).unwrap();
    }
    text
}

fn ply_binary(is_big: bool) -> Vec<u8> {
    let mut bytes = ply_header(if is_big { "binary_big_endian" } else { "binary_little_endian" }).into_bytes();
    let mut put = |low_first: &[u8]| {
        let mut number = low_first.to_vec();
        if is_big {
            number.reverse();
        }
        bytes.extend(number);
    };
    for [x, y, z] in cube().vertices {
        put(&[7]);
        put(&x.to_le_bytes());
        put(&f64::from(y).to_le_bytes());
        put(&[2]);
        put(&(-1_i16).to_le_bytes());
        put(&(-2_i16).to_le_bytes());
        put(&(z as i32).to_le_bytes());
    }
    for length in [0_u32, 3] {
        put(&1_i32.to_le_bytes());
        put(&length.to_le_bytes());
        (0..length).for_each(|_| put(&f32::NAN.to_le_bytes()));
    }
    for quad in quads() {
        put(&0.5_f32.to_le_bytes());
        put(&[4]);
        quad.iter().for_each(|at| put(&at.to_le_bytes()));
    }
    bytes
}

fn stl_binary(header: &[u8]) -> Vec<u8> {
    let mut bytes = cube().to_stl();
    bytes[..header.len()].copy_from_slice(header);
    bytes
}

/// The same cube in all formats.
pub(super) fn samples() -> Vec<(&'static str, MeshFormat, Vec<u8>)> {
    let crlf = |text: &str| text.replace("\r\n", "\n").replace('\n', "\r\n").into_bytes();
    let cr = |text: &str| text.replace("\r\n", "\n").replace('\n', "\r").into_bytes();
    let plain = obj(|quad| words(quad, |at| (at + 1).to_string()));
    let plain_text = String::from_utf8(plain.clone()).unwrap();
    vec![
        ("text", Stl, stl_text().into_bytes()),
        ("text, CRLF", Stl, crlf(&stl_text())),
        ("text, CR", Stl, cr(&stl_text())),
        ("text, mark", Stl, [b"\xef\xbb\xbf \n".to_vec(), stl_text().into_bytes()].concat()),
        ("text, Latin-1", Stl, [b"solid W\xfcrfel\n".to_vec(), stl_text().into_bytes()[29..].to_vec()].concat()),
        ("binary", Stl, cube().to_stl()),
        ("binary, solid", Stl, stl_binary(b"solid cube")),
        ("a", Obj, plain),
        ("CRLF", Obj, crlf(&plain_text)),
        ("CR", Obj, cr(&plain_text)),
        ("continued", Obj, obj(|quad| words(quad, |at| format!("{}\\\n", at + 1)) + " ")),
        ("a/b", Obj, obj(|quad| words(quad, |at| format!("{}/1", at + 1)))),
        ("a//c", Obj, obj(|quad| words(quad, |at| format!("{}//1", at + 1)))),
        ("a/b/c", Obj, obj(|quad| words(quad, |at| format!("{}/1/1", at + 1)))),
        ("negative", Obj, obj(|quad| words(quad, |at| format!("{}/-1", at as i32 - 8)))),
        ("text", Ply, ply_text().into_bytes()),
        ("text, CRLF", Ply, crlf(&ply_text())),
        ("text, CR", Ply, cr(&ply_text())),
        ("text, vertex_index", Ply, ply_text().replace("vertex_indices", "vertex_index").into_bytes()),
        ("little", Ply, ply_binary(false)),
        ("big", Ply, ply_binary(true)),
    ]
}

#[test]
fn the_same_cube_in_all_formats() {
    for (name, format, bytes) in samples() {
        let mesh = Mesh::parse(&bytes, format).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(mesh, cube(), "{name} of {format:?}");
    }
}

fn error(format: MeshFormat, bytes: impl AsRef<[u8]>) -> String {
    match Mesh::parse(bytes.as_ref(), format) {
        Ok(mesh) => panic!("{format:?} was accepted: {mesh:?}"),
        Err(error) => error.to_string(),
    }
}

fn assert_begins(message: &str, start: &str) {
    assert!(message.starts_with(start), "{message}\nexpected\n{start}");
}

/// The sample without a part of it.
fn replaced(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn a_file_that_ends_early_is_refused() {
    for (name, format, bytes) in samples() {
        let content = bytes.trim_ascii_end().len();
        for length in 0..content {
            // A line of OBJ may be complete earlier, and so may be a number at its end. A text of STL has two solids.
            let start = String::from_utf8_lossy(&bytes[..length]);
            let is_complete = match format {
                Obj => length > content / 2,
                _ => start.contains("endsolid") && !start.contains("SOLID"),
            };
            let read = Mesh::parse(&bytes[..length], format);
            assert!(read.is_err() || is_complete || read.unwrap() == cube(), "{length} bytes of {name}, {format:?}");
        }
    }
    let text = stl_text();
    assert_begins(
        &error(Stl, text.trim_end_matches("endsolid")),
        "STL mesh:76: the file ends early, expected facet or endsolid",
    );
    assert_begins(&error(Stl, b""), "STL mesh, byte 0: expected a text that begins with solid, or at least 84 bytes, found 0");
    assert_begins(&error(Obj, b""), "OBJ mesh: no triangle, expected at least one");
    assert_begins(&error(Ply, b""), "PLY mesh:1: expected a line `ply`");
    let bytes = ply_binary(false);
    let last = bytes.len() - 4;
    assert_begins(&error(Ply, &bytes[..last + 3]), &format!("PLY mesh, byte {last}: the file ends early, expected the index"));
    let text = ply_text();
    let text = text.trim_end().rsplit_once(' ').unwrap().0;
    assert_begins(&error(Ply, text), "PLY mesh:33: the file ends early, expected the index of a vertex");
    assert_begins(&error(Ply, "ply\nformat ascii 1.0\n"), "PLY mesh:3: the file ends early, expected a line `end_header`");
}

#[test]
fn a_file_that_continues_is_refused() {
    assert_begins(&error(Ply, ply_text() + "\n3\n"), "PLY mesh:35: the file continues, expected its end");
    let bytes = ply_binary(true);
    assert_begins(&error(Ply, [&bytes[..], &[0]].concat()), &format!("PLY mesh, byte {}: the file continues", bytes.len()));
    assert_begins(&error(Stl, stl_text() + "\nfacet"), "STL mesh:78: found 'facet', expected solid");
}

#[test]
fn headers_that_lie_are_refused() {
    let mut bytes = cube().to_stl();
    bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let expected = "STL mesh, byte 80: neither a text that begins with solid nor a binary file: \
                    4294967295 facets would need 214748364834 bytes, the file has 684";
    assert_eq!(error(Stl, &bytes), expected);
    bytes[..5].copy_from_slice(b"solid");
    assert_eq!(error(Stl, &bytes), expected);
    let text = ply_text();
    for count in ["99", "18446744073709551615"] {
        let message = error(Ply, replaced(&text, "vertex 8", &format!("vertex {count}")));
        assert_begins(&message, &format!("PLY mesh:4: {count} elements 'vertex' need at least "));
        let little = String::from_utf8_lossy(&ply_binary(false)[..393]).into_owned();
        let message = error(Ply, replaced(&little, "face 6", &format!("face {count}")));
        assert_begins(&message, "PLY mesh:4: 8 elements 'vertex' need at least ");
    }
    assert_begins(
        &error(Ply, replaced(&text, "vertex 8", "vertex 18446744073709551616")),
        "PLY mesh:4: '18446744073709551616' is not",
    );
    assert_begins(&error(Ply, replaced(&text, "vertex 8", "vertex -1")), "PLY mesh:4: '-1' is not a number of elements");
    // An element without properties takes no time.
    assert_eq!(Mesh::parse(replaced(&text, "nothing 5", "nothing 18446744073709551615").as_bytes(), Ply).unwrap(), cube());
    let mut bytes = ply_binary(false);
    let first = bytes.len() - 6 * 21 + 4;
    assert_eq!(bytes[first], 4);
    bytes[first] = 255;
    assert_begins(&error(Ply, &bytes), "PLY mesh, byte ");
    assert_begins(
        &error(Ply, replaced(&text, "0.5 4 ", "0.5 4000000000 ")),
        "PLY mesh:29: found '0.5', expected the index of a vertex",
    );
}

#[test]
fn wrong_headers_of_ply_are_refused() {
    let cases = [
        ("ply\n", "plx\n", "1: expected a line `ply`"),
        ("format ascii 1.0", "format utf8 1.0", "2: unknown format 'utf8', expected ascii, "),
        ("format ascii 1.0", "format ascii 2.0", "2: expected `format NAME 1.0`"),
        ("format ascii 1.0", "comment", "17: expected a line `format`"),
        ("comment a cube", "remark", "3: found 'remark', expected format, element, "),
        ("comment a cube", "property float x", "3: a property, expected a line `element` before it"),
        ("float x", "half x", "6: unknown type 'half', expected char, "),
        ("float x", "float u", "4: vertices without a property x"),
        ("float x", "list uchar float x", "4: vertices without a property x"),
        ("float x", "float", "6: expected `property TYPE NAME` or "),
        ("list uchar short", "list float short", "8: the count of a list is a float, expected"),
        ("list uchar uint vertex", "list uchar float vertex", "16: vertex_indices is a list of floating-point numbers"),
        ("vertex_indices", "vertices", "14: faces without a list vertex_indices or vertex_index"),
        ("element face", "element faces", "17: no element face, expected elements vertex and face"),
        ("element edge", "element vertex", "10: a second element vertex, expected one"),
    ];
    for (from, to, expected) in cases {
        assert_begins(&error(Ply, replaced(&ply_text(), from, to)), &format!("PLY mesh:{expected}"));
    }
}

#[test]
fn coordinates_that_are_not_finite_are_refused() {
    for word in ["nan", "-inf", "1e39"] {
        let stl = replaced(&stl_text(), "vertex\t0e0", &format!("vertex {word}"));
        let message = format!("x of a vertex: '{word}' is not finite (in f32), expected a finite number");
        assert_eq!(error(Stl, stl), format!("STL mesh:4: {message}"));
        assert_eq!(error(Obj, format!("v {word} 0 0\n")), format!("OBJ mesh:1: {message}"));
        let ply = replaced(&ply_text(), "7 0 0 ", &format!("7 {word} 0 "));
        assert_eq!(error(Ply, ply), format!("PLY mesh:18: {message}"));
    }
    assert_eq!(error(Obj, "\nv 0 1,5 0"), "OBJ mesh:2: y of a vertex: '1,5' is not a number, expected a finite number");
    assert_begins(&error(Obj, "v 0 1\n"), "OBJ mesh:1: z of a vertex is missing, expected v x y z");
    let mut bytes = cube().to_stl();
    bytes[84 + 50 + 12 + 16..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_begins(&error(Stl, &bytes), "STL mesh, byte 162: y of a vertex: NaN is not finite");
    let header = ply_header("binary_big_endian").len();
    for number in [f64::NAN, f64::NEG_INFINITY, 1e39] {
        let mut bytes = ply_binary(true);
        bytes[header + 5..][..8].copy_from_slice(&number.to_be_bytes());
        assert_begins(&error(Ply, &bytes), &format!("PLY mesh, byte {}: y of a vertex: {number} is not finite", header + 5));
    }
}

#[test]
fn wrong_indices_are_refused() {
    let face = |line: &str| error(Obj, format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf {line}\n"));
    assert_eq!(face("1 2 4"), "OBJ mesh:4: the index 4 is out of range, the file has 3 vertices");
    assert_eq!(face("1 2 -4"), "OBJ mesh:4: the index -4 is out of range, 3 vertices precede it");
    assert_begins(&face("-9223372036854775808 2 1"), "OBJ mesh:4: the index -9223372036854775808 is out of range");
    assert_begins(&face("4294967296 2 1"), "OBJ mesh:4: the index 4294967296 is out of range");
    assert_begins(&face("1 2 0"), "OBJ mesh:4: '0' is not an index, expected a whole number other than 0");
    assert_begins(&face("1 2 3.0"), "OBJ mesh:4: '3.0' is not an index");
    assert_begins(&face("1 2 /3"), "OBJ mesh:4: '/3' is not an index");
    assert_eq!(face("1 2"), "OBJ mesh:4: a face with 2 vertices, expected at least 3");
    assert_eq!(Mesh::parse(b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0", Obj).unwrap().triangles, [[0, 1, 2]]);
    let last = ply_text().trim_end().rsplit_once(' ').unwrap().0.to_owned();
    assert_eq!(error(Ply, format!("{last} 8")), "PLY mesh:33: the index 8 is out of range, the file has 8 vertices");
    assert_eq!(error(Ply, format!("{last} -1")), "PLY mesh:33: the index -1 is out of range, expected one from 0");
    assert_begins(&error(Ply, format!("{last} 1.0")), "PLY mesh:33: found '1.0', expected the index of a vertex");
    assert_eq!(
        error(Ply, replaced(&ply_text(), "0.5 4 ", "0.5 2 ")),
        "PLY mesh:28: a face with 2 vertices, expected at least 3"
    );
    let negative = error(Ply, replaced(&ply_text(), "2 -1 -2", "-2 -1 -2"));
    assert_eq!(negative, "PLY mesh:18: the length of a list is -2, expected at least 0");
    let mut bytes = ply_binary(true);
    let last = bytes.len() - 4;
    bytes[last..].copy_from_slice(&8_u32.to_be_bytes());
    assert_eq!(error(Ply, &bytes), format!("PLY mesh, byte {last}: the index 8 is out of range, the file has 8 vertices"));
}

#[test]
fn wrong_words_of_a_text_are_named() {
    let wrong = |from, to| error(Stl, replaced(&stl_text(), from, to));
    assert_eq!(wrong("Outer", "inner"), "STL mesh:3: found 'inner', expected outer");
    assert_eq!(wrong("normal", "normals"), "STL mesh:2: found 'normals', expected normal");
    assert_eq!(wrong("endloop", "vertex 0 0 0 endloop"), "STL mesh:7: found 'vertex', expected endloop");
    assert_eq!(wrong("endfacet", "end\u{1b}"), "STL mesh:7: found 'end\\u{1b}', expected endfacet");
    assert_eq!(wrong("endsolid", "end"), "STL mesh:38: found 'end', expected facet or endsolid");
    assert_eq!(error(Stl, "solid\nendsolid"), "STL mesh: no triangle, expected at least one");
}

#[test]
fn degenerate_triangles_of_files_are_counted() {
    let text = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nf 1 5 2\nf 1 2 3 3 4 1\n";
    let mesh = Mesh::parse(text, Obj).unwrap();
    assert_eq!((mesh.triangles, mesh.left_out), (vec![[0, 1, 2], [0, 2, 3]], 3));
    let flat = error(Obj, "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    assert_begins(&flat, "OBJ mesh: mesh.triangles: a mesh whose 1 triangles are all degenerate is not allowed");
}

/// A scene of a stranger may name any file.
#[cfg(unix)]
#[test]
fn only_regular_files_of_a_bounded_size_are_read() {
    let folder = std::env::temp_dir().join(format!("rockfall-large-mesh-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("folder.ply")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", folder.join("zero.stl")).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(folder.join("pipe.obj")).status().unwrap().success());
    for name in ["zero.stl", "pipe.obj", "folder.ply"] {
        let error = Mesh::read(folder.join(name)).unwrap_err().to_string();
        let expected = format!("{}: a folder, a device or a pipe, expected a regular file", folder.join(name).display());
        assert_eq!(error, expected);
    }
    // A file with a hole takes no room on the disk.
    std::fs::File::create(folder.join("hole.stl")).unwrap().set_len(super::LARGEST_FILE + 1).unwrap();
    let error = Mesh::read(folder.join("hole.stl")).unwrap_err().to_string();
    assert!(error.ends_with("hole.stl: 4294967297 bytes, expected at most 4294967296"), "{error}");
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn the_extension_decides_the_format() {
    let folder = std::env::temp_dir().join(format!("rockfall-mesh-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for (number, (_, format, bytes)) in samples().into_iter().enumerate() {
        let extension = format.extension();
        let path =
            folder.join(format!("cube.{}", if number % 2 == 0 { extension.to_uppercase() } else { extension.to_owned() }));
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(Mesh::read(&path).unwrap(), cube());
    }
    let error = |name: &str| Mesh::read(folder.join(name)).unwrap_err().to_string();
    let path = |name: &str| folder.join(name).display().to_string();
    std::fs::write(folder.join("bad.obj"), "f 1 2 3").unwrap();
    assert_eq!(error("bad.obj"), path("bad.obj:1: the index 3 is out of range, the file has 0 vertices"));
    assert_eq!(error("cube.dae"), path("cube.dae: the extension 'dae' is unknown, expected .stl, .obj or .ply"));
    assert_eq!(error("cube"), path("cube: the file name has no extension, expected .stl, .obj or .ply"));
    assert_begins(&error("missing.ply"), &path("missing.ply: "));
    std::fs::remove_dir_all(&folder).unwrap();
}
