//! Contacts between bodies: CSV, arrays for NumPy, and lines for ParaView that show force chains.
//!
//! All formats have the same values for each contact, in the order of [`Simulation::contacts`]:
//!
//! | CSV columns | array | contents |
//! |---|---|---|
//! | `step`, `time` | see below | number of steps done, simulated time in s |
//! | `a_kind`, `b_kind` | `a_kind`, `b_kind` | kind of body A and body B: `sphere` 0, `rod` 1, `box` 3, `polygon` 4 |
//! | `a`, `b` | `a`, `b` | index of the body among those of its kind, in insertion order |
//! | `x`, `y`, `z` | `point` | contact point: in the middle of the overlap, or on the surface of a static body |
//! | `nx`, `ny`, `nz` | `normal` | unit normal from A to B |
//! | `overlap` | `overlap` | depth of the overlap, in units |
//! | `fx`, `fy`, `fz` | `force` | contact force with friction on B in mass units/s²; 0 in a collision. A receives the opposite |
//! | `ix`, `iy`, `iz` | `impulse` | normal impulse of a collision on B in the next step, in mass units/s; 0 without one |
//! | `a_reference`, `b_reference` | `a_reference`, `b_reference` | number of the sphere in the scene file; empty, or -1 in arrays, if it has none |
//! | `normal_force` | `normal_force` | part of the contact force along the normal; positive where it pushes the bodies apart |
//! | `tx`, `ty`, `tz` | `tangential_force` | part of the contact force on B across the normal |
//! | `state` | `slip` | `slip` (1) at Coulomb's limit, `stick` (0) below it; empty (-1) without springs |
//! | `ux`, `uy`, `uz` | `displacement` | tangential displacement of A relative to B that a law with history remembers, in units |
//!
//! With the contact law of the thesis, the state is empty and the displacement is 0. In a collision the forces are 0. Friction
//! impulses (`coulomb_friction`) are not included.
//!
//! An `.npz` file has one element per contact, and `frame`, the index of its frame. The arrays `step`, `time` and `count` (number
//! of contacts) have one element per frame: `c["force"][c["frame"] == 2]` are the forces of the third frame.
//!
//! A `.vtp` file has a line for each contact, from the centre or axis of A through the contact point to the centre or axis of B,
//! or to the contact point on a box or polygon. The values are cell data; `force_magnitude` is also point data, for the filter
//! Tube: vary the radius by scalar to see force chains. A series `NAME.pvd` lists the files `NAME/STEP.vtp`.

use std::io::{self, Write};
use std::path::Path;

use rockfall::glam::Vec3;
use rockfall::output::{AtomicFile, Mark};
use rockfall::{Body, Contact, ContactAction, ContactSprings, Result, Scene, Simulation};

use crate::Format;
use crate::csv::numbers;
use crate::frame::bytes_of;
use crate::target::{Content, Series, Target};
use crate::vtp::Appended;

mod npz;

const HEADER: &str = "step,time,a_kind,a,b_kind,b,x,y,z,nx,ny,nz,overlap,fx,fy,fz,ix,iy,iz,a_reference,b_reference,\
    normal_force,tx,ty,tz,state,ux,uy,uz";

/// All contacts of one state.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Number of steps done.
    pub step: u64,
    /// Simulated time, in s.
    pub time: f64,
    rows: Vec<Row>,
}

/// One body of a contact.
#[derive(Clone, Copy, Debug)]
struct Side {
    body: Body,
    index: u32,
    reference: Option<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Row {
    sides: [Side; 2],
    point: Vec3,
    normal: Vec3,
    overlap: f32,
    force: Vec3,
    impulse: Vec3,
    normal_force: f32,
    tangential_force: Vec3,
    springs: Option<ContactSprings>,
    /// From the centre or axis of A to that of B.
    line: [Vec3; 2],
}

impl Contacts {
    /// Computes the contacts of the current state on the host.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] if the GPU failed.
    pub fn of(simulation: &mut Simulation) -> Result<Self> {
        let contacts = simulation.contacts()?;
        let (report, scene) = (simulation.report(), simulation.scene());
        let rows = contacts.iter().map(|contact| Row::of(contact, scene)).collect::<Result<_>>()?;
        Ok(Self { step: report.steps, time: report.time, rows })
    }

