//! Fabrics that are fitted in seconds, and how the program is asked to.
#![allow(dead_code, reason = "each test uses a part")]

#[path = "../common/mod.rs"]
mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Output, Stdio};

use common::{program, wale_given};

/// The fabric of the repository.
pub fn acrylic() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fabrics/acrylic-stockinette")
}

/// A fabric file of a pattern in thick acrylic, with a short curve along its courses; returns its path.
pub fn small_fabric(folder: &Path, name: &str, pattern: &str, forces: [f64; 3]) -> PathBuf {
    let folder = folder.join(name);
    fs::create_dir_all(&folder).unwrap();
    let scene = fs::read_to_string(acrylic().join("stockinette.toml")).unwrap();
    let scene = scene.replace("pattern = \"stockinette\"", &format!("pattern = \"{pattern}\""));
    fs::write(folder.join("scene.toml"), scene).unwrap();
    let [a, b, c] = forces;
    let table = format!("strain,force (N),compression\n0,0,0\n0.05,{a},0.02\n0.1,{b},0.04\n0.15,{c},0.06\n");
    fs::write(folder.join("course.csv"), table).unwrap();
    let path = folder.join("fabric.toml");
    let text = format!(
        "schema = 1\ntitle = \"{name}\"\n[structure]\nscene = \"scene.toml\"\n[[stretch]]\ndirection = \"course\"\nfile = \"course.csv\"\n"
    );
    fs::write(&path, text).unwrap();
    path
}

/// `wale fit` of fabrics, quickly, with a text for its standard input.
pub fn fit(fabrics: &[&Path], arguments: &[&str], input: &str) -> Output {
    let fabrics: Vec<&str> = fabrics.iter().map(|path| path.to_str().unwrap()).collect();
    wale_given(&[&["fit", "--quick"], &fabrics[..], arguments].concat(), input)
}

/// The same, begun, for a test that kills it.
pub fn begun(fabric: &Path, out: &Path) -> Child {
    let arguments = ["fit", "--quick", fabric.to_str().unwrap(), "--out", out.to_str().unwrap()];
    program().args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// What a program said of itself.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The first half of a file's bytes in another place, as a process leaves it that is killed while it writes.
pub fn half(from: &Path, to: &Path) {
    let bytes = fs::read(from).unwrap();
    fs::create_dir_all(to.parent().unwrap()).unwrap();
    fs::write(to, &bytes[..bytes.len() / 2]).unwrap();
}
