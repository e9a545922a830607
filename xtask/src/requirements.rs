//! What the tests need besides Rust: found, installed where that is allowed, or named.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};

use crate::process;

/// Names a Chromium goes by.
const CHROMIUM: [&str; 4] = ["chromium", "chromium-browser", "google-chrome-stable", "google-chrome"];
/// Names a Firefox goes by.
const FIREFOX: [&str; 2] = ["firefox-esr", "firefox"];

/// Something the tests need that Cargo can't bring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Requirement {
    /// Runs the tests of the WebAssembly module and drives the browser.
    Node,
    /// Installs the browser's driver and the checker of types.
    Npm,
    /// The browser that the page is tested in.
    Chromium,
    /// A second browser, without WebGPU, that the page is opened in.
    Firefox,
    /// Lavapipe, a Vulkan device in software, for the GPU engine on machines without a GPU.
    Vulkan,
}

impl Requirement {
    /// Everything that a whole test run needs.
    pub(crate) const ALL: [Self; 5] = [Self::Node, Self::Npm, Self::Chromium, Self::Firefox, Self::Vulkan];

    /// The Debian package that brings it.
    fn package(self) -> &'static str {
        match self {
            Self::Node => "nodejs",
            Self::Npm => "npm",
            Self::Chromium => "chromium",
            Self::Firefox => "firefox-esr",
            Self::Vulkan => "mesa-vulkan-drivers",
        }
    }

    /// What a person on another system looks for.
    fn description(self) -> &'static str {
        match self {
            Self::Node => "Node.js 18 or later",
            Self::Npm => "npm",
            Self::Chromium => "Chromium or Chrome",
            Self::Firefox => "Firefox",
            Self::Vulkan => "a Vulkan driver, such as Mesa's lavapipe",
        }
    }

    fn is_met(self) -> bool {
        match self {
            Self::Node => process::find_program(&["node"]).is_some(),
            Self::Npm => process::find_program(&["npm"]).is_some(),
            Self::Chromium => chromium().is_some(),
            Self::Firefox => firefox().is_some(),
            // Elsewhere the system brings its own graphics interface.
            Self::Vulkan => !cfg!(target_os = "linux") || has_vulkan_driver(),
        }
    }
}

/// The browser: `POINTWEAVE_CHROMIUM` when set, else the first one on the path.
pub(crate) fn chromium() -> Option<PathBuf> {
    browser("POINTWEAVE_CHROMIUM", &CHROMIUM)
}

/// The second browser: `POINTWEAVE_FIREFOX` when set, else the first one on the path.
pub(crate) fn firefox() -> Option<PathBuf> {
    browser("POINTWEAVE_FIREFOX", &FIREFOX)
}

fn browser(variable: &str, names: &[&str]) -> Option<PathBuf> {
    std::env::var_os(variable).map(PathBuf::from).or_else(|| process::find_program(names))
}

fn has_vulkan_driver() -> bool {
    ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d"].into_iter().any(|folder| {
        fs::read_dir(folder)
            .is_ok_and(|mut entries| entries.any(|entry| entry.is_ok_and(|entry| is_json(&entry.path()))))
    })
}

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "json")
}

/// Installs what is missing of `wanted` when we are root and have apt-get, else says what to install.
pub(crate) fn provide(wanted: &[Requirement], may_install: bool) -> Result<()> {
    let missing = |wanted: &[Requirement]| -> Vec<Requirement> {
        wanted.iter().copied().filter(|requirement| !requirement.is_met()).collect()
    };
    let absent = missing(wanted);
    if !absent.is_empty() && may_install && is_root() && process::find_program(&["apt-get"]).is_some() {
        let packages: Vec<&str> = absent.iter().map(|requirement| requirement.package()).collect();
        println!("Installing {}", packages.join(", "));
        // One command after the other; a list that can't be refreshed may still do.
        if let Err(error) = process::run(process::command("apt-get").args(["update", "--quiet"])) {
            println!("{error}");
        }
        process::run(
            process::command("apt-get")
                .env("DEBIAN_FRONTEND", "noninteractive")
                .args(["install", "--yes", "--quiet", "--no-install-recommends"])
                .args(packages),
        )?;
    }
    let absent = missing(wanted);
    if absent.is_empty() {
        return Ok(());
    }
    bail!("{}", advice(&absent))
}

fn advice(absent: &[Requirement]) -> String {
    let descriptions: Vec<&str> = absent.iter().map(|requirement| requirement.description()).collect();
    let packages: Vec<&str> = absent.iter().map(|requirement| requirement.package()).collect();
    format!(
        "missing: {}.\nOn Debian: sudo apt-get install --no-install-recommends {}",
        descriptions.join(", "),
        packages.join(" ")
    )
}

fn is_root() -> bool {
    process::read(process::command("id").arg("-u")).is_ok_and(|user| user.trim() == "0")
}

/// Adds the standard library for `triple` where the toolchain is there without it: rustup reads the targets of
/// rust-toolchain.toml only when it installs the toolchain itself.
pub(crate) fn provide_target(triple: &str) -> Result<()> {
    let mut ask = process::command("rustc");
    ask.args(["--print", "target-libdir", "--target", triple]);
    let folder = process::read(&mut ask).unwrap_or_default();
    if fs::read_dir(folder.trim()).is_ok_and(|mut files| files.next().is_some()) {
        return Ok(());
    }
    process::run(process::command("rustup").args(["target", "add", triple]))
}

/// Brings the packages of package-lock.json up to date. Does nothing when they are.
pub(crate) fn provide_npm_packages() -> Result<()> {
    let root = process::root();
    let lock = root.join("package-lock.json");
    if !lock.is_file() {
        return Ok(());
    }
    let changed = |path: &Path| fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    let installed = changed(&root.join("node_modules/.package-lock.json"));
    if installed.is_some() && installed >= changed(&lock) {
        return Ok(());
    }
    let npm = process::find_program(&["npm"]).unwrap_or_else(|| "npm".into());
    process::run(process::command(npm).args(["ci", "--no-audit", "--no-fund"]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_names_the_thing_and_its_package() {
        let words = advice(&[Requirement::Chromium, Requirement::Node]);
        assert!(words.contains("Chromium or Chrome, Node.js 18"), "{words}");
        assert!(words.ends_with("install --no-install-recommends chromium nodejs"), "{words}");
    }
}
