# SPDX-License-Identifier: MIT
"""What a scene is refused for, by key, value and what is allowed: in a file by the command, and in Python.

A line of `REFUSED` changes a good scene, which stands above it with the table of the keys: "key = value" as
TOML spells it, several of them between semicolons, "-key" to leave one out, and alternatives of the last
value between bars. Behind the arrow are pieces of the message; "=" stands for the last key with its value,
"@" at the beginning of a piece for the table, and "$NAME" for words that come often.
"""

import json
import re
import tomllib
from collections.abc import Iterator

import builders
import numpy as np
import pytest

from sam.scene import Scene, SceneError, parse_scene


def keys(edits: str, table: str = "") -> dict[str, str | None]:
    """Dotted key -> value as TOML spells it, None for one that is left out."""
    parts = [part.removeprefix("-").partition(" = ") for part in edits.split("; ")]
    return {f"{table}{key}": value if equals else None for key, equals, value in parts}


def changed(scene: dict[str, str], edits: dict[str, str | None]) -> dict[str, str]:
    """The keys of a scene with others in their place, and without what is inside of these."""
    left = {
        key: value
        for key, value in scene.items()
        if not any(f"{key}.".startswith(f"{other}.") for other in edits)
    }
    return left | {key: value for key, value in edits.items() if value is not None}


def lines_of(text: str) -> list[str]:
    """Those that end in a backslash go on in the next one."""
    return re.sub(r"\\\n *", "", text).strip().splitlines()


SCENES: dict[str, dict[str, str]] = {"": {}}
GOOD = r"""
SPHERE: title = 'Sphere'; body.young = '210 GPa'; body.poisson = 0.3; counterbody.shape = 'sphere'; \
    counterbody.radius = '105 um'; loading.force = '0.65 N'
SWIFT SPHERE body.plasticity.: law = 'swift'; B = '945 MPa'; C = 20; n = 0.121
LINEAR SPHERE body.plasticity.: law = 'linear'; yield_stress = '1 GPa'; modulus = '10.5 GPa'
PERFECT SPHERE body.plasticity.: law = 'perfect'; yield_stress = '1 GPa'
KINEMATIC PERFECT body.plasticity.kinematic.: modulus = ['1 GPa', '2 GPa']; recovery = [300, 0]
BATH SPHERE friction.: law = 'chemical-film'; low = 0.1; high = 0.4; film_thickness = '100 nm'; \
    film_young = '80 GPa'; film_poisson = 0.3; film_yield = '667 MPa'; bath_temperature = '373.15 K'; \
    track = '314 mm'; contact_width = '300 um'; speed = '1 m/s'
LAYER SWIFT body.plasticity.: layer_thickness = '1 um'; layer.law = 'swift'; layer.B = '945 MPa'; \
    layer.C = 20; layer.n = 0.121
CYLINDER SPHERE counterbody.: shape = 'cylinder'; length = '1 mm'
PATH SPHERE loading.path.: start = ['-9 um', '0 um']; end = ['9 um', '0 um']; steps = 4
GIVEN SPHERE: -counterbody; -loading.force; loading.prescribed = 'hertz'; loading.p0 = '4 GPa'; \
    loading.radius = '6 um'
GIVEN_PATH GIVEN loading.path.: start = ['-9 um', '0 um']; end = ['9 um', '0 um']; steps = 4
MISFIT LINEAR: -counterbody; -loading.force; loading.prescribed = 'misfit-sphere'; loading.depth = '15 um'; \
    loading.radius = '10 um'; loading.misfit = 0.02
FLAT SPHERE: -counterbody; counterbody.shape = 'flat'; surface.kind = 'sinusoid'; \
    surface.amplitude = '1 nm'; surface.wavelength_x = '9 um'; grid.cells = [32, 32]; \
    grid.extent = ['20 um', '20 um']
TURNED FLAT surface.: -amplitude; -wavelength_x; kind = 'hard-turned'; ra = '0.3 um'; feed = '20 um'; \
    nose_radius = '0.8 mm'; feed_share = 0.4; cutoff_long = '16 um'; cutoff_short = '6 um'; hurst = 0.8; \
    seed = 7
OTHER FLAT counterbody.surface.: kind = 'self-affine'; sq = '20 nm'; cutoff_long = '16 um'; \
    cutoff_short = '8 um'; hurst = 0.8; seed = 5
RENEWED OTHER: loading.cycles = 2; loading.unload = true; counterbody.surface.renew = true
WAVE FLAT counterbody.surface.: kind = 'sinusoid'; amplitude = '0.1 um'; wavelength_x = '10 um'
MAP FLAT: -surface; -grid; counterbody.surface.kind = 'file'; counterbody.surface.path = 'map.csv'
SLIDING OTHER: grid.cells = [24, 24]; grid.extent = ['24 um', '24 um']; surface.wavelength_x = '12 um'; \
    counterbody.surface.cutoff_long = '24 um'; counterbody.surface.cutoff_short = '12 um'; \
    loading.path.start = ['-6 um', '0 um']; loading.path.end = ['6 um', '0 um']; loading.path.steps = 6
"""
for line in lines_of(GOOD):
    names, edits = line.split(": ", 1)
    name, base, table, *_ = [*names.split(), "", ""]
    SCENES[name] = changed(SCENES[base], keys(edits, table))

