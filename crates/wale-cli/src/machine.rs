//! The machine: its memory and its threads.

use std::fs;

use crate::exit::{Code, Failure};

/// Memory that a new task may use \[bytes\]: what is free, or less where the process is confined; `None` where the
/// operating system does not say.
#[must_use]
pub fn available_memory() -> Option<u64> {
    let free = fs::read_to_string("/proc/meminfo").ok().and_then(|text| available_in(&text))?;
    let confined = fs::read_to_string("/sys/fs/cgroup/memory.max")
        .ok()
        .and_then(|text| text.trim().parse().ok())
        .unwrap_or(u64::MAX);
    Some(free.min(confined))
}

fn available_in(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// Reads a size such as `4GB`, `512 MiB` or `1e9`.
///
/// # Errors
/// A sentence, for text that is no size.
pub fn parse_size(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let split = text.find(|c: char| c.is_ascii_alphabetic() && !matches!(c, 'e' | 'E')).unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let factor = match unit {
        "" | "B" => 1.0,
        "k" | "kB" | "KB" => 1e3,
        "M" | "MB" => 1e6,
        "G" | "GB" => 1e9,
        "T" | "TB" => 1e12,
        "KiB" => 1024.0,
        "MiB" => 1024.0_f64.powi(2),
        "GiB" => 1024.0_f64.powi(3),
        "TiB" => 1024.0_f64.powi(4),
        _ => return Err(format!("`{unit}` is no unit of memory: try `4GB` or `512MiB`")),
    };
    let value = number
        .trim()
        .parse::<f64>()
        .ok()
        .map(|value| value * factor)
        .filter(|value| value.is_finite() && *value >= 1.0 && *value < u64::MAX as f64)
        .ok_or_else(|| format!("`{text}` is no size: try `4GB` or `512MiB`"))?;
    Ok(value as u64)
}

/// Sets the number of threads for all that follows, and says how many there are.
///
/// # Errors
/// When the threads cannot be started.
pub fn use_threads(threads: Option<usize>) -> Result<usize, Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .build_global()
        .map_err(|error| Failure::new(Code::ResourceLimit, format_args!("cannot start the threads: {error}")))?;
    Ok(rayon::current_num_threads())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read() {
        assert_eq!(parse_size("4GB"), Ok(4_000_000_000));
        assert_eq!(parse_size(" 1.5 KiB "), Ok(1536));
        assert_eq!(parse_size("1e6"), Ok(1_000_000));
        for bad in ["", "GB", "-1", "NaN", "inf", "1 XB", "1e400", "0", "99999999999TB"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn the_free_memory_is_found() {
        let text = "MemTotal:  8000000 kB\nMemFree: 1 kB\nMemAvailable:   1000 kB\n";
        assert_eq!(available_in(text), Some(1_024_000));
        assert_eq!(available_in("MemTotal: 1 kB\n"), None);
    }
}
