"""The picture that scripts/render makes; runs in ParaView's pvbatch. Usage: see scripts/render."""

import argparse
import itertools
import os
import sys

import numpy as np
from paraview import servermanager, simple
from vtkmodules.numpy_interface import dataset_adapter
from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet, vtkMultiBlockDataSet

KINDS = ("body", "contact", "tool")  # the part of a grid's name before the first dot


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/render")
    parser.add_argument("results", help="the XDMF file")
    parser.add_argument("--out")
    parser.add_argument("--field", default="displacement")
    parser.add_argument("--time", type=float, nargs="+", default=[None])
    parser.add_argument("--view", choices=("xy", "xz", "yz", "iso"))
    parser.add_argument("--zoom", type=float, default=1.0)
    args = parser.parse_args()
    folder, file = os.path.split(args.results)
    args.out = args.out or (folder if file == "fields.xdmf" else os.path.splitext(args.results)[0]) + ".png"
    return args


def refuse(what):
    """Ends with exit code 2."""
    print(f"scripts/render: {what}", file=sys.stderr)
    sys.exit(2)


def read(results, time):
    """The grids of one time, as {kind: multiblock of its grids}, and that time: the written one next to `time`."""
    # Of ParaView's Xdmf readers this one keeps the names of the grids. It wants an absolute path.
    reader = simple.Xdmf3ReaderT(FileName=[os.path.abspath(results)])
    reader.UpdatePipelineInformation()
    times = reader.TimestepValues or [0.0]
    times = [times] if isinstance(times, float) else list(times)  # ParaView hands a single one out bare
    time = times[-1] if time is None else nearest(times, time)
    reader.UpdatePipeline(time)
    data = servermanager.Fetch(reader)

    groups = {kind: vtkMultiBlockDataSet() for kind in KINDS}
    for i in range(data.GetNumberOfBlocks()):
        name = data.GetMetaData(i).Get(vtkCompositeDataSet.NAME())
        group = groups.get(name.partition(".")[0])
        if group is not None and data.GetBlock(i).GetNumberOfCells() > 0:
            group.SetBlock(group.GetNumberOfBlocks(), data.GetBlock(i))
    return {kind: group for kind, group in groups.items() if group.GetNumberOfBlocks() > 0}, time


def nearest(times, time):
    """The written time next to one between the first and the last; says which if it is another one."""
    rounding = 1e-5 * max(map(abs, times))
    if not times[0] - rounding <= time <= times[-1] + rounding:
        written = f"from {times[0]:g} to {times[-1]:g}" if len(times) > 1 else f"at {times[0]:g} alone"
        refuse(f"there is no time {time:g}; fields are written {written}")
    found = min(times, key=lambda t: abs(t - time))
    if abs(found - time) > rounding:
        print(f"scripts/render: nothing is written at time {time:g}: {found:g} is drawn", file=sys.stderr)
    return found


def displaced(group):
    """A source that gives the grids of a group in their displaced position."""
    source = simple.TrivialProducer()
    source.GetClientSideObject().SetOutput(group)
    warped = simple.WarpByVector(Input=source, Vectors=["POINTS", "displacement"])
    warped.UpdatePipeline()
    return warped


def corners(source):
    """The eight corners of the bounding box, one a row."""
    box = source.GetDataInformation().GetBounds()
    return np.array(list(itertools.product(box[0:2], box[2:4], box[4:6])))


def extent(source):
    """Edge lengths of the bounding box."""
    return np.ptp(corners(source), axis=0)


def association(source, name):
    """POINTS or CELLS, where the field is, or None."""
    if source is None:
        return None
    if source.PointData.GetArray(name):
        return "POINTS"
    return "CELLS" if source.CellData.GetArray(name) else None


def show(source, view, color=None, edges=False, opacity=1.0):
    display = simple.Show(source, view)
    display.Representation = "Surface With Edges" if edges else "Surface"
    display.Opacity = opacity
    display.EdgeColor = [0.45, 0.45, 0.45]
    display.LineWidth = 0.7
    if color:
        display.ColorArrayName = ["POINTS", ""]
        display.DiffuseColor = display.AmbientColor = color
    return display


