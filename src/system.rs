//! Facts of the machine that this runs on: Linux tells them in `/proc`, elsewhere they are unknown.

use std::fs::read_to_string;

/// Returns the memory that the system can give without swapping, in bytes.
pub fn available_memory() -> Option<u64> {
    kibibytes(&read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

/// Returns the most memory that this process has had resident so far, in bytes.
pub fn peak_memory() -> Option<u64> {
    kibibytes(&read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// Returns the number of cores and the processor's family: enough to read times by.
pub fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let cores = if cores == 1 { "1 core".into() } else { format!("{cores} cores") };
    match read_to_string("/proc/cpuinfo").ok().and_then(|text| family(&text)) {
        Some(family) => format!("{cores}, {family}"),
        None => format!("{cores}, {}", std::env::consts::ARCH),
    }
}

/// Returns the value of a line like `VmHWM:   1234 kB`, in bytes.
fn kibibytes(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.split_whitespace().next()?.parse::<u64>().ok().map(|kib| kib * 1024)
}

/// Returns maker and family of the first processor in `/proc/cpuinfo`.
fn family(text: &str) -> Option<String> {
    let value = |key: &str| {
        let line = text.lines().find(|line| line.split(':').next().is_some_and(|k| k.trim() == key))?;
        Some(line.split_once(':')?.1.trim())
    };
    let maker = match value("vendor_id")? {
        "AuthenticAMD" => "AMD",
        "GenuineIntel" => "Intel",
        other => other,
    };
    Some(format!("{maker} family {}", value("cpu family")?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_proc_are_read() {
        assert_eq!(kibibytes("VmPeak:\t 10 kB\nVmHWM:\t  2048 kB\n", "VmHWM:"), Some(2 << 20));
        assert_eq!(kibibytes("", "VmHWM:"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_process_has_some_memory() {
        assert!(peak_memory().unwrap() > 1 << 20);
        assert!(available_memory().unwrap() > 1 << 20);
    }

    #[test]
    fn the_family_is_read() {
        let text = "processor\t: 0\nvendor_id\t: AuthenticAMD\ncpu family\t: 25\nmodel\t\t: 1\n";
        assert_eq!(family(text).as_deref(), Some("AMD family 25"));
        assert_eq!(family("Hardware : something\n"), None);
        assert!(machine().contains("core"));
    }
}
