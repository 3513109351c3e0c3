//! Suggestions for unknown names. The browser host shares this file.

/// The expected name in a parser's message that is most similar to the unknown name in it.
pub fn known(message: &str) -> Option<&str> {
    let mut quoted = message.strip_prefix("unknown")?.split('`').skip(1).step_by(2);
    nearest(quoted.next()?, quoted)
}

/// The most similar of the known names; `None` if all differ too much.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    known
        .map(|candidate| (strsim::jaro_winkler(name, candidate), candidate))
        .filter(|(similarity, _)| *similarity > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}
