//! rosbag2 recordings: databases, MCAP files and the folders they lie in.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use rusqlite::{Connection, params};

use super::raw::{Layout, RawChannel, in_memory};

/// A topic of a drive.
#[derive(Clone, Debug, Default)]
pub struct Topic {
    pub name: String,
    pub message_type: String,
    pub schema: String,
    pub qos: String,
}

/// A message of a drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Index of its topic.
    pub topic: usize,
    pub log_ns: i64,
    pub data: Vec<u8>,
}

/// What is recorded, whatever into.
#[derive(Clone, Debug, Default)]
pub struct Drive {
    pub topics: Vec<Topic>,
    pub messages: Vec<Message>,
}

impl Drive {
    /// The drive in `count` pieces of equal length, as a recorder splits it. Every piece knows all topics.
    pub fn split(&self, count: usize) -> Vec<Self> {
        let each = self.messages.len().div_ceil(count);
        self.messages
            .chunks(each)
            .map(|messages| Self {
                topics: self.topics.clone(),
                messages: messages.to_vec(),
            })
            .collect()
    }

    /// The drive with every message compressed by itself.
    pub fn zstd_by_message(&self) -> Self {
        let mut drive = self.clone();
        for message in &mut drive.messages {
            message.data = zstd::bulk::compress(&message.data, 1).unwrap();
        }
        drive
    }

    /// The drive so many seconds later.
    pub fn later(&self, seconds: i64) -> Self {
        let mut drive = self.clone();
        for message in &mut drive.messages {
            message.log_ns += seconds * 1_000_000_000;
        }
        drive
    }

    /// First and last log time.
    pub fn span(&self) -> (i64, i64) {
        let times = || self.messages.iter().map(|message| message.log_ns);
        (times().min().unwrap_or(0), times().max().unwrap_or(0))
    }

    /// Messages by topic.
    pub fn count(&self, topic: usize) -> usize {
        self.messages.iter().filter(|message| message.topic == topic).count()
    }

    /// The bytes of an MCAP.
    pub fn mcap(&self, layout: Layout) -> Vec<u8> {
        in_memory(layout, |out| {
            let channels: Vec<u16> = self
                .topics
                .iter()
                .map(|topic| {
                    out.channel(&RawChannel {
                        topic: &topic.name,
                        message_type: &topic.message_type,
                        schema: &topic.schema,
                        qos: (!topic.qos.is_empty()).then_some(topic.qos.as_str()),
                        ..RawChannel::default()
                    })
                })
                .collect();
            for message in &self.messages {
                out.message(channels[message.topic], message.log_ns, &message.data);
            }
        })
    }

    /// Writes an MCAP.
    pub fn write_mcap(&self, path: &Path) {
        fs::write(path, self.mcap(Layout::default())).unwrap();
    }

    /// Writes a database.
    pub fn write_db3(&self, path: &Path, layout: Db3) {
        self.fill(&layout.create(path), layout);
    }

    /// Writes topics and messages into a new database.
    pub fn fill(&self, database: &Connection, layout: Db3) {
        database.execute_batch("BEGIN").unwrap();
        for (id, topic) in self.topics.iter().enumerate() {
            let id = i64::try_from(id + 1).unwrap();
            let row = (id, &topic.name, &topic.message_type, "cdr", &topic.qos);
            match layout.schema {
                Schema::Dashing => {
                    let sql = "INSERT INTO topics(id, name, type, serialization_format) VALUES(?1, ?2, ?3, ?4)";
                    database.execute(sql, params![row.0, row.1, row.2, row.3]).unwrap();
                }
                Schema::Humble => {
                    database
                        .execute("INSERT INTO topics VALUES(?1, ?2, ?3, ?4, ?5)", row)
                        .unwrap();
                }
                Schema::Jazzy => {
                    let sql = "INSERT INTO topics VALUES(?1, ?2, ?3, ?4, ?5, 'RIHS01_00')";
                    database.execute(sql, row).unwrap();
                    let sql = "INSERT INTO message_definitions(topic_type, encoding, encoded_message_definition, \
                               type_description_hash) VALUES(?1, 'ros2msg', ?2, 'RIHS01_00')";
                    database.execute(sql, (&topic.message_type, &topic.schema)).unwrap();
                }
            }
        }
        let mut insert = database
            .prepare("INSERT INTO messages(topic_id, timestamp, data) VALUES(?1, ?2, ?3)")
            .unwrap();
        for message in &self.messages {
            let topic = i64::try_from(message.topic + 1).unwrap();
            insert.execute((topic, message.log_ns, &message.data)).unwrap();
        }
        drop(insert);
        database.execute_batch("COMMIT").unwrap();
    }
}

/// The tables as distributions write them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Schema {
    /// Without QoS profiles.
    Dashing,
    /// Without definitions.
    Humble,
    /// With everything.
    Jazzy,
}

