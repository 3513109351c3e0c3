// Whether an earlier stage set one of the given status bits because a capacity was too small. Results of later
// stages would then be meaningless.

fn overflowed(room: u32) -> bool {
    return (counters[STATUS] & room) != 0u;
}
