//! How far a fit has come.

use std::sync::Mutex;

use super::problem::P;

/// What is told after every evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Evaluations so far.
    pub evaluations: usize,
    /// Least sum of squares so far.
    pub best: f64,
    /// The numbers that gave it.
    pub parameters: [f64; P],
}

/// Counts evaluations, keeps the best and tells both.
pub struct Progress<'a> {
    tell: &'a (dyn Fn(&Step) + Sync),
    step: Mutex<Step>,
}

impl<'a> Progress<'a> {
    /// Tells every step to a function.
    #[must_use]
    pub fn new(tell: &'a (dyn Fn(&Step) + Sync)) -> Self {
        Self { tell, step: Mutex::new(Step { evaluations: 0, best: f64::INFINITY, parameters: [f64::NAN; P] }) }
    }

    /// An evaluation was made; its cost if it counts.
    pub fn tell(&self, cost: Option<f64>, parameters: &[f64; P]) {
        let mut step = self.step.lock().expect("nobody panics with it");
        step.evaluations += 1;
        if let Some(cost) = cost.filter(|&cost| cost < step.best) {
            (step.best, step.parameters) = (cost, *parameters);
        }
        (self.tell)(&step);
    }

    /// Where it stands.
    #[must_use]
    pub fn now(&self) -> Step {
        *self.step.lock().expect("nobody panics with it")
    }
}
