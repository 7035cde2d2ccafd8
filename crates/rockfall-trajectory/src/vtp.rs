//! PolyData for ParaView and VTK: XML with the numbers appended in binary form.
//!
//! A series `NAME.pvd` lists the frames `NAME/STEP.vtp` with their times, and with every frame the file `NAME/static.vtp`,
//! which has the boxes and polygons. `NAME/scene.txt` is the scene text of the first state. A frame has a point and a vertex cell for every sphere in insertion order, then a line cell for
//! every rod and every spring.
//!
//! | array | belongs to | contents |
//! |---|---|---|
//! | `velocity`, `angular_momentum` | points | 3 components |
//! | `orientation` | points | unit quaternion w, x, y, z |
//! | `radius`, `mass` | points | |
//! | `fixed` | points | 1 for a fixed sphere |
//! | `reference` | points | number of the sphere in the scene file, -1 for none |
//! | `contacts` | points | number of contacts of the sphere, without those of its rods |
//! | `kind` | cells | 0 sphere, 1 rod, 2 spring; for static objects 3 box, 4 polygon |
//! | `cell_radius` | cells | radius of a sphere or rod, 0 for springs |
//! | `TimeValue`, `step` | the data set | time in s, number of steps done |
//!
//! In ParaView (tried with 5.11) a series has two blocks: the frame and the static objects. To draw the spheres, apply Extract
//! Block to the first block, then Glyph with spheres scaled by `radius`, factor 2, at all points. To select the rods and
//! springs, apply Threshold to `kind` from 1 to 2. A test opens the files with VTK.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rockfall::Scene;
use rockfall::output::{AtomicFile, Mark, remove_link};

use crate::Frame;
use crate::frame::{Indices, bytes_of};

const HEAD: &str =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
const FOOT: &str = "</Collection>\n</VTKFile>\n";
const STATIC: &str = "static.vtp";
/// The scene text, from which [`crate::Reader`] takes the objects.
pub(crate) const SCENE: &str = "scene.txt";

#[derive(Debug)]
pub(crate) struct Series {
    list: AtomicFile,
    folder: PathBuf,
    /// Name of the folder in the list.
    name: String,
    static_written: bool,
    scene_written: bool,
}

impl Series {
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        let mut list = AtomicFile::create(&path.with_extension("pvd"))?;
        list.write_all(HEAD.as_bytes())?;
        let series = Self::open(path, list)?;
        // One of an earlier trajectory would be taken for that of this one.
        match fs::remove_file(series.folder.join(SCENE)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => Ok(series),
        }
    }

    pub(crate) fn resume(path: &Path, mark: Mark) -> io::Result<Self> {
        let series = Self::open(path, AtomicFile::resume(&path.with_extension("pvd"), mark)?)?;
        // The scene is that of the first frame.
        let scene_written = series.folder.join(SCENE).exists();
        Ok(Self { scene_written, ..series })
    }

    fn open(path: &Path, list: AtomicFile) -> io::Result<Self> {
        let folder = path.with_extension("");
        let name = folder.file_name().and_then(|name| name.to_str()).map(escaped);
        let name = name.ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "the name of the file is not UTF-8"))?;
        fs::create_dir_all(&folder)?;
        Ok(Self { list, folder, name, static_written: false, scene_written: false })
    }

    pub(crate) fn frame(&mut self, frame: &Frame, scene: &Scene) -> io::Result<()> {
        self.add(frame.step, frame.time, |out| state(out, frame, scene))?;
        if !self.scene_written {
            commit(&self.folder.join(SCENE), |out| out.write_all(scene.to_text().as_bytes()))?;
            self.scene_written = true;
        }
        let counts = scene.counts();
        if counts.boxes + counts.polygons > 0 {
            if !self.static_written {
                commit(&self.folder.join(STATIC), |out| static_objects(out, scene))?;
                self.static_written = true;
            }
            self.list(frame.time, 1, STATIC)?;
        }
        Ok(())
    }

    /// Adds a file to the list.
    pub(crate) fn add(
        &mut self,
        step: u64,
        time: f64,
        write: impl FnOnce(&mut AtomicFile) -> io::Result<()>,
    ) -> io::Result<()> {
        let file = format!("{step:010}.vtp");
        commit(&self.folder.join(&file), write)?;
        self.list(time, 0, &file)
    }

    fn list(&mut self, time: f64, part: u32, file: &str) -> io::Result<()> {
        writeln!(self.list, "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{}/{file}\"/>", self.name)
    }

    pub(crate) fn mark(&mut self) -> io::Result<Option<Mark>> {
        self.list.mark()
    }

    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.list.write_all(FOOT.as_bytes())?;
        self.list.commit()
    }
}

