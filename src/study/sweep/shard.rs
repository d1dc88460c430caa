//! A part of the cases, for one of several machines.

use std::str::FromStr;

/// Part `index` (from 1) of `count`: every case whose number leaves index - 1 when divided by count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub index: usize,
    /// At least `index`.
    pub count: usize,
}

impl Shard {
    /// All cases.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Whether a case (from 0) belongs to it.
    pub fn has(self, case: usize) -> bool {
        case % self.count == self.index - 1
    }

    /// The folder of its rows inside that of the sweep; none for all cases.
    pub fn folder(self) -> Option<String> {
        (self.count > 1).then(|| format!("shard-{}-of-{}", self.index, self.count))
    }

    /// What a job array of Slurm, or MPI, says of this process; and which variable said so.
    pub fn of_environment(variable: impl Fn(&str) -> Option<String>) -> Option<(Self, &'static str)> {
        let number = |name: &str| variable(name)?.trim().parse::<usize>().ok();
        let task = || {
            let (id, count) = (number("SLURM_ARRAY_TASK_ID")?, number("SLURM_ARRAY_TASK_COUNT")?);
            let (first, step) =
                (number("SLURM_ARRAY_TASK_MIN").unwrap_or(0), number("SLURM_ARRAY_TASK_STEP").unwrap_or(1));
            Some((Self { index: id.checked_sub(first)? / step.max(1) + 1, count }, "SLURM_ARRAY_TASK_ID"))
        };
        let rank =
            |rank: &'static str, size: &str| Some((Self { index: number(rank)? + 1, count: number(size)? }, rank));
        let found = task()
            .or_else(|| rank("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"))
            .or_else(|| rank("PMI_RANK", "PMI_SIZE"))
            .or_else(|| rank("SLURM_PROCID", "SLURM_NTASKS"));
        found.filter(|(shard, _)| shard.count > 1 && shard.index <= shard.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    /// From "2/4".
    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = text
            .split_once('/')
            .and_then(|(index, count)| Some((index.trim().parse().ok()?, count.trim().parse().ok()?)));
        match parsed {
            Some((index, count)) if (1..=count).contains(&index) => Ok(Self { index, count }),
            _ => Err("write I/N, such as 2/4 for the second of four shards".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_is_in_one_shard() {
        for case in 0..20 {
            assert_eq!((1..=3).filter(|&index| Shard { index, count: 3 }.has(case)).count(), 1);
        }
        assert_eq!("2/4".parse(), Ok(Shard { index: 2, count: 4 }));
        for wrong in ["0/4", "5/4", "2", "a/b", "1/0"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn job_arrays_and_ranks_are_known() {
        fn set(pairs: &[(&str, &str)]) -> Option<(Shard, &'static str)> {
            Shard::of_environment(|name| pairs.iter().find(|pair| pair.0 == name).map(|pair| pair.1.to_owned()))
        }
        let slurm = [
            ("SLURM_ARRAY_TASK_ID", "5"),
            ("SLURM_ARRAY_TASK_COUNT", "4"),
            ("SLURM_ARRAY_TASK_MIN", "3"),
            ("SLURM_PROCID", "0"),
        ];
        assert_eq!(set(&slurm).map(|found| found.0), Some(Shard { index: 3, count: 4 }));
        assert_eq!(
            set(&[("PMI_RANK", "0"), ("PMI_SIZE", "2")]).map(|found| found.0),
            Some(Shard { index: 1, count: 2 })
        );
        assert_eq!(set(&[("SLURM_PROCID", "0"), ("SLURM_NTASKS", "1")]), None);
    }
}
