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
import pytest
from pydantic import ValidationError

from sam.scene import Scene, parse_scene


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


SPHERE = keys(
    "title = 'Sphere'; body.young = '210 GPa'; body.poisson = 0.3; counterbody.shape = 'sphere'; "
    "counterbody.radius = '105 um'; loading.force = '0.65 N'"
)
SWIFT = SPHERE | keys("law = 'swift'; B = '945 MPa'; C = 20; n = 0.121", "body.plasticity.")
LINEAR = SPHERE | keys("law = 'linear'; yield_stress = '1 GPa'; modulus = '10.5 GPa'", "body.plasticity.")
PERFECT = SPHERE | keys("law = 'perfect'; yield_stress = '1 GPa'", "body.plasticity.")
KINEMATIC = PERFECT | keys("modulus = ['1 GPa', '2 GPa']; recovery = [300, 0]", "body.plasticity.kinematic.")
LAYER = SWIFT | keys("body.plasticity.layer_thickness = '1 um'")
LAYER |= keys("law = 'swift'; B = '945 MPa'; C = 20; n = 0.121", "body.plasticity.layer.")
ON_PATH = keys("start = ['-9 um', '0 um']; end = ['9 um', '0 um']; steps = 4", "loading.path.")
PATH = SPHERE | ON_PATH
GIVEN = changed(SPHERE, keys("-counterbody; -loading.force"))
GIVEN |= keys("prescribed = 'hertz'; p0 = '4 GPa'; radius = '6 um'", "loading.")
GIVEN_PATH = GIVEN | ON_PATH
MISFIT = changed(LINEAR, keys("-counterbody; -loading.force"))
MISFIT |= keys("prescribed = 'misfit-sphere'; depth = '15 um'; radius = '10 um'; misfit = 0.02", "loading.")
FLAT = changed(SPHERE, keys("-counterbody")) | keys("counterbody.shape = 'flat'")
WAVES = FLAT | keys("cells = [20, 20]; extent = ['24 um', '24 um']; border = 'relief'", "grid.")
WAVES |= keys(
    "kind = 'hard-turned'; ra = '0.3 um'; feed = '20 um'; nose_radius = '0.8 mm'; feed_share = 0.4; "
    "cutoff_long = '16 um'; cutoff_short = '6 um'; hurst = 0.8; anisotropy = 1.5; seed = 7",
    "surface.",
)
COUNTER = FLAT | keys("loading.cycles = 2; loading.unload = true")
COUNTER |= keys("cells = [32, 32]; extent = ['20 um', '20 um']", "grid.")
ON = "counterbody.surface."
WAVE = COUNTER | keys(
    "kind = 'sinusoid'; amplitude = '0.1 um'; wavelength_x = '10 um'; wavelength_y = '8 um'", ON
)
DISC = COUNTER | keys("kind = 'self-affine'; sq = '20 nm'; cutoff_long = '16 um'; cutoff_short = '8 um'", ON)
DISC |= keys("hurst = 0.8; seed = 5; renew = true", ON)
MAP = COUNTER | keys("kind = 'file'; path = 'map.csv'; renew = true", ON)

