//! Commands and options in the guide: `reference/command-line.md` is made from the program, and every command shown is one.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use clap::error::ErrorKind;
use clap::{Arg, ArgAction, Command};
use riprap::cli;
use riprap::scene::parse::Override;

use super::pages::{docs, pages};

/// Set to rewrite the page instead of comparing it.
const UPDATE: &str = "RIPRAP_UPDATE";

/// The page is the program's own help; `RIPRAP_UPDATE=1` writes it anew.
#[test]
fn the_page_of_commands_is_that_of_the_program() {
    let path = docs().join("reference/command-line.md");
    let made = page();
    if std::env::var_os(UPDATE).is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap();
    let line = found
        .lines()
        .zip(made.lines())
        .find(|(found, made)| found != made);
    assert!(
        found == made,
        "docs/reference/command-line.md is not that of the program, first at {line:?}; \
         `{UPDATE}=1 cargo test --test coupling guide::commands` writes it anew"
    );
}

/// Every line that starts with `riprap` in a block of a shell is a command that the program takes, and every option in back
/// ticks is one of its options.
#[test]
fn commands_in_the_guide_are_taken() {
    let options = long_options();
    let mut n_commands = 0;
    for page in pages() {
        let lines = page
            .blocks
            .iter()
            .filter(|block| block.language == "sh")
            .flat_map(|block| block.text.lines());
        for line in lines.filter(|line| line.starts_with("riprap ")) {
            n_commands += 1;
            if let Err(fault) = cli::command().try_get_matches_from(words(line)) {
                // asking for help or the version is no fault
                assert!(fault.exit_code() == 0, "{}: `{line}`: {fault}", page.name);
            }
        }
        let spans = page.code_spans();
        for span in spans
            .iter()
            .filter(|span| span.starts_with("riprap ") && !span.contains("COMMAND"))
        {
            let taken = cli::command().try_get_matches_from(words(span));
            // words of a text leave out what a command needs
            let fault = taken.err().filter(|fault| {
                let is_short = matches!(
                    fault.kind(),
                    ErrorKind::MissingRequiredArgument
                        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
                );
                fault.exit_code() != 0 && !is_short
            });
            assert!(
                fault.is_none(),
                "{}: `{span}`: {}",
                page.name,
                fault.unwrap()
            );
        }
        for span in spans {
            if let Some(option) = span.strip_prefix("--") {
                let name = option.split([' ', '=']).next().unwrap();
                assert!(
                    options.contains(name),
                    "{}: no command has `{span}`",
                    page.name
                );
            }
        }
    }
    assert!(
        n_commands > 20,
        "{n_commands} commands: the reader of the pages lost its way"
    );
}

/// Overrides that a command sets, none for other lines.
pub fn overrides(line: &str) -> Vec<Override> {
    let words = words(line);
    let values = words
        .iter()
        .zip(words.iter().skip(1))
        .filter(|(word, _)| *word == "--set");
    values
        .map(|(_, value)| value.parse().unwrap_or_else(|e| panic!("`{line}`: {e}")))
        .collect()
}

/// Whether it checks or runs a file beside the reader, such as the scene above it, rather than a case of the repository.
pub fn runs_a_file_of_the_reader(line: &str) -> bool {
    let words = words(line);
    matches!(words.get(1).map(String::as_str), Some("run" | "check"))
        && !words.iter().any(|word| word.starts_with("cases/"))
}

/// Words of a line as a shell splits them; a comment, a redirection or a pipe ends it.
fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    let (mut word, mut quote, mut is_word) = (String::new(), None, false);
    for c in line.chars() {
        match (c, quote) {
            (c, Some(q)) if c == q => quote = None,
            (c, Some(_)) => word.push(c),
            ('"' | '\'', None) => (quote, is_word) = (Some(c), true),
            ('#' | '>' | '|', None) if !is_word => break,
            (' ', None) => {
                if is_word {
                    words.push(std::mem::take(&mut word));
                }
                is_word = false;
            }
            (c, None) => {
                word.push(c);
                is_word = true;
            }
        }
    }
    if is_word {
        words.push(word);
    }
    words
}

/// Long options of all commands.
fn long_options() -> BTreeSet<String> {
    fn collect(command: &Command, found: &mut BTreeSet<String>) {
        found.extend(
            command
                .get_arguments()
                .filter_map(Arg::get_long)
                .map(str::to_owned),
        );
        command
            .get_subcommands()
            .for_each(|below| collect(below, found));
    }
    let mut found = BTreeSet::from(["help".to_owned(), "version".to_owned()]);
    collect(&cli::command(), &mut found);
    found
}

/// The page.
fn page() -> String {
    let program = cli::command();
    let mut text = String::from(
        "# Command line\n\n\
         This page is made from the program's own help, `riprap --help` and `riprap COMMAND --help`.\n\n\
         | command | purpose |\n|---|---|\n",
    );
    for command in visible(&program) {
        let name = command.get_name();
        writeln!(
            text,
            "| [`riprap {name}`](#riprap-{name}) | {} |",
            about(command)
        )
        .unwrap();
    }
    text.push_str(
        "\nEvery command has `--help`, in short `-h`; `riprap --version`, in short `-V`, prints the version.\n\n\
         Exit codes, of every command: 0 done, 1 the run failed, 2 wrong usage or scene, 4 stopped at the wall limit, 130 \
         interrupted. Ctrl-C finishes the step and writes all output first.\n",
    );
    for command in visible(&program) {
        describe(command, "riprap", 2, &mut text);
    }
    text
}

