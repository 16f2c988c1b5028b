//! Arguments, and fleet files.

use crate::error::ZenohError;
use crate::keys;
use clap::Parser;
use serde::Deserialize;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use trirrr_line::Address;

/// Most machines of one program.
const MOST_MACHINES: u32 = 1000;

/// Puts machines on Zenoh: state, telemetry and events as keys, commands as queryables.
#[derive(Clone, Debug, Parser)]
#[command(
    version,
    after_help = "\
Keys of machine NAME: trirrr/NAME/{alive,identity,state,telemetry,events}, trirrr/NAME/command/VERB. Without --control the program \
looks on. It never switches drives on by itself. docs/fleet.md has the keys, the payloads and an example in Python."
)]
pub struct FleetArgs {
    /// Scene of the machines, the one that they were built from
    #[arg(
        value_name = "SCENE.toml",
        required_unless_present = "fleet",
        conflicts_with = "fleet"
    )]
    scene: Option<PathBuf>,
    /// Port of a machine: /dev/tty..., or tcp:HOST:PORT; again for each. Without, a machine is simulated here
    #[arg(long, value_name = "PORT", conflicts_with = "fleet")]
    port: Vec<Address>,
    /// Name of a machine in the keys, in the order of the ports [default: name of the scene, and -1, -2, ... of several]
    #[arg(long, value_name = "NAME", conflicts_with = "fleet")]
    name: Vec<String>,
    /// Key file of TCP ports that expect a key
    #[arg(long, value_name = "FILE", conflicts_with = "fleet")]
    key: Option<PathBuf>,
    /// File with the machines
    #[arg(long, value_name = "FLEET.toml")]
    fleet: Option<PathBuf>,
    /// Rate of serial ports
    #[arg(long, value_name = "BAUD", default_value_t = 921_600)]
    pub(crate) baud: u32,
    /// Router: tcp/HOST:PORT, tls/HOST:PORT, unixsock-stream/PATH; again for others [default: tcp/127.0.0.1:7447]
    #[arg(long, value_name = "ENDPOINT")]
    connect: Vec<String>,
    /// Configuration of Zenoh (JSON5): TLS, certificates, access control
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// Take commands, too
    #[arg(long)]
    pub(crate) control: bool,
    /// Ticks from one telemetry sample to the next
    #[arg(long, value_name = "TICKS", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) telemetry: u16,
    /// Publish sensor_msgs/JointState for zenoh-bridge-ros2dds, too: topic /trirrr/NAME/joint_states
    #[arg(long)]
    pub(crate) ros: bool,
    /// Seconds of telemetry that are kept for subscribers that have missed some
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=3600))]
    pub(crate) history: u32,
    /// First part of all keys
    #[arg(long, value_name = "PREFIX", default_value = keys::PREFIX, value_parser = name)]
    pub(crate) prefix: String,
}

/// Routes what programs with machines and their clients say to each other, by Zenoh.
#[derive(Clone, Debug, Parser)]
#[command(version)]
pub struct RouterArgs {
    /// Address: tcp/HOST:PORT, tls/HOST:PORT, unixsock-stream/PATH; again for others [default: tcp/127.0.0.1:7447]
    #[arg(long, value_name = "ENDPOINT")]
    listen: Vec<String>,
    /// Configuration of Zenoh (JSON5): TLS, certificates, access control
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
}

/// Endpoint unless another is given. A configuration of Zenoh has its own.
fn endpoints(given: &[String], config: Option<&PathBuf>) -> Vec<String> {
    match (given, config) {
        ([], None) => vec!["tcp/127.0.0.1:7447".into()],
        _ => given.to_vec(),
    }
}

impl RouterArgs {
    /// Returns the endpoints to listen at; none where the configuration has them.
    pub fn listen(&self) -> Vec<String> {
        endpoints(&self.listen, self.config.as_ref())
    }
}

