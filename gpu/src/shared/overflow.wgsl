// Whether a stage before had too little room: what later ones found would mean nothing.

fn overflowed(room: u32) -> bool {
    return (counters[STATUS] & room) != 0u;
}
