//! What the page needs to work without a network and on any host: a version from the content of its files, their list
//! with a hash each for the service worker, and the headers for hosts that read a `_headers` file. And what it needs to
//! load quickly without a bundler: a link in every page for each module that its script imports.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;
use sha2::{Digest, Sha256};

use crate::serve::HEADERS;

const WORKER: &str = "sw.js";
const VERSION: &str = "version.json";
const HOST: &str = "_headers";

/// Every file of the page by its path from there, with `/` on every system.
type Files = BTreeMap<String, Vec<u8>>;

/// Writes the version into the pages, their list into the service worker, and both the version's and the headers' own
/// files. What was written before is replaced, so the same content gets the same version again. Returns the version.
pub(crate) fn stamp(folder: &Path) -> Result<String> {
    let mut files = Files::new();
    read(folder, "", &mut files)?;
    for name in [VERSION, HOST] {
        files.remove(name);
    }
    let worker = files.remove(WORKER).with_context(|| format!("{} has no {WORKER}", folder.display()))?;
    let worker = String::from_utf8(worker)?;

    preload_modules(&mut files)?;
    // The version is that of the content without the stamps.
    write_version(&mut files, "")?;
    let mut hash = Sha256::new();
    for (path, bytes) in &files {
        hash.update(format!("{path}\n{}\n", integrity(bytes)));
    }
    hash.update(list_files(&worker, &json!({}), "")?);
    let version: String = hash.finalize().iter().take(8).fold(String::new(), |mut text, byte| {
        // Writing to a string can't fail.
        let _ = write!(text, "{byte:02x}");
        text
    });

    write_version(&mut files, &version)?;
    for (path, bytes) in files.iter().filter(|(path, _)| is_page(path)) {
        write(folder, path, bytes)?;
    }
    let hashes: BTreeMap<&String, String> = files.iter().map(|(path, bytes)| (path, integrity(bytes))).collect();
    write(folder, WORKER, list_files(&worker, &json!(hashes), &version)?.as_bytes())?;
    write(folder, VERSION, format!("{}\n", json!({ "version": version })).as_bytes())?;
    write(folder, HOST, host_headers().as_bytes())?;
    Ok(version)
}

fn is_page(path: &str) -> bool {
    Path::new(path).extension().is_some_and(|extension| extension == "html")
}

/// Lists in every page, after its module script, what that imports, directly or not: otherwise a browser learns of each
/// module from the one that imports it, and waits for a round trip of the line every time.
fn preload_modules(files: &mut Files) -> Result<()> {
    const LINK: &str = "<link rel=\"modulepreload\"";
    const SCRIPT: &str = "<script type=\"module\" src=\"./";

    let pages: Vec<String> = files.keys().filter(|path| is_page(path)).cloned().collect();
    for page in pages {
        let text = std::str::from_utf8(&files[&page]).with_context(|| format!("{page} is not UTF-8"))?;
        let mut lines = Vec::new();
        for line in text.lines().filter(|line| !line.trim_start().starts_with(LINK)) {
            lines.push(line.to_owned());
            let Some((indent, rest)) = line.split_once(SCRIPT) else { continue };
            let Some((script, _)) = rest.split_once('"') else { continue };
            // Pages lie in the folder that their scripts' paths start from.
            let mut modules = BTreeSet::new();
            collect_imports(files, script, &mut modules);
            modules.remove(script);
            lines.extend(modules.iter().map(|module| format!("{indent}{LINK} href=\"./{module}\" />")));
        }
        let text = lines.join("\n") + if text.ends_with('\n') { "\n" } else { "" };
        files.insert(page, text.into_bytes());
    }
    Ok(())
}

/// Adds the module and what it imports to `modules`.
fn collect_imports(files: &Files, module: &str, modules: &mut BTreeSet<String>) {
    let Some(text) = files.get(module).and_then(|bytes| std::str::from_utf8(bytes).ok()) else { return };
    if modules.insert(module.to_owned()) {
        for import in imports(text) {
            collect_imports(files, &join(module, import), modules);
        }
    }
}

/// What a module's `import … from './…'`, `export … from './…'` and `import './…'` name. Each stands in a line of its own,
/// or ends in one.
fn imports(text: &str) -> Vec<&str> {
    text.lines()
        .filter_map(|line| {
            let line = line.trim_start();
            let rest = match line.strip_prefix("import ") {
                Some(rest) if rest.starts_with(['\'', '"']) => rest,
                _ => line.starts_with(['i', 'e', '}']).then(|| line.split_once(" from "))??.1,
            };
            let quote = rest.chars().next().filter(|first| ['\'', '"'].contains(first))?;
            let path = rest[1..].split(quote).next()?;
            path.starts_with('.').then_some(path)
        })
        .collect()
}

/// The path that `relative` means in the module at `from`.
fn join(from: &str, relative: &str) -> String {
    let mut names: Vec<&str> = from.split('/').collect();
    names.pop();
    for name in relative.split('/') {
        match name {
            "." => {}
            ".." => drop(names.pop()),
            name => names.push(name),
        }
    }
    names.join("/")
}

/// Puts the version where `<html data-build="…">` is in every page.
fn write_version(files: &mut Files, version: &str) -> Result<()> {
    for (path, bytes) in files.iter_mut().filter(|(path, _)| is_page(path)) {
        let text = std::str::from_utf8(bytes).with_context(|| format!("{path} is not UTF-8"))?;
        let (head, rest) = text
            .split_once("data-build=\"")
            .with_context(|| format!("{path} has no data-build attribute for its version"))?;
        let (_, tail) = rest.split_once('"').with_context(|| format!("{path}: data-build has no end"))?;
        *bytes = format!("{head}data-build=\"{version}\"{tail}").into_bytes();
    }
    Ok(())
}

