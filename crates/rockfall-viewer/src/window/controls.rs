//! Keys and their commands: those of the thesis (section 2.12.1) and further common ones. [`Controls`] says what the mouse does.

use std::fmt;
use std::str::FromStr;

use super::constants::CONSTANTS;
use crate::camera::Direction;

/// What the mouse and the key F do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Controls {
    /// Those of most programs that show solid objects: left drag orbits, right drag pans, F frames the scene.
    #[default]
    Standard,
    /// Those of the thesis (section 2.12.1): left drag turns the camera, right drag changes its height, F raises the contact
    /// damping.
    Thesis,
}

impl Controls {
    /// All values.
    pub const ALL: [Self; 2] = [Self::Standard, Self::Thesis];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::Thesis => "thesis",
        }
    }
}

impl fmt::Display for Controls {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Controls {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|controls| controls.name() == text);
        found.ok_or_else(|| "expected standard or thesis".to_owned())
    }
}

/// A key, independent of the window system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// F1.
    F1,
    /// F12.
    F12,
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
    /// Alt.
    pub alt: bool,
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
    /// Go to the next recorded state before or after the present one.
    Rewind {
        /// Whether to go to a later state.
        forward: bool,
    },
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
    /// Undo the last edit.
    Undo,
    /// Repeat the edit that was undone last.
    Redo,
    /// Restore the initial scene.
    Reset,
    /// Restore the initial scene and start it.
    Restart,
    /// Show the whole scene from the initial direction.
    ResetCamera,
    /// Show the whole scene from the present direction.
    FrameAll,
    /// Start or end to follow the picked body, or the creatures of the scene.
    Follow,
    /// Show the whole scene from this direction.
    LookFrom(Direction),
    /// Change the speed.
    ChangeSpeed {
        /// Whether to go faster.
        faster: bool,
    },
    /// Open the file dialog to load a scene.
    Open,
    /// Save the present state to the file that this scene was saved to before. Without one, open the file dialog.
    Save,
    /// Open the file dialog to save the present state.
    SaveAs,
    /// Save the picture as a PNG file.
    Screenshot,
    /// Show or hide the panel.
    TogglePanel,
    /// Show or hide all messages.
    ToggleMessages,
    /// Close the topmost dialog or table, or else the window.
    Close,
    /// Close the window. With unsaved changes, ask first.
    Quit,
}

/// Returns the command of a key with modifiers.
pub fn command(key: Key, held: Modifiers, controls: Controls) -> Option<Command> {
    if held.ctrl {
        return match key {
            Key::Char('s') if held.shift => Some(Command::SaveAs),
            Key::Char('s') => Some(Command::Save),
            Key::Char('o') => Some(Command::Open),
            Key::Char('z') if held.shift => Some(Command::Redo),
            Key::Char('z') => Some(Command::Undo),
            Key::Char('y') => Some(Command::Redo),
            Key::Char('q') => Some(Command::Quit),
            _ => None,
        };
    }
    // F is a key of the thesis. With the standard controls it frames the scene, and the key of the thesis needs Shift.
    let frames = held.shift != (controls == Controls::Standard);
    Some(match key {
        Key::F1 => Command::Help,
        Key::F12 => Command::Screenshot,
        Key::Escape => Command::Close,
        Key::Space | Key::Char('a') => Command::ToggleRunning,
        Key::Backspace => Command::Reset,
        Key::Home => Command::ResetCamera,
        Key::Char('f') if frames => Command::FrameAll,
        Key::Char('s') => Command::SingleStep,
        Key::Char(',') => Command::Rewind { forward: false },
        Key::Char('.') => Command::Rewind { forward: true },
        Key::Char('r') if held.shift => Command::LoadGiven,
        Key::Char('r') => Command::LoadInput,
        Key::Char('k') => Command::ToggleCollisions,
        Key::Char('l') => Command::Throw,
        Key::Char('t') => Command::ToggleRealTime,
        Key::Char('p') => Command::TogglePanel,
        Key::Char('w') => Command::Follow,
        Key::Char('i') => Command::Restart,
        Key::Char(digit @ '1'..='4') => Command::LookFrom(Direction::NAMED[digit as usize - '1' as usize]),
        Key::Char('-') => Command::ChangeSpeed { faster: false },
        Key::Char('+' | '=') => Command::ChangeSpeed { faster: true },
        Key::Char(letter) => {
            let (constant, at) = CONSTANTS.iter().enumerate().find(|(_, at)| letter == at.up || letter == at.down)?;
            Command::Nudge { constant, up: letter == at.up }
        }
    })
}