AT, PRESSURE = "body.plasticity.", 'a pressure as a string with a unit, such as "210 GPa"'
COLUMNS = "columns peeq and yield_stress_Pa, 1 to 10000 rows"
LIST, RECOVERY = "a list of 1 to 8", "a number from 0 to 1e+07"
WORDS = {
    "PRESSURE": PRESSURE,
    "LENGTH": 'a length as a string with a unit, such as "10 um"',
    "COLUMNS": COLUMNS,
    "SWIFT": 'law = "swift" takes B, C, n',
    "OUTSIDE": "outside the folder of the scene",
    "FACES": "with plasticity the faces of the layers: two or more, the first 0",
    "LIST": LIST,
    "RECOVERY": RECOVERY,
    "TOGETHER": "young and poisson together",
    "FILM": "body.coating.thickness = '1 um'; body.coating.young = '80 GPa'; body.coating.poisson = 0.3",
}
REFUSED = r"""
## SPHERE
body.young = 210000000000.0 | '210e9' | '210 mm' | 'nan GPa' | '1e400 GPa' | '2 GPa * 3' | '9**9**9**9 Pa' \
    | '1 Pa**9**9**9' | '1 2 GPa' | '20 degC' | true | ['210 GPa'] | '' -> = & $PRESSURE
body.young = '-210 GPa' | '0 GPa' -> = & must be positive: a pressure & from 1e-30 to 1e+30 Pa
body.young = '210 Gpa' | '210 gPA' -> = & unknown unit & did you mean GPa? allowed: a pressure
body.young = '210 foo' -> = & unknown unit foo, allowed: a pressure
body.poisson = 0.51 | -0.1 | nan | true | '0.3' -> = & from 0 to 0.5
-body.young -> body.young is missing & $PRESSURE
-body; -title -> body is missing & a table [body]
body = [{young = '210 GPa', poisson = 0.3}] -> body = [{ & a table
-body.young; body.yuong = '210 GPa' -> = & did you mean young? & young, poisson
lodaing.x = 1 -> lodaing = & did you mean loading?
-counterbody -> counterbody is missing & required: a table [counterbody], or loading.prescribed
body.coating = {} -> body.coating.thickness is missing & body.coating.young is missing
surface.kind = 'file' -> surface.path is missing & takes path
friction = {} -> friction.coefficient is missing & from 0 to 10
loading.unload = true; wear.strain_limit = 0.01 -> wear & only together with [body.plasticity]
wear = {strain_limit = 1, smoothing_window = 0, smoothing_fills = true} -> wear.smoothing_fills & = 0: nothing
wear = {strain_limit = 0.01, roof = 'gone'} -> wear.roof & "stays" or "falls"
solver.method = 'paper' -> = & needs [body.plasticity]
solver.stop = 'stress' -> = & together with method = "paper"
solver.tolerance = 0 -> = & from 1e-14 to 0.1
fem.box = 2.9 -> = & from 3 to 1000
fem.cells_per_radius = 257 | 1 -> = & from 2 to 256
title = 3 -> = & a string
## SPHERE counterbody.
-radius; shape = 'cone' -> = & "rounded-punch", "flat" or "cylinder"
-shape; radius = '1 mm' -> @shape is missing & "sphere" or "ellipsoid"
-radius; shape = 'flat' -> surface is missing & =
shape = 'flat'; radius = '1 mm' -> = & takes no radius
-radius -> @radius is missing & takes radius
radius = '1 mm'; radius_x = '1 mm' -> = & takes radius: remove it
-radius; shape = 'ellipsoid'; radius_x = '1 mm'; radius_y = '1 km' -> = \
 & radius_x/radius_y from 0.0001 to 10000
shape = 'punch'; radius = '1 mm'; young = '1 GPa' -> @poisson is & $TOGETHER
shape = 'punch'; radius = '1 mm'; poisson = 0.2 -> @young is & $TOGETHER
slip = 0.5 -> = & only together with loading.path
## CYLINDER
-loading.force; loading.approach = '1 um' -> = & the approach of a line contact has no absolute value
grid.cells = [65, 4] -> = & one cell along y with a smooth
grid.extent = ['1 mm', '2 mm'] -> = & 0.001 m along y, the length of the cylinder
grid.periodic = 'xy' -> = & "y" with
solver.operator = 'swept' -> = & "dense" with
$FILM -> body.coating & with counterbody.shape = "cylinder"
loading.path.start = ['0 um', '0 um']; loading.path.end = ['9 um', '1 um']; loading.path.steps = 99 -> \
    loading.path.end = & y = 0 as in start
surface.kind = 'sinusoid'; surface.amplitude = '1 nm'; surface.wavelength_x = '9 um'; \
    grid.extent = ['1 mm', '1 mm']; grid.cells = [900, 4] -> grid.periodic is missing & "y" with
## SPHERE loading.
force = '-1 N' -> = & or 0
steps = 0 -> = & a whole number from 1 to 1000
steps = 2.5 | 2.0 -> = & a whole number
unload = 1 -> = & true or false
unload_steps = 2 -> = & unload = true
prescribed = 'hertz'; p0 = '4 GPa'; radius = '6 um' -> @force = "0.65 N" & not both & counterbody = { \
 & nothing presses
p0 = '4 GPa' -> = & only as part of prescribed = "h
approach = '0.1 um' -> = & either force or approach, not both
-force; approach = '-1 nm' | '0 nm' | '0.65 N' | 1e-07 | 'nan m' | true -> = & a length as a string
path.start = ['-9 m', '0 um']; path.end = ['9 m', '0 um']; path.step_per_radius = 1 -> = \
 & at most 0.0003363 & 1000 steps
## GIVEN
loading = {} -> loading.force is missing & required: force, approach, or prescribed
-loading.p0; -loading.radius -> loading.p0 is missing & loading.radius is missing & required: prescribed
loading.prescribed = 'flat' -> = & "hertz"
loading.approach = '0.1 um' -> = & either approach, or prescribed
surface.kind = 'sinusoid'; surface.amplitude = '1 nm'; surface.wavelength_x = '9 um' -> surface = {"kind": \
 & with loading.prescribed = "hertz" not available in this version
body.plasticity.law = 'perfect'; body.plasticity.yield_stress = '1 GPa'; friction.coefficient = 1; \
    loading.p0 = '0.867 GPa' -> = & at most 8.66e+08 Pa with friction.coefficient = 1
## GIVEN_PATH loading.path.
end = ['-9 um', '0 um'] -> = & another place than start
end = [9e-06, '0 um'] -> @end[0] = 9e-06 & such as "-10 um"
end = ['9 um'] -> = & a list of 2
-steps -> @steps is missing & a whole number from 1 to 1000 & or step_per_radius
return = 'to-and-fro' -> = & where the pressure is given
## SPHERE friction.
coefficient = -0.1 | inf -> = & from 0 to 10
coefficient = 0.1; coupling = 0 -> = & true or false
coefficient = 0.1; direction = 'x' -> = & "constant" or "alternating"
law = 'viscous' -> = & "constant", "map" or "chemical-film"
## BATH friction.
film_poisson = 0.5 -> = & less than 0.5
contact_width = '314 mm' -> = & less than track, 0.314 m
## SPHERE grid.
border = 'relief' -> = & only together with [surface]
cells = [65, 1] -> = & 3 or more cells along y
cells = [65] | 65 -> = & a list of 2
cells = [65, 5000] -> @cells[1] = 5000 & from 1 to 4097
extent = ['1 um', 2] -> @extent[1] = 2 & $LENGTH
depths = ['1 um', '0 um'] -> = & strictly ascending
depths = [] -> = & a list of 1 to 1001
depths = ['0 um']; layers = 3; depth = '1 um' -> @depths = ["0 um"] & not both
layers = 3 -> @depth is missing & layers and depth together
## SPHERE body.plasticity.
B = '1 GPa' -> @law is missing & "swift" or "linear" or "perfect"
law = 'table' -> @file is missing & law = "table" takes file
law = 'table'; file = 3 -> = & the name of a CSV file & $COLUMNS
law = 'table'; file = 'none.csv' -> = & cannot be read: No such file
law = 'table'; file = '../curve.csv' | '/etc/passwd' -> = & $OUTSIDE
law = 'table'; file = "a\u0000" -> @file = & cannot be read
## SWIFT body.plasticity.
-B -> @B is missing & $SWIFT
B = '-1 MPa' -> = & from 1e-30
C = 0 | '20' -> = & a number from 1e-15
n = 0 | 1.0 | nan -> = & from 1e-06 to 0.999999
alpha = 0 -> = & a number from 1e-15
yield_stress = '1 GPa' -> yield_stress = & law = "swift" takes B, C, n, alpha: remove
## LINEAR body.plasticity.
-modulus -> modulus is missing & yield_stress, modulus
modulus = '-1 GPa' -> = & or 0
## PERFECT body.plasticity.
modulus = '0 Pa' -> modulus = & "perfect" takes yield_stress: remove
layer_thickness = 1e-06 -> layer_thickness = 1e-06 & a length as a string
profile = 'p.csv' -> = & No such file
kinematic.recovery = [300] -> @kinematic.modulus & is missing & required
## SWIFT
body.poisson = 0.5 -> = & less than 0.5 with plasticity
grid.depths = ['1 nm', '1 um'] | ['0 um'] -> = & $FACES
solver.method = 'paper'; solver.stop = 'x' -> solver.stop & "stress" or "strain"
solver.method = 'newton' -> = & "paper"
solver.extrapolate = true; grid.depth = '10 um'; grid.layers = 7 -> = & an even number of layers
solver.extrapolate = true; grid.depths = ['0 um', '1 um', '2 um'] -> = & an even number of layers
## LAYER
-body.plasticity.layer_thickness -> body.plasticity.layer_thickness is missing & [body.plasticity.layer]
body.plasticity.layer = 3 -> = & a table
$FILM -> body.plasticity.layer & not together with [body.coating]
## LAYER body.plasticity.layer.
law = 'voce' -> = & "swift", "linear"
profile = 'p.csv' -> @profile & unknown key
layer_thickness = '1 um' -> @layer_thickness & unknown key, did you mean body.plasticity.layer_thickness
-B; -C; -n; law = 'table'; file = 'curve.csv' -> = & line 3 & softening is not available
## PATH loading.path.
step_per_radius = 4 -> = & not both
steps = 2 -> = & 3 or more & longer than the contact radius, 6.053e-06 m
-steps; step_per_radius = 0.5 -> = & from 1 to 1000
return = 'round' -> = & "lifted" or "to-and-fro"
start = [1, 2] | '9 um' | ['9 um', '0 um', '0 um'] | ['9 GPa', '0 um'] | [] -> @start
speed = 1 -> @speed
## PATH
loading.force = '0 N' -> = & above 0 with loading.path
loading.path.end = ['9 um', '3 um']; friction.coefficient = 0.2 -> loading.path.end = ["9 um", "3 um"] \
 & the y of start
friction.coefficient = 0.2; friction.direction = 'alternating' -> = & along the motion
counterbody.slip = 0; friction.coefficient = 0.2 -> counterbody.slip = 0 & stick-slip & =
counterbody.slip = -0.1 | 1.5 | nan | '1' | true -> = & from 0 to 1
grid.extent = ['24 um', '24 um'] -> = & at least 3.011e-05 m and 1.211e-05 m
body.coating.thickness = '1 um'; wear.strain_limit = 0.1 -> wear = { & body.coating = { \
 & with loading.path not available
solver.method = 'paper' -> = & knows no motion
loading.path = {begin = ['-9 um', '0 um'], end = ['9 um', '0 um'], step_per_radius = 3} \
    -> loading.path.start is missing: required: a list of 2, each a coordinate as a string
-loading.path.steps; loading.path.step_per_radius = 3; loading.force = '0 N' -> = & above 0 with loading.path
loading.force = '1e-25 N'; -loading.path.steps; loading.path.step_per_radius = 3 -> = & at most
## MISFIT loading.
-depth -> @depth & required
depth = '15 N' | '-15 um' -> @depth & a length
depth = '10 um' | '5 um' -> @depth & more than the radius
misfit = -0.02 | 0.0 | 2.0 | '2 %' -> @misfit & a strain
profile = 'cube' -> @profile & smooth
profile = 'gauss' -> @depth & 3 times the radius
surface = 'fixed' -> @surface & held
force = '1 N' -> @force & not both
p0 = '1 GPa' -> @p0 & prescribed = "hertz"
path.start = ['0 um', '0 um']; path.end = ['5 um', '0 um']; path.steps = 2 -> @path & prescribed = "hertz"
-prescribed; force = '1 N' -> @misfit & only as part of prescribed = "misfit-sphere"
prescribed = 'hertz'; p0 = '1 GPa' -> @depth & only as part of prescribed = "misfit-sphere"
## MISFIT
friction.coefficient = 0.1 -> friction & not together with
surface.kind = 'sinusoid'; surface.amplitude = '1 nm' -> surface & remove it
$FILM -> body.coating & not together with
counterbody.shape = 'sphere' -> counterbody & nothing presses on the body
loading.unload = true; wear.strain_limit = 0.01 -> loading.prescribed & needs a contact
solver.method = 'paper' -> solver.method & solves a contact
## TURNED surface.
-seed -> @seed is missing: required: kind = "hard-turned" takes ra, feed
kind = 'self-affine' -> @feed = "20 um": kind = "self-affine" takes & anisotropy: remove it
kind = 'wood' -> @kind = "wood": one of "file", "hard-turned", "self-affine" or
cutoff_long = '6 um' -> @cutoff_short = "6 um": less than cutoff_long, 6e-06 m
feed = '5 um' -> @feed = "5 um": at least cutoff_short, 6e-06 m
## TURNED
surface.anisotropy = 1.5; grid.cells = [5, 20] -> grid.cells = [5, 20]: at least [7, 5]: 2 cells in
-grid.cells -> grid.cells is missing: required: grid.cells and grid.extent
grid.extent = ['24 um', '5 um'] -> grid.extent = ["24 um", "5 um"]: at least 6e-06 m and 6e-06 m
-surface -> surface is missing: required: a table [surface] or [counterbody.surface], as & flat
grid.border = 'round' -> grid.border = "round": one of "free" or "relief"
solver.extrapolate = true -> = & belong to their grid
## FLAT surface.
-wavelength_x -> required: wavelength_x, wavelength_y, or both
form = 'sphere' -> = & kind = "sinusoid" takes amplitude, wavelength_x, wavelength_y: remove it
## FLAT counterbody.
surface = {} -> @surface.kind is missing: & "file" or "hard-turned" or "self-affine" or "sinusoid"
renew = true -> = & did you mean counterbody.surface.renew?
surface = 'map.csv' -> = & a table
## WAVE counterbody.surface.
amplitude = '0 um' -> = & from 1e-30 to 1e+30 m
wavelength_x = '1 um' -> grid.cells & in the shortest wavelength
## RENEWED counterbody.surface.
renew = 1 | 'each' | [true] -> = & true or false
seed = -1 | '5' | 1.5 -> = & a whole number from 0
seed = 9223372036854775808 -> = & to 9.22337e+18
-sq -> required: ra or sq
ra = '20 nm' -> @sq = "20 nm": & either ra or sq
cutoff_short = '1 um' -> grid.cells = [32, 32]: & at least [40, 40]
crop = ['4 um', '4 um'] -> = & remove it
## MAP counterbody.surface.
-path -> @path is missing & kind = "file" takes path
path = 3 -> = & the name of a CSV or npz file
path = 'none.csv' -> = & No such file
renew = true -> = & no second part of the size of counterbody.surface.crop
renew = true; crop = ['5 um', '6 um'] -> @renew = true: & false: no second part
crop = ['9 um', '9 um'] -> = & 8e-06 m
form = 'cone' | 3 -> @form & "quadratic"
resample = 'spline' -> = & "fourier"
taper = 0.1 -> = & only together with grid.periodic = "xy"
## SLIDING
-counterbody.surface -> loading.path & nothing moves
counterbody.slip = 0 -> counterbody.slip & nothing moves on a plane
-counterbody.surface; -loading.path.steps; loading.path.step_per_radius = 4 \
    -> loading.path.steps & no contact radius
loading.path.end = ['6.5 um', '0 um'] -> = & slides 12.5 and 0 cells
loading.path.steps = 8 -> = & 12, or a divisor
counterbody.slip = 0.5; loading.path.steps = 4 -> = & 6, or a divisor
loading.path.steps = 3 -> = & 4 or more
counterbody.surface.renew = true; loading.unload = true; loading.cycles = 2; \
    loading.path.return = 'to-and-fro' -> counterbody.surface.renew & the load stays on
counterbody.surface = {kind = 'file', path = 'map.csv'} -> counterbody.surface.path & at least 3.6e-05 m x \
    2.4e-05 m, the patch and the way of the counter-body over it; it has 8e-06
counterbody.surface = {kind = 'file', path = 'map.csv', resample = 'fourier'} \
    -> counterbody.surface.resample & remove it
counterbody.surface = {kind = 'file', path = 'map.csv'}; grid.extent = ['48 um', '24 um'] \
    -> counterbody.surface.path & cells of 2e-06 m x 1e-06 m, as those of the body; it has 1e-06 m x 1e-06 m
counterbody.surface.cutoff_short = '1.5 um' -> grid.cells & in the shortest wavelength
## KINEMATIC body.plasticity.kinematic.
modulus = ['1 GPa', '1 GPa', '1 GPa', '1 GPa', '1 GPa', '1 GPa', '1 GPa', '1 GPa', '1 GPa'] \
    -> @modulus = ["1 GPa", " & $LIST
modulus = ['1 GPa', '2 um'] | ['1 GPa', '-2 GPa'] | ['1 GPa', '2'] | ['1 GPa', true] \
    -> @modulus[1] & a pressure as a string
recovery = 300 | [] -> = & $LIST
recovery = [-1, 0] | ['1', 0] | [nan, 0] | [100000000.0, 0] | [[300, 0], 1] -> @recovery[0] & $RECOVERY
"""
LONG = [
    (f"body.young = '1 {'Pa*' * 500}Pa'", ['body.young = "1 Pa*Pa', PRESSURE]),
    (f"body.poisson = 1{'0' * 400}", ["body.poisson = 1000", "from 0 to 0.5"]),
    (f"body.plasticity.law = 'table'; body.plasticity.file = '{'a' * 300}'", ["cannot be read"]),
]
FLOOR = "peeq,yield_stress_Pa\n0,1e9\n"
CURVES = [
    ("", ['its first line is ""', COLUMNS]),
    ("peeq,peeq\n0,1e9\n", ['its first line is "peeq,peeq"']),
    ("peeq,yield_stress_Pa\n\xff,1\n", ["not UTF-8"]),
    ("peeq,yield_stress_Pa\n\n\n", [COLUMNS]),
    ('peeq,yield_stress_Pa\n0,"1e9\n', ["not CSV"]),
    ("peeq,yield_stress_Pa\n0," + "1" * 200_000, ["not CSV: field larger"]),
    ("#" * (1 << 20) + "\n", ["too large: at most 1048576 bytes"]),
    (FLOOR + "0,1e9\n" * 10_000, ["more than 10000 rows"]),
    ("peeq,yield_stress_Pa\n0,1e9,3\n", ['line 2: ["0", "1e9", "3"] is not two numbers']),
    ("peeq,yield_stress_Pa\n0,1 GPa\n", ['line 2: yield_stress_Pa = "1 GPa", allowed: a pressure']),
    (FLOOR + "inf,2e9\n", ["line 3: peeq = Infinity, allowed: a number from 0 to 1000"]),
    ("peeq,yield_stress_Pa\n0.002,1e9\n", ["line 2: peeq = 0.002, allowed: 0 in the first row"]),
    (FLOOR + "\n0,2e9\n", ["line 4: peeq = 0 after 0, allowed: strictly ascending"]),
    (FLOOR + "0.1,9e8\n", ["line 3: yield_stress_Pa = 9e+08 after 1e+09: softening is not av"]),
    ("peeq,yield_stress_Pa\n" + "0,a\n" * 7, ["line 2: ", "line 5: ", "; and 3 more"]),
]
PROFILES = [
    (FLOOR, ["depth_m and factor"]),
    ("depth_m,factor\n-1e-6,1\n", ["line 2: depth_m = -1e-06, allowed: a depth"]),
    ("depth_m,factor\n0,0\n", ["line 2: factor = 0.0, allowed: a number from 1e-06"]),
]


