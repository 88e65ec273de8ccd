//! The desktop app, the page and the command line: all three start here.

fn main() {}
