//! The fields of the lines of a scene text, and a parser for them.

use crate::error::{Error, Result, quoted, shown};

/// An error in a line.
pub(super) struct Wrong {
    pub(super) field: String,
    pub(super) message: String,
}

pub(super) type Line<T> = Result<T, Wrong>;

/// The fields of one kind of line: references first, then numbers. The last number may be optional.
pub(super) struct Kind {
    pub(super) word: &'static str,
    pub(super) references: &'static [&'static str],
    numbers: &'static [&'static str],
    last_is_optional: bool,
}

pub(super) const SPHERE: Kind = Kind {
    word: "S",
    references: &["reference"],
    numbers: &["x", "y", "z", "vx", "vy", "vz", "lx", "ly", "lz", "mass", "radius", "fixed"],
    last_is_optional: true,
};
pub(super) const ROD: Kind =
    Kind { word: "R", references: &["end1", "end2"], numbers: &["radius", "length"], last_is_optional: true };
pub(super) const CAPSULE: Kind = Kind {
    word: "C",
    references: &[],
    numbers: &["x1", "y1", "z1", "x2", "y2", "z2", "vx", "vy", "vz", "mass", "radius"],
    last_is_optional: false,
};
pub(super) const POLYGON: Kind = Kind {
    word: "P",
    references: &[],
    numbers: &["x", "y", "z", "left x", "left y", "left z", "right x", "right y", "right z"],
    last_is_optional: false,
};
pub(super) const TRIANGLE: Kind = Kind { word: "@triangle", ..POLYGON };
pub(super) const SPRING: Kind =
    Kind { word: "K", references: &["a", "b"], numbers: &["stiffness", "length", "damping"], last_is_optional: false };
pub(super) const MUSCLE: Kind =
    Kind { word: "@muscle", references: &[], numbers: &["amplitude", "frequency", "phase"], last_is_optional: false };
pub(super) const BOX: Kind = Kind {
    word: "B",
    references: &[],
    numbers: &["x", "y", "z", "i x", "i y", "i z", "j x", "j y", "j z", "k x", "k y", "k z"],
    last_is_optional: false,
};
pub(super) const TETHER: Kind = Kind {
    word: "T",
    references: &["sphere"],
    numbers: &["x", "y", "z", "stiffness", "length", "damping"],
    last_is_optional: false,
};
pub(super) const GROUP: Kind = Kind { word: "@group", references: &["number"], numbers: &[], last_is_optional: false };
pub(super) const ORIENTATION: Kind =
    Kind { word: "@orientation", references: &["sphere"], numbers: &["w", "x", "y", "z"], last_is_optional: false };
pub(super) const FORCE: Kind =
    Kind { word: "@force", references: &["sphere"], numbers: &["x", "y", "z"], last_is_optional: false };
pub(super) const MATERIAL: Kind =
    Kind { word: "@material", references: &["NAME"], numbers: &["density=D", "young=E", "poisson=N"], last_is_optional: false };
pub(super) const PAIR: Kind = Kind {
    word: "@pair",
    references: &["NAME", "NAME"],
    numbers: &[
        "restitution=e",
        "friction=mu",
        "stiffness=k",
        "characteristic_velocity=V",
        "rolling_friction=mu",
        "rolling_model=c",
        "rolling_damping=eta",
        "twisting_friction=mu",
        "surface_energy=gamma",
        "cohesion=jkr",
    ],
    last_is_optional: false,
};
pub(super) const USE: Kind = Kind { word: "@use", references: &["NAME"], numbers: &[], last_is_optional: false };
pub(super) const NAME: Kind = Kind { word: "@name", references: &["NAME"], numbers: &[], last_is_optional: false };
pub(super) const COLOUR: Kind = Kind { word: "@colour", references: &["COLOUR"], numbers: &[], last_is_optional: false };
pub(super) const LOOK: Kind = Kind { word: "@look", references: &["LOOK"], numbers: &[], last_is_optional: false };
pub(super) const LABEL: Kind = Kind { word: "@label", references: &["TEXT"], numbers: &[], last_is_optional: false };
pub(super) const RUN: Kind = Kind {
    word: "@run",
    references: &[],
    numbers: &["dt=S", "integrator=NAME", "steps=N", "every=K", "substeps=N", "speed=X"],
    last_is_optional: false,
};
pub(super) const MOTION: Kind = Kind {
    word: "@motion",
    references: &["NAME"],
    numbers: &[
        "velocity=x,y,z",
        "spin=w",
        "axis=x,y,z",
        "through=x,y,z",
        "amplitude=x,y,z",
        "frequency=F",
        "phase=P",
        "from=S",
        "to=S",
    ],
    last_is_optional: false,
};
pub(super) const SERVO: Kind = Kind {
    word: "@servo",
    references: &["NAME"],
    numbers: &["force=x,y,z|torque=T", "axis=x,y,z", "through=x,y,z", "speed=V", "displacement=D", "velocity=v"],
    last_is_optional: false,
};
pub(super) const MESH: Kind = Kind {
    word: "@mesh",
    references: &["FILE"],
    numbers: &["scale=s", "at=x,y,z", "axis=x,y,z", "turn=degrees", "name=N"],
    last_is_optional: false,
};
pub(super) const HULL: Kind = Kind {
    word: "@hull",
    references: &["x,y,z", "x,y,z", "...|FILE"],
    numbers: &["scale=s", "at=x,y,z", "axis=x,y,z", "turn=degrees"],
    last_is_optional: false,
};
pub(super) const PLANE: Kind =
    Kind { word: "@plane", references: &[], numbers: &["at=x,y,z", "normal=x,y,z", "name=N"], last_is_optional: true };