def cases() -> Iterator[tuple[str, str, str, list[str]]]:
    """The scene that is changed, the table of its keys, the changes, and pieces of the message."""
    yield from (("SPHERE", "", edits, pieces) for edits, pieces in LONG)
    for line in lines_of(REFUSED):
        if line.startswith("##"):
            _, name, table = f"{line} ".split(" ", 2)
            continue
        edits, words = re.sub(r"\$([A-Z_]+)", lambda word: WORDS[word[1]], line).split(" -> ")
        first, *others = map(str.strip, edits.split(" | "))
        lead = first[: first.rindex(" = ") + 3] if " = " in first else ""
        for edit in (first, *(lead + other for other in others)):
            yield name, table.strip(), edit, [piece.strip() for piece in words.split(" & ")]


def in_words(piece: str, edits: dict[str, str | None], table: str) -> str:
    """A piece of a message, see above."""
    key, value = list(edits.items())[-1]
    if piece == "=":
        return f"{key} = {json.dumps(tomllib.loads(f'x = {value}')['x'], ensure_ascii=False, default=str)}"
    return table + piece[1:] if piece.startswith("@") else piece


@pytest.fixture
def message(folder, refused):
    """Writes a scene beside a curve, which falls if none is given, and a map; returns what its solve says."""

    def said(scene, curve=FLOOR + "0.1,9e8\n"):
        text = "".join(f"{key} = {value}\n" for key, value in scene.items())
        (folder / "bad.toml").write_text(text, encoding="utf-8")
        (folder / "curve.csv").write_bytes(curve.encode("latin-1"))
        rows = [f"{x}e-6,{y}e-6,{x % 2}e-8\n" for x in range(8) for y in range(8)]
        (folder / "map.csv").write_text("x_m,y_m,height_m\n" + "".join(rows))
        words = refused("solve", "bad.toml", "--out", "out")
        assert "bad.toml" in words and len(words) < 2000
        return words

    return said


