//! The page: the crate as WebAssembly with its JavaScript half, beside the files of `www/`, in `dist/`.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use flate2::{Compression, write::GzEncoder};
use wasm_bindgen_cli_support::Bindgen;

use crate::{offline, process, requirements};

/// One of the page's modules of WebAssembly. Both are made of the same crate.
#[derive(Clone, Copy, Debug)]
struct Module {
    /// What its files begin with.
    name: &'static str,
    /// The feature that makes the crate this module.
    feature: &'static str,
    /// Cargo's profile.
    profile: &'static str,
    /// Most bytes it may take, compressed. It notices what comes in unintended; a feature that is worth it may raise it as
    /// long as the page keeps the goal of `cargo xtask bench-load`.
    gzip_budget: usize,
}

/// A visitor waits for the first before any point moves: on a line of 9 Mbit/s every 100 kB are 90 ms of the three seconds
/// that this may take. What reads files and links comes when it is needed.
const MODULES: [Module; 2] = [
    Module { name: "pointweave", feature: "engine-module", profile: "wasm", gzip_budget: 600_000 },
    Module { name: "pointweave_files", feature: "files-module", profile: "wasm-files", gzip_budget: 520_000 },
];

impl Module {
    fn path(self, package: &Path) -> PathBuf {
        package.join(format!("{}_bg.wasm", self.name))
    }
}

pub(crate) const TRIPLE: &str = "wasm32-unknown-unknown";

/// Options of `cargo xtask build`.
#[derive(Clone, Copy, Debug, Default, Args)]
pub(crate) struct BuildArguments {
    /// Shrink the modules with the wasm-opt of npm's binaryen, as for the page that people get; takes a minute.
    ///
    /// Never a distribution's: version 108 writes broken modules without a word.
    #[arg(long)]
    pub(crate) optimize: bool,
    /// With what the benchmark in the browser calls.
    #[arg(skip)]
    pub(crate) bench: bool,
    /// With a second, pretend method, into a folder of its own in Cargo's: a page for tests alone.
    #[arg(long, hide = true)]
    pub(crate) pretend: bool,
}

impl BuildArguments {
    /// Features of the crate beside the module's own.
    fn features(self, module: Module) -> Vec<&'static str> {
        let mut features = vec![module.feature];
        if self.bench && module.feature == "engine-module" {
            features.push("bench");
        }
        if self.pretend {
            features.push("pretend-method");
        }
        features
    }
}

/// Where the built page lies.
pub(crate) fn dist() -> PathBuf {
    process::root().join("dist")
}

/// Where the page with the pretend method lies.
pub(crate) fn pretend_dist() -> PathBuf {
    process::target().join("pretend-dist")
}

/// Builds the page into its folder, which is replaced as a whole. Returns that folder.
pub(crate) fn build(arguments: &BuildArguments) -> Result<PathBuf> {
    let www = process::root().join("www");
    if !www.is_dir() {
        bail!("{} is missing: there is no page to build", www.display());
    }
    // Prepared aside and moved in one go: a server that is running never shows half a page.
    let staging = process::target().join("dist-staging");
    remove(&staging)?;
    copy_folder(&www, &staging)?;
    let package = staging.join("pkg");
    for module in MODULES {
        compile(module, &package, &arguments.features(module))?;
        if arguments.optimize {
            shrink(&module.path(&package))?;
        }
    }
    offline::stamp(&staging)?;
    let dist = if arguments.pretend { pretend_dist() } else { dist() };
    remove(&dist)?;
    fs::rename(&staging, &dist)
        .with_context(|| format!("{} can't be moved to {}", staging.display(), dist.display()))?;
    println!("The page is in {}", dist.display());
    Ok(dist)
}

/// Builds the modules and fails when one is over its budget.
pub(crate) fn size() -> Result<()> {
    let folder = process::target().join("wasm-size");
    remove(&folder)?;
    for module in MODULES {
        compile(module, &folder, &[module.feature])?;
        shrink(&module.path(&folder))?;
    }
    check_sizes(&folder)
}

/// Fails when the page in `dist/` holds a module over its budget.
pub(crate) fn check_built_size() -> Result<()> {
    check_sizes(&dist().join("pkg"))
}

fn check_sizes(package: &Path) -> Result<()> {
    MODULES.into_iter().try_for_each(|module| check_size(&module.path(package), module.gzip_budget))
}

