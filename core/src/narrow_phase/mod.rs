//! Candidates in, contacts out: where two features meet, how near, and when.
