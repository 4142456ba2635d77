//! Instructions of a run of this program, counted by callgrind.

use std::process::Command;

/// Instructions of a repetition: the difference of two runs of this program with `few` and with `more` repetitions,
/// with the arguments `words`.
pub fn difference(words: impl Fn(String) -> Vec<String>, few: u32, more: u32) -> Result<f64, String> {
    let difference = counted(&words(more.to_string()))?.checked_sub(counted(&words(few.to_string()))?);
    let difference = difference.ok_or("callgrind counted fewer instructions for more repetitions")?;
    Ok(difference as f64 / f64::from(more - few))
}

fn counted(words: &[String]) -> Result<u64, String> {
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(program).args(words);
    let output = valgrind.output().map_err(|e| format!("valgrind: {e}"))?;
    let report = String::from_utf8_lossy(&output.stderr);
    let count = report.lines().find_map(|line| line.split_once("Collected :")?.1.trim().parse().ok());
    count.filter(|_| output.status.success()).ok_or_else(|| format!("valgrind, {}: {report}", words.join(" ")))
}
