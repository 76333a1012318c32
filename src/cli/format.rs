//! Numbers as users write them, and as users read them.

pub(super) use exocarp::internals::compare::grouped;
use std::num::NonZeroUsize;

/// A positive voxel size in model units.
pub(super) fn voxel(text: &str) -> Result<f64, String> {
    match finite(text)? {
        h if h > 0.0 => Ok(h),
        _ => Err("a voxel size is positive".into()),
    }
}

/// A number of threads. Far more of them than cores are busy with one another: 1024 on two cores
/// take twenty times as long as two, and 4096 take minutes of nothing else.
pub(super) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    const MOST: usize = 512;
    let most = std::thread::available_parallelism().map_or(MOST, |cores| cores.get().max(MOST));
    let number = text.parse().ok().filter(|number: &NonZeroUsize| number.get() <= most);
    number.ok_or_else(|| format!("a number of threads is 1 to {most}"))
}

/// A positive number of voxels.
pub(super) fn resolution(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(0) => Err("a resolution is at least 1".into()),
        Ok(n) => Ok(n),
        Err(_) => Err(format!("a resolution is a whole number from 1 to {}", u32::MAX)),
    }
}

/// A number of bytes, also with K, M, G or T (powers of 1024), `512M` or `1.5GiB`.
pub(super) fn bytes(text: &str) -> Result<u64, String> {
    let upper = text.to_ascii_uppercase();
    let short = upper.strip_suffix("IB").or(upper.strip_suffix('B')).unwrap_or(&upper);
    let (digits, power) = match short.chars().last() {
        Some('K') => (&short[..short.len() - 1], 1),
        Some('M') => (&short[..short.len() - 1], 2),
        Some('G') => (&short[..short.len() - 1], 3),
        Some('T') => (&short[..short.len() - 1], 4),
        _ => (short, 0),
    };
    match digits.parse::<f64>() {
        Ok(n) if n > 0.0 && n.is_finite() => Ok((n * 1024f64.powi(power)) as u64),
        _ => Err("a size is a positive number of bytes, or one with K, M or G, like 4G".into()),
    }
}

fn finite(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err("the number is not finite".into()),
        Err(_) => Err("this is not a number, nor one with % behind it".into()),
    }
}

/// `1 triangle`, `2 triangles`.
pub(super) fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{} {}", grouped(n as u64), if n == 1 { one } else { many })
}

/// Up to six significant digits.
pub(super) fn short(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    if !(1e-4..1e9).contains(&x.abs()) {
        return format!("{x:.5e}");
    }
    let decimals = (5 - x.abs().log10().floor() as i32).max(0) as usize;
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voxels_are_positive_and_finite() {
        assert_eq!(voxel("0.25"), Ok(0.25));
        for wrong in ["0", "-1", "nan", "inf", "x"] {
            assert!(voxel(wrong).is_err(), "{wrong}");
        }
        assert!(resolution("0").is_err() && resolution("-3").is_err() && resolution("1.5").is_err());
    }

    #[test]
    fn threads_are_a_few() {
        assert_eq!(threads("512").map(NonZeroUsize::get), Ok(512));
        for wrong in ["0", "-1", "4294967295", "18446744073709551616", "two", ""] {
            assert!(threads(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes_have_units_of_1024() {
        assert_eq!(bytes("1000"), Ok(1000));
        assert_eq!(bytes("4k"), Ok(4096));
        assert_eq!(bytes("1.5G"), Ok(3 << 29));
        assert_eq!(bytes("300MB"), Ok(300 << 20));
        assert_eq!(bytes("2GiB"), Ok(2 << 30));
        for wrong in ["", "G", "-1", "0", "4X"] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn numbers_read_well() {
        assert_eq!([grouped(7), grouped(1000), grouped(1234567)], ["7", "1,000", "1,234,567"]);
        assert_eq!([short(0.1), short(-1234.5678), short(1e-7)], ["0.1", "-1234.57", "1.00000e-7"]);
    }
}