fn check_size(module: &Path, budget: usize) -> Result<()> {
    let bytes = fs::read(module).with_context(|| format!("{} can't be read", module.display()))?;
    let compressed = gzip_size(&bytes)?;
    let name = module.file_name().unwrap_or_default().to_string_lossy();
    println!("{name}: {} bytes, {compressed} compressed; the budget is {budget}", bytes.len());
    if compressed > budget {
        bail!("{name}, compressed, is {} bytes over its budget of {budget}", compressed - budget);
    }
    Ok(())
}

fn gzip_size(bytes: &[u8]) -> Result<usize> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    Ok(encoder.finish()?.len())
}

/// Compiles the crate as one of the modules and writes that and its JavaScript half into `folder`.
fn compile(module: Module, folder: &Path, features: &[&str]) -> Result<()> {
    requirements::provide_target(TRIPLE)?;
    let mut command = process::cargo();
    command.args(["build", "--locked", "--profile", module.profile, "--target", TRIPLE, "--lib"]);
    command.args(["--no-default-features", "--features", &features.join(",")]);
    process::run(&mut command)?;
    let compiled = process::target().join(TRIPLE).join(module.profile).join("pointweave.wasm");
    Bindgen::new()
        .input_path(&compiled)
        .out_name(module.name)
        .web(true)?
        .typescript(false)
        // Without this the generated `init()` throws unless it is told where the module is.
        .omit_default_module_path(false)
        .generate(folder)
        .with_context(|| format!("no JavaScript could be made for {}", compiled.display()))
}

fn shrink(module: &Path) -> Result<()> {
    requirements::provide_npm_packages()?;
    let tool = process::root().join("node_modules/.bin/wasm-opt");
    if !tool.is_file() {
        bail!("{} is missing; `npm ci` brings it", tool.display());
    }
    // What rustc uses by default and wasm-opt does not.
    let features = [
        "simd",
        "bulk-memory",
        "sign-ext",
        "nontrapping-float-to-int",
        "mutable-globals",
        "reference-types",
        "multivalue",
    ];
    let mut command = process::command(tool);
    // What follows from the values that can occur at all (gufa) leaves the second pass a kilobyte to take away.
    // By name, functions that are much alike stand together, which compresses better. The names go: only a debugger reads
    // them, and nobody debugs a release module without its source.
    command.args(["-Os", "--gufa", "-Os", "--reorder-functions-by-name", "--strip-debug"]);
    command.args(features.map(|feature| format!("--enable-{feature}")));
    process::run(command.arg(module).arg("-o").arg(module))
}

fn remove(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("{} can't be removed", folder.display()))?;
    }
    Ok(())
}

fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| format!("{} can't be made", to.display()))?;
    for entry in fs::read_dir(from).with_context(|| format!("{} can't be listed", from.display()))? {
        let entry = entry?;
        let (source, copy) = (entry.path(), to.join(entry.file_name()));
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        if source.is_dir() {
            copy_folder(&source, &copy)?;
        } else {
            fs::copy(&source, &copy).with_context(|| format!("{} can't be copied", source.display()))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]
    use super::*;

    #[test]
    fn folders_are_copied_whole_but_for_hidden_files() {
        let base = std::env::temp_dir().join(format!("pointweave-copy-{}", std::process::id()));
        let (from, to) = (base.join("from"), base.join("to"));
        fs::create_dir_all(from.join("app")).unwrap();
        fs::write(from.join("app/main.js"), "1").unwrap();
        fs::write(from.join(".secret"), "2").unwrap();
        copy_folder(&from, &to).unwrap();
        assert_eq!(fs::read_to_string(to.join("app/main.js")).unwrap(), "1");
        assert!(!to.join(".secret").exists());
        fs::remove_dir_all(&base).unwrap();
    }

    #[test]
    fn a_module_over_the_budget_is_refused() {
        let file = std::env::temp_dir().join(format!("pointweave-size-{}.wasm", std::process::id()));
        // A multiplicative generator's bytes don't compress.
        let mut state = 1_u64;
        let noise = |length: usize, state: &mut u64| -> Vec<u8> {
            (0..length)
                .map(|_| {
                    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    (*state >> 56) as u8
                })
                .collect()
        };
        let budget = 10_000;
        fs::write(&file, noise(budget + 1, &mut state)).unwrap();
        assert!(check_size(&file, budget).unwrap_err().to_string().contains("over its budget"));
        fs::write(&file, noise(budget / 2, &mut state)).unwrap();
        check_size(&file, budget).unwrap();
        fs::remove_file(&file).unwrap();
    }
}
