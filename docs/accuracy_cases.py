"""Words of the pages on accuracy, one entry a study: the question, how it is answered, and the source of the reference.

Every number on these pages is read from the results; what stands here does not change with them.
"""

# study: (group, title, question and setup, source of the reference)
CASES = {
    "still_tank": (
        "Water at rest", "Still tank",
        "Water stands over a step and a slope. Does it stay at rest, with the right pressure? Compared is the mean pressure 0.9 m "
        "below the surface, relative to the pressure at the floor.",
        "Hydrostatic pressure, ρ g z.",
    ),
    "held_box": (
        "Water at rest", "Uplift on a held box",
        "A box six particle spacings high is held under still water. Compared is the upward force of the water on it.",
        "Archimedes: the weight of the displaced water.",
    ),
    "floating_box": (
        "Water at rest", "Floating box",
        "A box of half the density of water, six particle spacings high, floats. Compared is the height of its center, relative to "
        "the height of the box.",
        "Archimedes: half of the box is under water.",
    ),
    "standing_wave": (
        "Waves", "Low standing wave: height",
        "A standing wave 0.8 spacings high, 2 m long on 0.5 m of water, oscillates for six periods. Compared is the height that "
        "is left in the sixth.",
        "Linear theory: nothing is lost, as the viscosity of water takes only 0.01 % of the height.",
    ),
    "standing_wave_period": (
        "Waves", "Low standing wave: period",
        "The same wave. Compared is its period.",
        "Linear theory, T = 2π/√(g k tanh(k d)).",
    ),
    "standing_wave_high": (
        "Waves", "Standing wave five spacings high",
        "A wave high enough to stir the particles, 0.2 m high and 2 m long on 1 m of water. Compared is the height that is left in the "
        "eighth period. This is the test to look at before a wave has to travel far.",
        "Nothing is lost.",
    ),
    "piston": (
        "Waves", "Waves made by a piston",
        "A piston makes regular waves on water of k d = 1. Compared is the wave height half a wave length away from it.",
        "Linear wavemaker theory.",
    ),
    "solitary": (
        "Waves", "Solitary wave on a wall",
        "A solitary wave of 0.3 water depths travels fifteen depths and runs up a vertical wall. Compared is the run-up.",
        "Su & Mirie (1980), third order. The theory of second order of Byatt-Smith (1971) is 3 % lower.",
    ),
    "dam_break_front": (
        "Impact", "Dam break: speed of the front",
        "A column of water collapses onto a dry floor. Compared is the speed of its front, which does not depend on the moment at which "
        "the gate of the experiment opens.",
        "Fully nonlinear potential flow, without friction, as the runs are. The front measured by Martin & Moyce (1952) is 9 % slower.",
    ),
    "dam_break_pressure": (
        "Impact", "Dam break: pressure on a wall",
        "A dam break hits a wall. Compared is the mean pressure after the first peak, 15 mm above the floor. This flow is chaotic: "
        "runs that differ in the last digit differ by a percent or two, from 10 mm up by several.",
        "Fully nonlinear potential flow, without friction, as the runs are: 0.947 ρ g H. Lobovsky et al. (2014) measured 0.596.",
    ),
    "sliding_wedge": (
        "Rock into water", "Sliding wedge: first crest",
        "A wedge slides down 25 degrees into 0.6 m of water. Compared is the first crest 0.5 m from the toe of the slope.",
        "Our own extrapolation from three spacings, accurate to a few percent: there is no measurement of this scene.",
    ),
    "landslide_flume": (
        "Rock into water", "Landslide under water",
        "A block slides down a ramp under water. Compared is the surface over time, 1.5 m from the shoreline: the error is the "
        "root mean square difference from the record, over its range.",
        "Experiment of Sue, Nokes & Walters (2006). The record is not part of riprap; to repeat this study, supply your own.",
    ),
    "sliding_block": (
        "Rock", "Sliding block",
        "A block slides down 30 degrees with a friction angle of 20 degrees. Compared is the distance after 1 s.",
        "Coulomb: g (sin β − cos β tan φ) t²/2.",
    ),
    "block_drop": (
        "Rock", "Bouncing block: energy",
        "A tilted block falls and bounces on its edges without losses. Compared is the energy that the account cannot explain after "
        "1.9 s, relative to the energy of the fall.",
        "Conservation of energy.",
    ),
    "arch": (
        "Rock", "Arch of 24 voussoirs",
        "A semicircular arch of 24 blocks comes to rest under its own weight. Compared is how far the crown settles because contacts "
        "are springs.",
        "The result with the stiffest contacts.",
    ),
    "wall": (
        "Rock", "Wall of ten by ten stones",
        "A dry wall stands under its own weight, by contact dynamics. Compared is the force that its upper five courses exert on those "
        "below.",
        "Weight of fifty stones.",
    ),
    "hulls": (
        "Rock", "Hulls poured on a slope",
        "Two hundred angular blocks are poured on a slope of 35 degrees, by contact dynamics. Compared is where their center of mass is "
        "after 2 s, while most of them move, relative to the way that it has come.",
        "The mean by springs of 2.5e7, 1e8 and 1.6e9 N/m, which for these hulls agree within 0.7 %, for others within 5 %: the motion is "
        "chaotic. By contact dynamics the hulls are slower; the difference shrinks slowly with the step, from 7 % at 20 to 4 % at 1 ms.",
    ),
    "torrent": (
        "Rock", "Pebbles in a torrent",
        "328 pebbles roll down a channel past two settling tanks, by contact dynamics. Compared is when the first of them reaches the "
        "upper tank.",
        "10.56 s, published for a friction of 0.20 (Zic, Bicanic, Koziara & Ozanic 2014). The rows with another friction show how the time "
        "depends on it and are no errors: published are 8.415 s without friction and 10.83 s at 0.30.",
    ),
    "elastic_column": (
        "Rock", "Column under its own weight",
        "A soft column comes to rest. Compared is how much it is shortened by its own weight. A rigid block is not shortened at all, "
        "which is an error of 100 %.",
        "Elasticity: ρ g H²/(4 E) at the center.",
    ),
}

