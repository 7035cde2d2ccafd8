//! The table of the constants that keys and sliders change: the six of the thesis (section 2.12.1).

use std::ops::RangeInclusive;

use rockfall::Settings;
use rockfall::settings::Constant as Entry;

/// A constant of [`Settings`].
#[derive(Debug)]
pub struct Constant {
    /// Name in [`Settings::NAMES`].
    pub name: &'static str,
    /// Label of the slider.
    pub label: &'static str,
    /// The key that raises it.
    pub up: char,
    /// The key that lowers it.
    pub down: char,
    /// Change per key press.
    pub step: f32,
    /// Effect of the constant, shown as a tooltip.
    pub about: &'static str,
    field: fn(&mut Settings) -> &mut f32,
}

/// The six constants, in the order of the thesis.
pub const CONSTANTS: [Constant; 6] = [
    Constant {
        name: "activation_threshold",
        label: "contact threshold",
        up: 'd',
        down: 'c',
        step: 0.1,
        about: "Bodies that approach faster than this times the smaller radius collide. Slower ones only get contact forces.",
        field: |settings| &mut settings.activation_threshold,
    },
    Constant {
        name: "contact_damping",
        label: "contact damping",
        up: 'f',
        down: 'v',
        step: 0.5,
        about: "Damping of overlapping bodies.",
        field: |settings| &mut settings.contact_damping,
    },
    Constant {
        name: "contact_force",
        label: "contact force",
        up: 'g',
        down: 'b',
        step: 50.0,
        about: "Stiffness of contacts. Piles become unstable if it is too high for the time step.",
        field: |settings| &mut settings.contact_force,
    },
    Constant {
        name: "friction",
        label: "friction",
        up: 'h',
        down: 'n',
        step: 5.0,
        about: "Friction of contacts. It grows with the square root of the sliding velocity, so bodies creep on slopes.",
        field: |settings| &mut settings.friction,
    },
    Constant {
        name: "gravity",
        label: "gravity",
        up: 'j',
        down: 'm',
        step: 0.25,
        about: "Downward acceleration; negative values point upwards.",
        field: |settings| &mut settings.gravity,
    },
    Constant {
        name: "restitution",
        label: "restitution",
        up: 'z',
        down: 'x',
        step: 0.05,
        about: "Fraction of the approach velocity that a collision returns, from 0 to 1.",
        field: |settings| &mut settings.restitution,
    },
];

impl Constant {
    /// Returns the entry in the table of the settings.
    pub fn entry(&self) -> &'static Entry {
        Settings::TABLE.iter().find(|entry| entry.name == self.name).expect("every constant is a setting")
    }

    /// Returns the range of the slider and the keys.
    pub fn range(&self) -> RangeInclusive<f32> {
        let (low, high) = self.entry().slider.expect("every constant has a slider");
        low..=high
    }

    /// Returns the value.
    pub fn get(&self, settings: &Settings) -> f32 {
        let mut copy = *settings;
        *(self.field)(&mut copy)
    }

    /// Sets the value without a check; the simulation rejects invalid values.
    pub fn set(&self, settings: &mut Settings, value: f32) {
        *(self.field)(settings) = value;
    }

    /// Returns the default value.
    pub fn default_value(&self) -> f32 {
        self.get(&Settings::default())
    }

    /// Changes the value by one step, as a key press does. The range is enforced unless the scene's own value is outside it.
    pub fn nudge(&self, settings: &mut Settings, up: bool) {
        let value = self.get(settings);
        let moved = f64::from(value) + f64::from(if up { self.step } else { -self.step });
        // Rounded, because the errors of decimal steps would add up.
        let moved = ((moved * 1e4).round() / 1e4) as f32;
        let (low, high) = (value.min(*self.range().start()), value.max(*self.range().end()));
        self.set(settings, moved.clamp(low, high));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_constant_accesses_the_setting_of_its_name() {
        for constant in &CONSTANTS {
            let mut settings = Settings::default();
            settings.set(constant.name, "0.5").unwrap();
            assert_eq!(constant.get(&settings), 0.5, "{}", constant.name);
            assert_eq!(constant.default_value().to_string(), Settings::default().get(constant.name).unwrap());
            assert!(constant.range().contains(&constant.default_value()));
            settings.validate().unwrap();
        }
    }

    #[test]
    fn a_key_press_changes_one_constant_by_its_step() {
        for (index, constant) in CONSTANTS.iter().enumerate() {
            for (up, sign) in [(true, 1.0), (false, -1.0)] {
                let mut settings = Settings::default();
                constant.nudge(&mut settings, up);
                for (other, of) in CONSTANTS.iter().enumerate() {
                    let expected = of.default_value() + if other == index { sign * of.step } else { 0.0 };
                    assert!((of.get(&settings) - expected).abs() < 1e-6, "{}", of.name);
                }
            }
        }
    }

    #[test]
    fn key_presses_stay_within_the_range_or_the_value_of_the_scene() {
        let restitution = &CONSTANTS[5];
        let mut settings = Settings::default();
        (0..100).for_each(|_| restitution.nudge(&mut settings, true));
        assert_eq!(settings.restitution, 1.0);
        (0..100).for_each(|_| restitution.nudge(&mut settings, false));
        assert_eq!(settings.restitution, 0.0);
        settings.restitution = 1.3;
        restitution.nudge(&mut settings, true);
        assert_eq!(settings.restitution, 1.3);
        restitution.nudge(&mut settings, false);
        assert_eq!(settings.restitution, 1.25);
    }

    #[test]
    fn rounding_errors_do_not_add_up() {
        let mut settings = Settings::default();
        (0..7).for_each(|_| CONSTANTS[0].nudge(&mut settings, true));
        assert_eq!(settings.activation_threshold, 1.7);
    }
}
