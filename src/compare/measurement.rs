//! The measurement of one run of one method, and medians over several.

use super::Method;
use serde::{Deserialize, Serialize};

/// One run of one method: the line of JSON that its process prints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// The method.
    pub method: Method,
    /// Seconds from the mesh in memory to the offset surface in memory.
    pub engine: f64,
    /// Seconds by phase, in the order in which they ran; what they leave of `engine` has no name.
    #[serde(default)]
    pub phases: Vec<PhaseTime>,
    /// The most memory that the process had resident when the surface was complete, in bytes;
    /// `None` where the system does not tell.
    pub peak_memory: Option<u64>,
    /// Memory resident just before the method began, in bytes: program, libraries, input.
    pub memory_before: Option<u64>,
    /// Active voxels of the grid that was contoured; `None` where the method does not say.
    pub active_voxels: Option<u64>,
    /// Triangles of the offset surface.
    pub triangles: u64,
}

/// A phase of a method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhaseTime {
    /// Name of the phase.
    pub name: String,
    /// Seconds.
    pub seconds: f64,
}

impl PhaseTime {
    /// A phase.
    pub fn new(name: &str, seconds: f64) -> Self {
        PhaseTime { name: name.into(), seconds }
    }
}

impl Measurement {
    /// The measurement in what a process wrote to its standard output: the last line that is one.
    /// Libraries may have written there before.
    pub fn from_output(text: &str) -> Option<Measurement> {
        text.lines().rev().find_map(|line| serde_json::from_str(line.trim()).ok())
    }

    /// The line of JSON.
    ///
    /// # Errors
    /// Never for measurements made here; `serde_json` wants it said.
    pub fn to_line(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string(self)
    }

    /// The measurement with the median of each number; `None` without runs. Counts are those of the
    /// last run.
    pub fn median(runs: &[Measurement]) -> Option<Measurement> {
        let last = runs.last()?;
        let memory = |of: fn(&Measurement) -> Option<u64>| {
            median(runs.iter().filter_map(of).map(|bytes| bytes as f64).collect()).map(|bytes| bytes as u64)
        };
        let phases = last.phases.iter().map(|phase| {
            let all = runs.iter().flat_map(|r| &r.phases).filter(|p| p.name == phase.name);
            let seconds = median(all.map(|p| p.seconds).collect());
            PhaseTime { name: phase.name.clone(), seconds: seconds.unwrap_or(phase.seconds) }
        });
        Some(Measurement {
            engine: median(runs.iter().map(|r| r.engine).collect())?,
            phases: phases.collect(),
            peak_memory: memory(|r| r.peak_memory),
            memory_before: memory(|r| r.memory_before),
            ..last.clone()
        })
    }
}

/// The median: the mean of the two middle values of an even number; `None` of nothing.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    match n {
        0 => None,
        _ => Some(0.5 * (values[(n - 1) / 2] + values[n / 2])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(engine: f64, band: f64, memory: Option<u64>) -> Measurement {
        Measurement {
            method: Method::OpenvdbWide,
            engine,
            phases: vec![PhaseTime::new("band", band)],
            peak_memory: memory,
            memory_before: None,
            active_voxels: Some(7),
            triangles: 12,
        }
    }

    #[test]
    fn medians_are_in_the_middle() {
        assert_eq!(median(vec![]), None);
        assert_eq!(median(vec![5.0]), Some(5.0));
        assert_eq!(median(vec![9.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![9.0, 1.0, 2.0, 4.0]), Some(3.0));
    }

    #[test]
    fn each_number_has_its_own_median() {
        let runs = [run(3.0, 0.1, Some(30)), run(1.0, 0.3, Some(10)), run(2.0, 0.2, None)];
        let median = Measurement::median(&runs).unwrap();
        assert_eq!((median.engine, median.phases[0].seconds), (2.0, 0.2));
        assert_eq!((median.peak_memory, median.memory_before), (Some(20), None));
        assert_eq!(Measurement::median(&[]), None);
    }

    #[test]
    fn the_line_is_found_among_what_libraries_say() {
        let one = run(1.5, 0.5, Some(1 << 20));
        let text = format!("warning: a library\n{}\n\n", one.to_line().unwrap());
        assert!(!one.to_line().unwrap().contains('\n'));
        assert_eq!(Measurement::from_output(&text), Some(one));
        assert_eq!(Measurement::from_output("Segmentation fault\n"), None);
        assert_eq!(Measurement::from_output("{\"method\":\"exocarp\"}"), None);
    }
}
