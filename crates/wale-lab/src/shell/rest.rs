//! How a shell comes to rest.

use wale_numerics::trust::{Trust, TrustRule, is_enough};

use super::error::ShellError;
use super::system::ShellSystem;

/// When a shell is at rest, and how long that may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestSettings {
    /// Largest force left, over the largest that an element exerts \[–\].
    pub tolerance: f64,
    /// Most Newton iterations a load step.
    pub max_iterations: usize,
}

impl Default for RestSettings {
    fn default() -> Self {
        Self { tolerance: 1e-9, max_iterations: 150 }
    }
}

/// How a shell came to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestReport {
    /// Newton iterations.
    pub iterations: usize,
    /// Largest force left, over the largest that an element exerts \[–\].
    pub residual: f64,
    /// Energy \[J\].
    pub energy: f64,
}

/// Largest shift, in units of the stretch stiffness.
const LARGEST_SHIFT: f64 = 1e6;
const RULE: TrustRule = TrustRule { least: 1e-8, doubted: 1e-7, refused: 1e-7, growth: 10.0, fall: 0.1 };
/// Largest move of a coordinate in a step, in edges of the mesh.
const LONGEST_MOVE: f64 = 4.0;

/// Moves the unknowns of `q` to where no force is left on them, by Newton's method within a region that it trusts
/// ([`wale_numerics::trust`]).
///
/// # Errors
/// [`ShellError::NotAtRest`], with `q` where the last iteration left it; [`ShellError::Cholesky`] where something is not finite.
pub fn come_to_rest(
    system: &mut ShellSystem,
    q: &mut [f64],
    settings: &RestSettings,
) -> Result<RestReport, ShellError> {
    let unit = system.stiffness();
    let mut trust = Trust::new(RULE, 0.0, 0.0);
    let mut energy = system.linearise(q, trust.convexity);
    let mut iterations = 0;
    while iterations < settings.max_iterations && system.residual() > settings.tolerance {
        if trust.shift > LARGEST_SHIFT {
            break;
        }
        let Some(step) = system.step(trust.used_shift() * unit)? else {
            iterations += 1;
            if trust.refuse() {
                energy = system.linearise(q, trust.convexity);
            }
            continue;
        };
        let part = system.longest_step(q, &step.direction, LONGEST_MOVE * system.edge());
        let trial: Vec<f64> = q.iter().zip(&step.direction).map(|(q, d)| q + part * d).collect();
        let share = step.foreseen.share(part, energy - system.energy(&trial), energy, 1e-12);
        trust.judge(share, part, 0.0);
        iterations += 1;
        if is_enough(share) {
            q.copy_from_slice(&trial);
            energy = system.linearise(q, trust.convexity);
        }
    }
    let residual = system.residual();
    if residual <= settings.tolerance {
        return Ok(RestReport { iterations, residual, energy });
    }
    Err(ShellError::NotAtRest { load: "this load".into(), iterations, residual })
}

/// Advances a load from one value to another in steps that are halved where the shell does not come to rest, and grow again
/// where it does. `place(from, to, q)` moves what is held, and guesses where the rest will be.
///
/// # Errors
/// [`ShellError::NotAtRest`] when a step of a thousandth of `longest` fails; any other error as it comes.
pub fn advance_load(
    system: &mut ShellSystem,
    q: &mut Vec<f64>,
    settings: &RestSettings,
    [from, to]: [f64; 2],
    longest: f64,
    what: &str,
    place: impl Fn(f64, f64, &mut [f64]),
) -> Result<(), ShellError> {
    let (mut load, mut step) = (from, longest);
    while load != to {
        let next = if (to - load).abs() <= 1.001 * step { to } else { load + step * (to - load).signum() };
        let mut trial = q.clone();
        place(load, next, &mut trial);
        match come_to_rest(system, &mut trial, settings) {
            Ok(_) => {
                *q = trial;
                load = next;
                step = (1.5 * step).min(longest);
            }
            Err(ShellError::NotAtRest { iterations, residual, .. }) => {
                step = 0.5 * step.min((next - load).abs());
                if step < 1e-3 * longest {
                    return Err(ShellError::NotAtRest { load: format!("{what} {next:.4}"), iterations, residual });
                }
            }
            Err(other) => return Err(other),
        }
    }
    Ok(())
}
