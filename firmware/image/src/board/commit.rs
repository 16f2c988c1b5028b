//! Commit that an image is built from.

use std::path::Path;
use std::process::Command;

/// Source of images, from the root of the repository. What lies elsewhere changes no image, but for the scene, which has a key of
/// its own.
const SOURCES: [&str; 6] = [
    "core",
    "crates",
    "firmware",
    "memory.x",
    "Cargo.toml",
    "Cargo.lock",
];

/// Hexadecimal digits of a commit.
const DIGITS: &str = "--short=10";

/// Returns the commit of the repository at `root`, with `-dirty` behind it if a source of images was changed since. Empty without git.
/// Tells Cargo about the files that this depends on.
pub(super) fn commit(root: &Path) -> String {
    let Some(commit) = git(root, &["rev-parse", DIGITS, "HEAD"]) else {
        return String::new();
    };
    // A commit moves a branch, a checkout the head. Files that are not there would count as changed in each build.
    for name in ["HEAD", "refs/heads", "packed-refs"] {
        let path = git(root, &["rev-parse", "--git-path", name]).map(|path| root.join(path));
        if let Some(path) = path.filter(|path| path.exists()) {
            println!("cargo:rerun-if-changed={}", path.display());
        }
    }
    for source in SOURCES {
        println!("cargo:rerun-if-changed={}", root.join(source).display());
    }
    let mut changes = vec!["diff", "--name-only", "HEAD", "--"];
    changes.extend(SOURCES);
    match git(root, &changes) {
        Some(changed) if changed.is_empty() => commit,
        _ => commit + "-dirty",
    }
}

/// Output of git with these arguments; `None` if it fails, or is not there.
fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new("git")
        .arg("-C")
        .arg(root)
        .args(arguments)
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_commit_tells_whether_sources_of_images_were_changed() {
        let folder = tempfile::tempdir().expect("a folder for a test");
        let root = folder.path();
        // No repository around it: a parent of the folder is none.
        assert_eq!(commit(root), "");
        let run = |arguments: &[&str]| {
            let own = ["-c", "user.name=t", "-c", "user.email=t@example.org"];
            let all: Vec<&str> = own.iter().chain(arguments).copied().collect();
            git(root, &all).unwrap_or_else(|| panic!("git {arguments:?} fails"))
        };
        run(&["init", "--quiet"]);
        fs::write(root.join("memory.x"), "one").expect("a file of a test");
        fs::write(root.join("README.md"), "one").expect("a file of a test");
        run(&["add", "."]);
        run(&["commit", "--quiet", "-m", "one"]);
        let clean = commit(root);
        assert_eq!(clean.len(), 10);
        fs::write(root.join("README.md"), "two").expect("a file of a test");
        assert_eq!(commit(root), clean);
        fs::write(root.join("memory.x"), "two").expect("a file of a test");
        assert_eq!(commit(root), format!("{clean}-dirty"));
    }
}