@pytest.mark.parametrize("name", sorted(SCENES.keys() - {"", "MAP"}))
def test_the_scenes_that_are_changed_are_good(name):
    text = "".join(f"{key} = {value}\n" for key, value in SCENES[name].items())
    assert parse_scene(text.encode(), "good.toml")


@pytest.mark.parametrize("base, table, edits, pieces", list(cases()))
def test_a_malformed_scene_is_refused_by_name_and_nothing_is_created(message, base, table, edits, pieces):
    given = keys(edits, table)
    words = message(changed(SCENES[base], given))
    assert [piece for piece in pieces if in_words(piece, given, table) not in words] == []


@pytest.mark.parametrize(
    "key, content, pieces", [("file", *case) for case in CURVES] + [("profile", *case) for case in PROFILES]
)
def test_a_malformed_file_of_a_scene_is_refused_by_line(message, key, content, pieces):
    law = keys(f"law = '{'table' if key == 'file' else 'perfect'}'; {key} = 'curve.csv'", AT)
    law |= keys("yield_stress = '1 GPa'", AT) if key == "profile" else {}
    words = message(SCENES["SPHERE"] | law, content)
    assert words.count("\n") == 1 and len(words) < 1000
    assert [piece for piece in [f'{AT}{key} = "curve.csv": ', *pieces] if piece not in words] == []


