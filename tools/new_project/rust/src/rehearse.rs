//! Rehearse's interface for controllers: the functions of <rehearse/controller.h>, version 1.
//!
//! A controller implements the trait `Controller`, and its crate ends with `rehearse::controller!(Type)`. A function that
//! returns `Err(sentence)`, or panics, fails; the recording then has the sentence and the tick.
#![allow(dead_code)] // no controller needs all of it

use std::ffi::{c_void, CStr, CString};
use std::os::raw::{c_char, c_int};

pub const Q: c_int = 1; // displacement of a joint, or its target [rad or m]
pub const DQ: c_int = 2; // its velocity, or its target [rad/s or m/s]
pub const DDQ: c_int = 4; // its acceleration [rad/s² or m/s²]; not a command
pub const U: c_int = 8; // its torque or force [N·m or N]
pub const POSE: c_int = 16; // of a link: x y z [m], quaternion x y z w
pub const TWIST: c_int = 32; // velocity [m/s], angular velocity [rad/s]
pub const ACCELERATION: c_int = 64; // likewise [m/s²], [rad/s²]; not a command
pub const WRENCH: c_int = 128; // force [N], torque about the world's origin [N·m]; a command only

pub type Outcome = Result<(), String>;

pub trait Controller {
    fn new() -> Self;
    /// Names what is read and commanded.
    fn initialize(&mut self, io: Io) -> Outcome;
    /// After `initialize` of every controller.
    fn start(&mut self) -> Outcome {
        Ok(())
    }
    /// Once a step.
    fn control(&mut self) -> Outcome;
    /// After the last step.
    fn stop(&mut self) {}
}

/// The controller's view of its robot; to be used until the controller is dropped.
#[derive(Clone, Copy)]
pub struct Io(*mut c_void);

impl Io {
    /// [s]
    pub fn time_step(&self) -> f64 {
        unsafe { rehearse_time_step(self.0) }
    }
    /// Since the start of the run [s].
    pub fn time(&self) -> f64 {
        unsafe { rehearse_time(self.0) }
    }
    /// The controller's name in the scenario.
    pub fn name(&self) -> String {
        text(unsafe { rehearse_name(self.0) })
    }
    /// The options of the run and of the controller.
    pub fn options(&self) -> String {
        text(unsafe { rehearse_options(self.0) })
    }
    /// In `initialize` only: a command acts in the step of its `control`.
    pub fn set_no_delay(&self, on: bool) -> Outcome {
        self.outcome(unsafe { rehearse_set_no_delay(self.0, on as c_int) })
    }
    /// Text for people; it is recorded.
    pub fn print(&self, message: &str) {
        unsafe { rehearse_print(self.0, c_text(message).as_ptr()) }
    }
    pub fn joint(&self, name: &str) -> Result<Link, String> {
        self.link_of(unsafe { rehearse_joint(self.0, c_text(name).as_ptr()) })
    }
    /// All joints, by their ids.
    pub fn joints(&self) -> Result<Vec<Link>, String> {
        let count = unsafe { rehearse_joint_count(self.0) };
        (0..count).map(|id| self.link_of(unsafe { rehearse_joint_of_id(self.0, id) })).collect()
    }
    pub fn link(&self, name: &str) -> Result<Link, String> {
        self.link_of(unsafe { rehearse_link(self.0, c_text(name).as_ptr()) })
    }
    /// Link 0, to which all others are connected.
    pub fn root(&self) -> Link {
        Link { io: *self, handle: 0 }
    }
    pub fn device(&self, name: &str) -> Result<Device, String> {
        let handle = unsafe { rehearse_device(self.0, c_text(name).as_ptr()) };
        self.outcome(handle).map(|()| Device { io: *self, handle })
    }

    fn link_of(&self, handle: c_int) -> Result<Link, String> {
        self.outcome(handle).map(|()| Link { io: *self, handle })
    }
    fn outcome(&self, code: c_int) -> Outcome {
        if code >= 0 {
            Ok(())
        } else {
            Err(text(unsafe { rehearse_error(self.0) }))
        }
    }
}

/// A link, and the joint that moves it.
#[derive(Clone, Copy)]
pub struct Link {
    io: Io,
    handle: c_int,
}