pub(super) const CYLINDER: Kind = Kind {
    word: "@cylinder",
    references: &[],
    numbers: &["at=x,y,z", "axis=x,y,z", "radius=r", "length=l", "inside=yes|no", "name=N"],
    last_is_optional: true,
};
pub(super) const CONE: Kind = Kind {
    word: "@cone",
    numbers: &["at=x,y,z", "axis=x,y,z", "radius=a..b", "length=l", "inside=yes|no", "name=N"],
    ..CYLINDER
};
pub(super) const BALL: Kind = Kind {
    word: "@ball",
    references: &[],
    numbers: &["at=x,y,z", "radius=r", "inside=yes|no", "name=N"],
    last_is_optional: true,
};
pub(super) const MOVE: Kind = Kind { word: "@move", references: &["NAME"], numbers: &[], last_is_optional: false };
pub(super) const SURFACE: Kind =
    Kind { word: "@surface", references: &[], numbers: &["velocity=x,y,z"], last_is_optional: false };
pub(super) const PERIODIC: Kind = Kind {
    word: "@periodic",
    references: &["AXIS"],
    numbers: &["FROM", "TO", "shear=RATE,DIRECTION,DISPLACEMENT"],
    last_is_optional: true,
};
pub(super) const GAUGE: Kind =
    Kind { word: "@gauge", references: &[], numbers: &["name=N", "wall=NAME|plane=x,y,z,nx,ny,nz"], last_is_optional: false };
pub(super) const GRAIN: Kind = Kind {
    word: "@grain",
    references: &["NAME"],
    numbers: &["radius=r|a..b|lognormal:median,sigma", "by=number|mass", "mass=M|density=D"],
    last_is_optional: true,
};
pub(super) const INLET: Kind = Kind {
    word: "@inlet",
    references: &[],
    numbers: &[
        "name=N",
        "box=x0,y0,z0,x1,y1,z1",
        "rate=PER_S|mass_rate=M|volume_rate=V",
        "radius=r|a..b|lognormal:median,sigma|shape=NAME|mix=NAME:SHARE,...",
        "by=number|mass",
        "mass=M|density=D",
        "velocity=x,y,z",
        "from=S",
        "to=S",
        "limit=COUNT",
        "seed=N",
        "every=STEPS",
        "after=COUNT",
    ],
    last_is_optional: false,
};
pub(super) const OUTLET: Kind = Kind {
    word: "@outlet",
    references: &[],
    numbers: &["name=N", "box=x0,y0,z0,x1,y1,z1", "every=STEPS"],
    last_is_optional: false,
};
pub(super) const SENSOR: Kind =
    Kind { word: "@sensor", references: &[], numbers: &["name=N", "box=x0,y0,z0,x1,y1,z1"], last_is_optional: false };
pub(super) const BODY: Kind = Kind {
    word: "@body",
    references: &["NAME"],
    numbers: &["mass=M|density=D", "centre=x,y,z", "inertia=xx,yy,zz,xy,xz,yz"],
    last_is_optional: false,
};
pub(super) const PLACE: Kind = Kind {
    word: "@place",
    references: &["NAME"],
    numbers: &[
        "at=x,y,z|centre=x,y,z",
        "axis=x,y,z",
        "turn=degrees|orientation=w,x,y,z",
        "velocity=x,y,z",
        "spin=x,y,z|momentum=x,y,z",
        "force=x,y,z",
        "torque=x,y,z",
        "name=N",
        "first=REFERENCE",
        "fixed=0|1",
    ],
    last_is_optional: false,
};
pub(super) const JOINT: Kind = Kind {
    word: "@joint",
    references: &["ball|hinge|slider|fixed|distance", "A", "B"],
    numbers: &[
        "at=x,y,z",
        "to=x,y,z",
        "axis=x,y,z",
        "limits=a..b",
        "cone=a",
        "twist=a..b",
        "speed=v",
        "force=F|torque=T",
        "target=p",
        "stiffness=k",
        "damping=c",
        "effort=F",
        "drag=c",
        "armature=J",
        "friction=f",
        "break_force=F",
        "break_torque=T",
        "collide=yes",
        "name=N",
    ],
    last_is_optional: false,
};
pub(super) const REPEAT: Kind =
    Kind { word: "@repeat", references: &["N"], numbers: &["dx", "dy", "dz"], last_is_optional: false };