IN, BACK = "body.plasticity.layer", "body.plasticity.kinematic"
SWIFT = builders.SWIFT
THICK = SWIFT | {"layer_thickness": 1e-6}
SOFT = {"law": "perfect", "yield_stress": 355e6}
RISING = {"law": "linear", "yield_stress": 1e6, "modulus": 549.79e6}  # at 0.002 2.09958 MPa
MPA = {"law": "table", "file": ((0.0, 355.0), (0.01, 450.0))}  # in MPa, under a column in Pa
COATING = {"thickness": 1e-6, "young": 300e9, "poisson": 0.25, "yield_stress": 4e3}
FILMED = {"law": "chemical-film", "low": 0.1, "high": 0.4, "film_thickness": 1e-7, "film_young": 70e9}
FILMED |= {"film_poisson": 0.3, "strain_limit": 0.1, "film_yield": 700.0}
MODULUS = "a pressure from 1e-30"


def plastic(law, **more) -> dict:
    return {"body": {"plasticity": law | more}}


def back(**kinematic) -> dict:
    return plastic(SWIFT, kinematic={"modulus": (1e9, 2e9), "recovery": (300.0, 0.0)} | kinematic)


def rows_of(*rows) -> dict:
    return {"body": {"plasticity": {"law": "table", "file": list(rows)}}}


