//! `std_msgs/msg/String`.

use super::{Cdr, DecodeError};

/// The text of a string message.
pub fn data(message: &[u8]) -> Result<&str, DecodeError> {
    Cdr::new(message)?.str()
}