/// Actions of the mouse, for the table that F1 shows.
pub fn mouse_rows(controls: Controls) -> impl Iterator<Item = (&'static str, &'static str)> {
    let drags: &[_] = match controls {
        Controls::Standard => &[
            ("left drag", "orbit around the scene"),
            ("right or middle drag", "move the picture (or Alt, Shift + left drag)"),
            ("Alt + right drag", "zoom"),
        ],
        Controls::Thesis => &[
            ("left drag", "turn the camera"),
            ("right drag", "raise and lower the camera"),
            ("middle drag", "orbit around the scene"),
        ],
    };
    let others = [
        ("wheel, two fingers, pinch", "zoom to the pointer"),
        ("Alt + wheel, two fingers", "move the picture"),
        ("click", "show a body and its values"),
        ("double click", "move the camera to a body"),
        ("Ctrl + left drag", "pull a body"),
        ("arrows", "move the camera"),
    ];
    drags.iter().copied().chain(others)
}

/// Keys and their effects, for the table that F1 shows.
pub fn key_rows(controls: Controls) -> impl Iterator<Item = (String, String)> {
    let own = |text: &str| text.to_owned();
    let row = move |(keys, what): (&str, &str)| (own(keys), own(what));
    let frame = if controls == Controls::Standard { "F" } else { "Shift+F" };
    let constants = CONSTANTS.iter().map(move |constant| {
        let name = |key: char| match key {
            'f' if controls == Controls::Standard => own("Shift+F"),
            key => key.to_ascii_uppercase().to_string(),
        };
        (format!("{} {}", name(constant.up), name(constant.down)), format!("{} up and down", constant.label))
    });
    KEYS.into_iter().chain([(frame, "show the whole scene")]).map(row).chain(constants)
}