def described(**keys) -> dict:
    path = {"sha256": "00" * 32, "cells": (8, 8), "extent": (1e-6, 1e-6)} | keys
    return {"surface": {"kind": "file", "path": path}}


# tables of a scene: key that is named, pieces of its value and of what is said of it
IN_PYTHON = [
    (plastic(THICK, layer_thickness=float("nan"), layer=SOFT), f"{IN}_thickness", "NaN", "a length from"),
    (plastic(THICK, layer=[SOFT]), IN, "perfect", "a table"),
    (plastic(THICK, layer=SWIFT | {"B": "945 um"}), f"{IN}.B", "945 um", MODULUS),
    (plastic(THICK, layer=SWIFT | {"kinematic": {"modulus": ()}}), f"{IN}.kinematic.modulus", "[]", LIST),
    (plastic(SWIFT, kinematic=3), BACK, "3", "a table"),
    (back(modulus=1e9), f"{BACK}.modulus", "1000000000.0", LIST),
    (back(modulus=(0.0,)), f"{BACK}.modulus[0]", "0.0", MODULUS),
    (back(modulus=(True,)), f"{BACK}.modulus[0]", "true", MODULUS),
    (back(recovery=(1.0,) * 3), f"{BACK}.recovery", "1.0", "as many numbers as modulus has: 2"),
    (back(recovery=(0.0, 2e7)), f"{BACK}.recovery[1]", "20000000.0", RECOVERY),
    (back(recovery=(True, 0.0)), f"{BACK}.recovery[0]", "true", RECOVERY),
    (back() | {"solver": {"verdict": 1}}, "solver.verdict", "1", "true or false"),
    (back() | {"solver": {"method": "paper"}}, "solver.method", "paper", "knows no back-stress"),
    (plastic(MPA), f"{AT}file", "", "at a plastic strain of 0.002: it is 374 Pa: are values in MPa"),
    (plastic(SWIFT, B=945.0), f"{AT}B", "", "at least 2.1e+06 Pa"),
    (plastic(SOFT, yield_stress=2.099e6), f"{AT}yield_stress", "", "at least 2.1e+06 Pa"),
    (plastic(RISING), f"{AT}yield_stress", "", "at least 2.1e+06 Pa"),
    (plastic(SOFT, profile=((0.0, 1.0), (1e-5, 1e-3))), f"{AT}profile", "", "factors from 0.001"),
    (plastic(THICK, layer=SOFT | {"yield_stress": 1.0}), f"{IN}.yield_stress", "", "it is 1 Pa"),
    ({"body": {"coating": COATING}}, "body.coating.yield_stress", "", "least 3e+06 Pa"),
    ({"friction": FILMED}, "friction.film_yield", "", "film_young/100000"),
    (plastic({"law": "table", "file": "curve.csv"}), f"{AT}file", "curve", "rows: columns peeq"),
    (rows_of(), f"{AT}file", "", COLUMNS),
    (rows_of(0.0, 1e9), f"{AT}file", "", "row 1: 0.0 is not two numbers"),
    (rows_of((0.0, 1e9), (0.1, 1e9, 2)), f"{AT}file", "", "row 2: "),
    (rows_of((0.0, np.nan)), f"{AT}file", "", "row 1: yield_stress_Pa = NaN"),
    ({"surface": {"kind": "file", "path": np.zeros((5, 5))}}, "surface.path", "", "wrap it: samfem"),
    (described(sha256="00" * 31), "surface.path", "0000", "or sha256, cells and extent of one"),
    (described(cells=(2, 8)), "surface.path", "sha256", "or sha256, cells and extent of one"),
]
USUAL = [
    {"young": 11e9, "plasticity": SOFT | {"yield_stress": 1e6}},  # annealed indium
    {"young": 1141e9, "plasticity": SOFT | {"yield_stress": 80e9}},  # diamond
    {"plasticity": SWIFT | {"C": 1e-15, "n": 0.5}},  # rises from nearly 0
    {"plasticity": SOFT | {"yield_stress": 1e12}},  # never yields
    {"plasticity": SOFT | {"yield_stress": 1e9, "kinematic": {"modulus": (1e9,) * 8}}},  # as many as may be
]


@pytest.mark.parametrize("tables, key, value, allowed", IN_PYTHON)
def test_a_malformed_scene_is_refused_by_name_in_python(tables, key, value, allowed):
    tables = {"counterbody": builders.SPHERE, "loading": {"force": 1.0}} | tables
    with pytest.raises(SceneError) as caught:
        Scene(**tables | {"body": builders.STEEL | tables.get("body", {})})
    found = [(each.key, each.value, each.allowed) for each in caught.value.problems]
    assert any(place == key and value in given and allowed in said for place, given, said in found), found


@pytest.mark.parametrize("body", USUAL)
def test_a_yield_stress_of_a_real_material_is_taken(body):
    assert Scene(body=builders.STEEL | body, counterbody=builders.SPHERE, loading={"force": 1.0})
