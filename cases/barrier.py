#!/usr/bin/env python3
"""Scenes of dry and wet debris against a slit or a sectional barrier; standard library only.

    python3 barrier.py slit 5                     one opening of five mean radii in the middle
    python3 barrier.py slit closed --upright      no opening, upright instead of at right angles to the bed
    python3 barrier.py sectional F                one of the published ten, A to L
    python3 barrier.py sectional --piles 6 --pile 0.3 --opening 0.25
    python3 barrier.py slit 5 --settled           from rest behind a gate, which is gone at t = 0
    python3 barrier.py slit 5 --wet mud           mud in place of grains; `--wet mixed` has both

The scene goes to standard output. A test holds the committed scenes to this script. Published: doctoral thesis on debris flow against open
rigid barriers by coupled DEM-LBM, chapters 6 and 7 (table 7.1). x runs down the bed, y across, z off it; gravity is turned by the slope.
"""

import argparse
import math

RADIUS = 0.05  # mean of the grains; m
WIDTH, HEIGHT, LENGTH = 2.1, 1.35, 20.0  # of the channel; m
FACE, THICKNESS = 8.0, 0.1  # of the barrier; m
FRONT = 4.725  # of the mass at the start; m
ACROSS = 18  # grains in the width of the mass, 1.90 m
SPACING = 1.9 / ACROSS  # of its lattice; m
# Largest offset from its sites, over the largest diameter: as much as leaves no overlap. On the sites themselves nothing pushes a grain
# across the channel, and the mass is 18 plane flows side by side, whose largest force is half as large again.
JITTER = 0.0026
FRICTION, SLIDING, ROLLING, ROLLING_AT_WALLS = 0.577, 0.9 * 0.577, 0.0678, 0.1356
# The published dashpot, 0.456 of the critical one, is that of a restitution of 0.2 for a contact that may pull; one that only pushes rebounds
# so much.
RESTITUTION = 0.3249
GRAVITY = 9.81
SETTLING = 10.0  # at most; s
# Mud: density, plastic viscosity, yield stress, viscosity at rest over the plastic one; kg/m3, Pa s, Pa
MUD = (1500, 20, 20, 100)
DEPTH = 1.0  # of mud at the start; m
SHARE = 0.3  # of grains in the volume of mud and grains
FASTEST = 7.0  # expected; m/s
# piles, width of a pile, opening over the mean radius
SECTIONAL = {
    "A": (8, 0.10, 4), "B": (7, 0.10, 5), "C": (6, 0.10, 6), "D": (5, 0.10, 8), "E": (4, 0.10, 11),
    "F": (4, 0.33, 5), "G": (5, 0.22, 5), "H": (4, 0.30, 6), "I": (5, 0.18, 6), "L": (3, 0.42, 8),
}


def slit(opening):
    """Ends of the piles across the channel; the opening in m."""
    if opening == 0.0:
        return [(0.0, WIDTH)]
    return [(0.0, (WIDTH - opening) / 2), ((WIDTH + opening) / 2, WIDTH)]


def sectional(piles, pile, opening):
    """The same, with piles at the sides that take what is left."""
    end = (WIDTH - (piles - 1) * opening - (piles - 2) * pile) / 2
    if piles < 2 or end <= 0.0:
        raise SystemExit(f"{piles} piles of {pile} m with openings of {opening} m do not fit into {WIDTH} m")
    starts = [0.0] + [end + opening + k * (pile + opening) for k in range(piles - 2)] + [WIDTH - end]
    widths = [end] + [pile] * (piles - 2) + [end]
    return [(start, start + width) for start, width in zip(starts, widths)]


