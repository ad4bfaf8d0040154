//! Who sent which datagrams: a channel for each lidar, sentences of NMEA, and counts of everything else.
//!
//! Owns the names of topics: `/udp/` with the address of the sender and the port that it sends to.

use std::collections::BTreeMap;
use std::net::{IpAddr, SocketAddr};

use crate::read::bag::{Channel, Message, Visit};
use crate::read::messages::assembled::MadeMessage;
use crate::read::messages::packets::ASSEMBLED;
use crate::read::ouster::may_be_imu;
use crate::read::packets::{Maker, boundary, describes_sensor};

use super::network::Datagram;

/// Bound on senders; what others send is counted.
const MAX_SENDERS: usize = 1024;
/// Datagrams in a row that begin as those of a maker, for an unknown model to be taken for one of it: by chance one in 65536 does.
const IN_A_ROW: u32 = 3;

/// Address and port of the sender, and the port that it sends to.
type Key = (IpAddr, u16, u16);

/// What a sender is.
enum Kind {
    Lidar(Channel),
    /// With the last sentence.
    Nmea(Channel, String),
    /// Not yet known: datagrams in a row that begin as those of a lidar.
    Unknown(u32),
}

pub(super) struct Senders<'v> {
    pub(super) visit: &'v mut dyn Visit,
    known: BTreeMap<Key, Kind>,
    message: MadeMessage,
    channels: usize,
    /// Messages that were passed on.
    pub(super) messages: u64,
    /// Datagrams that are not of a lidar.
    pub(super) others: u64,
}

impl<'v> Senders<'v> {
    pub(super) fn new(visit: &'v mut dyn Visit) -> Self {
        Self {
            visit,
            known: BTreeMap::new(),
            message: MadeMessage::default(),
            channels: 0,
            messages: 0,
            others: 0,
        }
    }

    /// Takes in a datagram.
    pub(super) fn datagram(&mut self, datagram: &Datagram<'_>, log_ns: i64) {
        let Datagram {
            source,
            source_port,
            port,
            ref data,
        } = *datagram;
        let mut key = (source, source_port, port);
        if describes_sensor(data) {
            // It comes from another port than the data of the same sensor.
            let is_lidar = |(known, kind): &(&Key, &Kind)| known.0 == source && matches!(kind, Kind::Lidar(_));
            let Some((lidar, _)) = self.known.iter().find(is_lidar) else {
                return;
            };
            key = *lidar;
        }
        if !self.known.contains_key(&key) && self.known.len() >= MAX_SENDERS {
            self.others += 1;
            return;
        }
        // An Ouster sends what its IMU measures from the same address.
        let is_imu = may_be_imu(data)
            && self
                .known
                .iter()
                .any(|(known, kind)| known.0 == source && matches!(kind, Kind::Lidar(_)));
        let kind = self.known.entry(key).or_insert(Kind::Unknown(0));
        if let Kind::Unknown(in_a_row) = kind {
            let maker = Maker::of(data);
            let is_maker = maker.is_some();
            let is_known = maker.is_some_and(|maker| boundary(maker).begins(data).is_some());
            *in_a_row = if is_maker { *in_a_row + 1 } else { 0 };
            let topic = || format!("/udp/{}", SocketAddr::new(source, port));
            let announced = if is_known || is_imu || *in_a_row >= IN_A_ROW {
                Kind::Lidar(Channel::made(self.channels, topic(), "udp_msgs/msg/UdpPacket", "cdr"))
            } else if sentence(data).is_some() {
                Kind::Nmea(
                    Channel::made(self.channels, topic(), "nmea_msgs/msg/Sentence", ASSEMBLED),
                    String::new(),
                )
            } else {
                if !is_maker {
                    self.others += 1;
                }
                return;
            };
            self.channels += 1;
            if let Kind::Lidar(channel) | Kind::Nmea(channel, _) = &announced {
                self.visit.channel(channel);
            }
            *kind = announced;
        }
        let (channel, data) = match kind {
            Kind::Lidar(channel) => {
                let address = source.to_string();
                (&*channel, self.message.datagram(log_ns, (&address, source_port), data))
            }
            Kind::Nmea(channel, last) => match sentence(data) {
                // The last sentence of the receiver is repeated until the next one comes.
                Some(text) if text != last => {
                    text.clone_into(last);
                    (&*channel, self.message.sentence(log_ns, text))
                }
                _ => return,
            },
            Kind::Unknown(_) => return,
        };
        self.messages += 1;
        self.visit.message(channel, &Message { log_ns, data });
    }
}

/// The sentence in a position packet of Velodyne (512 bytes). Source: VLP-16 user manual (63-9243), chapter 9, position packet.
fn sentence(data: &[u8]) -> Option<&str> {
    let text = data.get(206..).filter(|_| data.len() == 512)?;
    let end = text.iter().position(|byte| !byte.is_ascii_graphic())?;
    let text = std::str::from_utf8(text.get(..end)?).ok()?;
    (text.starts_with('$') && text.contains('*')).then_some(text)
}