def color_by(display, source, field, view, more):
    """Colours a shown source by NAME or NAME.COMPONENT, with a scale beside the picture, for `more` stages than one."""
    name, _, component = field.partition(".")
    where = association(source, name)
    simple.ColorBy(display, (where, name, component.upper() or "Magnitude"))
    display.RescaleTransferFunctionToDataRange(more)
    table = simple.GetColorTransferFunction(name)
    low, high = table.RGBPoints[0], table.RGBPoints[-4]
    if 0.0 < low < 0.01 * high:
        table.RescaleTransferFunction(0.0, high)
    table.ApplyPreset("Viridis (matplotlib)", True)
    bar = simple.GetScalarBar(table, view)
    bar.Title, bar.ComponentTitle = name.replace("_", " ").replace("mises", "Mises"), component
    bar.TitleColor = bar.LabelColor = [0, 0, 0]
    bar.TitleFontSize, bar.LabelFontSize = 26, 24
    bar.HorizontalTitle = 1
    bar.TextPosition = "Ticks left/bottom, annotations right/top"
    bar.RangeLabelFormat = "%.3g"
    bar.ScalarBarThickness, bar.ScalarBarLength = 24, 0.33
    bar.WindowLocation = "Upper Right Corner"
    display.SetScalarBarVisibility(view, True)


def arrows(contact, length, view):
    """Contact forces, if they were written, the largest drawn `length` long, heads on the nodes."""
    force = contact.PointData.GetArray("force")
    largest = force.GetRange(-1)[1] if force else 0.0
    if largest == 0.0:
        return
    glyph = simple.Glyph(Input=contact, GlyphType="Arrow")
    glyph.OrientationArray = ["POINTS", "force"]
    glyph.ScaleArray = ["POINTS", "force"]
    glyph.ScaleFactor = length / largest
    glyph.GlyphMode = "All Points"
    glyph.GlyphType.ShaftRadius, glyph.GlyphType.TipRadius, glyph.GlyphType.TipLength = 0.015, 0.045, 0.2
    glyph.GlyphTransform = "Transform2"
    glyph.GlyphTransform.Translate = [-1.0, 0.0, 0.0]
    show(glyph, view, color=[0.8, 0.1, 0.1])


def outline(tool, view):
    """The border and the sharp edges of a tool, without which a strip seen edge-on would not show."""
    edges = simple.FeatureEdges(Input=simple.ExtractSurface(Input=tool), FeatureAngle=40.0)
    show(edges, view, color=[0.3, 0.3, 0.3]).LineWidth = 2.0


def contact_middle(contact):
    """The middle of the displaced nodes in contact, or None without any."""
    if contact is None:
        return None
    blocks = list(dataset_adapter.WrapDataObject(servermanager.Fetch(contact)))
    places = np.vstack([b.Points[np.asarray(b.PointData["status"]) > 0] for b in blocks])
    return (places.min(axis=0) + places.max(axis=0)) / 2 if len(places) else None


def best_view(points):
    """Along z at what is thin in z, from above a corner at what is not."""
    size = np.ptp(points, axis=0)
    return "xy" if size[2] < 0.05 * max(size) else "iso"


def place_camera(view, size, direction, points, centre, zoom):
    """Shows all points; zoomed in, what is around the centre, if there is one. Returns the direction of sight."""
    towards, up = (np.array(v, float) for v in {
        "xy": ((0, 0, -1), (0, 1, 0)),
        "xz": ((0, 1, 0), (0, 0, 1)),
        "yz": ((-1, 0, 0), (0, 0, 1)),
        "iso": ((-1, 1, -0.7), (0, 0, 1)),
    }[direction])
    towards /= np.linalg.norm(towards)
    right = np.cross(towards, up)
    right /= np.linalg.norm(right)
    up = np.cross(right, towards)

    # The box of the points on the screen fills it but for a margin, wide enough for the colour scale.
    seen = points @ np.column_stack([right, up, towards])
    half_width, half_height, depth = np.ptp(seen, axis=0) / 2
    view.CameraParallelProjection = 1
    view.CameraParallelScale = max(1.15 * half_height, 1.3 * half_width * size[1] / size[0])
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2 @ np.vstack([right, up, towards])
    view.CameraParallelScale /= zoom
    if zoom > 1.0 and centre is not None:
        middle = centre
    view.CameraFocalPoint = list(middle)
    view.CameraPosition = list(middle - 2 * (half_width + half_height + depth) * towards)
    view.CameraViewUp = list(up)
    return towards