/// The service worker with the list and the version in the two lines that hold them.
fn list_files(worker: &str, files: &serde_json::Value, version: &str) -> Result<String> {
    let values = [("const FILES = ", files.to_string()), ("const VERSION = ", format!("'{version}'"))];
    let mut lines: Vec<String> = worker.lines().map(str::to_owned).collect();
    for (start, value) in values {
        let Some(line) = lines.iter_mut().find(|line| line.trim_start().starts_with(start)) else {
            bail!("{WORKER} has no line '{start}…'");
        };
        let indent = line.len() - line.trim_start().len();
        *line = format!("{}{start}{value};", &line[..indent]);
    }
    Ok(lines.join("\n") + "\n")
}

/// The hash as browsers check it (Subresource Integrity).
fn integrity(bytes: &[u8]) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(bytes)))
}

/// The headers of [`serve`](crate::serve) for Netlify, Cloudflare Pages and others that read this layout. A cache has to
/// ask there each time, which costs little: the service worker keeps the files.
fn host_headers() -> String {
    let mut text = "/*\n".to_owned();
    for (name, value) in HEADERS {
        let value = if name == "cache-control" { "no-cache" } else { value };
        // Writing to a string can't fail.
        let _ = writeln!(text, "  {name}: {value}");
    }
    text
}

fn read(folder: &Path, prefix: &str, files: &mut Files) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| format!("{} can't be listed", folder.display()))? {
        let entry = entry?;
        let (path, name) = (entry.path(), format!("{prefix}{}", entry.file_name().to_string_lossy()));
        if path.is_dir() {
            read(&path, &format!("{name}/"), files)?;
        } else {
            files.insert(name, fs::read(&path).with_context(|| format!("{} can't be read", path.display()))?);
        }
    }
    Ok(())
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<()> {
    let path = folder.join(name);
    fs::write(&path, bytes).with_context(|| format!("{} can't be written", path.display()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]
    use super::*;

    #[test]
    fn a_stamp_follows_the_content_and_nothing_else() {
        let folder = std::env::temp_dir().join(format!("pointweave-stamp-{}", std::process::id()));
        fs::create_dir_all(folder.join("app")).unwrap();
        fs::write(folder.join("index.html"), "<html lang=\"en\" data-build=\"\"><p>page").unwrap();
        fs::write(folder.join("app/main.js"), "abc").unwrap();
        fs::write(folder.join(WORKER), "{\n  const FILES = {};\n  const VERSION = '';\n}\n").unwrap();
        let text = |name: &str| fs::read_to_string(folder.join(name)).unwrap();

        let first = stamp(&folder).unwrap();
        assert_eq!(first.len(), 16);
        assert_eq!(text("index.html"), format!("<html lang=\"en\" data-build=\"{first}\"><p>page"));
        assert_eq!(text(VERSION), format!("{{\"version\":\"{first}\"}}\n"));
        // `printf abc | openssl dgst -sha256 -binary | base64`
        let listed = "\"app/main.js\":\"sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0=\"";
        assert!(text(WORKER).contains(listed), "{}", text(WORKER));
        assert!(text(WORKER).contains(&format!("  const VERSION = '{first}';\n")), "{}", text(WORKER));
        assert!(!text(WORKER).contains("sw.js") && !text(WORKER).contains("version.json"), "{}", text(WORKER));
        assert!(text(HOST).starts_with("/*\n  cross-origin-opener-policy: same-origin\n"), "{}", text(HOST));
        assert!(text(HOST).contains("cache-control: no-cache"), "{}", text(HOST));

        assert_eq!(stamp(&folder).unwrap(), first, "the same content");
        fs::write(folder.join("app/main.js"), "abd").unwrap();
        let second = stamp(&folder).unwrap();
        assert_ne!(second, first);
        fs::write(folder.join("app/main.js"), "abc").unwrap();
        assert_eq!(stamp(&folder).unwrap(), first);
        // The worker's own code counts, too.
        let worker = text(WORKER) + "// more\n";
        fs::write(folder.join(WORKER), worker).unwrap();
        assert_ne!(stamp(&folder).unwrap(), first);

        // A module that the page's script imports, however far away, is loaded at once.
        let page = "<html data-build=\"\">\n  <script type=\"module\" src=\"./app/main.js\"></script>\n";
        fs::write(folder.join("index.html"), page).unwrap();
        fs::create_dir_all(folder.join("common")).unwrap();
        fs::write(folder.join("app/main.js"), "import {\n  a,\n} from './a.js';\nimport('./late.js');\n").unwrap();
        fs::write(folder.join("app/a.js"), "export * from '../common/b.js';\nimport \"./main.js\";\n").unwrap();
        fs::write(folder.join("common/b.js"), "// import './c.js';\n").unwrap();
        fs::write(folder.join("common/c.js"), "").unwrap();
        fs::write(folder.join("app/late.js"), "").unwrap();
        let third = stamp(&folder).unwrap();
        let links: Vec<String> = ["app/a.js", "common/b.js"]
            .map(|module| format!("  <link rel=\"modulepreload\" href=\"./{module}\" />\n"))
            .into();
        assert_eq!(text("index.html"), page.replace("=\"\"", &format!("=\"{third}\"")) + &links.concat());
        assert_eq!(stamp(&folder).unwrap(), third, "links are replaced");

        fs::write(folder.join("bare.html"), "<html>").unwrap();
        assert!(stamp(&folder).unwrap_err().to_string().contains("bare.html"));
        fs::remove_dir_all(&folder).unwrap();
    }
}