def pile_shape(start, end, lean):
    """A pile from the bed to the ceiling; `lean` is how far its top stands upstream of its foot, in m."""
    # piles at the sides reach into the walls
    start, end = (-0.1 if start == 0.0 else start), (WIDTH + 0.1 if end == WIDTH else end)
    if lean == 0.0:
        return f"Box(min: ({FACE:g}, {start:.6g}, 0), max: ({FACE + THICKNESS:g}, {end:.6g}, {HEIGHT:g}))"
    corners = [(FACE, 0.0), (FACE + THICKNESS, 0.0), (FACE + THICKNESS - lean, HEIGHT), (FACE - lean, HEIGHT)]
    polygon = ", ".join(f"({x:.6g}, {z:g})" for x, z in corners)
    return f"Extrusion(polygon: [{polygon}], axis: Y, from: {start:.6g}, to: {end:.6g})"


def scene(piles, words, args):
    """Text of the scene."""
    slope = math.radians(args.slope)
    lean = HEIGHT * math.tan(slope) if args.upright else 0.0
    degrees = lambda friction: math.degrees(math.atan(friction))
    spacing, jitter = args.spacing, args.jitter
    along = math.floor(4.6 / spacing + 0.5) * spacing
    left = (WIDTH - ACROSS * spacing) / 2
    settling, gate, start = "", "", "let go"
    if args.settled:
        settling = f', settle_blocks: (speed: 0.01, time: 0.1, at_most: {SETTLING:g}, gates: ["gate"])'
        gate = (
            f'        (name: "gate", material: "wall", motion: Fixed,'
            f' shape: Box(min: ({FRONT:g}, 0, 0), max: ({FRONT + THICKNESS:g}, {WIDTH:g}, {HEIGHT:g}))),\n'
        )
        start = "let go, once they lie behind a gate,"
    if args.wet == "mixed":
        spacing, jitter = 2 * RADIUS * (math.pi / 6 / SHARE) ** (1 / 3), 0.05
        along, left = math.floor(4.6 / spacing) * spacing, (WIDTH - math.floor(WIDTH / spacing) * spacing) / 2
    blocks = "\n".join(
        f'        (name: "pile_{number}", material: "wall", motion: Fixed, shape: {pile_shape(start, end, lean)}),'
        for number, (start, end) in enumerate(piles, 1)
    )
    wall = lambda name, low, high: (
        f'        (name: "{name}", material: "wall", motion: Fixed, shape: Box(min: ({low}), max: ({high}))),'
    )
    # thinner ones than the kernel's radius would be searched for water behind them: two thirds of a run
    thick = max(0.2, 3 * args.particles) if args.wet else 0.2
    channel = "\n".join([
        wall("bed", f"-{thick:g}, -{thick:g}, -{thick:g}", f"{LENGTH + thick:g}, {WIDTH + thick:g}, 0"),
        wall("right_side", f"-{thick:g}, -{thick:g}, 0", f"{LENGTH + thick:g}, 0, {HEIGHT:g}"),
        wall("left_side", f"-{thick:g}, {WIDTH:g}, 0", f"{LENGTH + thick:g}, {WIDTH + thick:g}, {HEIGHT:g}"),
        wall("back", f"-{thick:g}, 0, 0", f"0, {WIDTH:g}, {HEIGHT:g}"),
        wall("ceiling", f"-{thick:g}, -{thick:g}, {HEIGHT:g}", f"{LENGTH + thick:g}, {WIDTH + thick:g}, {HEIGHT + thick:g}"),
    ])
    slipping = (
        f'        (name: "grain", density: 2500.0, friction_angle_deg: {degrees(FRICTION):.6g}, residual_friction_angle_deg: {degrees(SLIDING):.6g},\n'
        f'         restitution: {RESTITUTION}, contact_stiffness: 1e6, shear_stiffness_ratio: 0.285714, rolling_friction: {ROLLING}),\n'
    )
    joint = f'    joints: [\n        (between: ("grain", "wall"), rolling_friction: {ROLLING_AT_WALLS}),\n    ],\n'
    layers = math.floor(DEPTH / spacing) if args.wet else 10
    count = "" if args.wet else f", count: {args.grains}"
    grains = f"""    grains: [
        (name: "grain", material: "grain",
         region: Box(min: ({FRONT - along:.6g}, {left:.6g}, 0), max: ({FRONT:g}, {WIDTH - left:.6g}, {layers * spacing:.6g})),
         diameter: (0.095, 0.105), spacing: {spacing:.6g}, jitter: {jitter:g}{count}, seed: {args.seed}),
    ],
"""
    reactions = """    // all that carries the grains
    reactions: [(name: "walls", between: ("grain_*", "wall"), direction: (1, 0, 0))],
"""
    fluid, numerics = "", "block_step_bound: Eigenvalues"
    if args.wet:
        density, viscosity, yield_stress, at_rest = MUD
        fluid = f"""    fluid: (
        density: {density},
        rheology: Bingham(dynamic_viscosity: {viscosity}, yield_stress: {yield_stress}, regularization: Bilinear({at_rest * viscosity})),
        resolution: Spacing({args.particles:g}),
        regions: [(name: "mud", shape: Box(min: ({FRONT - 4.6:g}, 0, 0), max: ({FRONT:g}, {WIDTH:g}, {DEPTH:g})))],
    ),
    interface: (slip: None),
"""
        numerics += f", expected_speed: {FASTEST:g}"
        grains = grains.replace("jitter:", "in_water: Averaged, jitter:")
    if args.wet == "mud":
        slipping, joint, grains, reactions = "", "", "", ""
    return f"""{wet_heading(words, args) if args.wet else dry_heading(words, start, args)}(
    title: "{"Wet" if args.wet else "Dry"} debris against a barrier: {words}",
    description: "{description(args)} on {args.slope:g} degrees.",
    domain: (min: (-{thick:g}, -{thick:g}, -{thick:g}), max: ({LENGTH:g}, {WIDTH + thick:g}, {HEIGHT + thick:g})),
    gravity: ({GRAVITY * math.sin(slope):.9g}, 0, {-GRAVITY * math.cos(slope):.9g}),
    materials: [
{slipping}        (name: "wall", density: 2500.0, friction_angle_deg: {degrees(FRICTION):.6g}, residual_friction_angle_deg: {degrees(SLIDING):.6g},
         restitution: {RESTITUTION}, contact_stiffness: 1e6, shear_stiffness_ratio: 0.285714),
    ],
{joint}    blocks: [
{channel}
{gate}{blocks}
    ],
{grains}{fluid}    barriers: [(name: "barrier", blocks: ["pile_*"], flow: (1, 0, 0), upstream: 1)],
{reactions}    // a bound of the step by eigenvalues: a third of the steps that sums over contacts ask for
    numerics: ({numerics}),
    time: (duration: {args.duration:g}{settling}),
    // blocks.npy of 20 MB for ten seconds
    output: (frame_interval: 0.5, gauge_interval: 0.02, ledger_interval: 0.1, block_table: (interval: 0.5, format: Npy)),
    camera: (position: (2, -12, 7), look_at: (7, 1, 0.5), field_of_view_deg: 40),
)
"""


