//! The line `@servo`.

use super::Reader;
use super::line::{Line, SERVO};
use super::motion::{number, vector};
use crate::error::{nearest, quoted};
use crate::scene::{Motion, Servo};

const KEYS: [&str; 7] = ["force", "torque", "axis", "through", "speed", "displacement", "velocity"];

impl Reader<'_> {
    pub(super) fn servo(&mut self, line: &str, at: usize) -> Line<()> {
        let mut words = line.split_ascii_whitespace().skip(1);
        let name = words.next().filter(|name| !name.contains('='));
        if !line.contains('=') || name.is_none() {
            return self.not_understood(at, SERVO.wrong("NAME", format!("missing, or no value, expected {}", SERVO.form())));
        }
        let mut values: [Option<&str>; KEYS.len()] = [None; KEYS.len()];
        for word in words {
            let (place, value) = key_and_value(word)?;
            if values[place].replace(value).is_some() {
                return Err(SERVO.wrong(KEYS[place], "given twice in the line"));
            }
        }
        let servo = servo_of(values)?;
        let motion = Motion::servo(name.unwrap_or_default(), servo);
        self.scene.add_motion(motion).map(drop).map_err(|error| SERVO.refused(&error))
    }
}

fn key_and_value(word: &str) -> Line<(usize, &str)> {
    let Some((key, value)) = word.split_once('=') else {
        return Err(SERVO.wrong(&quoted(word), format!("expected KEY=VALUE with a key of {}", KEYS.join(", "))));
    };
    let known = KEYS.iter().position(|known| *known == key).map(|place| (place, value));
    known.ok_or_else(|| {
        let known = || format!("expected one of {}", KEYS.join(", "));
        let hint = nearest(key, &KEYS).map_or_else(known, |near| format!("did you mean {near}?"));
        SERVO.wrong(&quoted(key), format!("an unknown key, {hint}"))
    })
}

/// The servo with the values of the keys.
fn servo_of([force, torque, axis, through, speed, displacement, velocity]: [Option<&str>; KEYS.len()]) -> Line<Servo> {
    let missing = |key: &str| SERVO.wrong(key, format!("missing, expected `{}`", SERVO.form()));
    let speed = number(&SERVO, "speed", speed.ok_or_else(|| missing("speed"))?)?;
    let mut servo = match (force, torque) {
        (Some(force), None) => {
            for (key, value) in [("axis", axis), ("through", through)] {
                if value.is_some() {
                    return Err(SERVO.wrong(key, "given with force, expected it with torque only"));
                }
            }
            Servo::force(vector(&SERVO, "force", force)?, speed)
        }
        (None, Some(torque)) => {
            let axis = vector(&SERVO, "axis", axis.ok_or_else(|| missing("axis"))?)?;
            let through = vector(&SERVO, "through", through.ok_or_else(|| missing("through"))?)?;
            Servo::torque(number(&SERVO, "torque", torque)?, axis, through, speed)
        }
        (Some(_), Some(_)) => return Err(SERVO.wrong("torque", "given with force, expected one of them")),
        (None, None) => return Err(missing("force or torque")),
    };
    if let Some(value) = displacement {
        servo.displacement = number(&SERVO, "displacement", value)?;
    }
    if let Some(value) = velocity {
        servo.velocity = number(&SERVO, "velocity", value)?;
    }
    Ok(servo)
}

#[cfg(test)]
#[path = "servo_tests.rs"]
mod tests;
