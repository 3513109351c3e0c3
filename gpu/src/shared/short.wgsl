// Whether a stage before had too little room: what later ones found would mean nothing.

fn lacks(room: u32) -> bool {
    return (plan[STATUS] & room) != 0u;
}
