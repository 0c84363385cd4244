//! `wale schema`: the JSON Schema of scene files.

use crate::exit::Failure;
use crate::output;

/// Prints it.
pub fn schema() -> Result<(), Failure> {
    output::json(&wale::scene::json_schema())
}