    /// Number of contacts.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are no contacts.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

impl Side {
    fn of(body: Body, scene: &Scene) -> Result<Self> {
        let reference = match body {
            Body::Sphere(id) => scene.reference(id),
            _ => None,
        };
        Ok(Self { body, index: body.index(scene)? as u32, reference })
    }

    /// Number of the kind, as in the other `.vtp` files.
    fn kind(&self) -> u8 {
        match self.body {
            Body::Sphere(_) => 0,
            Body::Rod(_) => 1,
            Body::Box(_) => 3,
            _ => 4,
        }
    }
}

impl Row {
    fn of(contact: &Contact, scene: &Scene) -> Result<Self> {
        let radius = |body: Body| {
            Ok(match body {
                Body::Sphere(id) => Some(scene.sphere(id)?.radius),
                Body::Rod(id) => Some(scene.rod(id)?.radius),
                _ => None,
            })
        };
        let Contact { a, b, point, normal, overlap, action, springs, .. } = *contact;
        let (normal_force, tangential_force) = (contact.normal_force(), contact.tangential_force());
        let (of_a, of_b) = (radius(a)?, radius(b)?);
        // A static body leaves the whole overlap to the other one.
        let shared = if of_b.is_some() { 0.5 * overlap } else { overlap };
        let start = point - of_a.map_or(0.0, |radius| radius - shared) * normal;
        let end = point + of_b.map_or(0.0, |radius| radius - shared) * normal;
        let (force, impulse) = match action {
            ContactAction::Force(force) => (force, Vec3::ZERO),
            ContactAction::Impulse(impulse) => (Vec3::ZERO, impulse),
            _ => (Vec3::ZERO, Vec3::ZERO),
        };
        let sides = [Side::of(a, scene)?, Side::of(b, scene)?];
        let line = [start, end];
        Ok(Self { sides, point, normal, overlap, force, impulse, normal_force, tangential_force, springs, line })
    }

    /// 1 for a contact that slips, 0 for one that sticks, -1 for one without springs.
    fn slip(&self) -> i8 {
        self.springs.map_or(-1, |springs| i8::from(springs.slips))
    }

    fn displacement(&self) -> Vec3 {
        self.springs.map_or(Vec3::ZERO, |springs| springs.displacement)
    }

