//! The QoS that publishers offered for a topic, as recorded: rosbag2's `offered_qos_profiles`, YAML text.
//!
//! Owns the reading of that text. Must not know its users.

/// The durability of each profile: `1` or `transient_local`, `2` or `volatile`.
fn durabilities(profiles: &str) -> impl Iterator<Item = &str> {
    profiles
        .lines()
        .filter_map(|line| line.trim().trim_start_matches("- ").strip_prefix("durability:"))
        .map(|value| value.trim().trim_matches(['"', '\'']))
}

/// Whether a publisher offered durability `volatile`.
pub fn is_volatile(profiles: &str) -> bool {
    durabilities(profiles).any(|value| matches!(value, "2" | "volatile"))
}

/// Whether every publisher offered durability `transient_local`, and there is one.
pub fn is_transient_local(profiles: &str) -> bool {
    let mut durabilities = durabilities(profiles).peekable();
    durabilities.peek().is_some() && durabilities.all(|value| matches!(value, "1" | "transient_local"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_words_are_read_alike() {
        for (profiles, volatile, transient_local) in [
            ("- history: 1\n  durability: 1\n", false, true),
            ("- durability: \"transient_local\"\n- durability: 1\n", false, true),
            ("- durability: 2\n", true, false),
            ("- durability: volatile\n- durability: transient_local\n", true, false),
            ("", false, false),
        ] {
            assert_eq!(
                (is_volatile(profiles), is_transient_local(profiles)),
                (volatile, transient_local),
                "{profiles}"
            );
        }
    }
}