def description(args):
    """Masses in a few words."""
    if args.wet:
        return "Mud" if args.wet == "mud" else f"Mud with a share of {SHARE:g} of spheres of 10 cm"
    return f"{args.grains} spheres of 10 cm"


def dry_heading(words, start, args):
    """Comment over a dry scene."""
    return f"""// Dry debris against a barrier: {words}.
//
// After a doctoral thesis on debris flow against open rigid barriers by coupled DEM-LBM, chapters 6 and 7: {args.grains} spheres of 9.5 to
// 10.5 cm are {start} on a bed of {args.slope:g} degrees, 3.275 m before a barrier. A simulation by another code, one run each, not an experiment.
// Its domain ends at the height of the barrier: a ceiling, as of a culvert, which the flow reaches from 30 degrees on. Its barrier is of
// spheres, rough; this one of plane piles. The mass is a lattice, 18 grains across 1.90 m, as published; here each grain is up to 0.3 mm off its
// site, for on the sites no grain would ever move across, and the mass be 18 plane flows side by side.
//
// Sliding friction 0.577, and 0.9 of it once a grain slips; rolling resistance 0.0678, at walls 0.1356; 1e6 N/m: at 5 m/s grains
// overlap by 4 % of their diameter. Restitution is published as 0.2, by a dashpot for contacts that may pull; with that dashpot one that only pushes
// has 0.3249. From barrier.py.
"""