impl Link {
    pub fn joint_name(&self) -> String {
        text(unsafe { rehearse_joint_name(self.io.0, self.handle) })
    }
    pub fn name(&self) -> String {
        text(unsafe { rehearse_link_name(self.io.0, self.handle) })
    }
    /// In `initialize`: these quantities are refreshed before each `control`.
    pub fn read(&self, quantities: c_int) -> Outcome {
        self.io.outcome(unsafe { rehearse_read(self.io.0, self.handle, quantities) })
    }
    /// In `initialize`: these quantities are sent after each `control`.
    pub fn command(&self, quantities: c_int) -> Outcome {
        self.io.outcome(unsafe { rehearse_command(self.io.0, self.handle, quantities) })
    }
    /// A number of the joint: `Q`, `DQ`, `DDQ` or `U`; NaN if there is none.
    pub fn get(&self, quantity: c_int) -> f64 {
        unsafe { rehearse_get(self.io.0, self.handle, quantity) }
    }
    /// A command of the joint: `Q`, `DQ` or `U`.
    pub fn set(&self, quantity: c_int, value: f64) -> Outcome {
        self.io.outcome(unsafe { rehearse_set(self.io.0, self.handle, quantity, value) })
    }
    pub fn pose(&self) -> Result<[f64; 7], String> {
        self.numbers(POSE)
    }
    pub fn twist(&self) -> Result<[f64; 6], String> {
        self.numbers(TWIST)
    }
    pub fn acceleration(&self) -> Result<[f64; 6], String> {
        self.numbers(ACCELERATION)
    }
    /// `POSE` has 7 numbers, `TWIST` and `WRENCH` have 6.
    pub fn set_numbers(&self, quantity: c_int, numbers: &[f64]) -> Outcome {
        let size = numbers.len() as c_int;
        self.io.outcome(unsafe { rehearse_set_numbers(self.io.0, self.handle, quantity, numbers.as_ptr(), size) })
    }
    /// The lower and the upper limit of `Q`, `DQ` or `U`; infinite where the model states none.
    pub fn limits(&self, quantity: c_int) -> Result<(f64, f64), String> {
        let (mut low, mut high) = (0.0, 0.0);
        let code = unsafe { rehearse_limits(self.io.0, self.handle, quantity, &mut low, &mut high) };
        self.io.outcome(code).map(|()| (low, high))
    }

    fn numbers<const N: usize>(&self, quantity: c_int) -> Result<[f64; N], String> {
        let mut numbers = [0.0; N];
        let code =
            unsafe { rehearse_get_numbers(self.io.0, self.handle, quantity, numbers.as_mut_ptr(), N as c_int) };
        self.io.outcome(code).map(|()| numbers)
    }
}

/// A sensor, a camera or a light.
#[derive(Clone, Copy)]
pub struct Device {
    io: Io,
    handle: c_int,
}

impl Device {
    /// In `initialize`: the device is refreshed before a `control` whenever it has measured.
    pub fn read(&self) -> Outcome {
        self.io.outcome(unsafe { rehearse_read_device(self.io.0, self.handle) })
    }
    /// Copies its numbers, as many as there is place for, and returns their count.
    pub fn numbers(&self, numbers: &mut [f64]) -> Result<usize, String> {
        let size = numbers.len() as c_int;
        let count = unsafe { rehearse_device_numbers(self.io.0, self.handle, numbers.as_mut_ptr(), size) };
        self.io.outcome(count).map(|()| count as usize)
    }
    /// Changes the settings of a device, and sends them.
    pub fn set_numbers(&self, numbers: &[f64]) -> Outcome {
        let size = numbers.len() as c_int;
        self.io.outcome(unsafe { rehearse_set_device_numbers(self.io.0, self.handle, numbers.as_ptr(), size) })
    }
    /// The last image of a camera, copied, and its rows, columns and bytes of a pixel.
    pub fn image(&self) -> Option<(Vec<u8>, [usize; 3])> {
        let mut shape = [0; 3];
        let pixels = unsafe { rehearse_image(self.io.0, self.handle, shape.as_mut_ptr()) };
        copied(pixels, shape)
    }
    /// The last points of a range camera, copied [m], and their rows, columns and 3.
    pub fn points(&self) -> Option<(Vec<f32>, [usize; 3])> {
        let mut shape = [0; 3];
        let points = unsafe { rehearse_points(self.io.0, self.handle, shape.as_mut_ptr()) };
        copied(points, shape)
    }
}

/// Records a number of the controller's own; the last one of a tick counts.
pub fn variable(name: &str, value: f64) {
    unsafe { rehearse_record_variable(c_text(name).as_ptr(), value) }
}

/// Exports the controller's functions. Write it once in a crate.
#[macro_export]
macro_rules! controller {
    ($type:ty) => {
        #[no_mangle]
        pub static rehearse_controller: $crate::rehearse::Functions = $crate::rehearse::Functions::of::<$type>();
    };
}
pub use crate::controller;

#[repr(C)]
pub struct Functions {
    abi: u32,
    create: extern "C" fn() -> *mut c_void,
    initialize: extern "C" fn(*mut c_void, *mut c_void) -> c_int,
    start: extern "C" fn(*mut c_void) -> c_int,
    control: extern "C" fn(*mut c_void) -> c_int,
    stop: extern "C" fn(*mut c_void),
    destroy: extern "C" fn(*mut c_void),
}

impl Functions {
    pub const fn of<T: Controller>() -> Functions {
        Functions {
            abi: 1,
            create: create::<T>,
            initialize: initialize::<T>,
            start: start::<T>,
            control: control::<T>,
            stop: stop::<T>,
            destroy: destroy::<T>,
        }
    }
}

struct State<T> {
    controller: T,
    io: Io,
}

