//! Makes the text of a shader short, for the page.

/// The text without comments, indentation, empty lines and the spaces that separate nothing. WGSL has no strings, so
/// two slashes always begin a comment.
pub fn minify(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim());
    let mut small = String::new();
    for line in lines.filter(|line| !line.is_empty()) {
        let mut characters = line.chars().peekable();
        while let Some(character) = characters.next() {
            if character != ' ' || separates(small.chars().next_back(), characters.peek().copied()) {
                small.push(character);
            }
        }
        if !line.ends_with([';', '{', '}', ',']) {
            small.push('\n');
        }
    }
    small
}

/// Whether a space between two characters separates two names, or two signs that would be another operator together.
fn separates(before: Option<char>, after: Option<char>) -> bool {
    let both = |are: fn(char) -> bool| before.is_some_and(are) && after.is_some_and(are);
    both(|c| c.is_alphanumeric() || "_@".contains(c)) || both(|c| "+-&|<>=/*!".contains(c))
}
