//! Holds the arm at the angle where it starts, or at the one in its options [rad], against gravity and pushes.
mod rehearse;

use rehearse::{Io, Link, Outcome, DQ, Q, U};

const STIFFNESS: f64 = 60.0; // [N·m/rad]
const DAMPING: f64 = 6.0; // [N·m·s/rad]

struct Hold {
    shoulder: Option<Link>,
    target: f64, // [rad]
}

impl rehearse::Controller for Hold {
    fn new() -> Hold {
        Hold { shoulder: None, target: 0.0 }
    }

    fn initialize(&mut self, io: Io) -> Outcome {
        let shoulder = io.joint("SHOULDER")?;
        shoulder.read(Q | DQ)?;
        shoulder.command(U)?;
        self.target = match io.options().trim() {
            "" => shoulder.get(Q),
            angle => angle.parse().map_err(|_| format!("the option '{angle}' isn't an angle"))?,
        };
        self.shoulder = Some(shoulder);
        Ok(())
    }

    fn control(&mut self) -> Outcome {
        let shoulder = self.shoulder.ok_or("initialize() failed")?;
        shoulder.set(U, STIFFNESS * (self.target - shoulder.get(Q)) - DAMPING * shoulder.get(DQ))
    }
}

rehearse::controller!(Hold);