ROUGH_PATH = PATH | keys("cells = [40, 40]; extent = ['40 um', '40 um']", "grid.")
ROUGH_PATH |= keys(
    "kind = 'self-affine'; sq = '10 nm'; cutoff_long = '9 um'; cutoff_short = '3 um'; hurst = 0.8; seed = 3",
    ON,
)
SCENES = {
    "SPHERE": SPHERE,
    "SWIFT": SWIFT,
    "LINEAR": LINEAR,
    "PERFECT": PERFECT,
    "KINEMATIC": KINEMATIC,
    "LAYER": LAYER,
    "PATH": PATH,
    "GIVEN": GIVEN,
    "GIVEN_PATH": GIVEN_PATH,
    "MISFIT": MISFIT,
    "WAVES": WAVES,
    "COUNTER": COUNTER,
    "WAVE": WAVE,
    "DISC": DISC,
    "MAP": MAP,
    "ROUGH_PATH": ROUGH_PATH,
}
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
    "LAYERED": "layer_thickness = '1 um'; layer.law = ",
    "FILM": "body.coating.thickness = '1 um'; body.coating.young = '80 GPa'; body.coating.poisson = 0.3",
}
REFUSED = r"""
## SPHERE
body.young = 210000000000.0 | '210e9' | 'GPa' | '210 mm' | '210 Gpa' | 'nan GPa' | 'inf GPa' \
    | '1e400 GPa' | '2 GPa * 3' | '9**9**9**9 Pa' | '1 Pa**9**9**9' | '1 ((Pa))' | '1 2 GPa' \
    | '210,5 GPa' | '20 degC' | '20 dB' | true | 2024-01-01 | ['210 GPa'] | '' -> = & $PRESSURE
body.young = '-210 GPa' | '0 GPa' -> = & from 1e-30 to 1e+30 Pa
body.poisson = 0.51 | -0.1 | nan | true | '0.3' -> = & from 0 to 0.5
-body.young -> body.young is missing & $PRESSURE
-body; -title -> body is missing & a table [body]
-title; body = 3 -> = & a table
body = [{young = '210 GPa', poisson = 0.3}] -> body = [{ & a table
-body.young; body.yuong = '210 GPa' -> = & did you mean young? & young, poisson
lodaing.x = 1 -> lodaing = & did you mean loading?
-counterbody -> counterbody is missing & required: a table [counterbody], or loading.prescribed
body.coating = {} -> body.coating.thickness is missing & body.coating.young is missing
surface.kind = 'file' -> surface.path is missing & takes path
friction = {} -> friction.coefficient is missing & from 0 to 10
loading.unload = true; wear.strain_limit = 0.01 -> wear & only together with [body.plasticity]
solver.method = 'paper' -> = & needs [body.plasticity]
solver.stop = 'stress' -> = & together with method = "paper"
solver.tolerance = 0 -> = & from 1e-14 to 0.1
fem.box = 2.9 -> = & from 3 to 1000
fem.cells_per_radius = 257 | 1 -> = & from 2 to 256
title = 3 -> = & a string
body.plasticity = 3 -> = & a table
## SPHERE counterbody.
-radius; shape = 'cone' -> = & "punch", "rounded-punch" or "flat"
-shape; radius = '1 mm' -> @shape is missing & "sphere" or "ellipsoid"
-radius; shape = 'flat' -> surface is missing & =
shape = 'flat'; radius = '1 mm' -> = & takes no radius
-radius -> @radius is missing & takes radius
radius = '1 mm'; radius_x = '1 mm' -> = & takes radius: remove it
-radius; shape = 'ellipsoid'; radius_x = '1 mm' -> @radius_y is missing & takes radius_x and radius_y
-radius; shape = 'ellipsoid'; radius_x = '1 mm'; radius_y = '1 km' -> = \
 & radius_x/radius_y from 0.0001 to 10000
-radius; shape = 'punch' -> @radius is missing & takes radius
shape = 'punch'; radius = '1 mm'; young = '1 GPa' -> @poisson is & $TOGETHER
shape = 'punch'; radius = '1 mm'; poisson = 0.2 -> @young is & $TOGETHER
slip = 0.5 -> = & only together with loading.path
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
-force; approach = '-1 nm' | '0 nm' | '0.65 N' | 1e-07 | 'nan m' | 'inf m' | true | ['1 nm'] \
    -> = & a length as a string with a unit
path.start = ['-9 m', '0 um']; path.end = ['9 m', '0 um']; path.step_per_radius = 1 -> = \
 & at most 0.0003363 & 1000 steps
## GIVEN
loading = {} -> loading.force is missing & required: force, approach, or prescribed
-loading.p0; -loading.radius -> loading.p0 is missing & loading.radius is missing & required: prescribed
loading.prescribed = 'flat' -> = & "hertz"
loading.approach = '0.1 um' -> = & either approach, or prescribed
## GIVEN_PATH loading.path.
end = ['-9 um', '0 um'] -> = & another place than start
end = [9e-06, '0 um'] -> @end[0] = 9e-06 & such as "-10 um"
end = ['9 um'] -> = & a list of 2
-steps -> @steps is missing & a whole number from 1 to 1000 & or step_per_radius
return = 'to-and-fro' -> = & where the pressure is given
## SPHERE friction.
coefficient = -0.1 | inf -> = & from 0 to 10
coefficient = '0.1' -> = & a number from 0 to 10
coefficient = 0.1; coupling = 0 -> = & true or false
coefficient = 0.1; direction = 'x' -> = & "constant" or "alternating"
law = 'viscous' -> = & "constant", "map" or "chemical-film"
coefficient = 0.1; mu = 0.2 -> = & unknown key
## SPHERE grid.
border = 'relief' -> = & only together with [surface]
cells = [65] | 65 -> = & a list of 2
cells = [65, 5000] -> @cells[1] = 5000 & from 3 to 4097
extent = ['1 um', 2] -> @extent[1] = 2 & $LENGTH
depths = ['1 um', '0 um'] -> = & strictly ascending
depths = ['-1 um'] -> @depths[0] = "-1 um" & or 0
depths = [] -> = & a list of 1 to 1001
depths = ['0 um']; layers = 3; depth = '1 um' -> @depths = ["0 um"] & not both
layers = 3 -> @depth is missing & layers and depth together
## SPHERE body.plasticity.
B = '1 GPa' -> @law is missing & "swift" or "linear" or "perfect"
law = 'ramberg' -> = & "swift", "linear", "perfect"
law = ['swift'] -> = & "table"
law = 'table' -> @file is missing & law = "table" takes file
law = 'table'; file = 3 -> = & the name of a CSV file & $COLUMNS
law = 'table'; file = [[0, 1000000000.0]] -> @file = [[0, & the name of a CSV
law = 'table'; file = 'none.csv' -> = & cannot be read: No such file
law = 'table'; file = '.' -> = & cannot be read: Is a directory
law = 'table'; file = '../curve.csv' -> file = "../curve.csv" & $OUTSIDE
law = 'table'; file = '/etc/passwd' -> file = "/etc/passwd" & $OUTSIDE
law = 'table'; file = "a\u0000" -> @file = & cannot be read
## SWIFT body.plasticity.
-B -> @B is missing & $SWIFT
B = 945000000.0 -> = & a pressure as a string with a unit
B = '-1 MPa' -> = & from 1e-30
-C -> @C is missing & $SWIFT
C = 0 | '20' -> = & a number from 1e-15
n = 0 | 1.0 | nan -> = & from 1e-06 to 0.999999
alpha = 0 -> = & a number from 1e-15
yield_stress = '1 GPa' -> yield_stress = & law = "swift" takes B, C, n, alpha: remove
layer_thickness = '1 um'; layer.alpha = 1000.0 -> @layer.law is missing
$LAYERED'voce' -> = & "swift", "linear"
$LAYERED1 -> =
$LAYERED'linear'; layer.yield_stress = '1 GPa'; layer.modulus = '1 GPa'; layer.alpha = 1.0 -> = & remove it
$LAYERED'linear'; layer.yield_stress = '1 GPa'; layer.modulus = '-1 GPa' -> =
$LAYERED'perfect'; layer.yield_stress = '0 GPa' -> =
$LAYERED'table' -> @layer.file is missing
$LAYERED'table'; layer.file = 'other.csv' -> = & No such file
$LAYERED'table'; layer.file = 'curve.csv' -> = & line 3 & softening is not available
## LINEAR body.plasticity.
alpha = 1.0 -> = & takes yield_stress, modulus: r
-modulus -> modulus is missing & yield_stress, modulus
modulus = '-1 GPa' -> = & or 0
## PERFECT body.plasticity.
modulus = '0 Pa' -> modulus = & "perfect" takes yield_stress: remove
yield_stress = '0 GPa' -> =
-yield_stress -> @yield_stress is missing
hardening = 3 -> = & unknown key & layer_thickness
layer_thickness = 1e-06 -> layer_thickness = 1e-06 & a length as a string
profile = 'p.csv' -> = & No such file
kinematic.recovery = [300] -> @kinematic.modulus & is missing & required
## SWIFT
body.poisson = 0.5 -> = & less than 0.5 with plasticity
body.coating.young = '1 GPa'; body.coating.poisson = 0 -> body.coating.thickness is missing
grid.depths = ['1 nm', '1 um'] -> grid.depths = [ & $FACES
grid.depths = ['0 um'] -> = & $FACES
solver.stop = 'stress' -> = & method = "paper"
solver.method = 'paper'; solver.stop = 'x' -> solver.stop & "stress" or "strain"
solver.method = 'newton' -> = & "paper"
solver.tolerance = 1.0 -> = & from 1e-14 to 0.1
## LAYER
-body.plasticity.layer_thickness -> body.plasticity.layer_thickness is missing & [body.plasticity.layer]
body.plasticity.layer_thickness = 1e-06 -> = & a length as a string
body.plasticity.layer_thickness = '0 um' -> =
body.plasticity.layer = 3 | 'swift' -> = & a table
body.plasticity.layer = {} -> body.plasticity.layer.law is missing & "swift" or "linear"
$FILM -> body.plasticity.layer & not together with [body.coating]
## LAYER body.plasticity.layer.
-B; n = 0.1 -> @B is missing & takes B, C, n
B = '-945 MPa' -> = & from 1e-30
B = 945000000.0 -> = & with a unit
n = -0.1 -> = & from 1e-06
alpha = 0 -> = & from 1e-15
modulus = '1 GPa' -> = & takes B, C, n, alpha: remove it
profile = 'p.csv' -> @profile & unknown key
layer_thickness = '1 um' -> @layer_thickness & unknown key, did you mean body.plasticity.layer_thickness
layer.law = 'perfect' -> @layer & unknown key
## PATH loading.path.
step_per_radius = 4 -> = & not both
steps = 2 -> = & 3 or more & longer than the contact radius, 6.053e-06 m
-steps; step_per_radius = 0.5 -> = & from 1 to 1000
return = 'round' -> = & "lifted" or "to-and-fro"
start = [1, 2] | '9 um' | ['9 um'] | ['9 um', '0 um', '0 um'] | ['9 GPa', '0 um'] | true | [] -> @start
end = [1, 2] | ['9 um', nan] | ['inf um', '0 um'] | ['9 parsec', 0] | [['9 um'], '0 um'] | {} -> @end
steps = 0 | -1 | 1001 | 1.5 | '4' | true | [4] | nan -> @steps
return = 'back' | true -> @return
step_per_radius = 0.5 | inf -> @step_per_radius
speed = 1 -> @speed
## PATH
loading.force = '0 N' -> = & above 0 with loading.path
loading.path.end = ['9 um', '3 um']; friction.coefficient = 0.2 -> loading.path.end = ["9 um", "3 um"] \
 & the y of start
friction.coefficient = 0.2; friction.direction = 'alternating' -> = & along the motion
counterbody.slip = 0; friction.coefficient = 0.2 -> counterbody.slip = 0 & stick-slip & =
counterbody.slip = 1.5 -> = & from 0 to 1
grid.extent = ['24 um', '24 um'] -> = & at least 3.011e-05 m and 1.211e-05 m
body.coating.thickness = '1 um'; wear.strain_limit = 0.1 -> wear = { & body.coating = { \
 & with loading.path not available
solver.method = 'paper' -> = & knows no motion
counterbody.slip = -0.1 | 1.5 | nan | '1' | true | [1] -> counterbody.slip
loading.path = {begin = ['-9 um', '0 um'], end = ['9 um', '0 um'], step_per_radius = 3} \
    -> loading.path.start is missing: required: a list of 2, each a coordinate as a string
-loading.path.steps; loading.path.step_per_radius = 3; loading.force = '0 N' -> = & above 0 with loading.path
loading.force = '1e-25 N'; -loading.path.steps; loading.path.step_per_radius = 3 -> = & at most
## ROUGH_PATH
loading.path = {begin = ['-9 um', '0 um'], end = ['9 um', '0 um'], step_per_radius = 3} \
    -> loading.path.start is missing: required: a list of 2, each a coordinate as a string
-loading.path.steps; loading.path.step_per_radius = 3; loading.force = '0 N' -> = & above 0 with loading.path
loading.force = '1e-25 N'; -loading.path.steps; loading.path.step_per_radius = 3 -> = & at most
## ROUGH_PATH counterbody.surface.
renew = 'yes' | 1 | [] -> @renew
kind = 'smooth' | 3 -> @kind
seed = -1 | 1.5 | '3' -> @seed
sq = 10e-9 | '10 GPa' | '-1 nm' -> @sq
## MISFIT loading.
-depth -> @depth & required
-radius -> @radius & required
-misfit -> @misfit & required
depth = 15 -> @depth & string with a unit
depth = '15 N' | '-15 um' -> @depth & a length
depth = '10 um' | '5 um' -> @depth & more than the radius
radius = '0 um' -> @radius & a length
misfit = -0.02 | 0.0 | 2.0 | '2 %' -> @misfit & a strain
profile = 'cube' -> @profile & smooth
profile = 'gauss' -> @depth & 3 times the radius
surface = 'fixed' -> @surface & held
force = '1 N' -> @force & not both
approach = '1 um' -> @approach & not both
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
## WAVES surface.
-seed -> @seed is missing: required: kind = "hard-turned" takes ra, feed
seed = -1 -> @seed = -1: a whole number from 0
hurst = 1.2 -> @hurst = 1.2: a number from 0 to 1
path = 'x' -> =
kind = 'self-affine' -> @feed = "20 um": kind = "self-affine" takes & anisotropy: remove it
kind = 'wood' -> @kind = "wood": one of "file", "hard-turned", "self-affine" or
cutoff_long = '6 um' -> @cutoff_short = "6 um": less than cutoff_long, 6e-06 m
feed = '5 um' -> @feed = "5 um": at least cutoff_short, 6e-06 m
## WAVES
grid.cells = [7, 20] -> grid.cells = [7, 20]: at least [8, 6]: 2 cells in the shortest
-grid.cells -> grid.cells is missing: required: grid.cells and grid.extent
grid.extent = ['24 um', '8 um'] -> grid.extent = ["24 um", "8 um"]: at least 6e-06 m and 9e-06 m
counterbody.radius = '1 um' -> counterbody.radius = "1 um": shape = "flat" takes no radius: remove
-surface -> surface is missing: required: a table [surface] or [counterbody.surface], as & flat
-surface -> grid.border = "relief": only together with [surface]
grid.border = 'round' -> grid.border = "round": one of "free" or "relief"
-counterbody; -loading.force; loading.prescribed = 'hertz'; loading.p0 = '1 GPa'; \
    loading.radius = '5 um' -> surface = {"kind": "hard-turned" \
 & with loading.prescribed = "hertz" not available in this version
## COUNTER counterbody.
surface = {} -> @surface.kind is missing: & "file" or "hard-turned" or "self-affine" or "sinusoid"
renew = true -> = & did you mean counterbody.surface.renew?
seed = 3 -> = & did you mean counterbody.surface.seed
surface = 3 | 'map.csv' -> = & a table
## WAVE counterbody.surface.
kind = 'waves' -> = & "self-affine" or "sinusoid"
amplitude = '0 um' -> = & from 1e-30 to 1e+30 m
amplitude = 0.1 -> = & a string with a unit, such as "10 um"
amplitude = '0.1 N' -> = & a length as a string
seed = 1 -> = & takes amplitude, wavelength_x, wavelength_y: remove it
## DISC counterbody.surface.
renew = 1 | 'each' | [true] -> = & true or false
renewed = true -> = & did you mean renew?
seed = -1 | '5' -> = & a whole number from 0
seed = 9223372036854775808 -> = & to 9.22337e+18
-seed -> @seed is missing: & takes cutoff_long, cutoff_short, hurst, seed
ra = '20 nm' -> @sq = "20 nm": & either ra or sq
feed = '80 um' -> = & remove it
hurst = 2.0 -> = & a number from 0 to 1
cutoff_long = '4 um' -> @cutoff_short = "8 um": & less than cutoff_long, 4e-06 m
cutoff_short = '1 um' -> grid.cells = [32, 32]: & at least [40, 40]
crop = ['4 um', '4 um'] -> = & remove it
## MAP counterbody.surface.
path = 3 -> = & the name of a CSV or npz file
path = 'none.csv' -> = & No such file
renew = true -> = & no second part of the size of counterbody.surface.crop
crop = ['5 um', '6 um'] -> @renew = true: & false: no second part
crop = ['9 um', '9 um'] -> = & 8e-06 m
## KINEMATIC body.plasticity.kinematic.
modulus = [] | '1 GPa' \
    -> = & $LIST
modulus = ['1 GPa', '1 GPa', '1 GPa', '1 GPa', '1 GPa', '1 GPa', '1 GPa', '1 GPa', '1 GPa'] \
    -> @modulus = ["1 GPa", " & $LIST
modulus = [1000000000.0, 2000000000.0] -> @modulus[0] = 1000000000.0 & a pressure as a string
modulus = ['1 GPa', '2 um'] -> @modulus[1] & "2 um" & a pressure as a string
modulus = ['1 GPa', '-2 GPa'] -> @modulus[1] & "-2 GPa" & a pressure as a string
modulus = ['0 GPa', '2 GPa'] -> @modulus[0] & "0 GPa" & a pressure as a string
modulus = ['1 GPa', '2'] -> @modulus[1] & "2" & a pressure as a string
modulus = ['1 GPa', ''] -> @modulus[1] & "" & a pressure as a string
recovery = [300] -> = & as many numbers as modulus has: 2
recovery = 300 | [] -> = & $LIST
recovery = [-1, 0] -> @recovery[0] & -1 & $RECOVERY
recovery = ['1', 0] -> @recovery[0] & "1" & $RECOVERY
recovery = [nan, 0] -> @recovery[0] & NaN & $RECOVERY
recovery = [100000000.0, 0] -> @recovery[0] & 100000000.0 & $RECOVERY
modulus = ['nan GPa', '2 GPa'] -> @modulus[0] & "nan GPa" & a pressure as a string
modulus = ['1 GPa', true] -> @modulus[1] & true & a pressure as a string
recovery = [300, inf] -> @recovery[1] & Infinity & $RECOVERY
recovery = [[300, 0], 1] -> @recovery[0] & [300, 0] & $RECOVERY
recover = [1, 0] -> = & did you mean recovery?
C = ['1 GPa'] -> = & unknown key
"""
LONG = [
    (f"body.young = '1 {'Pa*' * 500}Pa'", ['body.young = "1 Pa*Pa', PRESSURE]),
    (f"body.poisson = 1{'0' * 400}", ["body.poisson = 1000", "from 0 to 0.5"]),
    (f"body.plasticity.law = 'table'; body.plasticity.file = '{'a' * 300}'", ["cannot be read"]),
]


