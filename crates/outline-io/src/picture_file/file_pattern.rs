//! Files whose names match a pattern.
use std::fs;
use std::path::{Path, PathBuf};

use glob::{MatchOptions, Pattern, PatternError};

/// Stands for any folders within each other.
const ANY_FOLDERS: &str = "**";

/// Whether a path is a pattern: it has a `*`, `?` or `[`, and there is no file of this name.
pub(crate) fn is_pattern(path: &Path) -> bool {
    path.to_str().is_some_and(has_wildcard) && !path.exists()
}

fn has_wildcard(text: &str) -> bool {
    text.contains(['*', '?', '['])
}

/// All that matches a pattern, in any order. Links to folders are not followed by `**`: they may lead to where
/// they are, in as many ways as there are.
pub(crate) fn matching_files(pattern: &str) -> Result<Vec<PathBuf>, PatternError> {
    let path = Path::new(pattern);
    if !path.components().any(|part| part.as_os_str() == ANY_FOLDERS) {
        return Ok(glob::glob(pattern)?.filter_map(Result::ok).collect());
    }
    // As paths are put together below.
    let pattern = Pattern::new(&path.components().collect::<PathBuf>().to_string_lossy())?;
    let options = MatchOptions { require_literal_separator: true, ..MatchOptions::new() };
    let is_plain = |part: &std::path::Component<'_>| !part.as_os_str().to_str().is_some_and(has_wildcard);
    let mut folders = vec![path.components().take_while(is_plain).collect::<PathBuf>()];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        let place = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
        // A folder that cannot be read has nothing that is seen to match.
        for entry in fs::read_dir(place).into_iter().flatten().flatten() {
            let path = folder.join(entry.file_name());
            if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                folders.push(path.clone());
            }
            if pattern.matches_path_with(&path, options) {
                found.push(path);
            }
        }
    }
    Ok(found)
}
