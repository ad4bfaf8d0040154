//! A real browser without a window, driven over the pipe of its own debugging protocol: what it shows, and what it complains of.
//!
//! Nothing is asked of a network. Chromium reads its orders on descriptor 3 and answers on 4, documents between NULs.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use nix::sys::stat::Mode;
use nix::unistd::mkfifo;
use serde_json::{Value, json};

use super::at_hand::left_out;

/// A browser that needs longer for one answer hangs.
const PATIENCE: Duration = Duration::from_secs(60);

/// A running browser.
pub struct Browser {
    child: Child,
    orders: File,
    answers: Receiver<Value>,
    last: u64,
    _folder: tempfile::TempDir,
}

/// A page in it.
pub struct Page<'b> {
    browser: &'b mut Browser,
    session: String,
    url: String,
    events: Vec<Value>,
}

impl Browser {
    /// Starts Chromium; `None`, and a note, where none is installed.
    #[track_caller]
    pub fn start() -> Option<Self> {
        let Some(program) = installed() else {
            left_out("no chromium");
            return None;
        };
        let folder = tempfile::tempdir().expect("a temporary folder");
        let [orders, answers] = ["orders", "answers"].map(|name| {
            let path = folder.path().join(name);
            mkfifo(&path, Mode::S_IRWXU).expect("a pipe with a name");
            path
        });
        let mut command = Command::new("sh");
        command
            .args(["-c", "exec \"$0\" \"$@\" 3<\"$ORDERS\" 4>\"$ANSWERS\""])
            .arg(program)
            .args(["--headless", "--remote-debugging-pipe", "--no-sandbox", "--disable-gpu"])
            .args(["--disable-quic", "--no-first-run", "--disable-background-networking"])
            .args([
                "--disable-component-update",
                "--disable-sync",
                "--disable-dev-shm-usage",
            ])
            .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
            .env("ORDERS", &orders)
            .env("ANSWERS", &answers)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let child = command.spawn().expect("a shell starts");
        // Each side waits here for the other one, in the order in which the shell opens them.
        let orders = OpenOptions::new().write(true).open(orders).expect("a pipe");
        let answers = File::open(answers).expect("a pipe");
        let (sender, receiver) = channel();
        std::thread::spawn(move || {
            let documents = BufReader::new(answers).split(0);
            for document in documents.map_while(Result::ok) {
                let Ok(document) = serde_json::from_slice(&document) else {
                    continue;
                };
                if sender.send(document).is_err() {
                    break;
                }
            }
        });
        Some(Self {
            child,
            orders,
            answers: receiver,
            last: 0,
            _folder: folder,
        })
    }

    /// Opens a file, and waits until it is loaded.
    pub fn open(&mut self, path: &Path) -> Page<'_> {
        let url = format!("file://{}", path.display());
        let mut events = Vec::new();
        let target = self.ask("Target.createTarget", &json!({"url": "about:blank"}), None, &mut events);
        let attach = json!({"targetId": target["targetId"], "flatten": true});
        let attached = self.ask("Target.attachToTarget", &attach, None, &mut events);
        let session = attached["sessionId"].as_str().expect("a session").to_owned();
        let mut page = Page {
            browser: self,
            session,
            url,
            events,
        };
        for domain in ["Page", "Runtime", "Log", "Network"] {
            page.ask(&format!("{domain}.enable"), &json!({}));
        }
        let url = page.url.clone();
        page.ask("Page.navigate", &json!({ "url": url }));
        while !page.events.iter().any(|event| event["method"] == "Page.loadEventFired") {
            let event = page.browser.answers.recv_timeout(PATIENCE).expect("the page is loaded");
            page.events.push(event);
        }
        page
    }

    fn ask(&mut self, method: &str, parameters: &Value, session: Option<&str>, events: &mut Vec<Value>) -> Value {
        self.last += 1;
        let mut order = json!({"id": self.last, "method": method, "params": parameters});
        if let Some(session) = session {
            order["sessionId"] = session.into();
        }
        let mut bytes = order.to_string().into_bytes();
        bytes.push(0);
        self.orders.write_all(&bytes).expect("the browser listens");
        loop {
            let answer = self.answers.recv_timeout(PATIENCE).expect("the browser answers");
            if answer["id"] == self.last {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            events.push(answer);
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Page<'_> {
    /// Asks the browser something about the page.
    pub fn ask(&mut self, method: &str, parameters: &Value) -> Value {
        self.browser
            .ask(method, parameters, Some(&self.session), &mut self.events)
    }

    /// What an expression comes to in the page.
    pub fn eval(&mut self, expression: &str) -> Value {
        let asked = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let answer = self.ask("Runtime.evaluate", &asked);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// A width of the window, in pixels of the style.
    pub fn width(&mut self, width: u32) {
        let metrics = json!({"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": false});
        self.ask("Emulation.setDeviceMetricsOverride", &metrics);
    }

    /// As on paper or on a screen, and in which colours.
    pub fn media(&mut self, media: &str, scheme: &str) {
        let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
        self.ask(
            "Emulation.setEmulatedMedia",
            &json!({"media": media, "features": features}),
        );
    }

    /// Errors and warnings of the console, exceptions, what the policy of the page refused, and what was asked of others.
    pub fn complaints(&mut self) -> Vec<String> {
        // What happened so far has been told when this is answered.
        self.eval("new Promise(done => setTimeout(done, 100))");
        let is_loud = |level: &Value| level == "error" || level == "warning" || level == "assert";
        let url = self.url.clone();
        let complaint = |event: &Value| {
            let told = &event["params"];
            let is_meant = match event["method"].as_str()? {
                "Runtime.exceptionThrown" | "Inspector.targetCrashed" => true,
                "Runtime.consoleAPICalled" => is_loud(&told["type"]),
                "Log.entryAdded" => is_loud(&told["entry"]["level"]),
                "Network.requestWillBeSent" => told["request"]["url"] != url.as_str(),
                _ => false,
            };
            is_meant.then(|| event.to_string())
        };
        self.events.iter().filter_map(complaint).collect()
    }
}

/// Chromium, or a browser that is made of it, where it is usually installed.
fn installed() -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    let mut candidates = names
        .iter()
        .flat_map(|name| std::env::split_paths(&folders).map(move |folder| folder.join(name)));
    candidates.find(|path| path.is_file())
}
