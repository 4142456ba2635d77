//! The memory of another program.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use std::process::Child;
use std::time::Duration;
use std::{fs, thread};

/// Largest memory of a program that ends with success [kB]. The kernel stores the largest value, so the last reading
/// misses only the last moments.
pub fn largest(mut child: Child) -> u64 {
    let mut most = 0;
    let status = loop {
        let process = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let peak = process.lines().find_map(|line| line.strip_prefix("VmHWM:")?.split_whitespace().next());
        most = most.max(peak.map_or(0, |peak| peak.parse().unwrap()));
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        thread::sleep(Duration::from_millis(1));
    };
    assert!(status.success());
    most
}
