//! The code keeps to the floors that `ARCHITECTURE.md` draws: rooms use lower floors alone, files stay short, and the
//! library neither prints nor exits nor reads a clock.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Most lines of a source file, its tests not counted: a longer one holds two ideas.
const MOST_LINES: usize = 450;

/// Words that library code does not use, and the files that may all the same.
const ABSENT: [(&str, &[&str]); 8] = [
    ("println!", &[]),
    ("eprintln!", &[]),
    ("print!", &[]),
    ("dbg!", &[]),
    ("todo!", &[]),
    ("process::exit", &[]),
    ("SystemTime", &[]),
    // Memory bandwidth is a length of time.
    ("Instant", &["wale-numerics/src/triad.rs"]),
];

/// A row of the table of floors.
#[derive(Debug)]
struct Room {
    floor: u32,
    may_use: BTreeSet<String>,
}

/// The table of floors: the one place where it is written down.
fn rooms(text: &str) -> BTreeMap<String, Room> {
    let mut rooms = BTreeMap::new();
    for line in text.lines() {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let ["", floor, room, _, may_use, ""] = cells[..] else { continue };
        let Ok(floor) = floor.parse() else { continue };
        let may_use = may_use.split(',').map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect();
        let name = room.trim_matches('`').to_owned();
        assert!(rooms.insert(name.clone(), Room { floor, may_use }).is_none(), "`{name}` stands on two floors");
    }
    assert!(rooms.len() > 10, "the table of floors was not found");
    rooms
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Source files of a crate with their path from `crates/`, tests left out: files behind a `#[cfg(test)]` door, and what
/// follows the first `#[cfg(test)]` at the beginning of a line elsewhere.
fn sources(krate: &str) -> Vec<(String, String)> {
    let mut files = Vec::new();
    collect(&root().join("crates").join(krate).join("src"), &mut files);
    files.sort();
    assert!(!files.is_empty(), "no sources of {krate}");
    let crates = root().join("crates");
    let of_tests: BTreeSet<PathBuf> = files.iter().flat_map(|file| test_doors(file)).collect();
    files
        .iter()
        .filter(|file| !of_tests.contains(*file))
        .map(|file| {
            let text = fs::read_to_string(file).unwrap();
            let code = text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default().to_owned();
            (file.strip_prefix(&crates).unwrap().to_string_lossy().replace('\\', "/"), code)
        })
        .collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// Files that a file declares as modules of tests.
fn test_doors(file: &Path) -> Vec<PathBuf> {
    let text = fs::read_to_string(file).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let doors = lines.windows(2).filter(|pair| pair[0].trim() == "#[cfg(test)]");
    let names = doors.filter_map(|pair| pair[1].trim().strip_suffix(';')?.rsplit_once("mod ").map(|(_, name)| name));
    let folder = file.parent().unwrap();
    names.map(|name| folder.join(format!("{name}.rs"))).collect()
}

/// The module path of a file: `geometry/tube.rs` is `[geometry, tube]`, `geometry/mod.rs` is `[geometry]`.
fn module_of(file: &str) -> Vec<&str> {
    let inside = file.split_once("/src/").unwrap().1;
    let mut path: Vec<&str> = inside.strip_suffix(".rs").unwrap().split('/').collect();
    if matches!(path.last(), Some(&"mod" | &"lib" | &"main")) {
        path.pop();
    }
    path
}

/// Rooms that a piece of code names: modules of the crate by `crate::` or by enough `super::`, and other crates of ours.
fn rooms_named(module: &[&str], code: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let code: String = code.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    for krate in ["wale_numerics", "wale_lab", "wale_cli", "wale"] {
        let named = code.match_indices(&format!("{krate}::")).any(|(at, _)| !code[..at].ends_with(is_word));
        if named {
            found.insert(krate.to_owned());
        }
    }
    for (at, _) in code.match_indices("crate::") {
        if !code[..at].ends_with(is_word) && !code[..at].ends_with('$') {
            found.extend(first_names(&code[at + "crate::".len()..]));
        }
    }
    for (at, _) in code.match_indices("super::") {
        // Every chain of `super`s is looked at once, at its beginning.
        if code[..at].ends_with("super::") || code[..at].ends_with(is_word) {
            continue;
        }
        let mut rest = &code[at..];
        let mut climbed = 0;
        while let Some(after) = rest.strip_prefix("super::") {
            rest = after;
            climbed += 1;
        }
        if climbed >= module.len() {
            found.extend(first_names(rest));
        }
    }
    found
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The first name of a path, or of every path of a `{…}` list.
fn first_names(path: &str) -> Vec<String> {
    let name = |text: &str| text.trim_start().chars().take_while(|&c| is_word(c)).collect::<String>();
    let Some(list) = path.strip_prefix('{') else { return vec![name(path)] };
    let (mut names, mut depth, mut start) = (Vec::new(), 0, 0);
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            ',' | '}' if depth == 0 => {
                names.push(name(&list[start..at]));
                start = at + 1;
                if c == '}' {
                    break;
                }
            }
            '}' => depth -= 1,
            _ => {}
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

/// Faults of the table itself: arrows that do not point down.
fn faults_of_table(rooms: &BTreeMap<String, Room>) -> Vec<String> {
    let mut faults = Vec::new();
    for (name, room) in rooms {
        for used in room.may_use.iter().filter(|used| *used != "everything") {
            match rooms.get(used) {
                None => faults.push(format!("{name} may use {used}, which the table does not hold")),
                Some(other) if other.floor >= room.floor => {
                    faults.push(format!("{name} on floor {} may use {used} on floor {}", room.floor, other.floor));
                }
                Some(_) => {}
            }
        }
    }
    faults
}

/// Faults of one file: rooms that it names without leave.
fn faults_of_file(rooms: &BTreeMap<String, Room>, file: &str, code: &str) -> Vec<String> {
    let module = module_of(file);
    let own = match file.split('/').next().unwrap() {
        "wale-numerics" => "wale_numerics",
        // The door of the crate is no room.
        "wale" if module.is_empty() => return Vec::new(),
        "wale" => module[0],
        _ => return Vec::new(),
    };
    let Some(room) = rooms.get(own) else {
        return vec![format!("{file}: the room {own} is not in the table of floors")];
    };
    let named = rooms_named(&module, code);
    named
        .into_iter()
        // In the crate of mathematics, `crate::` names its own modules; elsewhere `wale::` stands only in texts.
        .filter(|name| if own == "wale_numerics" { name.starts_with("wale") } else { name != "wale" })
        .filter(|name| name != own && !room.may_use.contains(name))
        .map(|name| format!("{file}: {own} may not use {name}"))
        .collect()
}

#[test]
fn rooms_use_lower_floors_alone() {
    let rooms = rooms(&fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap());
    let mut faults = faults_of_table(&rooms);
    for krate in ["wale", "wale-numerics"] {
        for (file, code) in sources(krate) {
            faults.extend(faults_of_file(&rooms, &file, &code));
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn files_are_short_and_say_what_they_are() {
    let mut faults = Vec::new();
    for krate in ["wale", "wale-numerics", "wale-lab", "wale-cli"] {
        for (file, code) in sources(krate) {
            let lines = code.lines().count();
            if lines > MOST_LINES {
                faults.push(format!("{file} has {lines} lines"));
            }
            if !code.starts_with("//! ") {
                faults.push(format!("{file} does not begin with a sentence about itself"));
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn the_library_is_silent_and_timeless() {
    let mut faults = Vec::new();
    for krate in ["wale", "wale-numerics", "wale-lab"] {
        for (file, code) in sources(krate) {
            let code = code.lines().filter(|line| !line.trim_start().starts_with("//"));
            for (number, line) in code.enumerate() {
                for (word, exceptions) in ABSENT {
                    let named = line.match_indices(word).any(|(at, _)| !line[..at].ends_with(is_word));
                    if named && !exceptions.contains(&file.as_str()) {
                        faults.push(format!("{file}, about line {}: {word}", number + 1));
                    }
                }
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn an_arrow_that_points_up_is_found() {
    let house = |plan: &str| {
        let others: String = (0..10).map(|k| format!("| 3 | `c{k}` | - | |\n")).collect();
        rooms(&format!("{plan}{others}"))
    };
    let rooms = house("| 2 | `b` | - | a |\n| 1 | `a` | - | |\n| 1 | `wale_numerics` | - | |\n");
    let faults = |file: &str, code: &str| faults_of_file(&rooms, file, code).len();
    assert_eq!(faults("wale/src/b/x.rs", "use crate::a::Thing;\nuse super::y;"), 0);
    assert_eq!(faults("wale/src/a/x.rs", "use crate::b::Thing;"), 1);
    assert_eq!(faults("wale/src/a/x.rs", "use crate::{\n    a::{self, Thing},\n    b::Other,\n};"), 1);
    assert_eq!(faults("wale/src/a/x.rs", "let x = super::super::b::thing();"), 1);
    assert_eq!(faults("wale/src/a/mod.rs", "use super::b;"), 1);
    assert_eq!(faults("wale/src/a/y/x.rs", "use super::super::Thing;"), 0);
    assert_eq!(faults("wale/src/a/x.rs", "/// See [`crate::b`].\nfn f() {}"), 0);
    assert_eq!(faults("wale/src/d.rs", ""), 1);
    assert_eq!(faults("wale-numerics/src/x.rs", "use wale::a;"), 1);
    assert_eq!(faults("wale-numerics/src/x.rs", "use crate::b;"), 0);
    let circle = house("| 2 | `b` | - | a |\n| 2 | `a` | - | b |\n");
    assert_eq!(faults_of_table(&circle).len(), 2);
}
