//! Memory that the machine can give.

/// Bytes that the machine can give, if it states them (on Linux): the available memory, at most the rest of the control
/// group; elsewhere there is no limit.
pub fn available() -> f64 {
    let free = field("/proc/meminfo", "MemAvailable:").map_or(f64::INFINITY, |kilobytes| 1024.0 * kilobytes);
    let of_group = |file: &str| number(&text(&format!("/sys/fs/cgroup/{file}"))?);
    match (of_group("memory.max"), of_group("memory.current")) {
        (Some(most), Some(taken)) => free.min((most - taken).max(0.0)),
        _ => free,
    }
}

/// A limited address space cannot be used to its last byte: the remaining pieces are too small for the requests.
const USABLE: f64 = 0.9;

/// Least number of bytes of the address space that matrix products reserve.
const PACKED_BLOCKS: f64 = (64_u32 << 20) as f64;

/// Bytes of the address space that matrix products reserve for packed blocks; they use few of these bytes. It is twice
/// the third-level caches, allocated at once inside the factorisation, which could not end cleanly without them.
fn packed_blocks() -> f64 {
    const CPUS: &str = "/sys/devices/system/cpu";
    let cache = |file: &str| text(&format!("{CPUS}/cpu0/cache/index3/{file}"));
    let kilobytes = cache("size").and_then(|size| number(size.trim().trim_end_matches('K')));
    let shared = cache("shared_cpu_list").and_then(|list| count(&list));
    let all = text(&format!("{CPUS}/present")).and_then(|list| count(&list));
    let caches = all.zip(shared).map_or(1.0, |(all, shared)| (all / shared).max(1.0));
    kilobytes.map_or(PACKED_BLOCKS, |kilobytes| PACKED_BLOCKS.max(2.0 * 1024.0 * kilobytes * caches))
}

/// The number of numbers in a list like `0-3,8`.
fn count(list: &str) -> Option<f64> {
    let of_range = |range: &str| -> Option<f64> {
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        Some(last.parse::<f64>().ok()? - first.parse::<f64>().ok()? + 1.0)
    };
    list.trim().split(',').map(of_range).sum()
}

/// Bytes of the address space that the program may take in all, itself included, if that is limited (`ulimit -v`).
///
/// The program counts the bytes that it uses; code and stacks that it only reserves are subtracted.
pub fn address_space_left() -> f64 {
    let Some(limit) = field("/proc/self/limits", "Max address space") else { return f64::INFINITY };
    let size = field("/proc/self/status", "VmSize:").map_or(0.0, |kilobytes| 1024.0 * kilobytes);
    let reserved = size - held();
    (USABLE * (limit - reserved - packed_blocks())).max(0.0)
}

/// Bytes that may be taken in all: those that are `asked` for, or else those that the machine can give, within the
/// address space.
pub fn allowed(asked: Option<f64>) -> f64 {
    asked.unwrap_or_else(available).min(address_space_left())
}

/// Bytes of memory that this process has at the moment. For the crates of this workspace.
pub fn held() -> f64 {
    field("/proc/self/status", "VmRSS:").map_or(0.0, |kilobytes| 1024.0 * kilobytes)
}

/// The number after `name` in a file of the system.
fn field(file: &str, name: &str) -> Option<f64> {
    number(text(file)?.lines().find_map(|line| line.strip_prefix(name))?)
}

fn text(file: &str) -> Option<String> {
    std::fs::read_to_string(file).ok()
}

/// The first word as a number; `unlimited` and `max` mean no limit.
fn number(words: &str) -> Option<f64> {
    words.split_whitespace().next()?.parse().ok()
}

/// A number of bytes for a reader: in MB below a thousand of them, else in GB. For the crates of this workspace.
pub fn in_words(bytes: f64) -> String {
    if bytes < 1e9 { format!("{:.0} MB", bytes / 1e6) } else { format!("{:.1} GB", bytes / 1e9) }
}
