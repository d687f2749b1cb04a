#!/usr/bin/env python3
"""An input of a sweep from one measured number, by scipy and UM-Bridge.

    pip install scipy umbridge
    python3 benches/python/calibrate.py benches/sweeps/torrent.ron --record 10.56

Starts `riprap serve`, looks at the whole range of the input first, and then searches around the best. Every run is kept in the
sweep's folder: the same command again takes seconds. At the end it says how well the record determines the input: an output that
hardly depends on the input, or scatters by more than it depends on it, calibrates nothing.
"""

import argparse
import re
import subprocess
import sys

import numpy as np
import umbridge
from scipy.optimize import minimize_scalar

PARSER = argparse.ArgumentParser(description=__doc__.splitlines()[0])
PARSER.add_argument("sweep", help="sweep with one input")
PARSER.add_argument("--record", type=float, required=True, help="measured value of its first output")
PARSER.add_argument("--from", dest="low", type=float, default=3.0, help="smallest value of the input")
PARSER.add_argument("--to", dest="high", type=float, default=18.0, help="largest value")
PARSER.add_argument("--look", type=int, default=8, help="runs over the whole range")
PARSER.add_argument("--runs", type=int, default=10, help="runs of the search")
PARSER.add_argument("--riprap", default="target/release/riprap", help="the program")


def serve(program, sweep):
    """The server and its address."""
    server = subprocess.Popen([program, "serve", sweep, "--port", "0"], stdout=subprocess.PIPE, text=True)
    found = re.search(r"http://\S+?(?=;)", server.stdout.readline())
    if not found:
        sys.exit("the server did not start")
    return server, found.group()


def main():
    asked = PARSER.parse_args()
    server, address = serve(asked.riprap, asked.sweep)
    try:
        model = umbridge.HTTPModel(address, "forward")
        known = {}

        def output(x):
            # four digits are more than a friction is known to, and make neighbors one run
            x = float(f"{x:.4g}")
            if x not in known:
                known[x] = model([[x]])[0][0]
                print(f"  {x:8.4g}  {known[x]:10.5g}  {known[x] - asked.record:+.4g}")
            return known[x]

        print("   input      output  output - record")
        values = np.linspace(asked.low, asked.high, asked.look)
        seen = np.array([output(x) for x in values])
        k = int(np.argmin(abs(seen - asked.record)))
        around = values[max(k - 1, 0)], values[min(k + 1, len(values) - 1)]
        minimize_scalar(
            lambda x: (output(x) - asked.record) ** 2,
            bounds=around,
            method="bounded",
            options={"maxiter": asked.runs},
        )
        best = min(known, key=lambda x: abs(known[x] - asked.record))
        slope, _ = np.polyfit(values, seen, 1)
        scatter = np.std(seen - np.polyval(np.polyfit(values, seen, 1), values), ddof=2)
        print(f"best: {best:.4g}, with {known[best]:.5g} for {asked.record}")
        print(f"over the range the output changes by {slope:.3g} a unit of the input and scatters by {scatter:.2g}:")
        print(f"this record determines the input to about +-{2 * scatter / abs(slope):.2g}")
    finally:
        server.terminate()
        server.wait()


main()