FLOOR = "0,1e9\n"
CURVES = [
    ("", ['its first line is ""', COLUMNS]),
    ("strain,stress\n0,1e9\n", ['its first line is "strain,stress"', COLUMNS]),
    ("peeq,peeq\n0,1e9\n", ['its first line is "peeq,peeq"']),
    ("peeq,yield_stress_Pa\n\xff,1\n", ["not UTF-8"]),
    *(
        (f"peeq,yield_stress_Pa\n{rows}", [words])
        for rows, words in (
            ("\n\n", COLUMNS),
            ('0,"1e9\n', "not CSV"),
            ("0," + "1" * 200_000, "not CSV: field larger"),
            ("#" * (1 << 20), "too large: at most 1048576 bytes"),
            (FLOOR * 10_001, "more than 10000 rows"),
            ("0,1e9,3\n", 'line 2: ["0", "1e9", "3"] is not two numbers'),
            ("0,1 GPa\n", 'line 2: yield_stress_Pa = "1 GPa", allowed: a pressure'),
            ("0,\n", 'line 2: yield_stress_Pa = ""'),
            (FLOOR + "0.1,nan\n", "line 3: yield_stress_Pa = NaN"),
            (FLOOR + "inf,2e9\n", "line 3: peeq = Infinity, allowed: a number from 0 to 1000"),
            ("-0.1,1e9\n", "line 2: peeq = -0.1"),
            ("0,0\n", "line 2: yield_stress_Pa = 0.0"),
            ("0.002,1e9\n", "line 2: peeq = 0.002, allowed: 0 in the first row"),
            (FLOOR + "\n0,2e9\n", "line 4: peeq = 0 after 0, allowed: strictly ascending"),
            (FLOOR + "0.1,9e8\n", "line 3: yield_stress_Pa = 9e+08 after 1e+09: softening is not av"),
        )
    ),
    ("peeq,yield_stress_Pa\n" + "0,a\n" * 7, ["line 2: ", "line 5: ", "; and 3 more"]),
]
PROFILES = [
    ("peeq,yield_stress_Pa\n0,1e9\n0.01,1.5e9\n", ["depth_m and factor"]),
    ("depth_m,factor\n-1e-6,1\n", ["line 2: depth_m = -1e-06, allowed: a depth"]),
    ("depth_m,factor\n0,0\n", ["line 2: factor = 0.0, allowed: a number from 1e-06"]),
    ("depth_m,factor\n1e-6,1\n0,1\n", ["line 3: depth_m = 0 after 1e-06, allowed: strictly asc"]),
]


