//! A server for this machine: the page's files with the headers the page is written for.

use std::fs::{self, File};
use std::io::{self, Write};
use std::net::{SocketAddr, TcpListener, ToSocketAddrs};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::thread;

use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use percent_encoding::percent_decode_str;
use tiny_http::{Header, Method, Request, Response, Server};

use crate::web;

/// Requests answered at the same time; a browser opens six connections.
const WORKERS: usize = 6;
/// Ports tried after the one asked for, before the system chooses.
const NEIGHBOURS: u16 = 20;

/// Sent with every answer. The isolation pair lets the page measure time finely and share memory; the policy lets in
/// nothing but the page's own files. Nothing is cached: the next build must be what the next reload shows.
const HEADERS: [(&str, &str); 7] = [
    ("Cross-Origin-Opener-Policy", "same-origin"),
    ("Cross-Origin-Embedder-Policy", "require-corp"),
    ("Cross-Origin-Resource-Policy", "same-origin"),
    (
        "Content-Security-Policy",
        "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'; \
         style-src 'self'; img-src 'self' blob: data:; base-uri 'none'; form-action 'none'",
    ),
    ("X-Content-Type-Options", "nosniff"),
    ("Referrer-Policy", "no-referrer"),
    ("Cache-Control", "no-store"),
];

/// Options of `cargo xtask serve`.
#[derive(Debug, Args)]
pub(crate) struct ServeArguments {
    /// Port to listen on; the next free one is taken when something else has it. 0 lets the system choose.
    #[arg(long, default_value_t = 8080)]
    port: u16,
    /// Serve dist/ as it is.
    #[arg(long)]
    no_build: bool,
    /// Address to listen on. Only 127.0.0.1 and localhost count as secure without a certificate.
    #[arg(long, default_value = "127.0.0.1")]
    host: String,
}

/// Builds and serves until interrupted.
pub(crate) fn run(arguments: &ServeArguments) -> Result<()> {
    let dist = if arguments.no_build { web::dist() } else { web::build(&web::BuildArguments::default())? };
    if !dist.is_dir() {
        bail!("{} is missing; leave out --no-build", dist.display());
    }
    let server = Running::start(&arguments.host, arguments.port, vec![Mount::new("", &dist)?])?;
    if arguments.port != 0 && server.address.port() != arguments.port {
        println!("Port {} is taken; using {} instead.", arguments.port, server.address.port());
    }
    println!("Pointweave is at {}", server.url());
    io::stdout().flush()?;
    server.wait()
}

/// A folder whose files are served under a path.
#[derive(Clone, Debug)]
pub(crate) struct Mount {
    /// Without slashes at either end; empty for the root.
    prefix: &'static str,
    folder: PathBuf,
}

impl Mount {
    /// Serves `folder` under `/prefix/`.
    pub(crate) fn new(prefix: &'static str, folder: &Path) -> Result<Self> {
        let folder = folder.canonicalize().with_context(|| format!("{} can't be served", folder.display()))?;
        Ok(Self { prefix, folder })
    }
}

/// A server at work in the background.
pub(crate) struct Running {
    server: Arc<Server>,
    address: SocketAddr,
    workers: Vec<thread::JoinHandle<()>>,
}

impl Running {
    /// Listens on `port` of `host`, or on a port nearby when that one is taken.
    pub(crate) fn start(host: &str, port: u16, mounts: Vec<Mount>) -> Result<Self> {
        let listener = listen(host, port)?;
        let address = listener.local_addr()?;
        let server =
            Server::from_listener(listener, None).map_err(|error| anyhow!("the server can't start: {error}"))?;
        let (server, mounts) = (Arc::new(server), Arc::new(mounts));
        let workers = (0..WORKERS)
            .map(|_| {
                let (server, mounts) = (Arc::clone(&server), Arc::clone(&mounts));
                thread::spawn(move || {
                    // An error here means that the server was told to stop.
                    while let Ok(request) = server.recv() {
                        answer(request, &mounts);
                    }
                })
            })
            .collect();
        Ok(Self { server, address, workers })
    }

    /// Where a browser finds it.
    pub(crate) fn url(&self) -> String {
        format!("http://{}", self.address)
    }

    fn wait(self) -> Result<()> {
        for worker in self.workers {
            worker.join().map_err(|_| anyhow!("a worker of the server gave up"))?;
        }
        Ok(())
    }

    /// Stops listening.
    pub(crate) fn stop(self) -> Result<()> {
        for _ in 0..WORKERS {
            self.server.unblock();
        }
        self.wait()
    }
}

