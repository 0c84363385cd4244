//! `wale register`: a page on which yarns are laid over photographs of a swatch.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use wale::record::RecordError;
use wale::record::atomic_file::write_atomically;
use wale_lab::register::{MOST_BYTES, Photograph, RegisterPage};

use crate::arguments::register::Register;
use crate::exit::{Code, Failure};
use crate::say;

/// Writes it.
pub fn register(arguments: &Register) -> Result<(), Failure> {
    let front = photograph(&arguments.front)?;
    let back = arguments.back.as_deref().map(photograph).transpose()?;
    let name = arguments.front.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let page = RegisterPage {
        name,
        periods: arguments.period,
        radius: arguments.radius,
        scale: arguments.scale,
        front,
        back,
        mirrored: !arguments.back_as_it_is,
    };
    page.check().map_err(|fault| Failure::new(Code::BadInput, fault))?;
    let path = arguments.out.clone().unwrap_or_else(|| arguments.front.with_extension("register.html"));
    if path.exists() && !arguments.force {
        let mend = "there is something of that name: choose another with `--out`, or overwrite a file with `--force`";
        return Err(RecordError::NotEmpty { path, mend }.into());
    }
    write_atomically(&path, |out| page.write_html(out))?;
    say!("{} written; open it in a browser", path.display())
}

fn photograph(path: &Path) -> Result<Photograph, Failure> {
    let unread = |error| Failure::io(path, "read", error);
    let mut bytes = Vec::new();
    // One byte more than a photograph may have is enough to see that it has too many.
    let most = MOST_BYTES as u64 + 1;
    File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes)).map_err(unread)?;
    Photograph::new(&path.display().to_string(), bytes).map_err(|error| Failure::new(Code::BadInput, error))
}
