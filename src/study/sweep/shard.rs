//! A subset of the cases, for one of several machines.

use std::str::FromStr;

use crate::error::InputError;
use crate::input::Checked;

/// Part `index` (from 1) of `count` parts: every case whose number has the remainder index - 1 when divided by count. A shard with an invalid index
/// is refused by [`super::run`], and has no cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Number of the shard, from 1 to `count`.
    pub index: usize,
    /// Number of shards, at least `index`.
    pub count: usize,
}

impl Shard {
    /// Shard of all cases.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Returns whether a case (from 0) belongs to the shard.
    pub fn has(self, case: usize) -> bool {
        case.checked_rem(self.count).is_some_and(|rest| rest + 1 == self.index)
    }

    /// Checks that the index is between 1 and the count.
    pub(super) fn check(self) -> Checked {
        if (1..=self.count).contains(&self.index) {
            return Ok(());
        }
        let error = InputError::new(format!("there is no shard {} of {}", self.index, self.count)).key("shard");
        Err(error.allowed("1 <= index <= count").help("number the shards from 1"))
    }

    /// Returns the folder of the shard's rows inside that of the sweep, or `None` for all cases.
    pub fn folder(self) -> Option<String> {
        (self.count > 1).then(|| format!("shard-{}-of-{}", self.index, self.count))
    }

    /// Determines the shard of this process from environment variables, and returns it with their names. The process may be a task of a Slurm job
    /// array, one of several processes of MPI or of a Slurm step, or one of several processes of a task of a job array.
    ///
    /// # Errors
    /// A sentence, if the tasks of a job array are not evenly numbered.
    pub fn of_environment(variable: impl Fn(&str) -> Option<String>) -> Result<Option<(Self, String)>, String> {
        let number = |name: &str| variable(name)?.trim().parse::<usize>().ok();
        let process = PROCESS.iter().find_map(|&[rank, size]| Some((number(rank)?, number(size)?, rank)));
        let parts = [array_task(&number)?, process.filter(|(_, count, _)| *count > 1)];
        let known: Vec<_> = parts.into_iter().flatten().collect();
        let (index, count) =
            known.iter().fold((0, 1), |(index, count), part| (index * part.1 + part.0, count * part.1));
        let names: Vec<&str> = known.iter().map(|part| part.2).collect();
        Ok((count > 1 && index < count).then(|| (Self { index: index + 1, count }, names.join(" and "))))
    }
}

/// Variables with the rank of a process (from 0) and the number of processes. `SLURM_PROCID` is used with the number of tasks of the step, because a
/// batch script outside a step has a `SLURM_PROCID`, too.
const PROCESS: [[&str; 2]; 3] = [
    ["OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"],
    ["PMI_RANK", "PMI_SIZE"],
    ["SLURM_PROCID", "SLURM_STEP_NUM_TASKS"],
];

/// Returns the position of the task in a Slurm job array (from 0), the number of tasks and the name of the variable, or `None` without an array.
fn array_task(number: &dyn Fn(&str) -> Option<usize>) -> Result<Option<(usize, usize, &'static str)>, String> {
    const ID: &str = "SLURM_ARRAY_TASK_ID";
    let (Some(id), Some(count)) = (number(ID), number("SLURM_ARRAY_TASK_COUNT")) else { return Ok(None) };
    let [first, last, step] = [("MIN", 0), ("MAX", id), ("STEP", 1)]
        .map(|(name, default)| number(&format!("SLURM_ARRAY_TASK_{name}")).unwrap_or(default));
    let step = step.max(1);
    let even = (first..=last).contains(&id) && (last - first) / step < count;
    if count > 1 && !even {
        return Err(format!("the {count} tasks of the job array, from {first} to {last}, are not evenly numbered"));
    }
    Ok((count > 1).then_some(((id - first) / step, count, ID)))
}

/// Description of the format of a shard.
const AS_TEXT: &str = "write I/N with I from 1 to N, such as 2/4 for the second of four shards";

impl FromStr for Shard {
    type Err = InputError;

    /// Parses a shard such as "2/4".
    fn from_str(text: &str) -> Result<Self, InputError> {
        let parsed = text
            .split_once('/')
            .and_then(|(index, count)| Some((index.trim().parse().ok()?, count.trim().parse().ok()?)));
        match parsed.map(|(index, count)| Self { index, count }) {
            Some(shard) if shard.check().is_ok() => Ok(shard),
            _ => Err(InputError::new(AS_TEXT)),
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
        assert_eq!("2/4".parse::<Shard>().expect("right"), Shard { index: 2, count: 4 });
        for wrong in ["0/4", "5/4", "2", "a/b", "1/0"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }

    fn known(pairs: &[(&str, &str)]) -> Result<Option<(usize, usize)>, String> {
        let variable = |name: &str| pairs.iter().find(|pair| pair.0 == name).map(|pair| pair.1.to_owned());
        Shard::of_environment(variable).map(|found| found.map(|(shard, _)| (shard.index, shard.count)))
    }

    #[test]
    fn job_arrays_and_ranks_are_known() {
        let array = [
            ("SLURM_ARRAY_TASK_ID", "5"),
            ("SLURM_ARRAY_TASK_COUNT", "4"),
            ("SLURM_ARRAY_TASK_MIN", "3"),
            ("SLURM_ARRAY_TASK_MAX", "6"),
        ];
        assert_eq!(known(&array), Ok(Some((3, 4))));
        assert_eq!(known(&[("PMI_RANK", "0"), ("PMI_SIZE", "2")]), Ok(Some((1, 2))));
        assert_eq!(known(&[("SLURM_PROCID", "1"), ("SLURM_STEP_NUM_TASKS", "2")]), Ok(Some((2, 2))));
        // A batch script by itself, which is one process whatever the job asks for.
        assert_eq!(known(&[("SLURM_PROCID", "0"), ("SLURM_NTASKS", "4")]), Ok(None));
        assert_eq!(known(&[("SLURM_PROCID", "0"), ("SLURM_STEP_NUM_TASKS", "1")]), Ok(None));
        // Two processes in each task.
        let processes = [("OMPI_COMM_WORLD_RANK", "1"), ("OMPI_COMM_WORLD_SIZE", "2")];
        assert_eq!(known(&[array.as_slice(), &processes].concat()), Ok(Some((6, 8))));
    }

    #[test]
    fn tasks_are_counted_in_their_steps() {
        let task = |id, count, max, step| {
            known(&[
                ("SLURM_ARRAY_TASK_ID", id),
                ("SLURM_ARRAY_TASK_COUNT", count),
                ("SLURM_ARRAY_TASK_MIN", "1"),
                ("SLURM_ARRAY_TASK_MAX", max),
                ("SLURM_ARRAY_TASK_STEP", step),
            ])
        };
        assert_eq!(task("7", "4", "7", "2"), Ok(Some((4, 4))));
        // --array=1,3,7 has no step; --array=3 alone is all of it.
        assert!(task("7", "3", "7", "1").is_err_and(|message| message.contains("from 1 to 7")));
        assert_eq!(task("3", "1", "3", "1"), Ok(None));
    }
}
