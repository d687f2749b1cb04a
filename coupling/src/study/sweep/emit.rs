//! Scripts that start the rows of a sweep on engines that people have.
//!
//! Every script names single rows, which are run once whoever starts them, so that a script may be given twice, and to two
//! engines.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

/// What a script says of the rows that it starts.
#[derive(Clone, Debug)]
pub struct Rows<'a> {
    /// Name of the job.
    pub name: &'a str,
    /// Command line up to the number of the row, word by word.
    pub command: &'a [String],
    /// Folder of all runs.
    pub runs: &'a Path,
    /// Rows that have not ended, in increasing order.
    pub numbers: &'a [usize],
    /// Wall time that a row may take.
    pub wall_time: Duration,
    /// Source of it.
    pub wall_time_source: &'a str,
    /// Memory of the largest row; bytes.
    pub memory: u64,
    /// Threads of a row.
    pub threads: usize,
}

/// Time before the end of a job at which Slurm asks for a checkpoint; s.
const SIGNAL: u64 = 120;
/// Share of the time of a job after which a run stops by itself.
const WALL_LIMIT_SHARE: f64 = 0.95;

/// A command line a row, for GNU parallel, Snakemake or a shell.
pub fn list(rows: &Rows) -> String {
    let command = quoted(rows.command);
    let line = |number: &usize| format!("{command} --row {number}\n");
    rows.numbers.iter().map(line).collect()
}

/// Job array of Slurm: a checkpoint before its time is over, and then it is put back into the queue to go on.
pub fn slurm(rows: &Rows) -> String {
    let megabytes = rows.memory.div_ceil(1_000_000);
    let seconds = rows.wall_time.as_secs();
    let own_limit = (WALL_LIMIT_SHARE * seconds as f64) as u64;
    format!(
        "#!/bin/bash\n\
         # {n} rows of {name}, made by riprap sweep --emit slurm. Submit with sbatch; again after failures of nodes: rows that have\n\
         # ended are not repeated, others go on from their checkpoints. Time: {source}.\n\
         # Sites limit the size of arrays (scontrol show config | grep MaxArraySize): submit parts with sbatch --array=1-1000.\n\
         #SBATCH --job-name={name}\n\
         #SBATCH --array={array}\n\
         #SBATCH --ntasks=1\n\
         #SBATCH --cpus-per-task={threads}\n\
         #SBATCH --mem={megabytes}M\n\
         #SBATCH --time={time}\n\
         #SBATCH --signal=B:USR1@{SIGNAL}\n\
         #SBATCH --requeue\n\
         #SBATCH --open-mode=append\n\
         #SBATCH --output={log}\n\
         \n\
         {command} --row \"$SLURM_ARRAY_TASK_ID\" --wall-limit {own_limit} &\n\
         run=$!\n\
         trap 'kill -USR1 $run' USR1\n\
         trap 'kill -TERM $run' TERM\n\
         # a signal ends the waiting, not the run\n\
         while wait $run; status=$?; kill -0 $run 2>/dev/null; do :; done\n\
         if [ $status = 4 ]; then\n\
         \x20   scontrol requeue \"${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}\"\n\
         fi\n\
         exit $status\n",
        n = rows.numbers.len(),
        name = one_word(rows.name),
        source = rows.wall_time_source,
        array = ranges(rows.numbers),
        threads = rows.threads,
        time = clock(seconds),
        log = quoted(&[rows.runs.join("slurm-%a.log").display().to_string()]),
        command = quoted(rows.command),
    )
}

/// Job file of HyperQueue: a task a row, with the time that it needs, so that many fit one allocation.
pub fn hyperqueue(rows: &Rows) -> String {
    let mut text = format!(
        "# {n} rows of {name}, made by riprap sweep --emit hq. Submit with hq job submit-file FILE. Time: {source}.\n\
         name = {quoted_name}\n",
        n = rows.numbers.len(),
        name = one_word(rows.name),
        source = rows.wall_time_source,
        quoted_name = toml(rows.name),
    );
    for number in rows.numbers {
        let row = ["--row".to_owned(), number.to_string()];
        let words: Vec<String> = rows
            .command
            .iter()
            .chain(&row)
            .map(|word| toml(word))
            .collect();
        let log = |end: &str| {
            toml(
                &rows
                    .runs
                    .join(format!("hq-{number}.{end}"))
                    .display()
                    .to_string(),
            )
        };
        let _ = write!(
            text,
            "\n[[task]]\nid = {number}\ncommand = [{words}]\nstdout = {out}\nstderr = {err}\n\
             \n[[task.request]]\nresources = {{ \"cpus\" = {threads} }}\ntime_request = \"{seconds}s\"\n",
            words = words.join(", "),
            out = log("out"),
            err = log("err"),
            threads = rows.threads,
            seconds = rows.wall_time.as_secs(),
        );
    }
    text
}

/// Rows as `1-3,7`.
fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let range = |run: &[usize]| match run {
        [one] => one.to_string(),
        [first, .., last] => format!("{first}-{last}"),
        [] => String::new(),
    };
    runs.map(range).collect::<Vec<_>>().join(",")
}

/// Time as `hours:minutes:seconds`.
fn clock(seconds: u64) -> String {
    format!(
        "{:02}:{:02}:{:02}",
        seconds / 3600,
        seconds / 60 % 60,
        seconds % 60
    )
}

/// Words as a shell reads them.
fn quoted(words: &[String]) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,%+@".contains(c);
    let quoted = |word: &String| match !word.is_empty() && word.chars().all(plain) {
        true => word.clone(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    };
    words.iter().map(quoted).collect::<Vec<_>>().join(" ")
}

/// A string of TOML.
fn toml(word: &str) -> String {
    format!("\"{}\"", word.replace('\\', "\\\\").replace('"', "\\\""))
}

/// A name without blanks, as directives take it.
fn one_word(name: &str) -> String {
    name.chars()
        .map(|c| if c.is_whitespace() { '_' } else { c })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows<'a>(command: &'a [String], numbers: &'a [usize]) -> Rows<'a> {
        Rows {
            name: "a sweep",
            command,
            runs: Path::new("/runs/a b"),
            numbers,
            wall_time: Duration::from_secs(5400),
            wall_time_source: "given",
            memory: 123_456_789,
            threads: 2,
        }
    }

    #[test]
    fn scripts_say_what_they_were_asked() {
        let command = ["/bin/riprap", "sweep", "it's.ron"].map(str::to_owned);
        let numbers = [1, 2, 3, 7, 9, 10];
        let rows = rows(&command, &numbers);
        let script = slurm(&rows);
        for line in [
            "#SBATCH --job-name=a_sweep\n",
            "#SBATCH --array=1-3,7,9-10\n",
            "#SBATCH --time=01:30:00\n",
            "#SBATCH --mem=124M\n",
            "#SBATCH --cpus-per-task=2\n",
            "/bin/riprap sweep 'it'\\''s.ron' --row \"$SLURM_ARRAY_TASK_ID\" --wall-limit 5130 &\n",
        ] {
            assert!(script.contains(line), "{line}{script}");
        }
        let file = hyperqueue(&rows);
        assert_eq!(file.matches("[[task]]").count(), 6);
        assert!(
            file.contains(
                "command = [\"/bin/riprap\", \"sweep\", \"it's.ron\", \"--row\", \"7\"]\n"
            )
        );
        assert!(list(&rows).ends_with("/bin/riprap sweep 'it'\\''s.ron' --row 10\n"));
    }
}