extern "C" fn create<T: Controller>() -> *mut c_void {
    std::panic::set_hook(Box::new(|panic| PANIC.with(|kept| *kept.borrow_mut() = panic.to_string())));
    let state = State { controller: T::new(), io: Io(std::ptr::null_mut()) };
    Box::into_raw(Box::new(state)) as *mut c_void
}

extern "C" fn initialize<T: Controller>(state: *mut c_void, io: *mut c_void) -> c_int {
    unsafe { (*(state as *mut State<T>)).io = Io(io) };
    run::<T>(state, |state| state.controller.initialize(state.io))
}

extern "C" fn start<T: Controller>(state: *mut c_void) -> c_int {
    run::<T>(state, |state| state.controller.start())
}

extern "C" fn control<T: Controller>(state: *mut c_void) -> c_int {
    run::<T>(state, |state| state.controller.control())
}

extern "C" fn stop<T: Controller>(state: *mut c_void) {
    run::<T>(state, |state| {
        state.controller.stop();
        Ok(())
    });
}

extern "C" fn destroy<T: Controller>(state: *mut c_void) {
    drop(unsafe { Box::from_raw(state as *mut State<T>) });
    drop(std::panic::take_hook());
}

thread_local! {
    /// The message of the last panic, with its file and line.
    static PANIC: std::cell::RefCell<String> = std::cell::RefCell::new(String::new());
}

/// Calls a part of the controller. A panic must not leave Rust.
fn run<T: Controller>(state: *mut c_void, part: impl FnOnce(&mut State<T>) -> Outcome) -> c_int {
    let state = unsafe { &mut *(state as *mut State<T>) };
    let io = state.io;
    let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| part(state)))
        .unwrap_or_else(|_| Err(PANIC.with(|kept| kept.borrow().clone())));
    match outcome {
        Ok(()) => 0,
        Err(sentence) => unsafe { rehearse_set_error(io.0, c_text(&sentence).as_ptr()) },
    }
}

fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

fn copied<T: Copy>(first: *const T, shape: [c_int; 3]) -> Option<(Vec<T>, [usize; 3])> {
    if first.is_null() {
        return None;
    }
    let shape = shape.map(|n| n as usize);
    let all = unsafe { std::slice::from_raw_parts(first, shape.iter().product()) };
    Some((all.to_vec(), shape))
}

extern "C" {
    fn rehearse_time_step(io: *const c_void) -> f64;
    fn rehearse_time(io: *const c_void) -> f64;
    fn rehearse_name(io: *const c_void) -> *const c_char;
    fn rehearse_options(io: *const c_void) -> *const c_char;
    fn rehearse_set_no_delay(io: *mut c_void, on: c_int) -> c_int;
    fn rehearse_print(io: *mut c_void, text: *const c_char);
    fn rehearse_error(io: *const c_void) -> *const c_char;
    fn rehearse_set_error(io: *mut c_void, text: *const c_char) -> c_int;
    fn rehearse_joint_count(io: *const c_void) -> c_int;
    fn rehearse_joint_of_id(io: *mut c_void, id: c_int) -> c_int;
    fn rehearse_joint(io: *mut c_void, name: *const c_char) -> c_int;
    fn rehearse_link(io: *mut c_void, name: *const c_char) -> c_int;
    fn rehearse_joint_name(io: *mut c_void, joint: c_int) -> *const c_char;
    fn rehearse_link_name(io: *mut c_void, link: c_int) -> *const c_char;
    fn rehearse_read(io: *mut c_void, link: c_int, quantities: c_int) -> c_int;
    fn rehearse_command(io: *mut c_void, link: c_int, quantities: c_int) -> c_int;
    fn rehearse_get(io: *mut c_void, joint: c_int, quantity: c_int) -> f64;
    fn rehearse_set(io: *mut c_void, joint: c_int, quantity: c_int, value: f64) -> c_int;
    fn rehearse_get_numbers(io: *mut c_void, link: c_int, quantity: c_int, numbers: *mut f64, size: c_int) -> c_int;
    fn rehearse_set_numbers(io: *mut c_void, link: c_int, quantity: c_int, numbers: *const f64, size: c_int) -> c_int;
    fn rehearse_limits(io: *mut c_void, joint: c_int, quantity: c_int, lower: *mut f64, upper: *mut f64) -> c_int;
    fn rehearse_device(io: *mut c_void, name: *const c_char) -> c_int;
    fn rehearse_read_device(io: *mut c_void, device: c_int) -> c_int;
    fn rehearse_device_numbers(io: *mut c_void, device: c_int, numbers: *mut f64, size: c_int) -> c_int;
    fn rehearse_set_device_numbers(io: *mut c_void, device: c_int, numbers: *const f64, size: c_int) -> c_int;
    fn rehearse_image(io: *mut c_void, device: c_int, shape: *mut c_int) -> *const u8;
    fn rehearse_points(io: *mut c_void, device: c_int, shape: *mut c_int) -> *const f32;
    fn rehearse_record_variable(name: *const c_char, value: f64);
}
