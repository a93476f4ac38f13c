//! stoop.cpp in Rust. The options "panic" and "fail" make control() fail in its 50th tick.
#[path = "../../../../tools/new_project/rust/src/rehearse.rs"]
mod rehearse;

use rehearse::{Io, Link, Outcome, Q, U};

const STIFFNESS: f64 = 8000.0; // [N·m/rad]
const ARM_STIFFNESS: f64 = 3000.0; // [N·m/rad]
const DAMPING: f64 = 100.0; // [N·m·s/rad]
const SMOOTHING: f64 = 0.2; // of the velocity filter, per step

struct Joint {
    link: Link,
    stiffness: f64,
    bend: f64,
    start: f64,
    before: f64,
    velocity: f64,
}

struct Stoop {
    joints: Vec<Joint>,
    time_step: f64, // [s]
    depth: f64,     // [rad]
    tick: usize,
    phase: usize,
    options: String,
}

impl rehearse::Controller for Stoop {
    fn new() -> Stoop {
        Stoop { joints: Vec::new(), time_step: 0.0, depth: 0.0, tick: 0, phase: 0, options: String::new() }
    }

    fn initialize(&mut self, io: Io) -> Outcome {
        self.time_step = io.time_step();
        self.options = io.options();
        self.depth = self.options.parse().unwrap_or(0.0);
        if self.options == "joint" {
            io.joint("KNEE")?;
        }
        for link in io.joints()? {
            let name = link.joint_name();
            link.read(Q)?;
            link.command(U)?;
            self.joints.push(Joint {
                link,
                stiffness: if name.contains("ARM") { ARM_STIFFNESS } else { STIFFNESS },
                bend: if name.contains("KNEE") {
                    2.0
                } else if name.contains("HIP_P") || name.contains("ANKLE_P") {
                    -1.0
                } else {
                    0.0
                },
                start: link.get(Q),
                before: link.get(Q),
                velocity: 0.0,
            });
        }
        Ok(())
    }

    fn control(&mut self) -> Outcome {
        if self.tick == 50 && self.options == "panic" {
            let none: Vec<f64> = Vec::new();
            self.depth = none[self.tick];
        }
        if self.tick == 50 && self.options == "fail" {
            return Err("the battery is empty".to_string());
        }
        if self.phase == 0 && self.tick == 100 {
            self.phase = 1;
        }
        if self.phase == 1 && self.tick == 400 {
            self.phase = 2;
        }
        let share = match self.phase {
            0 => 0.0,
            1 => (self.tick - 100) as f64 / 300.0,
            _ => 1.0,
        };
        rehearse::variable("phase", self.phase as f64);
        for joint in &mut self.joints {
            let q = joint.link.get(Q);
            joint.velocity += SMOOTHING * ((q - joint.before) / self.time_step - joint.velocity);
            joint.before = q;
            let target = joint.start + self.depth * joint.bend * share;
            joint.link.set(U, joint.stiffness * (target - q) - DAMPING * joint.velocity)?;
        }
        self.tick += 1;
        Ok(())
    }
}

rehearse::controller!(Stoop);