const KEYS: [(&str, &str); 21] = [
    ("space, A", "start and stop"),
    ("S", "make one step"),
    (", .", "back and forward in the last seconds"),
    ("- +", "slower and faster"),
    ("T", "real time, or one step per frame"),
    ("Backspace", "reset the scene"),
    ("I", "start again from the initial scene"),
    ("L", "throw a sphere towards the pointer"),
    ("Ctrl+Z, Ctrl+Y", "undo and redo edits"),
    ("K", "turn collisions on or off"),
    ("R", "load input.txt"),
    ("Shift+R", "load the file of the command line again"),
    ("Ctrl+O", "open a scene file (or drop one here)"),
    ("Ctrl+S, Ctrl+Shift+S", "save the present state, save as"),
    ("F12", "save the picture"),
    ("P", "show or hide the panel"),
    ("W", "follow the picked body, or creatures; again: stop"),
    ("F1", "this table"),
    ("Esc, Ctrl+Q", "close what is open or else quit, quit; unsaved changes are asked about"),
    ("1 2 3 4", "look from the front, the side, the top, along the diagonal"),
    ("Home", "reset the camera"),
];

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Modifiers = Modifiers { shift: false, ctrl: false, alt: false };
    const SHIFT: Modifiers = Modifiers { shift: true, ..NONE };
    const CTRL: Modifiers = Modifiers { ctrl: true, ..NONE };

    fn nudge(name: &str, up: bool) -> Command {
        let constant = CONSTANTS.iter().position(|constant| constant.name == name).unwrap();
        Command::Nudge { constant, up }
    }

    /// The table of section 2.12.1 of the thesis.
    #[test]
    fn keys_of_the_thesis_have_the_commands_of_the_thesis() {
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
            assert_eq!(command(Key::Char(letter), NONE, Controls::Thesis), Some(expected), "{letter}");
            if letter != 'f' {
                assert_eq!(command(Key::Char(letter), NONE, Controls::Standard), Some(expected), "{letter}");
            }
        }
        for controls in Controls::ALL {
            assert_eq!(command(Key::F1, NONE, controls), Some(Command::Help));
            assert_eq!(command(Key::Escape, NONE, controls), Some(Command::Close));
        }
    }

    #[test]
    fn f_frames_the_scene_and_needs_shift_where_it_is_a_key_of_the_thesis() {
        let [frame, damping] = [Command::FrameAll, nudge("contact_damping", true)];
        for (controls, held, expected) in [
            (Controls::Standard, NONE, frame),
            (Controls::Standard, SHIFT, damping),
            (Controls::Thesis, NONE, damping),
            (Controls::Thesis, SHIFT, frame),
        ] {
            assert_eq!(command(Key::Char('f'), held, controls), Some(expected), "{controls} {held:?}");
        }
    }

    /// Space and A both start and stop.
    #[test]
    fn no_two_other_keys_have_the_same_command() {
        let keys = ('a'..='z').chain("-+,.1234".chars()).map(Key::Char);
        let keys = keys.chain([Key::F1, Key::F12, Key::Escape, Key::Backspace, Key::Home]);
        let mut commands: Vec<Command> = Vec::new();
        for command in keys.filter_map(|key| command(key, NONE, Controls::Thesis)) {
            assert!(!commands.contains(&command), "{command:?}");
            commands.push(command);
        }
        assert_eq!(commands.len(), 5 + 12 + 2 + 4 + 5 + 6);
        assert_eq!(command(Key::Space, NONE, Controls::Standard), Some(Command::ToggleRunning));
        for letter in "eoquy5".chars() {
            assert_eq!(command(Key::Char(letter), NONE, Controls::Standard), None, "{letter}");
        }
    }

    #[test]
    fn shift_and_ctrl_change_the_command() {
        let standard = |key: char, held| command(Key::Char(key), held, Controls::Standard);
        assert_eq!(standard('r', SHIFT), Some(Command::LoadGiven));
        assert_eq!(standard('s', CTRL), Some(Command::Save));
        assert_eq!(standard('z', CTRL), Some(Command::Undo));
        assert_eq!(standard('z', Modifiers { shift: true, ..CTRL }), Some(Command::Redo));
        // Ctrl+A, Ctrl+X and the like have other meanings in all programs.
        for letter in "adfklrtx".chars() {
            assert_eq!(standard(letter, CTRL), None, "{letter}");
        }
        // Letters work with caps lock or shift as well.
        assert_eq!(standard('d', SHIFT), standard('d', NONE));
    }

    #[test]
    fn controls_are_read_by_their_names() {
        for controls in Controls::ALL {
            assert_eq!(controls.to_string().parse(), Ok(controls));
        }
        assert_eq!("mouse".parse::<Controls>(), Err("expected standard or thesis".to_owned()));
    }

    /// Every key with a command is in the table, whichever controls are chosen.
    #[test]
    fn the_table_names_every_key() {
        for controls in Controls::ALL {
            let table: String = key_rows(controls).map(|(keys, _)| format!(" {} ", keys.replace(',', " , "))).collect();
            for key in ('a'..='z').chain("-+,.1234".chars()).filter(|key| command(Key::Char(*key), NONE, controls).is_some()) {
                let name = format!(" {} ", key.to_ascii_uppercase());
                assert!(table.contains(&name), "{controls}: {key} is missing in {table}");
            }
        }
    }
}