def cases() -> Iterator[tuple[dict[str, str], str, str, list[str]]]:
    """The scene that is changed, the table of its keys, the changes, and pieces of the message."""
    yield from ((SPHERE, "", edits, pieces) for edits, pieces in LONG)
    for line in REFUSED.replace("\\\n", "").strip().splitlines():
        if line.startswith("##"):
            _, name, table = f"{line} ".split(" ", 2)
            continue
        edits, words = re.sub(r"\$([A-Z_]+)", lambda word: WORDS[word[1]], line).split(" -> ")
        first, *others = map(str.strip, edits.split(" | "))
        lead = first[: first.rindex(" = ") + 3] if " = " in first else ""
        for edit in (first, *(lead + other for other in others)):
            yield SCENES[name], table.strip(), edit, [piece.strip() for piece in words.split(" & ")]


def in_words(piece: str, edits: dict[str, str | None], table: str) -> str:
    """A piece of a message, see above."""
    key, value = list(edits.items())[-1]
    if piece == "=":
        return f"{key} = {json.dumps(tomllib.loads(f'x = {value}')['x'], ensure_ascii=False, default=str)}"
    return table + piece[1:] if piece.startswith("@") else piece


@pytest.fixture
def message(folder, refused):
    """Writes a scene beside a curve, which falls if none is given, and a map; returns what its solve says."""

    def said(scene, curve="peeq,yield_stress_Pa\n0,1e9\n0.1,9e8\n"):
        text = "".join(f"{key} = {value}\n" for key, value in scene.items())
        (folder / "bad.toml").write_text(text, encoding="utf-8")
        (folder / "curve.csv").write_bytes(curve.encode("latin-1"))
        rows = [f"{x}e-6,{y}e-6,{x % 2}e-8\n" for x in range(8) for y in range(8)]
        (folder / "map.csv").write_text("x_m,y_m,height_m\n" + "".join(rows))
        words = refused("solve", "bad.toml", "--out", "out")
        assert "bad.toml" in words and len(words) < 2000
        return words

    return said


