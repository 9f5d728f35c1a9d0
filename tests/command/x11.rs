//! The part of the X protocol for keys and a mouse: the program under test receives them like those of a user.
//!
//! Numbers are those of the X protocol, version 11, and of its extension XTEST, version 2.2.

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;

const GET_WINDOW_ATTRIBUTES: u8 = 3;
/// Map state of a visible window in its reply.
const VIEWABLE: u8 = 2;
const QUERY_TREE: u8 = 15;
const WARP_POINTER: u8 = 41;
const SET_INPUT_FOCUS: u8 = 42;
const QUERY_EXTENSION: u8 = 98;
const GET_KEYBOARD_MAPPING: u8 = 101;
/// XTEST's request, and the events that it makes.
const FAKE_INPUT: u8 = 2;
const KEY_PRESS: u8 = 2;
const KEY_RELEASE: u8 = 3;
const BUTTON_PRESS: u8 = 4;
const BUTTON_RELEASE: u8 = 5;
const MOTION: u8 = 6;
/// The left button, and the wheel away from the user.
pub const LEFT: u8 = 1;
pub const WHEEL_UP: u8 = 4;
/// The keysym of Escape.
const ESCAPE: u32 = 0xff1b;

/// A connection to a display, for its keyboard and mouse.
pub struct Keyboard {
    stream: UnixStream,
    root: u32,
    first_keycode: u8,
    keycodes: u8,
    xtest: u8,
}

fn u16_at(bytes: &[u8], at: usize) -> usize {
    usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]))
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
}

impl Keyboard {
    /// Of a display of this machine, `:7`.
    pub fn of(display: &str) -> Self {
        let path = format!("/tmp/.X11-unix/X{}", display.trim_start_matches(':'));
        let mut stream = UnixStream::connect(path).expect("the display answers");
        // Little-endian, version 11.0, no authorization.
        stream
            .write_all(&[0x6c, 0, 11, 0, 0, 0, 0, 0, 0, 0, 0, 0])
            .expect("writes");
        let mut head = [0; 8];
        stream.read_exact(&mut head).expect("an answer");
        let mut setup = vec![0; 4 * u16_at(&head, 6)];
        stream.read_exact(&mut setup).expect("the setup");
        assert_eq!(head[0], 1, "{}", String::from_utf8_lossy(&setup));
        let vendor = u16_at(&setup, 16).next_multiple_of(4);
        let screen = 32 + vendor + 8 * usize::from(setup[21]);
        let mut keyboard = Self {
            root: u32_at(&setup, screen),
            first_keycode: setup[26],
            keycodes: setup[27] - setup[26] + 1,
            stream,
            xtest: 0,
        };
        let answer = keyboard.ask(QUERY_EXTENSION, 0, b"\x05\0\0\0XTEST\0\0\0");
        assert_eq!(answer[8], 1, "the display has XTEST");
        keyboard.xtest = answer[9];
        keyboard
    }

    /// Gives pointer and focus to the window that is seen on the display; whether there is one yet.
    pub fn focus_window(&mut self) -> bool {
        let root = self.root.to_le_bytes();
        let tree = self.ask(QUERY_TREE, 0, &root);
        let windows = (0..u16_at(&tree, 16)).map(|n| u32_at(&tree, 32 + 4 * n).to_le_bytes());
        let mut is_seen =
            |window: &[u8; 4]| self.ask(GET_WINDOW_ATTRIBUTES, 0, window)[26] == VIEWABLE;
        let Some(window) = windows.into_iter().find(|window| is_seen(window)) else {
            return false;
        };
        let mut to = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 20, 0, 20, 0];
        to[4..8].copy_from_slice(&window);
        self.send(WARP_POINTER, 0, &to);
        // Back to the root if the window goes; at the present time.
        let focus = [window, [0; 4]].concat();
        self.send(SET_INPUT_FOCUS, 1, &focus);
        true
    }

    /// Presses and releases the key of an unshifted character.
    pub fn press(&mut self, character: u8) {
        // Latin keysyms are their characters.
        self.press_keysym(u32::from(character));
    }

    /// Presses and releases Escape.
    pub fn escape(&mut self) {
        self.press_keysym(ESCAPE);
    }

    fn press_keysym(&mut self, keysym: u32) {
        let keycode = self.keycode(keysym);
        for event in [KEY_PRESS, KEY_RELEASE] {
            self.fake(event, keycode, (0, 0));
        }
    }

    /// Moves the pointer to a pixel of the display.
    pub fn point(&mut self, x: i16, y: i16) {
        self.fake(MOTION, 0, (x, y));
    }

    /// Presses a button of the mouse, or releases it.
    pub fn button(&mut self, button: u8, is_pressed: bool) {
        let event = if is_pressed {
            BUTTON_PRESS
        } else {
            BUTTON_RELEASE
        };
        self.fake(event, button, (0, 0));
    }

    fn fake(&mut self, event: u8, detail: u8, (x, y): (i16, i16)) {
        let mut input = [0; 32];
        (input[0], input[1]) = (event, detail);
        input[8..12].copy_from_slice(&self.root.to_le_bytes());
        input[20..22].copy_from_slice(&x.to_le_bytes());
        input[22..24].copy_from_slice(&y.to_le_bytes());
        self.send(self.xtest, FAKE_INPUT, &input);
    }

    fn keycode(&mut self, keysym: u32) -> u8 {
        let (first, count) = (self.first_keycode, self.keycodes);
        let answer = self.ask(GET_KEYBOARD_MAPPING, 0, &[first, count, 0, 0]);
        let per_keycode = usize::from(answer[1]);
        let unshifted = (0..usize::from(count)).map(|n| u32_at(&answer, 32 + 4 * n * per_keycode));
        let place = unshifted.enumerate().find(|(_, one)| *one == keysym);
        first + place.expect("a key of this keysym").0 as u8
    }

    fn send(&mut self, request: u8, detail: u8, body: &[u8]) {
        let words = (1 + body.len() / 4) as u16;
        let mut bytes = vec![request, detail];
        bytes.extend(words.to_le_bytes());
        bytes.extend(body);
        self.stream.write_all(&bytes).expect("the display listens");
    }

    /// Sends a request and reads its reply. An event that arrives before is skipped, an error ends the test.
    fn ask(&mut self, request: u8, detail: u8, body: &[u8]) -> Vec<u8> {
        self.send(request, detail, body);
        loop {
            let mut answer = vec![0; 32];
            self.stream.read_exact(&mut answer).expect("an answer");
            assert_ne!(
                answer[0], 0,
                "X error {} of request {}",
                answer[1], answer[10]
            );
            if answer[0] == 1 {
                let mut rest = vec![0; 4 * u32_at(&answer, 4) as usize];
                self.stream.read_exact(&mut rest).expect("the rest");
                answer.extend(rest);
                return answer;
            }
        }
    }
}
