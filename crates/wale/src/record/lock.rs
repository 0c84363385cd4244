//! One process at a time in a run folder.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

use super::error::RecordError;

const NAME: &str = "lock";

/// A claim on a folder, given back when dropped.
///
/// The operating system holds the lock, so that a killed process gives it back too; the process id and the host in
/// the file tell others who holds it, and tell a stale claim of another host on a shared disk.
#[derive(Debug)]
pub struct FolderLock {
    file: File,
}

impl FolderLock {
    /// Claims a folder.
    ///
    /// # Errors
    /// [`RecordError::InUse`] when another process has it; those of the file system.
    pub fn take(folder: &Path) -> Result<Self, RecordError> {
        let path = folder.join(NAME);
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(|error| RecordError::from_io(&path, "lock", error))?;
        let locked = file.try_lock();
        let mut text = String::new();
        // An unreadable claim is a claim by nobody knows whom.
        let _ = (&mut file).take(1024).read_to_string(&mut text);
        let owner = Owner::parse(&text);
        let in_use = |mend: String| {
            let (pid, host) =
                owner.clone().map_or(("?".into(), "?".into()), |owner| (owner.pid.to_string(), owner.host));
            RecordError::InUse { path: folder.to_path_buf(), pid, host, mend }
        };
        match locked {
            Err(TryLockError::WouldBlock) => {
                return Err(in_use("wait for it to end, or choose another folder".to_owned()));
            }
            // A file system without locks: the process id must do.
            Err(TryLockError::Error(_)) if owner.as_ref().is_some_and(Owner::may_live) => {
                return Err(in_use(delete_hint(&path)));
            }
            // The lock of another host may not reach here.
            Ok(()) if owner.as_ref().is_some_and(|owner| owner.host != host()) => {
                return Err(in_use(delete_hint(&path)));
            }
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        let claim = format!("{} {}\n", std::process::id(), host());
        file.set_len(0)
            .and_then(|()| file.seek(SeekFrom::Start(0)))
            .and_then(|_| file.write_all(claim.as_bytes()))
            .and_then(|()| file.sync_all())
            .map_err(|error| RecordError::from_io(&path, "lock", error))?;
        Ok(Self { file })
    }

    /// Whether some process holds the folder now, as far as this one can see.
    #[must_use]
    pub fn is_held(folder: &Path) -> bool {
        let path = folder.join(NAME);
        let Ok(file) = File::open(&path) else {
            return false;
        };
        match file.try_lock_shared() {
            Err(TryLockError::WouldBlock) => true,
            Ok(()) | Err(TryLockError::Error(_)) => fs::read_to_string(&path)
                .ok()
                .and_then(|text| Owner::parse(&text))
                .is_some_and(|owner| owner.host != host()),
        }
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // Emptied, not removed: a removed lock file can be held by one process under no name while another makes a
        // new one.
        let _ = self.file.set_len(0);
        let _ = self.file.unlock();
    }
}

#[derive(Clone, Debug, PartialEq)]
struct Owner {
    pid: u32,
    host: String,
}

impl Owner {
    fn parse(text: &str) -> Option<Self> {
        let (pid, host) = text.trim().split_once(' ')?;
        Some(Self { pid: pid.parse().ok()?, host: host.to_owned() })
    }
    fn may_live(&self) -> bool {
        self.host != host() || !cfg!(target_os = "linux") || Path::new(&format!("/proc/{}", self.pid)).exists()
    }
}

fn delete_hint(path: &Path) -> String {
    format!("if that process is gone, delete {} and try again", path.display())
}

fn host() -> String {
    fs::read_to_string("/proc/sys/kernel/hostname")
        .ok()
        .or_else(|| std::env::var("HOSTNAME").ok())
        .or_else(|| std::env::var("COMPUTERNAME").ok())
        .map(|name| name.trim().replace(char::is_whitespace, "-"))
        .filter(|name| !name.is_empty())
        .unwrap_or_else(|| "this-host".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_claim_is_refused_by_name_and_the_third_granted() {
        let folder = tempfile::tempdir().unwrap();
        let first = FolderLock::take(folder.path()).unwrap();
        assert!(FolderLock::is_held(folder.path()));
        let error = FolderLock::take(folder.path()).unwrap_err().to_string();
        assert!(error.contains(&format!("process {} on {}", std::process::id(), host())), "{error}");
        drop(first);
        assert!(!FolderLock::is_held(folder.path()));
        FolderLock::take(folder.path()).unwrap();
    }

    #[test]
    fn the_claim_of_a_killed_process_is_stale() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(NAME), format!("1 {}\n", host())).unwrap();
        // Process 1 lives, but does not hold the lock: its number was used again.
        assert!(!FolderLock::is_held(folder.path()));
        FolderLock::take(folder.path()).unwrap();
    }

    #[test]
    fn the_claim_of_another_host_stands_until_deleted() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(NAME);
        fs::write(&path, "77 elsewhere\n").unwrap();
        assert!(FolderLock::is_held(folder.path()));
        let error = FolderLock::take(folder.path()).unwrap_err().to_string();
        assert!(error.contains("77 on elsewhere") && error.contains("delete"), "{error}");
        fs::remove_file(&path).unwrap();
        FolderLock::take(folder.path()).unwrap();
    }

    #[test]
    fn rubbish_in_the_file_is_no_claim() {
        let folder = tempfile::tempdir().unwrap();
        for rubbish in [&b"\xff\xfe"[..], b"", b"12", b"x y"] {
            fs::write(folder.path().join(NAME), rubbish).unwrap();
            FolderLock::take(folder.path()).unwrap();
        }
    }
}