@pytest.mark.parametrize("name", sorted(SCENES.keys() - {"COUNTER", "MAP", "ROUGH_PATH"}))
def test_the_scenes_that_are_changed_are_good(name):
    text = "".join(f"{key} = {value}\n" for key, value in SCENES[name].items())
    assert parse_scene(text.encode(), "good.toml")


@pytest.mark.parametrize("base, table, edits, pieces", list(cases()))
def test_a_malformed_scene_is_refused_by_name_and_nothing_is_created(message, base, table, edits, pieces):
    given = keys(edits, table)
    words = message(changed(base, given))
    assert [piece for piece in pieces if in_words(piece, given, table) not in words] == []


@pytest.mark.parametrize(
    "key, content, pieces",
    [("file", *case) for case in CURVES] + [("profile", *case) for case in PROFILES],
)
def test_a_malformed_file_of_a_scene_is_refused_by_line(message, key, content, pieces):
    law = keys(f"law = '{'table' if key == 'file' else 'perfect'}'; {key} = 'curve.csv'", AT)
    words = message(SPHERE | law | (keys("yield_stress = '1 GPa'", AT) if key == "profile" else {}), content)
    assert words.count("\n") == 1 and len(words) < 1000
    assert [piece for piece in [f'{AT}{key} = "curve.csv": ', *pieces] if piece not in words] == []


