"""The command of the wheel behaves as the program."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import riprap

from conftest import command


def test_exit_codes_and_streams(case: Path) -> None:
    folder = case.parent
    version = command("--version", cwd=folder)
    assert (version.returncode, version.stdout, version.stderr) == (0, f"riprap {riprap.__version__}\n", "")
    assert command("--help", cwd=folder).stdout.startswith("Rock blocks and water")
    wrong = command("ran", cwd=folder)
    assert wrong.returncode == 2 and wrong.stdout == "" and "Usage: riprap" in wrong.stderr
    assert command("check", case, cwd=folder).returncode == 0
    missing = command("check", "none.ron", cwd=folder)
    assert missing.returncode == 2 and "cannot read the scene" in missing.stderr


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("signals", [1, 2])
def test_the_first_ctrl_c_ends_in_good_order_and_the_second_at_once(case: Path, signals: int) -> None:
    line = [sys.executable, "-m", "riprap", "run", str(case), "-o", "run", "--until", "60", "--quiet", "--no-report"]
    process = subprocess.Popen(line, cwd=case.parent, stderr=subprocess.PIPE, text=True)
    gauges = case.parent / "run" / "gauges.csv"
    deadline = time.monotonic() + 30
    while not (gauges.is_file() and gauges.read_text().count("\n") > 3) and time.monotonic() < deadline:
        time.sleep(0.05)
    for _ in range(signals):
        process.send_signal(signal.SIGINT)
        time.sleep(0.01)
    assert process.wait(timeout=30) == 130
    if signals == 1:
        assert (case.parent / "run" / "checkpoint.bin").is_file()


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_a_command_without_a_run_is_ended_by_a_signal(tmp_path: Path) -> None:
    script = "import signal, riprap.__main__ as m, sys; sys.argv = ['riprap', '--version']; m.main(); print(signal.getsignal(signal.SIGINT) == signal.SIG_DFL)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stdout.endswith("True\n")
