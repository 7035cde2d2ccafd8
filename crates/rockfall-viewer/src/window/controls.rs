//! Keys and their commands: those of the thesis (section 2.12.1) and further common ones.

use super::constants::CONSTANTS;

/// A key, independent of the window system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// F1.
    F1,
    /// Escape.
    Escape,
    /// The space bar.
    Space,
    /// Backspace.
    Backspace,
    /// Home.
    Home,
    /// A letter (lower case) or symbol.
    Char(char),
}

/// Modifier keys that are down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Modifiers {
    /// Shift.
    pub shift: bool,
    /// Ctrl, or Command on a Mac.
    pub ctrl: bool,
}

/// A command to the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Show or hide the table of keys.
    Help,
    /// Start or stop the simulation.
    ToggleRunning,
    /// Stop and make one step.
    SingleStep,
    /// Load `input.txt`.
    LoadInput,
    /// Load the file of the command line again.
    LoadGiven,
    /// Turn collisions on or off.
    ToggleCollisions,
    /// Switch between real time and one step per frame.
    ToggleRealTime,
    /// Raise or lower one of [`CONSTANTS`].
    Nudge {
        /// Index of the constant.
        constant: usize,
        /// Whether to raise it.
        up: bool,
    },
    /// Throw a sphere.
    Throw,
    /// Restore the initial scene.
    Reset,
    /// Frame the scene.
    ResetCamera,
    /// Change the speed.
    ChangeSpeed {
        /// Whether to go faster.
        faster: bool,
    },
    /// Open the file dialog to load a scene.
    Open,
    /// Save the present state to the last file.
    Save,
    /// Open the file dialog to save the present state.
    SaveAs,
    /// Show or hide the panel.
    TogglePanel,
    /// Close the file dialog, or else the window.
    Quit,
}

/// Returns the command of a key with modifiers.
pub fn command(key: Key, held: Modifiers) -> Option<Command> {
    if held.ctrl {
        return match key {
            Key::Char('s') if held.shift => Some(Command::SaveAs),
            Key::Char('s') => Some(Command::Save),
            Key::Char('o') => Some(Command::Open),
            _ => None,
        };
    }
    Some(match key {
        Key::F1 => Command::Help,
        Key::Escape => Command::Quit,
        Key::Space => Command::Throw,
        Key::Backspace => Command::Reset,
        Key::Home => Command::ResetCamera,
        Key::Char('a') => Command::ToggleRunning,
        Key::Char('s') => Command::SingleStep,
        Key::Char('r') if held.shift => Command::LoadGiven,
        Key::Char('r') => Command::LoadInput,
        Key::Char('k') => Command::ToggleCollisions,
        Key::Char('t') => Command::ToggleRealTime,
        Key::Char('p') => Command::TogglePanel,
        Key::Char('-') => Command::ChangeSpeed { faster: false },
        Key::Char('+' | '=') => Command::ChangeSpeed { faster: true },
        Key::Char(letter) => {
            let (constant, at) = CONSTANTS.iter().enumerate().find(|(_, at)| letter == at.up || letter == at.down)?;
            Command::Nudge { constant, up: letter == at.up }
        }
    })
}

/// The table that F1 shows: keys and their effects. The rows of the constants follow from [`CONSTANTS`].
pub const TABLE: [(&str, &str); 21] = [
    ("F1", "this table"),
    ("arrows", "move the camera"),
    ("left drag", "turn the camera"),
    ("right drag", "raise and lower the camera"),
    ("middle drag", "turn the camera about its target"),
    ("scroll", "zoom in and out"),
    ("A", "start or stop"),
    ("S", "make one step"),
    ("R", "load input.txt from the working directory or the folder of the program"),
    ("Shift+R", "load the file of the command line again"),
    ("K", "turn collisions on or off"),
    ("T", "switch between real time and one step per frame"),
    ("click", "show the values of a body"),
    ("Ctrl+drag", "pull a body"),
    ("space", "throw a sphere towards the pointer"),
    ("- +", "slower and faster"),
    ("Backspace  Home", "reset the scene, reset the camera"),
    ("Ctrl+O", "open a scene file (or drop one on the window)"),
    ("Ctrl+S", "save the present state as a scene text; Shift+Ctrl+S asks for a file"),
    ("P", "show or hide the panel"),
    ("Esc", "quit"),
];

/// Returns the rows of the table for the keys that change constants.
pub fn constant_rows() -> impl Iterator<Item = (String, String)> {
    let keys = |up: char, down: char| format!("{} {}", up.to_ascii_uppercase(), down.to_ascii_uppercase());
    CONSTANTS.iter().map(move |constant| (keys(constant.up, constant.down), format!("{} up and down", constant.label)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Modifiers = Modifiers { shift: false, ctrl: false };

    /// The table of section 2.12.1 of the thesis.
    #[test]
    fn keys_of_the_thesis_have_the_commands_of_the_thesis() {
        let nudge = |name: &str, up| {
            let constant = CONSTANTS.iter().position(|constant| constant.name == name).unwrap();
            Command::Nudge { constant, up }
        };
        let letters = [
            ('a', Command::ToggleRunning),
            ('s', Command::SingleStep),
            ('r', Command::LoadInput),
            ('k', Command::ToggleCollisions),
            ('t', Command::ToggleRealTime),
            ('d', nudge("activation_threshold", true)),
            ('c', nudge("activation_threshold", false)),
            ('f', nudge("contact_damping", true)),
            ('v', nudge("contact_damping", false)),
            ('g', nudge("contact_force", true)),
            ('b', nudge("contact_force", false)),
            ('h', nudge("friction", true)),
            ('n', nudge("friction", false)),
            ('j', nudge("gravity", true)),
            ('m', nudge("gravity", false)),
            ('z', nudge("restitution", true)),
            ('x', nudge("restitution", false)),
        ];
        for (letter, expected) in letters {
            assert_eq!(command(Key::Char(letter), NONE), Some(expected), "{letter}");
        }
        assert_eq!(command(Key::F1, NONE), Some(Command::Help));
        assert_eq!(command(Key::Escape, NONE), Some(Command::Quit));
    }

    #[test]
    fn no_two_keys_have_the_same_command() {
        let keys = ('a'..='z').chain("-+".chars()).map(Key::Char);
        let keys = keys.chain([Key::F1, Key::Escape, Key::Space, Key::Backspace, Key::Home]);
        let mut commands: Vec<Command> = Vec::new();
        for command in keys.filter_map(|key| command(key, NONE)) {
            assert!(!commands.contains(&command), "{command:?}");
            commands.push(command);
        }
        assert_eq!(commands.len(), 5 + 12 + 1 + 2 + 5);
        for letter in "eiloquwy1".chars() {
            assert_eq!(command(Key::Char(letter), NONE), None, "{letter}");
        }
    }

    #[test]
    fn shift_and_ctrl_change_the_command() {
        let (shift, ctrl) = (Modifiers { shift: true, ctrl: false }, Modifiers { shift: false, ctrl: true });
        assert_eq!(command(Key::Char('r'), shift), Some(Command::LoadGiven));
        assert_eq!(command(Key::Char('s'), ctrl), Some(Command::Save));
        // Ctrl+A, Ctrl+Z and the like have other meanings in all programs.
        for letter in "adkrtxz".chars() {
            assert_eq!(command(Key::Char(letter), ctrl), None, "{letter}");
        }
        // Letters work with caps lock or shift as well.
        assert_eq!(command(Key::Char('d'), shift), command(Key::Char('d'), NONE));
    }
}
