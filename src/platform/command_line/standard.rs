//! Standard streams that a parent has closed. Rust opens the null device in their place, which takes and loses everything: whether
//! they were open is known only before `main`.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Were standard input and output closed when the process started?
static CLOSED: [AtomicBool; 2] = [AtomicBool::new(false), AtomicBool::new(false)];

#[cfg(unix)]
#[used]
#[cfg_attr(target_vendor = "apple", unsafe(link_section = "__DATA,__mod_init_func"))]
#[cfg_attr(not(target_vendor = "apple"), unsafe(link_section = ".init_array"))]
static BEFORE_MAIN: extern "C" fn() = look;

#[cfg(unix)]
extern "C" fn look() {
    for (descriptor, closed) in (0..).zip(&CLOSED) {
        // SAFETY: the call reads a flag of a descriptor, open or not, and changes nothing.
        let is_open = unsafe { libc::fcntl(descriptor, libc::F_GETFD) } != -1;
        closed.store(!is_open, Ordering::Relaxed);
    }
}

/// Was standard input closed?
pub(super) fn is_input_closed() -> bool {
    CLOSED[0].load(Ordering::Relaxed)
}

/// Was standard output closed?
pub(super) fn is_output_closed() -> bool {
    CLOSED[1].load(Ordering::Relaxed)
}

/// Is a path a device name of standard output?
pub(super) fn is_output_device(path: &Path) -> bool {
    ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|name| path == Path::new(name))
}
