//! The machine that measured.

/// Cores and processor family, as far as the system tells: enough to read times by.
pub fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let cores = if cores == 1 { "1 core".into() } else { format!("{cores} cores") };
    match std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| family(&text)) {
        Some(family) => format!("{cores}, {family}"),
        None => format!("{cores}, {}", std::env::consts::ARCH),
    }
}

/// Maker and family of the first processor in `/proc/cpuinfo`.
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
    fn the_family_is_read() {
        let text = "processor\t: 0\nvendor_id\t: AuthenticAMD\ncpu family\t: 25\nmodel\t\t: 1\n";
        assert_eq!(family(text).as_deref(), Some("AMD family 25"));
        assert_eq!(family("Hardware : something\n"), None);
        assert!(machine().contains("core"));
    }
}
