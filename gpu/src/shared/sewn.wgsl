// The vertices that each vertex is sewn to: the start of each vertex's row, then the rows.

fn joins(a: u32, b: u32) -> bool {
    if params.sewn == 0u {
        return false;
    }
    let rows = params.vertices + 1u;
    for (var k = sewn[a]; k < sewn[a + 1u]; k++) {
        if sewn[rows + k] == b {
            return true;
        }
    }
    return false;
}
