//! Takes comments and indentation out of the shaders: a third of what they weigh on the wire. Lines stay where they are,
//! so that a compiler's message still points to the right one.

use std::path::Path;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=shaders");
    let out = env::var_os("OUT_DIR").ok_or_else(|| io::Error::other("cargo sets OUT_DIR"))?;
    for entry in fs::read_dir("shaders")? {
        let path = entry?.path();
        let (Some(name), true) = (path.file_name(), path.extension().is_some_and(|extension| extension == "wgsl"))
        else {
            continue;
        };
        let bare = |line: &str| line.split("//").next().unwrap_or_default().trim().to_owned() + "\n";
        let text: String = fs::read_to_string(&path)?.lines().map(bare).collect();
        fs::write(Path::new(&out).join(name), text)?;
    }
    Ok(())
}