IN, BACK = "body.plasticity.layer", "body.plasticity.kinematic"
THICK = builders.SWIFT | {"layer_thickness": 1e-6}
SOFT = builders.SWIFT | {"alpha": 1e3}
NO_C = {key: value for key, value in SOFT.items() if key != "C"}
# keys of the body, its layer: key that is named, value, what is allowed
LAYERS = [
    (builders.SWIFT, SOFT, f"{IN}_thickness", "", "the thickness of the layer"),
    (builders.SWIFT | {"layer_thickness": 0.0}, SOFT, f"{IN}_thickness", "0.0", "a length from 1e-30"),
    (builders.SWIFT | {"layer_thickness": -1e-6}, SOFT, f"{IN}_thickness", "-1e-06", "a length from 1e-30"),
    (
        builders.SWIFT | {"layer_thickness": float("nan")},
        SOFT,
        f"{IN}_thickness",
        "nan",
        "a length from 1e-30",
    ),
    (builders.SWIFT | {"layer_thickness": "1 N"}, SOFT, f"{IN}_thickness", "1 N", "a length from 1e-30"),
    (THICK, 3, IN, "3", "a table"),
    (THICK, [SOFT], IN, "swift", "a table"),
    (THICK, {}, f"{IN}.law", "", 'required: "swift" or "linear"'),
    (THICK, {"law": "voce"}, f"{IN}.law", "voce", 'one of "swift", "linear", "perfect" or "table"'),
    (THICK, {"law": None}, f"{IN}.law", "", '"swift", "linear", "perfect" or "table"'),
    (THICK, NO_C, f"{IN}.C", "", 'law = "swift" takes B, C, n'),
    (THICK, SOFT | {"B": -1.0}, f"{IN}.B", "-1.0", "a pressure from 1e-30"),
    (THICK, SOFT | {"B": "945 um"}, f"{IN}.B", "945 um", "a pressure from 1e-30"),
    (THICK, SOFT | {"B": float("inf")}, f"{IN}.B", "inf", "a pressure from 1e-30"),
    (THICK, SOFT | {"C": 0.0}, f"{IN}.C", "0.0", "a number from 1e-15"),
    (THICK, SOFT | {"n": 1.5}, f"{IN}.n", "1.5", "a number from 1e-06 to 0.999999"),
    (THICK, SOFT | {"alpha": True}, f"{IN}.alpha", "True", "a number from 1e-15"),
    (
        THICK,
        builders.LINEAR | {"n": 0.1},
        f"{IN}.n",
        "0.1",
        'law = "linear" takes yield_stress, modulus: remove it',
    ),
    (THICK, SOFT | {"yield_stress": 1e9}, f"{IN}.yield_stress", "1000000000.0", "remove it"),
    (
        THICK,
        {"law": "perfect", "yield_stress": 1e9, "modulus": 1e9},
        f"{IN}.modulus",
        "1000000000.0",
        "remove it",
    ),
    (THICK, builders.LINEAR | {"modulus": -1.0}, f"{IN}.modulus", "-1.0", "to 1e+30 Pa or 0"),
    (THICK, {"law": "table", "file": ((0.0, 1e9), (0.1, 9e8))}, f"{IN}.file", "900000000.0", "softening"),
    (THICK, {"law": "table", "file": ((0.1, 1e9),)}, f"{IN}.file", "0.1", "peeq"),
    (THICK, SOFT | {"profile": ((0.0, 1.0),)}, f"{IN}.profile", "1.0", "unknown key"),
    (THICK, SOFT | {"aplha": 1e3}, f"{IN}.aplha", "1000.0", "did you mean"),
]
MPA = {"law": "table", "file": ((0.0, 355.0), (0.01, 450.0))}  # in MPa, under a column in Pa
SOFT_STEEL = {"law": "perfect", "yield_stress": 355e6}
COATING = {"thickness": 1e-6, "young": 300e9, "poisson": 0.25}
FILMED = {"law": "chemical-film", "low": 0.1, "high": 0.4, "film_thickness": 1e-7, "film_young": 70e9}
FILMED |= {"film_poisson": 0.3, "strain_limit": 0.1}
# the body, and friction: key that is named, what is said of it;
MATERIALS = [
    (
        {"plasticity": MPA},
        None,
        "body.plasticity.file",
        "column yield_stress_Pa: .* at a plastic strain of 0.002: it is 374 Pa: are values in MPa",
    ),
    ({"plasticity": builders.SWIFT | {"B": 945.0}}, None, "body.plasticity.B", "at least 2.1e.06 Pa"),
    (
        {"plasticity": SOFT_STEEL | {"profile": ((0.0, 1.0), (1e-5, 1e-3))}},
        None,
        "body.plasticity.profile",
        "factors from 0.001",
    ),
    (
        {"plasticity": THICK | {"layer": SOFT_STEEL | {"yield_stress": 1.0}}},
        None,
        f"{IN}.yield_stress",
        "it is 1 Pa",
    ),
    ({"coating": COATING | {"yield_stress": 4e3}}, None, "body.coating.yield_stress", "at least 3e.06 Pa"),
    ({}, FILMED | {"film_yield": 700.0}, "friction.film_yield", "film_young/100000"),
]
USUAL = [
    {"young": 11e9, "plasticity": SOFT_STEEL | {"yield_stress": 1e6}},  # annealed indium
    {"young": 1141e9, "plasticity": SOFT_STEEL | {"yield_stress": 80e9}},  # diamond
    {"plasticity": builders.SWIFT | {"C": 1e-15, "n": 0.5}},  # rises from nearly 0
    {"plasticity": SOFT_STEEL | {"yield_stress": 1e12}},  # never yields
]
GOOD = {"modulus": (1e9, 2e9), "recovery": (300.0, 0.0)}
MODULUS = "a pressure from 1e-30"
# the table: key that is named, value, what is allowed
IN_PYTHON = [
    ({}, f"{BACK}.modulus", "", "required"),
    ({"recovery": (1.0,)}, f"{BACK}.modulus", "", "required"),
    ({"modulus": ()}, f"{BACK}.modulus", "()", LIST),
    ({"modulus": (1e9,) * 9}, f"{BACK}.modulus", "1000000000.0", LIST),
    ({"modulus": 1e9}, f"{BACK}.modulus", "1000000000.0", LIST),
    ({"modulus": "1 GPa"}, f"{BACK}.modulus", "1 GPa", LIST),
    ({"modulus": None}, f"{BACK}.modulus", "None", LIST),
    ({"modulus": {"first": 1e9}}, f"{BACK}.modulus", "first", LIST),
    ({"modulus": (0.0,)}, f"{BACK}.modulus.0", "0.0", MODULUS),
    ({"modulus": (1e9, -1e9)}, f"{BACK}.modulus.1", "-1000000000.0", MODULUS),
    ({"modulus": (float("nan"),)}, f"{BACK}.modulus.0", "nan", MODULUS),
    ({"modulus": (float("inf"),)}, f"{BACK}.modulus.0", "inf", MODULUS),
    ({"modulus": (True,)}, f"{BACK}.modulus.0", "True", MODULUS),
    ({"modulus": ("1 um",)}, f"{BACK}.modulus.0", "1 um", MODULUS),
    ({"modulus": ("one GPa",)}, f"{BACK}.modulus.0", "one GPa", MODULUS),
    ({"modulus": ((1e9,),)}, f"{BACK}.modulus.0", "1000000000.0", MODULUS),
    ({"modulus": (1e31,)}, f"{BACK}.modulus.0", "1e+31", MODULUS),
    (GOOD | {"recovery": 300.0}, f"{BACK}.recovery", "300.0", LIST),
    (GOOD | {"recovery": ()}, f"{BACK}.recovery", "()", LIST),
    (GOOD | {"recovery": (1.0,) * 9}, f"{BACK}.recovery", "1.0", LIST),
    (GOOD | {"recovery": (1.0,)}, f"{BACK}.recovery", "1.0", "as many numbers as modulus has: 2"),
    (GOOD | {"recovery": (1.0,) * 3}, f"{BACK}.recovery", "1.0", "as many numbers as modulus has: 2"),
    (GOOD | {"recovery": (-1.0, 0.0)}, f"{BACK}.recovery.0", "-1.0", RECOVERY),
    (GOOD | {"recovery": (0.0, 2e7)}, f"{BACK}.recovery.1", "20000000.0", RECOVERY),
    (GOOD | {"recovery": (float("nan"), 0.0)}, f"{BACK}.recovery.0", "nan", RECOVERY),
    (GOOD | {"recovery": (float("inf"), 0.0)}, f"{BACK}.recovery.0", "inf", RECOVERY),
    (GOOD | {"recovery": ("300", 0.0)}, f"{BACK}.recovery.0", "300", RECOVERY),
    (GOOD | {"recovery": (True, 0.0)}, f"{BACK}.recovery.0", "True", RECOVERY),
    (GOOD | {"moduli": (1e9,)}, f"{BACK}.moduli", "1000000000.0", "allowed here: modulus, recovery"),
    (GOOD | {"law": "prager"}, f"{BACK}.law", "prager", "unknown key"),
    (GOOD | {"yield_stress": 1e9}, f"{BACK}.yield_stress", "1000000000.0", "unknown key"),
    ([GOOD], BACK, "modulus", "a table"),
    (3, BACK, "3", "a table"),
    ("prager", BACK, "prager", "a table"),
]
SOLVER = [
    ({"verdict": 1}, "solver.verdict", "1", "true or false"),
    ({"verdict": "yes"}, "solver.verdict", "yes", "true or false"),
    ({"verdict": 0.0}, "solver.verdict", "0.0", "true or false"),
    ({"verdict": (True,)}, "solver.verdict", "True", "true or false"),
    ({"verdict": None}, "solver.verdict", "None", "true or false"),
    ({"verdicts": True}, "solver.verdicts", "True", "did you mean verdict?"),
    ({"method": "paper"}, "solver.method", "paper", "the loop of the paper knows no back-stress"),
]


