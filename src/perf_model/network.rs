//! Networks: latency, time per byte and overhead of messages, and a few typical networks.

use serde::{Deserialize, Serialize};

/// Cost of messages between ranks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Network {
    /// Name of the network.
    pub name: String,
    /// Source of the numbers.
    pub source: String,
    /// L: time from the end of a send to the arrival of the message \[s\].
    pub latency: f64,
    /// G: time per byte \[s/B\].
    pub seconds_per_byte: f64,
    /// 2 o: overhead of a message for its sender and its receiver together \[s\].
    pub overhead: f64,
    /// Cost of an exchange besides its messages \[s\].
    pub call: f64,
    /// Time per level of the reduction tree over all ranks \[s\].
    pub reduction_level: f64,
    /// Whether it was measured on the machine of the file.
    pub measured: bool,
}

/// The network on the command line cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum NetworkError {
    /// Unknown name.
    #[error("--network {0:?}: not known; allowed: measured, {names}, or LATENCY,BANDWIDTH such as 1.3e-6,25e9 [s, B/s]", names = names())]
    Unknown(String),
    /// Invalid numbers.
    #[error(
        "--network {0:?}: not two numbers above 0; allowed: LATENCY,BANDWIDTH such as 1.3e-6,25e9 [s, B/s], latency at most 1 s"
    )]
    Numbers(String),
}

/// Name, latency \[s\], bandwidth \[B/s\] and source of typical networks. Latencies are half round
/// trips of small MPI messages, bandwidths are those of large ones. Real values depend on the
/// switches and on other traffic.
pub const NETWORKS: [(&str, f64, f64, &str); 5] = [
    ("shared-memory", 0.5e-6, 8e9, "MPI between cores of a node, typical of copies through memory"),
    ("hdr", 1.2e-6, 24e9, "InfiniBand HDR, 200 Gb/s a port; MPI latency typically 1.0 to 1.3 us"),
    ("slingshot11", 2.0e-6, 24e9, "HPE Slingshot 11, 200 Gb/s a port; MPI latency typically 2 us"),
    ("25gbe", 5.0e-6, 2.9e9, "Ethernet of 25 Gb/s with RoCE or kernel bypass, typical"),
    ("25gbe-tcp", 20e-6, 2.5e9, "Ethernet of 25 Gb/s with TCP through the kernel, typical"),
];

fn names() -> String {
    NETWORKS.map(|n| n.0).join(", ")
}

impl Network {
    /// Default without a measurement: messages through the memory of a node.
    pub fn assumed() -> Self {
        let (name, latency, bandwidth, source) = NETWORKS[0];
        Network {
            name: name.into(),
            source: format!("not measured: {source}"),
            latency,
            seconds_per_byte: 1.0 / bandwidth,
            overhead: 0.6e-6,
            call: 0.2e-6,
            reduction_level: 1.5e-6,
            measured: false,
        }
    }

    /// The network given by name, or as `LATENCY,BANDWIDTH` in s and B/s. The processor costs of a
    /// message are those of `own`, the network of the machine. The time per level of a reduction
    /// increases by the difference of the latencies.
    ///
    /// # Errors
    ///
    /// If the name is unknown, or if a number is out of range.
    pub fn parse(text: &str, own: &Network) -> Result<Network, NetworkError> {
        if text == "measured" {
            return Ok(own.clone());
        }
        if let Some(&(name, latency, bandwidth, source)) = NETWORKS.iter().find(|n| n.0 == text) {
            return Ok(own.with(name, source, latency, bandwidth));
        }
        let Some((latency, bandwidth)) = text.split_once(',') else {
            return Err(NetworkError::Unknown(text.into()));
        };
        match (latency.trim().parse::<f64>(), bandwidth.trim().parse::<f64>()) {
            (Ok(l), Ok(b)) if l > 0.0 && l <= 1.0 && b > 0.0 && b.is_finite() => {
                Ok(own.with("given", "given on the command line", l, b))
            }
            _ => Err(NetworkError::Numbers(text.into())),
        }
    }

    fn with(&self, name: &str, source: &str, latency: f64, bandwidth: f64) -> Network {
        Network {
            name: name.into(),
            source: source.into(),
            latency,
            seconds_per_byte: 1.0 / bandwidth,
            reduction_level: (self.reduction_level + latency - self.latency)
                .max(latency + self.overhead),
            measured: false,
            ..self.clone()
        }
    }

    /// Time of a reduction over `ranks` in a binary tree \[s\].
    pub fn reduction(&self, ranks: usize) -> f64 {
        let levels = usize::BITS - ranks.saturating_sub(1).leading_zeros();
        self.reduction_level * f64::from(levels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_are_read() {
        let own = Network::assumed();
        assert_eq!(Network::parse("measured", &own).unwrap(), own);
        let hdr = Network::parse("hdr", &own).unwrap();
        assert_eq!((hdr.latency, hdr.overhead, hdr.measured), (1.2e-6, own.overhead, false));
        let given = Network::parse("2e-6, 1e9", &own).unwrap();
        assert_eq!((given.latency, given.seconds_per_byte), (2e-6, 1e-9));
        assert!(given.reduction_level > own.reduction_level);
        for (text, said) in [
            ("infiniband", "allowed: measured, shared-memory, hdr"),
            ("1e-6,0", "not two numbers above 0"),
            ("-1,1e9", "not two numbers above 0"),
            ("NaN,1e9", "not two numbers above 0"),
            ("1e-6,inf", "not two numbers above 0"),
            ("1e-6,1e9,3", "not two numbers above 0"),
        ] {
            let error = Network::parse(text, &own).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn a_reduction_takes_a_level_for_each_doubling() {
        let own = Network { reduction_level: 1.0, ..Network::assumed() };
        let levels = [1, 2, 3, 4, 5, 1024, 1025].map(|ranks| own.reduction(ranks));
        assert_eq!(levels, [0.0, 1.0, 2.0, 2.0, 3.0, 10.0, 11.0]);
    }
}
