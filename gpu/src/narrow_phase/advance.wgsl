// Conservative advancement: two features advance by times in which they cannot collide. The reserve for rounding
// is twice that of the core, because divisions and roots are less exact here.

const ROUNDING: f32 = 64.0 * EPSILON;
const MOST_ADVANCES: u32 = 128u;
const CLOSE: f32 = 0.1;
const TARGET: f32 = 0.9;
// Sums of squares below this have lost digits to underflow.
const LEAST_SQUARED: f32 = 1e-31;
const LARGEST: f32 = 3.4e38;
const NEVER: f32 = 2.0;

// The time, 0 to 1, at which two features come within `separation + tolerance`; NEVER if they stay farther apart
// than `separation`. The time is never late.
fn advance(x: array<vec3<f32>, 4>, y: array<vec3<f32>, 4>, separation: f32, tolerance: f32) -> f32 {
    var begin = x;
    var end = y;
    for (var i = 0u; i < 4u; i++) {
        begin[i] = x[i] - x[0];
        end[i] = y[i] - y[0];
    }
    let reserve = ROUNDING * largest(x, y);
    var time = 0.0;
    var hit = 0.0;
    var goal = 0.0;
    let speed = fastest(begin, end);
    var now = begin;
    for (var advances = 0u; advances < MOST_ADVANCES; advances++) {
        let between = nearest(now).between;
        let distance = length(between);
        if advances == 0u {
            let gap = max(min(CLOSE * (distance - separation), tolerance), reserve);
            hit = separation + gap;
            goal = separation + TARGET * gap;
        }
        if distance <= hit {
            return time;
        }
        var next = closing(between, now, end, time, goal);
        if next < 1.0 {
            next = max(next, closing(upright(now, between), now, end, time, goal));
            next = max(next, time + (distance - goal) / speed);
        }
        if next >= 1.0 {
            return NEVER;
        }
        time = next;
        for (var i = 0u; i < 4u; i++) {
            now[i] = begin[i] + time * (end[i] - begin[i]);
        }
    }
    return time;
}

// The largest coordinate relative to the first vertex, at both ends of the step.
fn largest(x: array<vec3<f32>, 4>, y: array<vec3<f32>, 4>) -> f32 {
    var most = vec3<f32>(0.0);
    for (var i = 1u; i < 4u; i++) {
        most = max(most, max(abs(x[i] - x[0]), abs(y[i] - y[0])));
    }
    return max(max(most.x, most.y), most.z);
}

// Whether all coordinates are numbers below 2^29, so that fourth powers of their differences do not overflow. The
// bits are compared, because compilers may assume that no value is infinite or NaN.
fn are_moderate(x: array<vec3<f32>, 4>) -> bool {
    var most = vec3<u32>(0u);
    for (var i = 0u; i < 4u; i++) {
        most = max(most, bitcast<vec3<u32>>(x[i]) & vec3<u32>(0x7fffffffu));
    }
    return all(most < vec3<u32>(0x4e000000u));
}

// The earliest time at which the slab between the features, perpendicular to the direction, is as thin as the
// goal: 1 if never, `time` if it already is or if the direction is too short to tell.
fn closing(along: vec3<f32>, now: array<vec3<f32>, 4>, end: array<vec3<f32>, 4>, time: f32, goal: f32) -> f32 {
    let squared = dot(along, along);
    if !(squared >= LEAST_SQUARED) {
        return time;
    }
    let size = sqrt(squared);
    let gap = slab(along, now) / size;
    let last = slab(along, end) / size;
    if gap > goal && last >= goal {
        return 1.0;
    }
    if gap > goal {
        return time + (1.0 - time) * ((gap - goal) / (gap - last));
    }
    return time;
}

// The thickness of the slab times the length of the direction.
fn slab(along: vec3<f32>, x: array<vec3<f32>, 4>) -> f32 {
    var least = LARGEST;
    var most = -LARGEST;
    for (var i = 0u; i < 4u; i++) {
        let height = dot(along, x[i]);
        if i < FIRST {
            least = min(least, height);
        } else {
            most = max(most, height);
        }
    }
    return least - most;
}

// The direction perpendicular to the triangle, or to both edges, towards the first feature.
fn upright(x: array<vec3<f32>, 4>, between: vec3<f32>) -> vec3<f32> {
    let along = direction(x);
    return select(along, -along, dot(along, between) < 0.0);
}

// The farthest that a vertex of one feature moves relative to a vertex of the other.
fn fastest(begin: array<vec3<f32>, 4>, end: array<vec3<f32>, 4>) -> f32 {
    var moves = begin;
    for (var i = 0u; i < 4u; i++) {
        moves[i] = end[i] - begin[i];
    }
    return sqrt(approach_squared(moves));
}
