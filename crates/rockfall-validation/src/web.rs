//! `cargo xtask web`: builds the page of the browser to `web/dist`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use rockfall_validation::Result;

const TARGET: &str = "wasm32-unknown-unknown";
const HELP: &str = "no Rust compiler here builds for wasm32-unknown-unknown: run `rustup target add wasm32-unknown-unknown`, or \
                    on Debian install rustc-web and rust-web-src";

/// A compiler that builds for the target.
struct Compiler {
    /// The program; `None` for the one that cargo takes.
    rustc: Option<&'static str>,
    /// The standard library has to be built first, with this linker.
    linker: Option<PathBuf>,
}

/// Builds the page. The folder is replaced as a whole.
///
/// # Errors
/// When a program is missing or fails, and when a file cannot be written.
pub(crate) fn build(out: &Path, dev: bool) -> Result<()> {
    let root = fs::canonicalize(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))?;
    let package = root.join("crates/rockfall-web");
    // The folder of the workspace, which has some of the macros and tools already.
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    let (profile, folder) = if dev { ("dev", "debug") } else { ("release", "release") };
    let compiler = find_compiler()?;
    run(compiler.command(profile).current_dir(&package).arg("--target-dir").arg(&target))?;
    let mut bindgen = cargo();
    bindgen.args(["run", "--quiet", "--locked", "--package", "rockfall-web-bindgen", "--target-dir"]).arg(&target).arg("--");
    clear(out)?;
    let out = fs::canonicalize(out)?;
    bindgen.arg(target.join(TARGET).join(folder).join("rockfall_web.wasm")).arg(&out);
    run(bindgen.current_dir(&package))?;
    copy_all(&package.join("page"), &out)?;
    copy_all(&root.join("scenes"), &out.join("scenes"))?;
    let bytes: u64 = sizes(&out)?;
    println!("{}: {:.1} MB; serve it with any web server, for example:", out.display(), bytes as f64 / 1e6);
    println!("  python3 -m http.server --directory {}", out.display());
    Ok(())
}

/// Empties the folder of an earlier page, or creates it. A folder with other files is left alone.
fn clear(out: &Path) -> Result<()> {
    let is_empty = !out.exists() || fs::read_dir(out)?.next().is_none();
    if !is_empty && !out.join("rockfall_bg.wasm").exists() {
        return Err(
            format!("{}: the folder has files that are not those of an earlier page; choose another", out.display()).into()
        );
    }
    if out.exists() {
        fs::remove_dir_all(out)?;
    }
    Ok(fs::create_dir_all(out)?)
}

fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

fn run(command: &mut Command) -> Result<()> {
    let status = command.status().map_err(|error| format!("{command:?} could not be started: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("{command:?} failed: {status}").into()) }
}

/// The folder of a compiler and its libraries, or `None` if there is no such compiler.
fn sysroot(rustc: &str) -> Option<PathBuf> {
    let output = Command::new(rustc).args(["--print", "sysroot"]).output().ok()?;
    output.status.success().then(|| PathBuf::from(String::from_utf8_lossy(&output.stdout).trim()))
}

/// Chooses a compiler that has the target, or else one that has the source of the standard library.
fn find_compiler() -> Result<Compiler> {
    let found: Vec<_> = ["rustc", "/usr/bin/rustc"].into_iter().filter_map(|rustc| Some((rustc, sysroot(rustc)?))).collect();
    let named = |rustc: &'static str| (rustc != "rustc").then_some(rustc);
    if let Some((rustc, _)) = found.iter().find(|(_, root)| root.join("lib/rustlib").join(TARGET).join("lib").exists()) {
        return Ok(Compiler { rustc: named(rustc), linker: None });
    }
    let has_source = |root: &Path| root.join("lib/rustlib/src/rust/library/Cargo.lock").exists();
    let (rustc, _) = found.iter().find(|(_, root)| has_source(root)).ok_or(HELP)?;
    let linker = found.iter().find_map(|(_, root)| rust_lld(root)).ok_or("there is no linker for WebAssembly: install lld")?;
    Ok(Compiler { rustc: named(rustc), linker: Some(linker) })
}

/// The linker of a toolchain, or that of the system.
fn rust_lld(sysroot: &Path) -> Option<PathBuf> {
    let hosts = fs::read_dir(sysroot.join("lib/rustlib")).ok()?;
    let of_host = hosts.flatten().map(|host| host.path().join("bin/rust-lld"));
    let of_system = ["/usr/bin/wasm-ld", "/usr/bin/rust-lld"].map(PathBuf::from);
    of_host.chain(of_system).find(|linker| linker.exists())
}

impl Compiler {
    fn command(&self, profile: &str) -> Command {
        let mut command = cargo();
        command.args(["build", "--profile", profile, "--locked", "--package", "rockfall-web", "--target", TARGET]);
        if let Some(rustc) = self.rustc {
            command.env("RUSTC", rustc);
        }
        if let Some(linker) = &self.linker {
            // Permits `-Z` to a stable compiler.
            command.env("RUSTC_BOOTSTRAP", "1").args(["-Z", "build-std=std,panic_abort"]);
            command.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker);
        }
        command
    }
}

/// Copies the files of a folder and of its folders.
fn copy_all(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from).map_err(|error| format!("{}: {error}", from.display()))? {
        let entry = entry?;
        let (source, name) = (entry.path(), entry.file_name());
        if source.is_dir() {
            copy_all(&source, &to.join(name))?;
        } else {
            fs::copy(&source, to.join(name))?;
        }
    }
    Ok(())
}

fn sizes(folder: &Path) -> Result<u64> {
    let mut bytes = 0;
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        bytes += if path.is_dir() { sizes(&path)? } else { fs::metadata(&path)?.len() };
    }
    Ok(bytes)
}
