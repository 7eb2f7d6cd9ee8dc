//! How deep the schema of a Parquet file goes and how long its lists are, found before the library builds the one by recursion and goes
//! through the others.

/// Groups within each other that are read; an outline has three.
const DEEPEST: usize = 32;

/// Structs within each other in the table of contents.
const DEEPEST_STRUCT: usize = 16;

/// Refuses a table of contents (`FileMetaData` in the compact protocol of Thrift) whose schema has groups within each other without
/// end, or that has lists of more elements than there are bytes. What else is wrong with it the library tells.
///
/// # Errors
/// What is wrong.
pub(crate) fn check_depth(footer: &[u8]) -> Result<(), &'static str> {
    const CUT: &str = "the table of contents is cut short or damaged";
    let mut walk = Walk { rest: footer };
    let mut id = 0;
    while let Some((field, kind)) = walk.field(&mut id).ok_or(CUT)? {
        if (field, kind) != (2, LIST) {
            walk.skip(kind, DEEPEST_STRUCT).ok_or(CUT)?;
        } else if !walk.schema().ok_or(CUT)? {
            return Err("the schema goes too deep");
        }
    }
    Ok(())
}

// Types of the protocol.
const TRUE: u8 = 1;
const FALSE: u8 = 2;
const BYTE: u8 = 3;
const I16: u8 = 4;
const I32: u8 = 5;
const I64: u8 = 6;
const DOUBLE: u8 = 7;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const SET: u8 = 10;
const STRUCT: u8 = 12;

/// Goes through bytes; `None` where they end too soon or are no such protocol.
struct Walk<'a> {
    rest: &'a [u8],
}

impl Walk<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(*first)
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    /// The next field of a struct: its number and type; nothing at the end of the struct.
    #[expect(clippy::option_option, reason = "the end of the bytes is not the end of the struct")]
    fn field(&mut self, id: &mut i64) -> Option<Option<(i64, u8)>> {
        let head = self.byte()?;
        if head == 0 {
            return Some(None);
        }
        *id = match head >> 4 {
            0 => zigzag(self.varint()?),
            step => *id + i64::from(step),
        };
        Some(Some((*id, head & 0x0f)))
    }

    /// Number and type of the elements of a list.
    fn list(&mut self) -> Option<(u64, u8)> {
        let head = self.byte()?;
        let count = match head >> 4 {
            15 => self.varint()?,
            count => u64::from(count),
        };
        let kind = head & 0x0f;
        // An element has a byte at least. Lists of truth values are in no table of contents, and the library counts through those that it
        // does not know without reading a byte: a few bytes could keep it busy for minutes.
        let is_there = count <= self.rest.len() as u64 && !matches!(kind, TRUE | FALSE);
        is_there.then_some((count, kind))
    }

    fn skip(&mut self, kind: u8, depth: usize) -> Option<()> {
        let depth = depth.checked_sub(1)?;
        match kind {
            TRUE | FALSE => {}
            BYTE => drop(self.byte()?),
            I16 | I32 | I64 => drop(self.varint()?),
            DOUBLE => self.rest = self.rest.get(8..)?,
            BINARY => {
                let length = usize::try_from(self.varint()?).ok()?;
                self.rest = self.rest.get(length..)?;
            }
            LIST | SET => {
                let (count, kind) = self.list()?;
                for _ in 0..count {
                    self.skip(kind, depth)?;
                }
            }
            STRUCT => {
                let mut id = 0;
                while let Some((_, kind)) = self.field(&mut id)? {
                    self.skip(kind, depth)?;
                }
            }
            _ => return None,
        }
        Some(())
    }

    /// Whether no group of the schema, a list of elements depth first, lies in too many others.
    fn schema(&mut self) -> Option<bool> {
        let (count, _) = self.list()?;
        // Elements that are still to come of each open group.
        let mut open: Vec<u64> = Vec::new();
        for _ in 0..count {
            let (mut id, mut children) = (0, 0);
            while let Some((field, kind)) = self.field(&mut id)? {
                match (field, kind) {
                    (5, I32) => children = u64::try_from(zigzag(self.varint()?)).unwrap_or(0),
                    _ => self.skip(kind, DEEPEST_STRUCT)?,
                }
            }
            // Groups whose last element has come to its end.
            while open.last() == Some(&0) {
                open.pop();
            }
            if let Some(left) = open.last_mut() {
                *left -= 1;
            }
            if children > 0 {
                open.push(children);
            }
            if open.len() > DEEPEST {
                return Some(false);
            }
        }
        Some(true)
    }
}

/// A signed number.
fn zigzag(value: u64) -> i64 {
    (value >> 1) as i64 ^ -((value & 1) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Version 1, a schema of one element without a field, and what follows.
    fn footer(rest: &[u8]) -> Vec<u8> {
        [&[0x15, 0x02, 0x19, 0x1c, 0x00], rest].concat()
    }

    #[test]
    fn lists_with_more_elements_than_bytes_are_refused_wherever_they_stand() {
        assert_eq!(check_depth(&footer(&[0x00])), Ok(()));
        // An unknown list of two bytes, then the end.
        assert_eq!(check_depth(&footer(&[0xc9, 0x23, 7, 8, 0x00])), Ok(()));
        // Of two billion bytes, and of two billion truth values, which take none.
        for kind in [0xf3, 0xf1, 0xf2] {
            assert!(check_depth(&footer(&[0xc9, kind, 0xff, 0xff, 0xff, 0xff, 0x07, 0x00])).is_err(), "{kind:x}");
        }
    }
}
