//! Cooked scenes and snapshots with other numbers in them and a right checksum.

/// The sum that cooked scenes and snapshots hold.
pub fn checksum(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks::<8>();
    let all = words.iter().map(|&word| u64::from_le_bytes(word)).chain(rest.iter().map(|&byte| byte.into()));
    all.fold(0xcbf2_9ce4_8422_2325, |sum: u64, word| {
        let product = (sum ^ word).wrapping_mul(0x0000_0100_0000_01b3);
        product ^ product >> 32
    })
}

/// Gives a cooked scene the checksum and the length of its bytes.
pub fn mend(block: &mut [u8]) {
    let length = block.len() as u64;
    if let Some((head, columns)) = block.split_at_mut_checked(64) {
        head[16..24].copy_from_slice(&length.to_le_bytes());
        head[32..40].fill(0);
        let sum = checksum(columns) ^ checksum(head);
        head[32..40].copy_from_slice(&sum.to_le_bytes());
    }
}

/// Gives a snapshot the checksum of its bytes.
pub fn mend_snapshot(bytes: &mut [u8]) {
    let (sum, rest) = bytes.split_at_mut(8);
    sum.copy_from_slice(&checksum(rest).to_le_bytes());
}