/// How a database is laid out.
#[derive(Clone, Copy, Debug)]
pub struct Db3 {
    pub schema: Schema,
    pub indexed: bool,
    pub page_size: u32,
}

impl Default for Db3 {
    fn default() -> Self {
        Self {
            schema: Schema::Jazzy,
            indexed: true,
            page_size: 4096,
        }
    }
}

impl Db3 {
    /// A database with empty tables.
    pub fn create(self, path: &Path) -> Connection {
        let database = Connection::open(path).unwrap();
        let qos = match self.schema {
            Schema::Dashing => "",
            Schema::Humble => ", offered_qos_profiles TEXT NOT NULL",
            Schema::Jazzy => ", offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL",
        };
        let mut sql = format!(
            "PRAGMA page_size = {}; PRAGMA synchronous = OFF; PRAGMA journal_mode = MEMORY;
             CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, \
             serialization_format TEXT NOT NULL{qos});
             CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, \
             data BLOB NOT NULL);",
            self.page_size
        );
        if self.indexed {
            sql.push_str("CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
        }
        if self.schema == Schema::Jazzy {
            sql.push_str(
                "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
                 INSERT INTO schema VALUES(4, 'jazzy');
                 CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, \
                 encoding TEXT NOT NULL, encoded_message_definition TEXT NOT NULL, \
                 type_description_hash TEXT NOT NULL);",
            );
        }
        database.execute_batch(&sql).unwrap();
        database
    }
}

/// The metadata of a drive in these files.
#[derive(Clone, Debug)]
pub struct Yaml {
    pub version: u32,
    pub storage: &'static str,
    /// Compression mode.
    pub mode: &'static str,
    pub files: Vec<String>,
}

impl Yaml {
    pub fn new(storage: &'static str, files: &[&str]) -> Self {
        Self {
            version: 9,
            storage,
            mode: "",
            files: files.iter().map(|&file| file.to_owned()).collect(),
        }
    }

    /// The metadata of files of one kind.
    pub fn of(paths: &[PathBuf]) -> Self {
        let names: Vec<&str> = paths
            .iter()
            .map(|path| path.file_name().unwrap().to_str().unwrap())
            .collect();
        let storage = if names[0].contains(".db3") { "sqlite3" } else { "mcap" };
        Self::new(storage, &names)
    }

    /// Writes it where the files lie.
    pub fn write(&self, drive: &Drive, folder: &Path) {
        fs::write(folder.join("metadata.yaml"), self.text(drive)).unwrap();
    }

    /// The text. From version 9 on QoS profiles are lists, before they are texts.
    pub fn text(&self, drive: &Drive) -> String {
        let (start, end) = drive.span();
        let mut out = format!(
            "rosbag2_bagfile_information:\n  version: {}\n  storage_identifier: {}\n  duration:\n    nanoseconds: {}\n  \
             starting_time:\n    nanoseconds_since_epoch: {start}\n  message_count: {}\n  topics_with_message_count:\n",
            self.version,
            self.storage,
            end - start,
            drive.messages.len()
        );
        for (index, topic) in drive.topics.iter().enumerate() {
            let _ = write!(
                out,
                "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: cdr\n",
                topic.name, topic.message_type
            );
            if self.version >= 9 {
                out.push_str("        offered_qos_profiles:\n");
                for line in topic.qos.lines() {
                    let _ = writeln!(out, "          {line}");
                }
            } else {
                let _ = writeln!(out, "        offered_qos_profiles: {:?}", topic.qos);
            }
            let _ = writeln!(out, "      message_count: {}", drive.count(index));
        }
        let format = if self.mode.is_empty() { "" } else { "zstd" };
        let _ = write!(
            out,
            "  compression_format: \"{format}\"\n  compression_mode: \"{}\"\n  relative_file_paths:\n",
            self.mode
        );
        for file in &self.files {
            let _ = writeln!(out, "    - {file}");
        }
        out.push_str("  ros_distro: jazzy\n  custom_data:\n    vehicle: cart 7\n");
        out
    }
}

/// Writes the parts of a drive as `drive_0.db3` or `drive_0.mcap`, ..., and gives their paths.
pub fn write_parts(parts: &[Drive], folder: &Path, ending: &str) -> Vec<PathBuf> {
    parts
        .iter()
        .enumerate()
        .map(|(number, part)| {
            let path = folder.join(format!("drive_{number}.{ending}"));
            match ending {
                "db3" => part.write_db3(&path, Db3::default()),
                _ => part.write_mcap(&path),
            }
            path
        })
        .collect()
}

/// Compresses a file as rosbag2 does when it closes it: `x.db3` becomes `x.db3.zstd`.
pub fn zstd_file(path: &Path) -> PathBuf {
    let packed = PathBuf::from(format!("{}.zstd", path.display()));
    fs::write(
        &packed,
        zstd::encode_all(fs::read(path).unwrap().as_slice(), 3).unwrap(),
    )
    .unwrap();
    fs::remove_file(path).unwrap();
    packed
}