fn listen(host: &str, port: u16) -> Result<TcpListener> {
    let bind = |port: u16| -> io::Result<TcpListener> {
        let addresses: Vec<SocketAddr> = (host, port).to_socket_addrs()?.collect();
        TcpListener::bind(addresses.as_slice())
    };
    let nearby = (port..=port.saturating_add(NEIGHBOURS)).chain([0]);
    for candidate in nearby {
        match bind(candidate) {
            Ok(listener) => return Ok(listener),
            Err(error) if error.kind() == io::ErrorKind::AddrInUse => {}
            Err(error) => return Err(error).with_context(|| format!("can't listen on {host}, port {candidate}")),
        }
    }
    bail!("no free port on {host}")
}

fn answer(request: Request, mounts: &[Mount]) {
    let outcome = match request.method() {
        Method::Get | Method::Head => resolve(request.url(), mounts).and_then(open),
        _ => Err(Refusal::Method),
    };
    let sent = match outcome {
        Ok((file, kind)) => request.respond(with_headers(Response::from_file(file), kind)),
        Err(refusal) => {
            let (status, words) = refusal.status();
            let response = Response::from_string(words).with_status_code(status);
            request.respond(with_headers(response, "text/plain; charset=utf-8"))
        }
    };
    if let Err(error) = sent {
        // A browser that leaves in the middle of a file is no trouble of ours.
        if !matches!(error.kind(), io::ErrorKind::BrokenPipe | io::ErrorKind::ConnectionReset) {
            eprintln!("An answer could not be sent: {error}");
        }
    }
}

fn with_headers<R: io::Read>(mut response: Response<R>, kind: &str) -> Response<R> {
    for (name, value) in HEADERS.into_iter().chain([("Content-Type", kind)]) {
        // All of them are constants of this file, so none is ever left out; a test holds them to it.
        if let Ok(header) = Header::from_bytes(name, value) {
            response.add_header(header);
        }
    }
    response
}

/// Why a request gets no file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Refusal {
    Path,
    Missing,
    Method,
}

impl Refusal {
    fn status(self) -> (u16, &'static str) {
        match self {
            Self::Path => (400, "This path is not one of the page's.\n"),
            Self::Missing => (404, "There is no such file.\n"),
            Self::Method => (405, "Only GET and HEAD are answered.\n"),
        }
    }
}

/// The file a request's target names. Whatever would leave the mounted folders is refused.
fn resolve(target: &str, mounts: &[Mount]) -> Result<PathBuf, Refusal> {
    let path = target.split(['?', '#']).next().unwrap_or_default();
    let path = percent_decode_str(path).decode_utf8().map_err(|_| Refusal::Path)?;
    let relative = path.strip_prefix('/').ok_or(Refusal::Path)?;
    let harmless = |name: &str| !name.starts_with('.') && !name.contains(['\\', ':', '\0']);
    let names: Vec<&str> = relative.split('/').filter(|name| !name.is_empty()).collect();
    if !names.iter().all(|name| harmless(name)) {
        return Err(Refusal::Path);
    }
    let (mount, rest) = mounts
        .iter()
        .filter(|mount| !mount.prefix.is_empty() && names.first() == Some(&mount.prefix))
        .map(|mount| (mount, &names[1..]))
        .chain(mounts.iter().filter(|mount| mount.prefix.is_empty()).map(|mount| (mount, &names[..])))
        .next()
        .ok_or(Refusal::Missing)?;
    let relative: PathBuf = rest.iter().collect();
    if !relative.components().all(|component| matches!(component, Component::Normal(_))) {
        return Err(Refusal::Path);
    }
    let mut file = mount.folder.join(relative);
    if file.is_dir() {
        file.push("index.html");
    }
    // Follows links, so that one that points outside is refused as well.
    let file = file.canonicalize().map_err(|_| Refusal::Missing)?;
    if !file.starts_with(&mount.folder) {
        return Err(Refusal::Path);
    }
    if file.is_file() { Ok(file) } else { Err(Refusal::Missing) }
}

fn open(path: PathBuf) -> Result<(File, &'static str), Refusal> {
    let kind = media_type(&path);
    fs::File::open(path).map(|file| (file, kind)).map_err(|_| Refusal::Missing)
}

