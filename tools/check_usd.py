#!/usr/bin/env python3
"""Opens exported files with the programs they are made for, and fails on anything these complain about.

    pip install usd-core==26.11 vtk==9.7.2
    python tools/check_usd.py FILE_OR_FOLDER...

.usda is read with pxr (usd-core) and run through all of its validators. .vtp and .pvd are read with VTK.
"""

import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path


def check_usd(path):
    """Validators' errors and our own promises: units, diameters, counts and finite samples in every frame."""
    from pxr import Usd, UsdGeom, UsdValidation

    stage = Usd.Stage.Open(str(path))
    registry = UsdValidation.ValidationRegistry()
    validators = registry.GetOrLoadAllValidators()
    if not validators:
        yield "usd-core has no validators: nothing was checked"
    context = UsdValidation.ValidationContext(validators)
    for error in context.Validate(stage):
        sites = ", ".join(str(site.GetPrim().GetPath() if site.IsPrim() else "stage") for site in error.GetSites())
        yield f"{error.GetName()}: {error.GetMessage()} ({sites})"

    if UsdGeom.GetStageMetersPerUnit(stage) != 1.0 or not stage.HasAuthoredMetadata("metersPerUnit"):
        yield "metersPerUnit is not authored as 1"
    for key in ("upAxis", "timeCodesPerSecond"):
        if not stage.HasAuthoredMetadata(key):
            yield f"{key} is not authored"
    if not stage.GetDefaultPrim():
        yield "there is no default prim"

    found = [UsdGeom.BasisCurves(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.BasisCurves)]
    if not found:
        yield "there are no curves"
    for curves in found:
        yield from check_curves(stage, curves)


def check_curves(stage, curves):
    from pxr import Gf, Usd, UsdGeom

    counts = curves.GetCurveVertexCountsAttr().Get()
    times = curves.GetPointsAttr().GetTimeSamples() or [Usd.TimeCode.Default()]
    if len(times) > 1 and (times[0] != stage.GetStartTimeCode() or times[-1] != stage.GetEndTimeCode()):
        yield f"samples from {times[0]} to {times[-1]} do not fill the stage's time"
    primvars = UsdGeom.PrimvarsAPI(curves.GetPrim()).GetPrimvarsWithAuthoredValues()
    for time in times:
        points = curves.GetPointsAttr().Get(time)
        if len(points) != sum(counts):
            yield f"{len(points)} points for {sum(counts)} in the counts at {time}"
        if not all(abs(x) < 1e6 for point in points for x in point):
            yield f"a point is not finite at {time}"
        extent = curves.GetExtentAttr().Get(time)
        computed = UsdGeom.Boundable.ComputeExtentFromPlugins(curves, time)
        if not all(Gf.IsClose(a, b, 1e-7) for a, b in zip(extent, computed)):
            yield f"extent {extent} at {time} is not {computed}"
        for primvar in primvars:
            size = {
                UsdGeom.Tokens.constant: 1,
                UsdGeom.Tokens.uniform: len(counts),
                UsdGeom.Tokens.varying: curves.ComputeVaryingDataSize(time),
                UsdGeom.Tokens.vertex: curves.ComputeVertexDataSize(time),
            }[primvar.GetInterpolation()]
            if len(primvar.Get(time)) != size:
                yield f"{primvar.GetName()} has {len(primvar.Get(time))} values for {size} at {time}"
    print(f"  {len(counts)} yarns, {sum(counts)} points, {len(times)} frames, {len(primvars)} primvars")


def check_vtp(path):
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    problems = []
    reader = vtkXMLPolyDataReader()
    reader.AddObserver("ErrorEvent", lambda *_: problems.append("VTK cannot read it"))
    reader.SetFileName(str(path))
    reader.Update()
    yield from problems
    data = reader.GetOutput()
    if data.GetNumberOfPoints() == 0 or data.GetNumberOfLines() == 0:
        yield "there are no lines"
    names = {data.GetPointData().GetArrayName(i) for i in range(data.GetPointData().GetNumberOfArrays())}
    for name in ("radius", "rest_arc_length"):
        if name not in names:
            yield f"there is no point array {name}"
    if data.GetFieldData().GetArray("TimeValue") is None:
        yield "there is no TimeValue"
    for i in range(data.GetPointData().GetNumberOfArrays()):
        array = data.GetPointData().GetArray(i)
        if array.GetNumberOfTuples() != data.GetNumberOfPoints():
            yield f"{array.GetName()} has {array.GetNumberOfTuples()} values"


def check_pvd(path):
    last = float("-inf")
    for entry in ElementTree.parse(path).getroot().iter("DataSet"):
        time = float(entry.get("timestep"))
        if time <= last:
            yield f"time {time} is not later than {last}"
        last = time
        if not (path.parent / entry.get("file")).is_file():
            yield f"{entry.get('file')} is missing"
    if last == float("-inf"):
        yield "the collection is empty"


CHECKS = {".usda": check_usd, ".vtp": check_vtp, ".pvd": check_pvd}


def main(arguments):
    paths = []
    for argument in map(Path, arguments):
        paths += sorted(p for p in argument.iterdir() if p.suffix in CHECKS) if argument.is_dir() else [argument]
    if not paths:
        print(__doc__)
        return 2
    failures = 0
    for path in paths:
        print(path)
        check = CHECKS.get(path.suffix)
        problems = list(check(path)) if check else ["no check for this kind of file"]
        for problem in problems:
            print(f"  ERROR {problem}")
        failures += len(problems)
    print(f"{len(paths)} files, {failures} errors")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
