# Everything above is of this run, and may be changed; below it is the same for every run.

import os
import sys

import paraview
from paraview.simple import *

paraview.simple._DisableFirstRenderCameraReset()


def folder():
    """The run folder: that of this file where ParaView says which it is, or else where the run was."""
    beside = os.path.dirname(os.path.abspath(__file__)) if "__file__" in globals() else ""
    places = [os.path.join(beside, RUN_BESIDE), RUN] if beside else [RUN]
    for place in places:
        if os.path.exists(os.path.join(place, "case.ron")):
            return place
    raise RuntimeError("no run folder at " + " or ".join(places) + "; set RUN at the top of the script")


def opened(name, reader):
    """A file of the run as a source; None if the run has none."""
    path = os.path.join(folder(), name)
    return reader(registrationName=name, FileName=path) if os.path.exists(path) else None


def plain(display):
    """One color, by no array."""
    display.ColorArrayName = [None, ""]


def scale(array, title, limits, preset):
    """One range of colors for the whole run, and its legend."""
    colors = GetColorTransferFunction(array)
    colors.ApplyPreset(preset, True)
    colors.RescaleTransferFunction(*limits)
    colors.AutomaticRescaleRangeMode = "Never"
    legend = GetScalarBar(colors, view)
    legend.Title, legend.ComponentTitle = title, ""
    legend.TitleColor = legend.LabelColor = INK
    legend.TitleFontSize, legend.LabelFontSize = 16, 14
    legend.WindowLocation = "Lower Right Corner"
    legend.ScalarBarLength = 0.3
    legend.Visibility = 0


def colored(display, association, array):
    """Colors by an array on the scale of the run: the first choice of an array scales by the first frame."""
    display.MapScalars = 1
    ColorBy(display, (association, array))
    for name, title, limits, preset in SCALES:
        scale(name, title, limits, preset)
    display.SetScalarBarVisibility(view, True)


def shown_water(source):
    """Spheres as wide as the particles are apart, colored by speed, or by elevation."""
    first = Calculator(registrationName="speed", Input=source)
    first.Function, first.ResultArrayName = "mag(Velocity)", "Speed"
    both = Calculator(registrationName="water", Input=first)
    both.Function, both.ResultArrayName = "coordsZ", "Elevation"
    display = Show(both, view)
    display.SetRepresentationType("Point Gaussian")
    display.GaussianRadius = 0.5 * SPACING
    display.ShaderPreset = "Sphere"
    colored(display, "POINTS", COLOR)
    return both


def shown_blocks(source, has_water):
    """Stone among water; without water colored by speed."""
    speed = Calculator(registrationName="blocks", Input=source)
    speed.AttributeType = "Cell Data"
    speed.Function, speed.ResultArrayName = "mag(Velocity)", "Speed"
    display = Show(speed, view)
    display.SetRepresentationType("Surface With Edges" if N_BLOCKS < 2000 else "Surface")
    display.EdgeColor = INK
    display.AmbientColor = display.DiffuseColor = STONE
    if has_water:
        plain(display)
    else:
        colored(display, "CELLS", "Speed")
    return speed


def part(source, name, low, high):
    """Faces of the blocks with these numbers."""
    chosen = Threshold(registrationName=name, Input=source)
    chosen.Scalars = ["CELLS", "BlockId"]
    if hasattr(chosen, "LowerThreshold"):
        chosen.LowerThreshold, chosen.UpperThreshold = low, high
        chosen.ThresholdMethod = "Between"
    else:
        # before 5.10
        chosen.ThresholdRange = [low, high]
    return chosen


def shown_fixed(source):
    """The ground shaded by its slope; walls so that one sees through."""
    if not TERRAIN:
        wall = Show(source, view)
        wall.SetRepresentationType("Surface")
        wall.AmbientColor = wall.DiffuseColor = WALL
        wall.Opacity = WALL_OPACITY
        plain(wall)
        edges = FeatureEdges(registrationName="edges of walls", Input=source)
        lines = Show(edges, view)
        lines.AmbientColor = lines.DiffuseColor = INK
        plain(lines)
        return
    for low, high in TERRAIN:
        ground = Show(part(source, "ground", low, high), view)
        ground.SetRepresentationType("Surface")
        ground.AmbientColor = ground.DiffuseColor = GROUND
        ground.Ambient, ground.Diffuse, ground.Specular = 0.1, 0.95, 0.0
        plain(ground)
    for low, high in OTHERS:
        wall = Show(part(source, "walls", low, high), view)
        wall.SetRepresentationType("Surface")
        wall.AmbientColor = wall.DiffuseColor = WALL
        plain(wall)


def shown_time(source):
    """The time in a corner."""
    clock = AnnotateTimeFilter(registrationName="time", Input=source)
    version = paraview.servermanager.vtkSMProxyManager
    number = 100 * version.GetVersionMajor() + version.GetVersionMinor()
    clock.Format = "t = {time:.%df} s" % DIGITS if 510 <= number else "t = %%.%df s" % DIGITS
    text = Show(clock, view)
    text.WindowLocation = "Upper Left Corner"
    text.Color, text.FontSize = INK, 18


def set_camera():
    """The camera of the scene, or one that has all of it in view."""
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = EYE, LOOK_AT, UP
    view.CenterOfRotation = LOOK_AT
    if PARALLEL_SCALE is None:
        view.CameraParallelProjection = 0
        view.CameraViewAngle = VIEW_ANGLE
    else:
        view.CameraParallelProjection = 1
        view.CameraParallelScale = PARALLEL_SCALE


SCALES = [
    ("Speed", "speed, m/s", SPEEDS, "Viridis (matplotlib)"),
    ("Elevation", "elevation, m", ELEVATIONS, "Cool to Warm"),
]
view = GetActiveViewOrCreate("RenderView")
view.UseColorPaletteForBackground = 0
view.Background = PAPER
view.OrientationAxesLabelColor = INK
view.ViewSize = SIZE
water = opened("water.pvd", PVDReader)
blocks = opened("blocks.pvd", PVDReader)
fixed = opened("fixed_blocks.vtp", XMLPolyDataReader)
if fixed:
    shown_fixed(fixed)
if water:
    water = shown_water(water)
if blocks:
    blocks = shown_blocks(blocks, water is not None)
if water or blocks:
    shown_time(water or blocks)
scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
scene.PlayMode = "Snap To TimeSteps"
scene.GoToFirst()
set_camera()
Render(view)

# pvbatch paraview.py PICTURE.png [TIME]
if len(sys.argv) > 1 and sys.argv[1].endswith(".png"):
    times = list(scene.TimeKeeper.TimestepValues) or [0.0]
    wanted = float(sys.argv[2]) if len(sys.argv) > 2 else times[-1]
    scene.AnimationTime = min(times, key=lambda t: abs(t - wanted))
    set_camera()
    SaveScreenshot(sys.argv[1], view, ImageResolution=SIZE)
