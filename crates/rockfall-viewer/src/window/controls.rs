//! What keys do: the thesis's table (section 2.12.1), and what people expect besides.

use super::constants::CONSTANTS;

/// A key that was pressed, whatever the window system calls it.
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
    /// A letter (lower case) or sign.
    Char(char),
}

/// Keys that are held with another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Modifiers {
    /// Shift.
    pub shift: bool,
    /// Ctrl, on a Mac Command.
    pub ctrl: bool,
}

/// What a key press asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Show or hide the table of keys.
    Help,
    /// Start or stop.
    ToggleRunning,
    /// One step.
    SingleStep,
    /// Read `input.txt`.
    LoadInput,
    /// Read the file of the command line again.
    LoadGiven,
    /// Collisions on or off.
    ToggleCollisions,
    /// Real time, or a fixed step a frame.
    ToggleRealTime,
    /// Raise or lower one of [`CONSTANTS`].
    Nudge {
        /// Which one.
        constant: usize,
        /// Up or down.
        up: bool,
    },
    /// Throw a sphere.
    Throw,
    /// The scene as it was read.
    Reset,
    /// The camera as it was.
    ResetCamera,
    /// Less or more speed.
    ChangeSpeed {
        /// More.
        faster: bool,
    },
    /// Ask for a scene file to open.
    Open,
    /// Write the present state, to the file of the last time.
    Save,
    /// Ask for a file, and write the present state to it.
    SaveAs,
    /// Show or hide the panel.
    TogglePanel,
    /// End.
    Quit,
}

/// What a key asks for, with the keys that are held with it.
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

/// The table that F1 shows: keys, and what they do. Those of the constants follow from [`CONSTANTS`].
pub const TABLE: [(&str, &str); 21] = [
    ("F1", "this table"),
    ("arrows", "move the camera"),
    ("left drag", "turn the camera"),
    ("right drag", "raise and lower the camera"),
    ("middle drag", "turn the camera about what it looks at"),
    ("scroll", "nearer and farther"),
    ("A", "start and stop"),
    ("S", "one step"),
    ("R", "read input.txt, from the working directory, else from beside the program"),
    ("Shift+R", "read the file of the command line again"),
    ("K", "collisions on and off"),
    ("T", "real time, or a step a frame"),
    ("click", "what a body is, and its values"),
    ("Ctrl+drag", "pull a body"),
    ("space", "throw a sphere where the pointer is"),
    ("- +", "slower and faster"),
    ("Backspace  Home", "the scene, the camera as at the start"),
    ("Ctrl+O", "open a scene file; or drop one on the window"),
    ("Ctrl+S", "save the present state as a scene text; with Shift, asks for a file"),
    ("P", "hide and show this panel"),
    ("Esc", "quit"),
];

/// The rows of the table that change constants.
pub fn constant_rows() -> impl Iterator<Item = (String, String)> {
    let keys = |up: char, down: char| format!("{} {}", up.to_ascii_uppercase(), down.to_ascii_uppercase());
    CONSTANTS.iter().map(move |constant| (keys(constant.up, constant.down), format!("{} up and down", constant.label)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Modifiers = Modifiers { shift: false, ctrl: false };

    /// The table of the thesis, section 2.12.1, written out.
    #[test]
    fn the_thesis_keys_do_what_the_thesis_says() {
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
    fn no_two_keys_do_the_same_and_others_nothing() {
        let keys = ('a'..='z').chain("-+".chars()).map(Key::Char);
        let keys = keys.chain([Key::F1, Key::Escape, Key::Space, Key::Backspace, Key::Home]);
        let mut asked: Vec<Command> = Vec::new();
        for command in keys.filter_map(|key| command(key, NONE)) {
            assert!(!asked.contains(&command), "{command:?}");
            asked.push(command);
        }
        assert_eq!(asked.len(), 5 + 12 + 1 + 2 + 5);
        for letter in "eiloquwy1".chars() {
            assert_eq!(command(Key::Char(letter), NONE), None, "{letter}");
        }
    }

    #[test]
    fn with_shift_and_ctrl_keys_are_others() {
        let (shift, ctrl) = (Modifiers { shift: true, ctrl: false }, Modifiers { shift: false, ctrl: true });
        assert_eq!(command(Key::Char('r'), shift), Some(Command::LoadGiven));
        assert_eq!(command(Key::Char('s'), ctrl), Some(Command::Save));
        // Ctrl+A, Ctrl+Z and the like mean something else everywhere.
        for letter in "adkrtxz".chars() {
            assert_eq!(command(Key::Char(letter), ctrl), None, "{letter}");
        }
        // Caps lock or shift do not keep a letter from working.
        assert_eq!(command(Key::Char('d'), shift), command(Key::Char('d'), NONE));
    }
}
