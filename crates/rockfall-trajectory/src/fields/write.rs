//! Files of fields.

use std::io::{self, Write};
use std::path::Path;

use glam::{DMat3, DVec3};
use rockfall::output::AtomicFile;
use rockfall::{Error, Result};
use zip::ZipWriter;

use crate::fields::Fields;
use crate::frame::bytes_of;
use crate::npz::archive::start_array;
use crate::vtp::Appended;

/// Columns of a CSV file.
const HEADER: &str = "x,y,z,density,vx,vy,vz,pressure,temperature,sxx,sxy,sxz,syx,syy,syz,szx,szy,szz,wall_x,wall_y,wall_z";

impl Fields {
    /// Writes the fields to a file: an image for ParaView and VTK (`.vti`), arrays for NumPy (`.npz`) or a table (`.csv`), by the
    /// extension of the path in upper or lower case.
    ///
    /// | array | shape in NumPy | unit |
    /// |---|---|---|
    /// | `density` | Z, Y, X | mass/units³ |
    /// | `velocity` | Z, Y, X, 3 | units/s |
    /// | `stress`, `contact_stress`, `kinetic_stress` | Z, Y, X, 3, 3 | mass/(units s²), positive in tension |
    /// | `pressure` | Z, Y, X | mass/(units s²) |
    /// | `temperature` | Z, Y, X | units²/s² |
    /// | `wall_force` | Z, Y, X, 3 | mass/(units² s²) |
    /// | `origin`, `spacing` (only `.npz`) | 3 and 1 | units |
    ///
    /// All are f8. A row of the table has the columns x, y, z, density, velocity, pressure, temperature, stress by rows (the
    /// normal of the face, then the direction of the force) and wall force.
    ///
    /// # Errors
    /// [`Error::Invalid`] for another extension, [`Error::File`] if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_ascii_lowercase();
        let write: fn(&Self, &mut AtomicFile) -> io::Result<()> = match extension.as_str() {
            "csv" => Self::table,
            "npz" => Self::arrays,
            "vti" => Self::image,
            _ => {
                let value = path.display().to_string();
                return Err(Error::Invalid { field: "fields", value, expected: "a file .vti, .npz or .csv" });
            }
        };
        let written = AtomicFile::create(path).and_then(|mut file| {
            write(self, &mut file)?;
            file.commit()
        });
        written.map_err(|source| Error::File { file: path.to_owned(), source })
    }

    fn table(&self, out: &mut AtomicFile) -> io::Result<()> {
        writeln!(out, "{HEADER}")?;
        for (index, (stress, pressure)) in self.stress().zip(self.pressure()).enumerate() {
            let numbers = [
                &self.grid.point(index).to_array()[..],
                &[self.density[index]],
                &self.velocity[index].to_array(),
                &[pressure, self.temperature[index]],
                &stress.to_cols_array(),
                &self.wall_force[index].to_array(),
            ];
            let numbers: Vec<String> = numbers.concat().iter().map(f64::to_string).collect();
            writeln!(out, "{}", numbers.join(","))?;
        }
        Ok(())
    }

    /// All fields by name, each with the lengths of an item and the numbers: 1 number, a vector (`[3]`) or a matrix (`[3, 3]`, the
    /// normal of the face, then the direction of the force) per point. Units are those of the table of [`Fields::save`].
    pub fn named(&self) -> [(&'static str, &'static [usize], Vec<f64>); 8] {
        let vectors = |all: &[DVec3]| all.iter().flat_map(DVec3::to_array).collect();
        let matrices = |all: &[DMat3]| all.iter().flat_map(DMat3::to_cols_array).collect();
        [
            ("density", &[], self.density.clone()),
            ("velocity", &[3], vectors(&self.velocity)),
            ("pressure", &[], self.pressure().collect()),
            ("temperature", &[], self.temperature.clone()),
            ("stress", &[3, 3], self.stress().flat_map(|stress| stress.to_cols_array()).collect()),
            ("contact_stress", &[3, 3], matrices(&self.contact_stress)),
            ("kinetic_stress", &[3, 3], matrices(&self.kinetic_stress)),
            ("wall_force", &[3], vectors(&self.wall_force)),
        ]
    }

    fn arrays(&self, out: &mut AtomicFile) -> io::Result<()> {
        let mut zip = ZipWriter::new_stream(out);
        let [x, y, z] = self.grid.counts;
        let mut array = |name: &str, shape: &[usize], numbers: Vec<f64>| {
            let shape: Vec<u64> = shape.iter().map(|length| *length as u64).collect();
            start_array(&mut zip, name, "<f8", &shape, 8 * numbers.len() as u64)?;
            zip.write_all(&bytes_of(numbers))
        };
        for (name, inner, numbers) in self.named() {
            array(name, &[&[z, y, x], inner].concat(), numbers)?;
        }
        array("origin", &[3], self.grid.origin.to_array().to_vec())?;
        array("spacing", &[1], vec![self.grid.spacing])?;
        zip.finish()?;
        Ok(())
    }

    fn image(&self, out: &mut AtomicFile) -> io::Result<()> {
        let mut file = Appended::default();
        file.open("PointData");
        for (name, inner, numbers) in self.named() {
            file.array("Float64", name, inner.iter().product::<usize>() as u32, bytes_of(numbers));
        }
        file.close("PointData");
        file.write_image(out, self.grid.origin.to_array(), self.grid.spacing, self.grid.counts)
    }
}
