//! The bytes that a glTF file names: in the file itself, in its text, or in a file beside it.

use super::document::Buffer;
use crate::mesh_file::{LARGEST_FILE, ParseError, shortened};

/// Reads a file beside the glTF file, by its relative name.
pub type ReadBeside<'a> = &'a dyn Fn(&str) -> Result<Vec<u8>, String>;

/// The bytes of all buffers. `chunk` is the binary part of a GLB file.
pub(super) fn read_buffers(
    buffers: &[Buffer],
    chunk: Option<&[u8]>,
    beside: ReadBeside<'_>,
) -> Result<Vec<Vec<u8>>, ParseError> {
    let mut read = Vec::new();
    let mut total = 0;
    for (i, buffer) in buffers.iter().enumerate() {
        let fail = |message: String| ParseError::new(format!("buffers[{i}]"), message);
        let bytes = match &buffer.uri {
            None if i == 0 => chunk.map(<[u8]>::to_vec).ok_or_else(|| {
                fail("has no uri, and the file has no binary part: it is cut; export it again".to_owned())
            })?,
            None => return Err(fail("has no uri; export the file again".to_owned())),
            Some(uri) => bytes_of(uri, beside).map_err(fail)?,
        };
        if (bytes.len() as u64) < buffer.byte_length {
            let message = format!(
                "has {} bytes instead of {}: it is cut; export it again",
                bytes.len(),
                buffer.byte_length
            );
            return Err(fail(message));
        }
        // Many names of one file are as many copies of it.
        total += bytes.len() as u64;
        if total > LARGEST_FILE {
            return Err(fail("takes all buffers together above 1 GiB; simplify the mesh".to_owned()));
        }
        read.push(bytes);
    }
    Ok(read)
}

fn bytes_of(uri: &str, beside: ReadBeside<'_>) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (kind, text) = data.split_once(',').ok_or("its data URI has no comma")?;
        if !kind.ends_with(";base64") {
            return Err(format!("its data URI is of kind \"{}\", not base64", shortened(kind)));
        }
        return from_base64(text.as_bytes());
    }
    let name = without_percents(uri)?;
    // A file says what is beside it, not what is elsewhere on this machine or on the network.
    let elsewhere = name.contains(':') || name.starts_with(['/', '\\']);
    if elsewhere || name.split(['/', '\\']).any(|part| part == "..") {
        return Err(format!(
            "\"{}\" is not in the folder of the file; put it there and name it without a path",
            shortened(&name)
        ));
    }
    beside(&name).map_err(|why| format!("\"{}\" cannot be read: {why}", shortened(&name)))
}

/// `a%20b` to `a b`.
fn without_percents(uri: &str) -> Result<String, String> {
    let mut parts = uri.split('%');
    let mut bytes = parts.next().unwrap_or_default().as_bytes().to_vec();
    for part in parts {
        let digits = part.get(..2).and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(digits.ok_or_else(|| format!("\"{}\" has a % without two digits", shortened(uri)))?);
        bytes.extend(&part.as_bytes()[2..]);
    }
    String::from_utf8(bytes).map_err(|_| format!("\"{}\" is no text", shortened(uri)))
}

/// RFC 4648, section 4; white space is skipped and the padding may be missing.
fn from_base64(text: &[u8]) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0_u32, 0);
    for &c in text.iter().filter(|c| !c.is_ascii_whitespace() && **c != b'=') {
        let digit = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return Err(format!("its data URI has a byte {c}, which is not base64")),
        };
        // The oldest bits leave at the top.
        bits = bits << 6 | u32::from(digit);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_and_percents_as_the_rfcs_say() {
        // RFC 4648, section 10.
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg", "foob"),
            ("Zm9vYmE=\n", "fooba"),
        ] {
            assert_eq!(from_base64(text.as_bytes()).unwrap(), bytes.as_bytes());
        }
        assert!(from_base64(b"Zm9v-").is_err());
        assert_eq!(without_percents("a%20b%c3%bc.bin").unwrap(), "a bü.bin");
        for bad in ["%", "%4", "%zz", "a%ff", "%é"] {
            assert!(without_percents(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn nothing_outside_the_folder_is_read() {
        let read = |_: &str| Ok(vec![1]);
        for uri in ["/etc/x", "../x", "a/../../x", "a\\..\\x", "http://x/y", "file:x", "C:x", "%2e%2e/x"] {
            assert!(bytes_of(uri, &read).unwrap_err().contains("folder"), "{uri}");
        }
        assert_eq!(bytes_of("parts/a..b.bin", &read).unwrap(), [1]);
    }
}
