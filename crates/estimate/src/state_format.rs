//! Saved states, and what stands before them: version, kind and checksum.
use serde::{Serialize, de::DeserializeOwned};

/// Bytes before the state: version, kind and checksum.
const HEADER: usize = 16;

/// Why bytes are no saved state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// Fewer bytes than the header has.
    #[error("{found} byte(s) are no saved state: at least {needed} are needed")]
    TooShort {
        /// Bytes given.
        found: usize,
        /// Bytes of the header.
        needed: usize,
    },
    /// Saved by another version of this library.
    #[error("the state has the format version {found}, this library reads version {supported}")]
    Version {
        /// Version of the bytes.
        found: u32,
        /// The version that can be read.
        supported: u32,
    },
    /// Bytes of something else.
    #[error("the bytes are not the state of a {expected}")]
    Kind {
        /// What was to be restored.
        expected: &'static str,
    },
    /// Bytes were cut off, added or changed.
    #[error("the state is damaged: its bytes do not agree with their checksum")]
    Damaged,
    /// The bytes are well-formed and describe no state.
    #[error("the state is not consistent: {part}")]
    Inconsistent {
        /// What of it.
        part: &'static str,
    },
}

/// The format of the saved states of one type. Version (4 bytes, little-endian), kind (4 bytes) and a checksum (8 bytes) stand before
/// each state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StateFormat {
    /// Another one for every change of what is saved.
    pub version: u32,
    /// What the bytes hold.
    pub kind: [u8; 4],
    /// What the bytes hold in words, for messages.
    pub name: &'static str,
}

impl StateFormat {
    /// Counters of a saved state stay below this: more frames than a camera sees in a thousand years.
    pub const MOST_COUNTED: usize = 1 << 48;

    /// Numbers of a saved state stay below this: squares of larger ones are none.
    pub const LARGEST_NUMBER: f64 = 1e100;

    /// A state as bytes with the header before them.
    ///
    /// # Errors
    /// None for states that memory holds.
    pub fn encoded(&self, state: &impl Serialize) -> Result<Vec<u8>, StateError> {
        let state = postcard::to_allocvec(state).map_err(|_| StateError::Inconsistent { part: "encoding" })?;
        Ok(self.with_header(&state))
    }

    /// The state that bytes are, header and all. Whether its parts belong together remains to be seen.
    ///
    /// # Errors
    /// Bytes of another version or kind, damaged ones, and more or other bytes than those of such a state.
    pub fn decoded<T: DeserializeOwned>(&self, bytes: &[u8]) -> Result<T, StateError> {
        match postcard::take_from_bytes(self.without_header(bytes)?) {
            Ok((state, [])) => Ok(state),
            Ok(_) => Err(StateError::Inconsistent { part: "bytes left over" }),
            Err(_) => Err(StateError::Inconsistent { part: "encoding" }),
        }
    }

    /// Puts the header before a state.
    #[must_use]
    pub fn with_header(&self, state: &[u8]) -> Vec<u8> {
        let header = self.version.to_le_bytes().into_iter().chain(self.kind).chain(checksum(state).to_le_bytes());
        header.chain(state.iter().copied()).collect()
    }

    /// The state behind the header.
    ///
    /// # Errors
    /// Bytes of another version or kind, and damaged ones.
    pub fn without_header<'a>(&self, bytes: &'a [u8]) -> Result<&'a [u8], StateError> {
        let Some((header, state)) = bytes.split_first_chunk::<HEADER>() else {
            return Err(StateError::TooShort { found: bytes.len(), needed: HEADER });
        };
        let [a, b, c, d, rest @ ..] = *header;
        let [e, f, g, h, sum @ ..] = rest;
        let found = u32::from_le_bytes([a, b, c, d]);
        if found != self.version {
            return Err(StateError::Version { found, supported: self.version });
        }
        if [e, f, g, h] != self.kind {
            return Err(StateError::Kind { expected: self.name });
        }
        if u64::from_le_bytes(sum) != checksum(state) { Err(StateError::Damaged) } else { Ok(state) }
    }
}

/// FNV-1a of 64 bits (G. Fowler, L. C. Noll, K.-P. Vo): enough against accidents, and none against malice, which the checks of the
/// state itself are for.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}