/// Commands below a command, without that of help.
fn visible(command: &Command) -> impl Iterator<Item = &Command> {
    command
        .get_subcommands()
        .filter(|below| !below.is_hide_set() && below.get_name() != "help")
}

/// A command: purpose, usage, arguments and options; then those below it.
fn describe(command: &Command, above: &str, depth: usize, text: &mut String) {
    let path = format!("{above} {}", command.get_name());
    write!(
        text,
        "\n{} {path}\n\n{}.\n",
        "#".repeat(depth),
        about(command)
    )
    .unwrap();
    let aliases: Vec<&str> = command.get_visible_aliases().collect();
    if !aliases.is_empty() {
        writeln!(text, "\nAlso: `{above} {}`.", aliases.join("`, `")).unwrap();
    }
    let shown =
        |arg: &&Arg| !arg.is_hide_set() && !matches!(arg.get_id().as_str(), "help" | "version");
    let (places, options): (Vec<&Arg>, Vec<&Arg>) = command
        .get_arguments()
        .filter(shown)
        .partition(|arg| arg.is_positional());
    let usage: String = places
        .iter()
        .map(|arg| format!(" {}", place(arg)))
        .collect();
    let (below, flags) = (
        visible(command).next(),
        if options.is_empty() { "" } else { " [OPTIONS]" },
    );
    let further = if below.is_some() { " COMMAND" } else { "" };
    write!(text, "\n```text\n{path}{flags}{usage}{further}\n```\n").unwrap();
    if !(places.is_empty() && options.is_empty()) {
        text.push_str("\n| argument or option | meaning |\n|---|---|\n");
    }
    for arg in places.into_iter().chain(options) {
        writeln!(text, "| `{}` | {} |", spelled(arg), meaning(arg)).unwrap();
    }
    for next in visible(command) {
        describe(next, &path, depth + 1, text);
    }
}

/// Name of a positional argument, in brackets when it may be left out.
fn place(arg: &Arg) -> String {
    let name = values(arg);
    if arg.is_required_set() {
        name
    } else {
        format!("[{name}]")
    }
}

/// Names of the values of an argument.
fn values(arg: &Arg) -> String {
    let names = arg.get_value_names().unwrap_or_default();
    let names: Vec<&str> = names.iter().map(|name| name.as_str()).collect();
    if names.is_empty() {
        arg.get_id().as_str().to_uppercase()
    } else {
        names.join(" ")
    }
}

/// An argument as it is typed.
fn spelled(arg: &Arg) -> String {
    let takes_value = matches!(arg.get_action(), ArgAction::Set | ArgAction::Append);
    let Some(long) = arg.get_long() else {
        return place(arg);
    };
    let short = arg
        .get_short()
        .map_or(String::new(), |short| format!("-{short}, "));
    let value = if takes_value {
        format!(" {}", values(arg))
    } else {
        String::new()
    };
    format!("{short}--{long}{value}")
}

/// Help of an argument, with its default and its values.
fn meaning(arg: &Arg) -> String {
    let mut text = sentence(&arg.get_help().map(ToString::to_string).unwrap_or_default());
    let takes_value = matches!(arg.get_action(), ArgAction::Set | ArgAction::Append);
    let possible: Vec<String> = arg
        .get_possible_values()
        .iter()
        .map(|value| format!("`{}`", value.get_name()))
        .collect();
    if takes_value && !possible.is_empty() {
        write!(text, " One of {}.", possible.join(", ")).unwrap();
    }
    let defaults: Vec<String> = arg
        .get_default_values()
        .iter()
        .map(|value| format!("`{}`", value.to_string_lossy()))
        .collect();
    if takes_value && !defaults.is_empty() {
        write!(text, " Default: {}.", defaults.join(", ")).unwrap();
    }
    if arg.is_required_set() && arg.get_long().is_some() {
        text.push_str(" Required.");
    }
    text
}

/// First paragraph about a command, without its full stop.
fn about(command: &Command) -> String {
    let text = command
        .get_about()
        .map(ToString::to_string)
        .unwrap_or_default();
    escaped(text.trim_end_matches('.'))
}

/// Text of a help that ends with a full stop.
fn sentence(help: &str) -> String {
    format!("{}.", escaped(help.trim_end_matches('.')))
}

/// Text without signs that mean something in Markdown; back ticks stay.
fn escaped(text: &str) -> String {
    let mut made = String::new();
    let mut is_code = false;
    for c in text.chars() {
        is_code ^= c == '`';
        if matches!(c, '|') || (!is_code && matches!(c, '<' | '>' | '*' | '_' | '[' | ']')) {
            made.push('\\');
        }
        made.push(if c == '\n' { ' ' } else { c });
    }
    made
}