/// Writes a file of the folder, whose name nobody has chosen.
fn commit(path: &Path, write: impl FnOnce(&mut AtomicFile) -> io::Result<()>) -> io::Result<()> {
    remove_link(path)?;
    let mut file = AtomicFile::create(path)?;
    write(&mut file)?;
    file.commit()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// Writes one state as a separate file.
///
/// # Errors
/// Returns the error of the writer.
pub fn state(out: &mut impl Write, frame: &Frame, scene: &Scene) -> io::Result<()> {
    let (spheres, rods, springs) = (&frame.spheres, scene.rods(), scene.springs());
    let indices = Indices::of(scene);
    let lines = rods.iter().map(|rod| indices.pair(rod.end1, rod.end2));
    let lines = lines.chain(springs.iter().map(|spring| indices.pair(spring.a, spring.b)));
    let lines: Vec<[i64; 2]> = lines.map(|line| line.map(i64::from)).collect();
    let count = spheres.len() as i64;

    let mut file = Appended::default();
    file.open("PointData");
    file.floats("velocity", 3, bytes_of(spheres.iter().map(|sphere| sphere.velocity.to_array())));
    file.floats("angular_momentum", 3, bytes_of(spheres.iter().map(|sphere| sphere.angular_momentum.to_array())));
    let quaternions = spheres.iter().map(|sphere| {
        let q = sphere.orientation;
        [q.w, q.x, q.y, q.z]
    });
    file.floats("orientation", 4, bytes_of(quaternions));
    file.floats("radius", 1, bytes_of(spheres.iter().map(|sphere| sphere.radius)));
    file.floats("mass", 1, bytes_of(spheres.iter().map(|sphere| sphere.mass)));
    file.array("UInt8", "fixed", 1, bytes_of(spheres.iter().map(|sphere| u8::from(sphere.fixed))));
    file.array("UInt32", "contacts", 1, bytes_of(frame.contacts.iter().copied()));
    let references = frame.references.iter().map(|reference| reference.map_or(-1, i64::from));
    file.array("Int64", "reference", 1, bytes_of(references));
    file.close("PointData");
    file.open("CellData");
    let kinds = [(0, spheres.len()), (1, rods.len()), (2, springs.len())];
    let kinds = kinds.into_iter().flat_map(|(kind, count)| std::iter::repeat_n(kind, count));
    file.array("UInt8", "kind", 1, bytes_of(kinds.map(|kind: u8| kind)));
    let radii = spheres.iter().map(|sphere| sphere.radius).chain(rods.iter().map(|rod| rod.radius));
    file.floats("cell_radius", 1, bytes_of(radii.chain(springs.iter().map(|_| 0.0))));
    file.close("CellData");
    file.open("Points");
    file.floats("Points", 3, bytes_of(spheres.iter().map(|sphere| sphere.position.to_array())));
    file.close("Points");
    file.cells("Verts", bytes_of(0..count), bytes_of(1..=count));
    file.cells("Lines", bytes_of(lines.iter().copied()), bytes_of((1..=lines.len() as i64).map(|line| 2 * line)));
    let counts = [spheres.len(), spheres.len(), lines.len(), 0];
    file.write(out, counts, Some((frame.step, frame.time)))
}

/// Writes the boxes and polygons as a separate file.
fn static_objects(out: &mut impl Write, scene: &Scene) -> io::Result<()> {
    // Corners around every face of a box. The bits of a corner are the edges that lead to it: I = 1, J = 2, K = 4.
    const FACES: [[usize; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let (mut points, mut faces, mut kinds) = (Vec::new(), Vec::new(), Vec::new());
    for cuboid in scene.boxes() {
        let first = points.len() as i64;
        let corner = |which: usize| {
            let edges = cuboid.edges.iter().enumerate().filter(|(edge, _)| which >> edge & 1 == 1);
            edges.fold(cuboid.corner, |corner, (_, edge)| corner + *edge).to_array()
        };
        points.extend((0..8).map(corner));
        faces.extend(FACES.map(|face| face.map(|corner| first + corner as i64).to_vec()));
        kinds.extend([3_u8; 6]);
    }
    for polygon in scene.polygons() {
        let first = points.len() as i64;
        points.extend(polygon.vertices().map(|corner| corner.to_array()));
        faces.push((first..points.len() as i64).collect());
        kinds.push(4);
    }
    let mut file = Appended::default();
    let counts = [points.len(), 0, 0, faces.len()];
    file.open("CellData");
    file.array("UInt8", "kind", 1, kinds);
    file.close("CellData");
    file.open("Points");
    file.floats("Points", 3, bytes_of(points));
    file.close("Points");
    let ends = faces.iter().scan(0, |end, face: &Vec<i64>| {
        *end += face.len() as i64;
        Some(*end)
    });
    file.cells("Polys", bytes_of(faces.iter().flatten().copied()), bytes_of(ends));
    file.write(out, counts, None)
}

/// XML that describes arrays, and the arrays that are appended to it.
#[derive(Default)]
pub(crate) struct Appended {
    xml: String,
    arrays: Vec<Vec<u8>>,
    /// Total size of the arrays in bytes, including the length before each.
    length: usize,
}

impl Appended {
    pub(crate) fn open(&mut self, name: &str) {
        self.xml.push_str(&format!("<{name}>\n"));
    }

    pub(crate) fn close(&mut self, name: &str) {
        self.xml.push_str(&format!("</{name}>\n"));
    }

    pub(crate) fn floats(&mut self, name: &str, components: u32, bytes: Vec<u8>) {
        self.array("Float32", name, components, bytes);
    }

    pub(crate) fn array(&mut self, kind: &str, name: &str, components: u32, bytes: Vec<u8>) {
        self.xml.push_str(&format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{}\"/>\n",
            self.length
        ));
        self.length += 8 + bytes.len();
        self.arrays.push(bytes);
    }

    pub(crate) fn cells(&mut self, name: &str, connectivity: Vec<u8>, offsets: Vec<u8>) {
        self.open(name);
        self.array("Int64", "connectivity", 1, connectivity);
        self.array("Int64", "offsets", 1, offsets);
        self.close(name);
    }

    /// Writes the file. `counts` are the numbers of points, vertices, lines and polygons.
    pub(crate) fn write(self, out: &mut impl Write, counts: [usize; 4], time: Option<(u64, f64)>) -> io::Result<()> {
        let [points, vertices, lines, polygons] = counts;
        writeln!(
            out,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>"
        )?;
        if let Some((step, time)) = time {
            let field = |kind: &str, name: &str, value: &dyn std::fmt::Display| {
                format!(
                    "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfTuples=\"1\" format=\"ascii\">{value}</DataArray>\n"
                )
            };
            let fields = field("Float64", "TimeValue", &time) + &field("UInt64", "step", &step);
            write!(out, "<FieldData>\n{fields}</FieldData>\n")?;
        }
        writeln!(
            out,
            "<Piece NumberOfPoints=\"{points}\" NumberOfVerts=\"{vertices}\" NumberOfLines=\"{lines}\" NumberOfStrips=\"0\" NumberOfPolys=\"{polygons}\">"
        )?;
        self.append(out, "PolyData")
    }

    /// Writes a file of values at the points of a regular grid.
    pub(crate) fn write_image(
        self,
        out: &mut impl Write,
        origin: [f64; 3],
        spacing: f64,
        counts: [usize; 3],
    ) -> io::Result<()> {
        let extent = counts.map(|count| format!("0 {}", count - 1)).join(" ");
        let [x, y, z] = origin;
        writeln!(
            out,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
             <ImageData WholeExtent=\"{extent}\" Origin=\"{x} {y} {z}\" Spacing=\"{spacing} {spacing} {spacing}\">\n\
             <Piece Extent=\"{extent}\">"
        )?;
        self.append(out, "ImageData")
    }

    /// Writes the description of the arrays, the end of the XML, and the arrays.
    fn append(self, out: &mut impl Write, kind: &str) -> io::Result<()> {
        write!(out, "{}</Piece>\n</{kind}>\n<AppendedData encoding=\"raw\">\n_", self.xml)?;
        for array in &self.arrays {
            out.write_all(&(array.len() as u64).to_le_bytes())?;
            out.write_all(array)?;
        }
        write!(out, "\n</AppendedData>\n</VTKFile>\n")
    }
}
