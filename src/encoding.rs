//! Texts as files have them: the mark that may stand before UTF-8, and encodings that are not read.

use std::path::Path;

/// The mark before a text in UTF-8 (RFC 3629, section 6).
const MARK: &[u8] = b"\xef\xbb\xbf";
/// Characters of ASCII at the beginning that tell UTF-16 without a mark.
const TELLING: usize = 4;

/// The bytes of a file of text, or that begins with text, without a mark.
///
/// # Errors
/// A file in UTF-16 or UTF-32: what is wrong with it, and what helps.
pub fn unmarked(path: &Path, mut data: Vec<u8>) -> Result<Vec<u8>, (String, String)> {
    if let Some(wide) = wide(&data) {
        let what = format!("is in {wide}, as some editors and PowerShell write it");
        let name = path.file_name().unwrap_or_default().display();
        return Err((what, format!("save it as UTF-8, or: iconv -f {wide} -t UTF-8 '{name}' > NEW")));
    }
    if data.starts_with(MARK) {
        data.drain(..MARK.len());
    }
    Ok(data)
}

/// The encoding of wide characters that data begins in, by its mark or by the zeros of ASCII in it.
fn wide(data: &[u8]) -> Option<&'static str> {
    if data.starts_with(b"\xff\xfe\0\0") || data.starts_with(b"\0\0\xfe\xff") {
        return Some("UTF-32");
    }
    if data.starts_with(b"\xff\xfe") || data.starts_with(b"\xfe\xff") {
        return Some("UTF-16");
    }
    let (pairs, _) = data.get(..2 * TELLING)?.as_chunks::<2>();
    let is_ascii = |byte: u8| byte != 0 && byte.is_ascii();
    if pairs.iter().all(|&[low, high]| is_ascii(low) && high == 0) {
        return Some("UTF-16LE");
    }
    pairs.iter().all(|&[high, low]| is_ascii(low) && high == 0).then_some("UTF-16BE")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_left_out_and_wide_characters_named() {
        let read = |data: &[u8]| unmarked(Path::new("a/deck.inp"), data.to_vec());
        assert_eq!(read(b"\xef\xbb\xbf*NODE").unwrap(), b"*NODE");
        assert_eq!(read(b"*NODE").unwrap(), b"*NODE");
        assert_eq!(read(b"").unwrap(), b"");
        let text = "*NODE\r\n1, 0.5";
        let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        for (data, name) in [
            ([b"\xff\xfe", &little[..]].concat(), "UTF-16"),
            ([b"\xfe\xff", &big[..]].concat(), "UTF-16"),
            (little, "UTF-16LE"),
            (big, "UTF-16BE"),
            (b"\xff\xfe\0\0*\0\0\0".to_vec(), "UTF-32"),
        ] {
            let (what, help) = read(&data).unwrap_err();
            assert!(what.starts_with(&format!("is in {name}, as")), "{what}");
            assert!(help.ends_with(&format!("iconv -f {name} -t UTF-8 'deck.inp' > NEW")), "{help}");
        }
    }
}