pub(super) const MARK: Kind = Kind { word: "@capsule", references: &["end1", "end2"], numbers: &[], last_is_optional: false };

impl Kind {
    pub(super) fn wrong(&self, field: &str, message: impl Into<String>) -> Wrong {
        Wrong { field: format!("{} {field}", self.word), message: message.into() }
    }

    /// Translates the library's error about an object into the terms of the line: `sphere.mass` becomes `S mass`.
    pub(super) fn refused(&self, error: &Error) -> Wrong {
        match error {
            Error::Invalid { field, value, expected } => {
                let names: Vec<&str> =
                    field.split(' ').map(|word| word.split_once('.').map_or(word, |(_, name)| name)).collect();
                let value = shown(value.trim_end_matches(".0"));
                self.wrong(&names.join(" "), format!("{value} is not allowed, expected {expected}"))
            }
            other => Wrong { field: self.word.to_owned(), message: other.to_string() },
        }
    }

    /// The line with the names of its fields, such as `R end1 end2 radius [length]`.
    pub(super) fn form(&self) -> String {
        let names = self.references.iter().chain(self.numbers).map(|name| name.replace(' ', "_"));
        let mut words: Vec<String> = std::iter::once(self.word.to_owned()).chain(names).collect();
        if let Some(last) = words.last_mut().filter(|_| self.last_is_optional) {
            *last = format!("[{last}]");
        }
        words.join(" ")
    }

    /// The keys of a line of words KEY=VALUE.
    pub(super) fn keys(&self) -> Vec<&'static str> {
        self.numbers.iter().filter_map(|number| number.split_once('=')).map(|(key, _)| key).collect()
    }

    /// The expected number of words after the first one, for a message.
    fn length(&self) -> String {
        let most = self.references.len() + self.numbers.len();
        let plural = if most == 1 { "" } else { "s" };
        if self.last_is_optional { format!("{} or {most} numbers", most - 1) } else { format!("{most} number{plural}") }
    }

    /// Parses the references and numbers of a line. A missing optional number is 0.
    pub(super) fn read<const R: usize, const N: usize>(&self, line: &str) -> Line<([u32; R], [f32; N])> {
        debug_assert!(R == self.references.len() && N == self.numbers.len());
        let mut words = line.split_ascii_whitespace().skip(1);
        let missing = |name: &str| {
            let found = line.split_ascii_whitespace().count() - 1;
            let message = format!("missing, expected {} after {}, found {found}", self.length(), self.word);
            self.wrong(name, message)
        };
        let mut references = [0; R];
        for (reference, name) in references.iter_mut().zip(self.references) {
            let word = words.next().ok_or_else(|| missing(name))?;
            let not_whole = |_| self.wrong(name, format!("{} is not a whole number from 0 to {}", quoted(word), u32::MAX));
            *reference = word.parse().map_err(not_whole)?;
        }
        let mut numbers = [0.0; N];
        for (index, (number, name)) in numbers.iter_mut().zip(self.numbers).enumerate() {
            let Some(word) = words.next() else {
                if self.last_is_optional && index == N - 1 {
                    break;
                }
                return Err(missing(name));
            };
            *number = self.number(name, word)?;
        }
        match words.next() {
            None => Ok((references, numbers)),
            Some(word) => {
                let message = format!("one too many, expected {} after {}", self.length(), self.word);
                Err(self.wrong(&quoted(word), message))
            }
        }
    }

    fn number(&self, name: &str, word: &str) -> Line<f32> {
        match word.parse::<f32>() {
            Ok(number) if number.is_finite() => Ok(number),
            // Stands for the mass that follows from the density of the material.
            Err(_) if name == "mass" && word == "-" => Ok(f32::NAN),
            Ok(_) => Err(self.wrong(name, format!("{} is not finite (in f32), expected a finite number", quoted(word)))),
            Err(_) if name == "fixed" => {
                let use_one = "expected 1 for a fixed sphere, 0 or nothing for one that moves";
                Err(self.wrong(name, format!("{} is not a number, {use_one}", quoted(word))))
            }
            Err(_) => Err(self.wrong(name, format!("{} is not a number, expected a finite number", quoted(word)))),
        }
    }
}