def wet_heading(words, args):
    """Comment over a wet scene."""
    density, viscosity, yield_stress, at_rest = MUD
    mixed = f""" It holds a share of
// {SHARE:g} of spheres of 9.5 to 10.5 cm, {2 * RADIUS / args.particles:g} spacings of the mud wide, which share its space: buoyancy, drag of a fluid with a yield stress, and their opposite on
// the mud. Contacts are those of the dry case.""" if args.wet == "mixed" else ""
    return f"""// Wet debris against a barrier: {words}.
//
// The flume of the dry case, filled up with mud: {DEPTH:g} m deep, {density} kg/m3, a Bingham fluid of {viscosity} Pa s and {yield_stress} Pa, whose viscosity at rest is
// {at_rest} times the plastic one, and which sticks to walls.{mixed}
//
// No measurement: what is known is that mass is kept, that mud and grains give each other equal and opposite momentum, and that the
// barrier's record has solid and fluid apart. A layer of this mud stops on {args.slope:g} degrees where it is thinner than {1000 * yield_stress / (density * GRAVITY * math.sin(math.radians(args.slope))):.2g} mm. From barrier.py.
"""


def main():
    """Reads the arguments and prints the scene."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=["slit", "sectional"])
    parser.add_argument("which", nargs="?", help="opening over the mean radius, or closed; letter of a published sectional barrier")
    parser.add_argument("--piles", type=int)
    parser.add_argument("--pile", type=float, help="width of a pile; m")
    parser.add_argument("--opening", type=float, help="between two piles; m")
    parser.add_argument("--upright", action="store_true", help="upright instead of at right angles to the bed")
    parser.add_argument("--settled", action="store_true", help="the mass comes to rest behind a gate before it is released")
    parser.add_argument("--wet", choices=["mud", "mixed"], help="filled up with mud, without grains, or with grains spread in it")
    parser.add_argument("--particles", type=float, default=0.1, help="spacing of the particles of mud; m")
    parser.add_argument("--slope", type=float, default=35.0, help="of the bed; degrees")
    parser.add_argument("--grains", type=int, default=7640)
    parser.add_argument("--spacing", type=float, default=SPACING, help="of the lattice of the grains at the start; m")
    parser.add_argument("--jitter", type=float, default=JITTER, help="largest offset of a grain from its site, over the largest diameter")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--duration", type=float, default=10.0, help="s")
    args = parser.parse_args()
    if args.kind == "slit":
        opening = 0.0 if args.which in (None, "closed") else float(args.which) * RADIUS
        piles, words = slit(opening), "closed" if opening == 0.0 else f"one slit of {opening:g} m"
    elif args.which is not None:
        count, pile, over_radius = SECTIONAL[args.which]
        piles = sectional(count, pile, over_radius * RADIUS)
        words = f"{count} piles of {pile:g} m, openings of {over_radius * RADIUS:g} m"
    else:
        piles = sectional(args.piles, args.pile, args.opening)
        words = f"{args.piles} piles of {args.pile:g} m, openings of {args.opening:g} m"
    if args.upright:
        words += ", upright"
    if args.settled and args.wet:
        parser.error("mud is filled in around grains where they are drawn: --settled is for dry ones")
    if args.settled:
        words += ", settled behind a gate"
    print(scene(piles, words, args), end="")


if __name__ == "__main__":
    main()