def draw(view, size, sources, time, args):
    """Draws one time in a view of `size`; `sources` are those of all times."""
    body, contact, tool = (sources[time].get(kind) for kind in KINDS)
    name, _, component = args.field.partition(".")
    colored = next((s for s in (body, contact) if association(s, name)), None)
    if colored is None:
        known = sorted({n for s in (body, contact) if s for n in s.PointData.keys() + s.CellData.keys()})
        refuse(f"there is no field {name}; there are {', '.join(known)}")
    data = colored.PointData if association(colored, name) == "POINTS" else colored.CellData
    array = data.GetArray(name)
    if component:
        count = array.GetNumberOfComponents()
        known = [array.GetComponentName(i).lower() for i in range(count)] if count > 1 else []
        if component.lower() not in known:
            refuse(f"{name} has no component {component}; it has {', '.join(known) or 'one value'}")
    low, high = array.GetRange(0)
    if not low <= high:
        refuse(f"{name} has no values at time {time:g}; some fields have them at ends of steps only")

    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.OrientationAxesLabelColor = [0, 0, 0]
    view.OrientationAxesVisibility = int(args.zoom <= 1.0)  # nothing left to stand on
    displays = {body: show(body, view, color=[0.85, 0.85, 0.85], edges=True)}
    if tool:
        show(tool, view, color=[0.55, 0.55, 0.55], opacity=0.5)
        outline(tool, view)
    if contact:
        arrows(contact, 0.15 * max(extent(body)) / args.zoom, view)
        if colored is contact:
            displays[contact] = show(contact, view, edges=True)
    color_by(displays[colored], colored, args.field, view, len(sources) > 1)
    displays[colored].SetScalarBarVisibility(view, time == max(sources))
    points = np.vstack([corners(s) for sources in sources.values() for s in sources.values()])
    direction = args.view or best_view(points)
    if direction != "iso":  # nothing to shade: colours as on the scale
        displays[colored].Ambient, displays[colored].Diffuse = 1.0, 0.0

    label = simple.Show(simple.Text(Text=f"time {time:g}"), view)
    label.Color = [0, 0, 0]
    label.FontSize = 26
    label.WindowLocation = "Upper Left Corner"
    middles = [contact_middle(sources[t].get("contact")) for t in sorted(sources)]
    middle = next((m for m in reversed(middles) if m is not None), None)
    sight = place_camera(view, size, direction, points, middle, args.zoom)
    if contact in displays:  # in front of the body's face that it lies on
        displays[contact].Position = list(-2e-3 * max(extent(body)) * sight)


def main():
    args = arguments()
    stages = [read(args.results, time) for time in args.time]
    sources = {time: {kind: displaced(group) for kind, group in groups.items()} for groups, time in stages}
    size = [1600 if len(sources) == 1 else 560, 900]
    layout, place = simple.CreateLayout("stages"), 0
    for left, time in zip(reversed(range(len(sources))), sources):
        view = simple.CreateView("RenderView")
        view.ViewSize = size
        if left:
            layout.SplitHorizontal(place, 1.0 / (left + 1))
        simple.AssignViewToLayout(view, layout, 2 * place + 1 if left else place)
        place = 2 * place + 2
        draw(view, size, sources, time, args)
    picture = [size[0] * len(sources), size[1]]
    simple.SaveScreenshot(args.out, layout, ImageResolution=picture, SeparatorWidth=0, CompressionLevel=9)


main()
