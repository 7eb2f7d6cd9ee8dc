//! Where a file is that a path names.
use std::fs::{self, Metadata};
use std::io;
use std::path::{Path, PathBuf};

/// Links that are followed one after the other, as the system does.
const MOST_LINKS: usize = 40;

/// The place of a file, through links, so that what they lead to is written and not they; also of a file that is not there yet.
pub(super) fn destination(path: &Path) -> io::Result<PathBuf> {
    let mut place = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::symlink_metadata(&place) {
            Ok(found) if found.is_symlink() => place = folder_of(&place).join(fs::read_link(&place)?),
            Ok(_) => return fs::canonicalize(&place),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let Some(name) = place.file_name() else { return Ok(place) };
                return Ok(fs::canonicalize(folder_of(&place))?.join(name));
            }
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::new(io::ErrorKind::InvalidInput, "too many links one after the other"))
}

/// The folder that a file is named in.
pub(super) fn folder_of(file: &Path) -> &Path {
    // A name without a folder has an empty one.
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether two paths lead to one file, by whatever names.
pub(super) fn is_same_file(a: &Path, b: &Path) -> bool {
    match (fs::metadata(a), fs::metadata(b)) {
        (Ok(found), Ok(other)) if is_same_entry(&found, &other) => true,
        _ => destination(a).ok().zip(destination(b).ok()).is_some_and(|(a, b)| a == b),
    }
}

#[cfg(unix)]
fn is_same_entry(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

#[cfg(not(unix))]
fn is_same_entry(_: &Metadata, _: &Metadata) -> bool {
    false
}
