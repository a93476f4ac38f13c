//! planner.cpp in Rust: threads of std, which wait by futexes past the C library.
#[path = "../../../../tools/new_project/rust/src/rehearse.rs"]
mod rehearse;

use rehearse::{Io, Link, Outcome, Q, U};
use std::sync::mpsc::{channel, Receiver, Sender};
use std::sync::{Arc, Mutex};
use std::thread;

struct Planner {
    hinge: Option<Link>,
    angles: Option<Sender<f64>>,
    plans: Option<Receiver<f64>>,
    plan: f64,
    count: Arc<Mutex<f64>>,
    thread: Option<thread::JoinHandle<()>>,
}

impl rehearse::Controller for Planner {
    fn new() -> Planner {
        let count = Arc::new(Mutex::new(0.0));
        Planner { hinge: None, angles: None, plans: None, plan: 0.0, count, thread: None }
    }

    fn initialize(&mut self, io: Io) -> Outcome {
        let hinge = io.joint("hinge")?;
        hinge.read(Q)?;
        hinge.command(U)?;
        self.hinge = Some(hinge);
        let (angles, asked) = channel();
        let (answers, plans) = channel();
        let count = self.count.clone();
        let plan = move || {
            for angle in asked {
                *count.lock().unwrap() += 1.0;
                if answers.send(-4.0 * angle).is_err() {
                    return;
                }
            }
        };
        self.thread = Some(thread::Builder::new().name("planner".to_string()).spawn(plan).unwrap());
        self.angles = Some(angles);
        self.plans = Some(plans);
        Ok(())
    }

    fn control(&mut self) -> Outcome {
        let workers: Vec<_> = (0..2)
            .map(|share| {
                let count = self.count.clone();
                thread::spawn(move || {
                    let mut count = count.lock().unwrap();
                    *count = 2.0 * *count % 1000.0 + share as f64;
                })
            })
            .collect();
        for worker in workers {
            worker.join().unwrap();
        }
        for plan in self.plans.as_ref().unwrap().try_iter() {
            self.plan = plan;
        }
        let hinge = self.hinge.as_mut().unwrap();
        self.angles.as_ref().unwrap().send(hinge.get(Q)).unwrap();
        hinge.set(U, self.plan + 1e-6 * *self.count.lock().unwrap())
    }
}

impl Drop for Planner {
    fn drop(&mut self) {
        self.angles = None;
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }
}

rehearse::controller!(Planner);