    fn csv(&self, out: &mut impl Write) -> io::Result<()> {
        for side in &self.sides {
            write!(out, ",{},{}", side.body.kind(), side.index)?;
        }
        for vector in [self.point, self.normal] {
            numbers(out, &vector.to_array())?;
        }
        numbers(out, &[self.overlap])?;
        for vector in [self.force, self.impulse] {
            // Adding 0 turns -0 into 0.
            numbers(out, &(vector + 0.0).to_array())?;
        }
        for side in &self.sides {
            let reference = side.reference.map_or(String::new(), |reference| reference.to_string());
            write!(out, ",{reference}")?;
        }
        numbers(out, &[self.normal_force + 0.0])?;
        numbers(out, &(self.tangential_force + 0.0).to_array())?;
        let state = match self.slip() {
            1 => "slip",
            0 => "stick",
            _ => "",
        };
        write!(out, ",{state}")?;
        numbers(out, &(self.displacement() + 0.0).to_array())?;
        writeln!(out)
    }
}

fn csv(out: &mut impl Write, contacts: &Contacts) -> io::Result<()> {
    let mut prefix = contacts.step.to_string().into_bytes();
    numbers(&mut prefix, &[contacts.time])?;
    contacts.rows.iter().try_for_each(|row| {
        out.write_all(&prefix)?;
        row.csv(out)
    })
}

/// Writes the contacts of one state as a `.vtp` file.
///
/// # Errors
/// Returns the error of the writer.
pub fn lines(out: &mut impl Write, contacts: &Contacts) -> io::Result<()> {
    let rows = &contacts.rows;
    let count = rows.len() as i64;
    let mut file = Appended::default();
    file.open("PointData");
    file.floats("force_magnitude", 1, bytes_of(rows.iter().flat_map(|row| [row.force.length(); 2])));
    file.close("PointData");
    file.open("CellData");
    for (side, name) in ["a", "b"].into_iter().enumerate() {
        file.array("UInt8", &format!("{name}_kind"), 1, bytes_of(rows.iter().map(|row| row.sides[side].kind())));
        file.array("UInt32", name, 1, bytes_of(rows.iter().map(|row| row.sides[side].index)));
    }
    for (name, vector) in [("point", 0), ("normal", 1), ("force", 2), ("impulse", 3)] {
        let of = |row: &Row| [row.point, row.normal, row.force, row.impulse][vector].to_array();
        file.floats(name, 3, bytes_of(rows.iter().map(of)));
    }
    file.floats("overlap", 1, bytes_of(rows.iter().map(|row| row.overlap)));
    file.floats("force_magnitude", 1, bytes_of(rows.iter().map(|row| row.force.length())));
    file.floats("normal_force", 1, bytes_of(rows.iter().map(|row| row.normal_force)));
    file.floats("tangential_force", 3, bytes_of(rows.iter().map(|row| row.tangential_force.to_array())));
    file.array("Int8", "slip", 1, bytes_of(rows.iter().map(Row::slip)));
    file.floats("displacement", 3, bytes_of(rows.iter().map(|row| row.displacement().to_array())));
    file.close("CellData");
    file.open("Points");
    file.floats("Points", 3, bytes_of(rows.iter().map(|row| row.line.map(|end| end.to_array()))));
    file.close("Points");
    file.cells("Lines", bytes_of(0..2 * count), bytes_of((1..=count).map(|line| 2 * line)));
    file.write(out, [2 * rows.len(), 0, rows.len(), 0], Some((contacts.step, contacts.time)))
}

impl Content for Contacts {
    const HEADER: &str = HEADER;
    type Arrays = npz::Records;

    fn unpack(path: &Path, scratch: &mut AtomicFile, mark: Mark) -> io::Result<()> {
        npz::unpack(path, scratch, mark)
    }

    fn arrays(scratch: &mut AtomicFile, bytes: u64) -> io::Result<Self::Arrays> {
        npz::Records::new(scratch, bytes)
    }
}

/// A file of contacts that is being written, frame by frame. [`Writer`](crate::Writer) describes how files appear.
#[derive(Debug)]
pub struct Writer {
    target: Target<npz::Records>,
}

impl Writer {
    /// Begins a file.
    ///
    /// # Errors
    /// [`rockfall::Error::File`] if the path cannot be written to.
    pub fn create(path: impl AsRef<Path>, format: Format) -> Result<Self> {
        Ok(Self { target: Target::create::<Contacts>(path.as_ref(), format)? })
    }

    /// Continues a file from a mark, whether it was finished or not. Frames after the mark are removed.
    ///
    /// # Errors
    /// [`rockfall::Error::File`] if the path cannot be written to, or if the contents before the mark are missing or have
    /// changed.
    pub fn resume(path: impl AsRef<Path>, format: Format, mark: Mark) -> Result<Self> {
        Ok(Self { target: Target::resume::<Contacts>(path.as_ref(), format, mark)? })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`rockfall::Error::File`] if the file cannot be written.
    pub fn frame(&mut self, contacts: &Contacts) -> Result<()> {
        self.target.write(|series| match series {
            Series::Csv(file) => csv(file, contacts),
            Series::Npz(npz) => npz.1.frame(&mut npz.0.scratch, contacts),
            Series::Vtp(series) => series.add(contacts.step, contacts.time, |out| lines(out, contacts)),
        })
    }

    /// Writes everything so far to the disk and returns the position for [`Writer::resume`], as
    /// [`Writer::mark`](crate::Writer::mark) does.
    ///
    /// # Errors
    /// [`rockfall::Error::File`] if the file cannot be written.
    pub fn mark(&mut self) -> Result<Option<Mark>> {
        self.target.mark()
    }

    /// Completes the file and moves it to its final path.
    ///
    /// # Errors
    /// [`rockfall::Error::File`] if the file cannot be written.
    pub fn finish(self) -> Result<()> {
        self.target.finish(|archive, _| npz::finish(archive))
    }
}
