//! A server for this machine: the page's files with the headers the page is written for.

use std::fs;
use std::io::{self, Write};
use std::net::{SocketAddr, TcpListener, ToSocketAddrs};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::thread;

use anyhow::{Context, Result, anyhow, bail};
use axum::Router;
use axum::body::Body;
use axum::extract::Request;
use axum::http::{HeaderName, HeaderValue, Method, StatusCode};
use axum::response::Response;
use clap::Args;
use percent_encoding::percent_decode_str;
use tokio::sync::oneshot;

use crate::web;

/// Ports tried after the one asked for, before the system chooses.
const NEIGHBOURS: u16 = 20;

/// Sent with every answer. The isolation pair lets the page measure time finely and share memory; the policy lets in
/// nothing but the page's own files, and lets the page fetch a file of points from an address that a person confirms. Any
/// page may show this one in a frame (there is no frame-ancestors, and files may be used across origins): it holds no
/// secrets, and `docs/embed.md` says what an embedding page can learn. Nothing is cached: the next build must be what the
/// next reload shows.
pub(crate) const HEADERS: [(&str, &str); 7] = [
    ("cross-origin-opener-policy", "same-origin"),
    ("cross-origin-embedder-policy", "require-corp"),
    ("cross-origin-resource-policy", "cross-origin"),
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self' https:; \
         style-src 'self'; img-src 'self' blob: data:; base-uri 'none'; form-action 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cache-control", "no-store"),
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
    address: SocketAddr,
    stop: oneshot::Sender<()>,
    thread: thread::JoinHandle<Result<()>>,
}

impl Running {
    /// Listens on `port` of `host`, or on a port nearby when that one is taken.
    pub(crate) fn start(host: &str, port: u16, mounts: Vec<Mount>) -> Result<Self> {
        let listener = listen(host, port)?;
        let address = listener.local_addr()?;
        listener.set_nonblocking(true)?;
        let (stop, stopped) = oneshot::channel();
        let thread = thread::spawn(move || serve(listener, mounts, stopped));
        Ok(Self { address, stop, thread })
    }

    /// Where a browser finds it.
    pub(crate) fn url(&self) -> String {
        format!("http://{}", self.address)
    }

    /// Serves until the process is ended.
    fn wait(self) -> Result<()> {
        // Kept: dropping it would stop the server.
        let _stop = self.stop;
        self.thread.join().map_err(|_| anyhow!("the server gave up"))?
    }

    /// Stops listening.
    pub(crate) fn stop(self) -> Result<()> {
        // The server may have ended by itself; joining it tells.
        let _ = self.stop.send(());
        self.thread.join().map_err(|_| anyhow!("the server gave up"))?
    }
}

/// Answers requests on this thread until told to stop.
fn serve(listener: TcpListener, mounts: Vec<Mount>, stopped: oneshot::Receiver<()>) -> Result<()> {
    let mounts = Arc::new(mounts);
    let router = Router::new().fallback(move |request: Request| {
        let mounts = Arc::clone(&mounts);
        async move { answer(&request, &mounts) }
    });
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let listener = tokio::net::TcpListener::from_std(listener)?;
        let server = axum::serve(listener, router).into_future();
        // Connections that a browser keeps open must not delay the end: no graceful shutdown.
        tokio::select! {
            outcome = server => outcome.map_err(anyhow::Error::from),
            _ = stopped => Ok(()),
        }
    })
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

fn answer(request: &Request, mounts: &[Mount]) -> Response {
    let outcome = match *request.method() {
        Method::GET | Method::HEAD => {
            let target = request.uri().path_and_query().map_or("", |target| target.as_str());
            resolve(target, mounts).and_then(open)
        }
        _ => Err(Refusal::Method),
    };
    match outcome {
        Ok((bytes, kind)) => respond(StatusCode::OK, kind, bytes),
        Err(refusal) => {
            let (status, words) = refusal.status();
            respond(status, "text/plain; charset=utf-8", words.into())
        }
    }
}

fn respond(status: StatusCode, kind: &'static str, bytes: Vec<u8>) -> Response {
    let mut response = Response::new(Body::from(bytes));
    *response.status_mut() = status;
    for (name, value) in HEADERS.into_iter().chain([("content-type", kind)]) {
        response.headers_mut().insert(HeaderName::from_static(name), HeaderValue::from_static(value));
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
    fn status(self) -> (StatusCode, &'static str) {
        match self {
            Self::Path => (StatusCode::BAD_REQUEST, "This path is not one of the page's.\n"),
            Self::Missing => (StatusCode::NOT_FOUND, "There is no such file.\n"),
            Self::Method => (StatusCode::METHOD_NOT_ALLOWED, "Only GET and HEAD are answered.\n"),
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

fn open(path: PathBuf) -> Result<(Vec<u8>, &'static str), Refusal> {
    let kind = media_type(&path);
    fs::read(path).map(|bytes| (bytes, kind)).map_err(|_| Refusal::Missing)
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
        assert!(page.contains("content-type: text/html; charset=utf-8\r\n"), "{page}");
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

    /// Browsers open several connections at once and keep all of them: none may wait for another to end.
    #[test]
    fn many_open_connections_are_all_answered() {
        let site = Site::new("many");
        let server = Running::start("127.0.0.1", 0, site.mounts()).unwrap();
        let mut streams: Vec<TcpStream> = (0..24).map(|_| TcpStream::connect(server.address).unwrap()).collect();
        for stream in &mut streams {
            stream.set_read_timeout(Some(std::time::Duration::from_secs(20))).unwrap();
            stream.write_all(b"GET /app/main.js HTTP/1.1\r\nHost: a\r\n\r\n").unwrap();
        }
        for stream in &mut streams {
            let mut answer = Vec::new();
            let mut buffer = [0; 2048];
            while !answer.ends_with(b"run()") {
                let count = stream.read(&mut buffer).unwrap();
                assert_ne!(count, 0, "closed early: {}", String::from_utf8_lossy(&answer));
                answer.extend_from_slice(&buffer[..count]);
            }
        }
        server.stop().unwrap();
    }
}