def errors_of(**tables) -> list[tuple[str, str, str]]:
    """Key, value and what is allowed of each error of a sphere on a body, in Python."""
    tables["body"] = builders.STEEL | tables["body"]
    with pytest.raises(ValidationError) as caught:
        Scene(**{"counterbody": builders.SPHERE, "loading": {"force": 1.0}} | tables)
    return [
        (".".join(map(str, line["loc"])), str(line["input"]), line["msg"]) for line in caught.value.errors()
    ]


def has(errors, key: str, value: str, allowed: str) -> bool:
    return any(line[0] == key and value in line[1] and allowed in line[2] for line in errors)


@pytest.mark.parametrize(("body", "layer", "key", "value", "allowed"), LAYERS)
def test_a_malformed_layer_is_refused_by_name_in_python(body, layer, key, value, allowed):
    assert has(errors_of(body={"plasticity": {**body, "layer": layer}}), key, value, allowed)


@pytest.mark.parametrize("body, friction, key, words", MATERIALS)
def test_a_yield_stress_in_another_unit_than_youngs_modulus_is_refused(body, friction, key, words):
    tables = {"body": body} | ({"friction": friction} if friction else {})
    ((place, _, said),) = errors_of(**tables)
    assert place == key and re.search(words, said)


@pytest.mark.parametrize("body", USUAL)
def test_a_yield_stress_of_a_real_material_is_taken(body):
    assert Scene(body=builders.STEEL | body, counterbody=builders.SPHERE, loading={"force": 1.0})


@pytest.mark.parametrize(("kinematic", "key", "value", "allowed"), IN_PYTHON)
@pytest.mark.parametrize("layer", [False, True], ids=["body", "layer"])
def test_back_stresses_are_refused_by_name_in_python(kinematic, key, value, allowed, layer):
    law = builders.SWIFT | {"kinematic": kinematic}
    body = THICK | {"layer": law} if layer else law
    key = key.replace(BACK, f"{IN}.kinematic") if layer else key
    assert has(errors_of(body={"plasticity": body}), key, value, allowed)


@pytest.mark.parametrize(("solver", "key", "value", "allowed"), SOLVER)
def test_refused_of_the_solver(solver, key, value, allowed):
    body = {"plasticity": builders.SWIFT | {"kinematic": GOOD}}
    assert has(errors_of(body=body, solver=solver), key, value, allowed)