/// The media type of a file, by the end of its name. Browsers refuse modules of another type.
fn media_type(path: &Path) -> &'static str {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "wasm" => "application/wasm",
        "json" | "map" => "application/json",
        "webmanifest" => "application/manifest+json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "ico" => "image/x-icon",
        "csv" => "text/csv; charset=utf-8",
        "txt" | "md" => "text/plain; charset=utf-8",
        "woff2" => "font/woff2",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail loudly")]
    use std::io::Read;
    use std::net::TcpStream;

    use super::*;

    /// A folder of its own for every test, with a secret beside it.
    struct Site {
        base: PathBuf,
    }

    impl Site {
        fn new(name: &str) -> Self {
            let base = std::env::temp_dir().join(format!("pointweave-serve-{name}-{}", std::process::id()));
            fs::create_dir_all(base.join("dist/app")).unwrap();
            fs::create_dir_all(base.join("bench")).unwrap();
            fs::write(base.join("dist/index.html"), "<p>page").unwrap();
            fs::write(base.join("dist/app/main.js"), "run()").unwrap();
            fs::write(base.join("dist/two words.txt"), "2").unwrap();
            fs::write(base.join("dist/.hidden"), "no").unwrap();
            fs::write(base.join("bench/index.html"), "<p>bench").unwrap();
            fs::write(base.join("secret.txt"), "secret").unwrap();
            Self { base }
        }

        fn mounts(&self) -> Vec<Mount> {
            vec![
                Mount::new("", &self.base.join("dist")).unwrap(),
                Mount::new("bench", &self.base.join("bench")).unwrap(),
            ]
        }

        fn file(&self, name: &str) -> Result<PathBuf, Refusal> {
            Ok(self.base.join(name).canonicalize().unwrap())
        }
    }

    impl Drop for Site {
        fn drop(&mut self) {
            fs::remove_dir_all(&self.base).unwrap();
        }
    }

    #[test]
    fn paths_lead_to_files() {
        let site = Site::new("files");
        let mounts = site.mounts();
        assert_eq!(resolve("/", &mounts), site.file("dist/index.html"));
        assert_eq!(resolve("/?v=1&x=../..", &mounts), site.file("dist/index.html"));
        assert_eq!(resolve("/app/main.js", &mounts), site.file("dist/app/main.js"));
        assert_eq!(resolve("/two%20words.txt", &mounts), site.file("dist/two words.txt"));
        assert_eq!(resolve("/bench/", &mounts), site.file("bench/index.html"));
        assert_eq!(resolve("/app/", &mounts), Err(Refusal::Missing));
        assert_eq!(resolve("/nothing.js", &mounts), Err(Refusal::Missing));
    }

    #[test]
    fn paths_out_of_the_folder_are_refused() {
        let site = Site::new("traversal");
        let mounts = site.mounts();
        for target in [
            "/../secret.txt",
            "/app/../../secret.txt",
            "/%2e%2e/secret.txt",
            "/..%2fsecret.txt",
            "/app/..%5c..%5csecret.txt",
            "/bench/../secret.txt",
            "/.hidden",
            "/%00",
            "/%ff",
            "secret.txt",
            "http://elsewhere/secret.txt",
        ] {
            assert_eq!(resolve(target, &mounts), Err(Refusal::Path), "{target}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_out_of_the_folder_are_refused() {
        let site = Site::new("links");
        std::os::unix::fs::symlink(site.base.join("secret.txt"), site.base.join("dist/link.txt")).unwrap();
        assert_eq!(resolve("/link.txt", &site.mounts()), Err(Refusal::Path));
    }

    #[test]
    fn browsers_get_the_types_they_insist_on() {
        assert_eq!(media_type(Path::new("pkg/pointweave_bg.wasm")), "application/wasm");
        assert_eq!(media_type(Path::new("a.MJS")), "text/javascript; charset=utf-8");
        assert_eq!(media_type(Path::new("a.min.js")), "text/javascript; charset=utf-8");
        assert_eq!(media_type(Path::new("style.css")), "text/css; charset=utf-8");
        assert_eq!(media_type(Path::new("README")), "application/octet-stream");
    }

    #[test]
    fn every_header_is_valid() {
        let response = with_headers(Response::from_string(""), "text/html");
        for (name, value) in HEADERS {
            let found = response.headers().iter().find(|header| header.field.as_str() == name);
            assert_eq!(found.unwrap().value.as_str(), value);
        }
    }

    fn ask(address: SocketAddr, request: &str) -> String {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    }

    #[test]
    fn a_taken_port_is_left_alone_and_the_page_comes_with_its_headers() {
        let site = Site::new("http");
        let holder = TcpListener::bind("127.0.0.1:0").unwrap();
        let taken = holder.local_addr().unwrap().port();
        let server = Running::start("127.0.0.1", taken, site.mounts()).unwrap();
        let address = server.address;
        assert_ne!(address.port(), taken);

        let end = "HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n";
        let page = ask(address, &format!("GET / {end}"));
        assert!(page.starts_with("HTTP/1.1 200") && page.ends_with("<p>page"), "{page}");
        assert!(page.contains("Content-Type: text/html; charset=utf-8\r\n"), "{page}");
        for (name, value) in HEADERS {
            assert!(page.contains(&format!("{name}: {value}\r\n")), "{name} in {page}");
        }
        let head = ask(address, &format!("HEAD /app/main.js {end}"));
        assert!(head.contains("text/javascript") && head.ends_with("\r\n\r\n"), "{head}");
        assert!(ask(address, &format!("GET /../secret.txt {end}")).starts_with("HTTP/1.1 400"));
        assert!(ask(address, &format!("GET /none {end}")).starts_with("HTTP/1.1 404"));
        assert!(ask(address, &format!("DELETE / {end}")).starts_with("HTTP/1.1 405"));
        server.stop().unwrap();
    }
}