fn name(text: &str) -> Result<String, String> {
    match keys::is_name(text) {
        true => Ok(text.into()),
        false => Err("expected 1 to 64 letters, digits, '-', '_' or '.'".into()),
    }
}

/// A machine of the fleet.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MachineEntry {
    pub(crate) name: String,
    pub(crate) scene: PathBuf,
    /// Port; none of a machine that is simulated here.
    pub(crate) port: Option<Address>,
    pub(crate) key: Option<PathBuf>,
}

/// A fleet file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FleetFile {
    machine: Vec<FileEntry>,
}

/// A table `[[machine]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileEntry {
    name: String,
    scene: PathBuf,
    port: Option<String>,
    key: Option<PathBuf>,
    count: Option<u32>,
}

impl FleetArgs {
    pub(crate) fn connect(&self) -> Vec<String> {
        endpoints(&self.connect, self.config.as_ref())
    }

    /// Machines, each with a name of its own.
    ///
    /// # Errors
    /// Refused: the fleet file, a name that cannot be one or stands twice, a port that stands twice, too many machines.
    pub(crate) fn machines(&self, scene_name: &str) -> Result<Vec<MachineEntry>, ZenohError> {
        let (machines, at) = match (&self.fleet, &self.scene) {
            (Some(file), _) => (read_fleet(file)?, format!("{}: ", file.display())),
            (None, Some(scene)) => (self.of_ports(scene, scene_name)?, String::new()),
            (None, None) => (Vec::new(), String::new()),
        };
        let refused = |why: String| Err(ZenohError::Refused(format!("{at}{why}")));
        let (mut names, mut ports) = (BTreeSet::new(), BTreeSet::new());
        for machine in &machines {
            let MachineEntry { name, port, .. } = machine;
            if let Err(expected) = self::name(name) {
                return refused(format!("name {name:?}: {expected}"));
            }
            if !names.insert(name) {
                return refused(format!(
                    "name {name:?} stands twice: each machine has its own"
                ));
            }
            if let Some(port) = port
                && !ports.insert(port.to_string())
            {
                return refused(format!(
                    "port {port} stands twice: a machine has one client"
                ));
            }
        }
        match machines.len() {
            0 => refused("no machine".into()),
            1..=1000 => Ok(machines),
            count => refused(format!("{count} machines; {MOST_MACHINES} at most")),
        }
    }

    /// Scene that the arguments name, if there is no fleet file.
    pub(crate) fn scene(&self) -> Option<&Path> {
        self.scene.as_deref()
    }

    fn of_ports(&self, scene: &Path, scene_name: &str) -> Result<Vec<MachineEntry>, ZenohError> {
        let count = self.port.len().max(1);
        if !self.name.is_empty() && self.name.len() != count {
            return Err(ZenohError::Refused(format!(
                "{} names for {count} machines: give one --name for each --port",
                self.name.len()
            )));
        }
        let machine = |index: usize| MachineEntry {
            name: match (self.name.get(index), count) {
                (Some(name), _) => name.clone(),
                (None, 1) => scene_name.into(),
                (None, _) => format!("{scene_name}-{}", index + 1),
            },
            scene: scene.into(),
            port: self.port.get(index).cloned(),
            key: self.key.clone(),
        };
        Ok((0..count).map(machine).collect())
    }
}