# names of knobs and values in the tables of results, where a reader would not know them
KNOBS = {
    "preset": "preset",
    "scheme": "scheme",
    "smoothing length over spacing": "smoothing length / spacing",
    "walls": "wall method",
    "body": "body",
}
VALUES = {
    "artificial, half step": "default of earlier versions (artificial viscosity, half the step)",
    "artificial": "default of earlier versions (artificial viscosity, half the step)",
    "published": "published scheme (`Mueller2003`)",
}

# plots of the coupling of rock and water: file, title, caption
COUPLED = [
    ("coupling_crest_sliding_wedge.svg", "Sliding wedge, gauges", "Surface at three gauges after the wedge has entered the water."),
    ("coupling_crest_impacting_block.svg", "Block onto water, gauges", "Surface at three gauges after a block has hit the water."),
    ("coupling_floating_boxes.svg", "Floating boxes", "Height and attitude of three boxes and a square that float."),
    ("coupling_heave_boxes.svg", "Heave of boxes", "Boxes released above their floating position, and linear potential flow."),
    ("coupling_column.svg", "Block on a column of water", "Oscillation of a block on a column of water."),
    ("coupling_released.svg", "Released cylinder", "A light cylinder let go under water: its first acceleration contains the added mass."),
    ("coupling_submerged.svg", "Held bodies in space", "Force of still water on bodies of several shapes."),
    ("coupling_submerged_plane.svg", "Held bodies in a plane", "The same in two dimensions."),
    ("coupling_thin_plate.svg", "Thin plate", "Force on a plate one spacing thick between two water levels."),
    ("coupling_wedge_entry.svg", "Wedge that enters water", "Force on a wedge that enters at constant speed, Zhao & Faltinsen (1993)."),
    ("coupling_paddle_work.svg", "Work of a paddle", "Work of a paddle, and what of it is found in the water."),
]
LABORATORY = [
    ("laboratory_ellipse.png", "Landslide under water", "Surface over time for a half ellipse on a prescribed path; Sue et al. (2006)."),
    ("laboratory_ellipse_free.png", "Landslide under water, free", "The same with a block that slides by itself."),
    ("laboratory_cosine_block.png", "Cosine-shaped block", "Surface at two gauges."),
    ("laboratory_submarine_body.png", "Triangular body", "Surface at four gauges, three-dimensional."),
    ("laboratory_falling_block.png", "Falling block", "Height of a block that is dropped into water."),
    ("laboratory_floating_block.png", "Floating block", "Height of a block released on the floor of a tank."),
    ("laboratory_cube.png", "Cube in a dam break", "Position of a cube pushed by a dam break; Canelas et al. (2016)."),
    ("laboratory_dam_breaks.png", "Dam breaks", "Front on a dry floor; pressures on a wall, means over 0.05 sqrt(H/g), thin. Potential flow has no "
     "friction, as riprap with free slip; by `benches/python/dam_potential.py`."),
    ("laboratory_heave_sphere.png", "Heave of a sphere", "A sphere released above its floating position."),
]