/// Reads a fleet file. Paths in it are relative to its folder.
fn read_fleet(file: &Path) -> Result<Vec<MachineEntry>, ZenohError> {
    let refused = |why: String| ZenohError::Refused(format!("{}: {why}", file.display()));
    let text = std::fs::read_to_string(file).map_err(|error| refused(error.to_string()))?;
    let fleet: FleetFile = toml::from_str(&text).map_err(|error| refused(error.to_string()))?;
    let folder = file.parent().unwrap_or(Path::new("."));
    let mut machines = Vec::new();
    for entry in fleet.machine {
        let count = entry.count.unwrap_or(1);
        if entry.count.is_some() && entry.port.is_some() {
            return Err(refused(format!(
                "machine {:?}: count is for machines that are simulated here, and port for one that is not; leave one out",
                entry.name
            )));
        }
        if !(1..=MOST_MACHINES).contains(&count) {
            return Err(refused(format!(
                "machine {:?}: count is {count}; 1 to {MOST_MACHINES} are allowed",
                entry.name
            )));
        }
        let port = entry.port.as_deref().map(str::parse).transpose();
        let port = port.map_err(|error| refused(format!("machine {:?}: {error}", entry.name)))?;
        machines.extend((1..=count).map(|index| MachineEntry {
            name: match entry.count {
                Some(_) => format!("{}-{index}", entry.name),
                None => entry.name.clone(),
            },
            scene: folder.join(&entry.scene),
            port: port.clone(),
            key: entry.key.as_ref().map(|key| folder.join(key)),
        }));
    }
    Ok(machines)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(words: &[&str]) -> FleetArgs {
        FleetArgs::try_parse_from([&["trirrr-zenoh"], words].concat()).unwrap()
    }

    fn names(words: &[&str]) -> Vec<String> {
        let machines = args(words).machines("thesis").unwrap();
        machines.into_iter().map(|machine| machine.name).collect()
    }

    #[test]
    fn machines_are_named_by_their_scene_or_by_the_user() {
        assert_eq!(names(&["a.toml"]), ["thesis"]);
        let two = ["a.toml", "--port", "tcp:h:1", "--port", "tcp:h:2"];
        assert_eq!(names(&two), ["thesis-1", "thesis-2"]);
        let named = [two.as_slice(), &["--name", "left", "--name", "right"]].concat();
        assert_eq!(names(&named), ["left", "right"]);
        for (words, says) in [
            (
                [two.as_slice(), &["--name", "left"]].concat(),
                "1 names for 2",
            ),
            (vec!["a.toml", "--name", "a/b"], "letters"),
            (
                vec!["a.toml", "--port", "tcp:h:1", "--port", "tcp:h:1"],
                "stands twice",
            ),
        ] {
            let error = args(&words).machines("thesis").unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
    }

    #[test]
    fn a_fleet_file_is_read_and_a_wrong_one_says_why() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("fleet.toml");
        let machines = |text: &str| {
            std::fs::write(&file, text).unwrap();
            let file = file.to_str().unwrap();
            args(&["--fleet", file]).machines("")
        };
        let two = "[[machine]]\nname = \"sim\"\nscene = \"a.toml\"\ncount = 2\n[[machine]]\nname = \"cell\"\nscene = \"b.toml\"\nport = \"tcp:pi:7333\"";
        let found = machines(two).unwrap();
        let names: Vec<_> = found.iter().map(|machine| machine.name.as_str()).collect();
        assert_eq!(names, ["sim-1", "sim-2", "cell"]);
        assert_eq!(found[0].scene, folder.path().join("a.toml"));
        assert_eq!(found[0].port, None);
        assert_eq!(found[2].port, Some("tcp:pi:7333".parse().unwrap()));
        for (text, says) in [
            ("", "machine"),
            ("machine = []", "no machine"),
            ("[[machine]]\nname = \"a\"\nscen = \"b\"", "scen"),
            (
                "[[machine]]\nname = \"a\"\nscene = \"b\"\ncount = 0",
                "count is 0",
            ),
            (
                "[[machine]]\nname = \"a\"\nscene = \"b\"\ncount = 2\nport = \"tcp:h:1\"",
                "leave one out",
            ),
            (
                &format!("{two}\n[[machine]]\nname = \"cell\"\nscene = \"b\""),
                "\"cell\" stands twice",
            ),
        ] {
            let error = machines(text).unwrap_err().to_string();
            assert!(
                error.contains(says) && error.contains("fleet.toml"),
                "{error}"
            );
        }
    }
}
