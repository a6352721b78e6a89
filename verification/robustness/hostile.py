# SPDX-License-Identifier: MIT
"""What the fuzzed inputs are made of: good scenes and tables, and what is hostile."""

from sam.scene import LAWS, SHAPES as COUNTER_BODIES

SMALL = """title = "Small"
[body]
young = "210 GPa"
poisson = 0.3
[counterbody]
shape = "sphere"
radius = "1 mm"
[loading]
force = "1 N"
[grid]
cells = [17, 17]
[fem]
cells_per_radius = 4
"""
YIELDING = '[body.plasticity]\nlaw = "table"\nfile = "yield.csv"\n'
PLASTIC = SMALL.replace("[counterbody]", f"{YIELDING}[counterbody]")
LAYERS = PLASTIC.replace("cells = [17, 17]", 'cells = [17, 17]\nlayers = 3\ndepth = "40 um"')
APPROACH = SMALL.replace('force = "1 N"', 'approach = "0.3 um"')
ROUGH = SMALL.replace('shape = "sphere"\nradius = "1 mm"', 'shape = "flat"')
ROUGH = ROUGH.replace("[grid]\ncells = [17, 17]\n", "") + '[surface]\nkind = "file"\npath = "heights.npz"\n'
RARE = f"""{PLASTIC}[friction]
coefficient = 0.1
coupling = false
direction = "alternating"
[solver]
method = "paper"
stop = "strain"
uncertainty = true
accuracy = "2 %"
accuracy_of = ["peeq_max", "approach_m"]
beyond_model = true
extrapolate = true
[wear]
strain_limit = 0.01
roof = "falls"
smoothing_fills = true
"""
STUDY = """scene = "scene.toml"
mode = "zip"
model = "sam"
seed = 1
[vary]
"loading.force" = { range = ["1 N", "2 N"], count = 2 }
"body.young" = { random = ["200 GPa", "220 GPa"], count = 2 }
"""
OF_STUDIES = (
    "grid|zip|morris|sobol|uniform|samples = 2|count = 3|range|log|random-log|list|block = true"
    "|loading.steps|grid.cells|fem-axisymmetric|title|body|[33, 33]|1e9|x.y.z"
).split("|")
YIELD = b"peeq,yield_stress_Pa\n0,1e9\n0.01,1.2e9\n1,2e9\n"
DEPTH = b"depth_m,factor\n0,1.3\n1e-6,1\n"

MARKUP = (
    *"<script>alert(1)</script>|[red]title[/red]|[/]|\x1b[31mred\x1b[0m|\x1b]0;title\x07|\x9b31m".split("|"),
    *("$\\frac{1}$", "$", "{{ 7 * 7 }}", "{% raw %}", "&lt;&amp;", '"><img src=x onerror=alert(1)>', "]]>"),
    "\u202eabc",
    *("%s%n", "{0.__class__}", "a\nb", "\r\nx", "\u2028", "=1+1", "\U0001f600", "e\u0301" * 50, "x" * 20_000),
    *("\x7f", ""),
)
WHOLE = "1|0|-1|2|3|4|64|129|1025|4097|4098|1000000000|18446744073709551616|65.0|true|nan".split("|")
NUMBERS = (
    *WHOLE,
    *"-0 0.0 -0.0 1e308 1e-308 5e-324 1e400 -1e400 -nan inf -inf 1e15 1e-15 1e-14 0.1 0.5 0.4999999".split(),
    *"0.51 2.5 1000 1001 9223372036854775808".split(),
    *("0x1F", "0o17", "0b11", "1_000", "1__0", "01", ".5", "5.", "+3", "1e", "--1", "9" * 3_000, "9" * 5_000),
    "0." + "3" * 9_000,
)
UNITS = (
    "Pa|GPa|MPa|m|um|µm|nm|N|mN|kN||s|kg|degC|delta_degC|dB|rad|%|Gpa|m**-3|Pa*m**2|N/m**2"
    "|N/m/m|m**99.999|Ym**99|m*m*m*m*m*m|1/m|Pa Pa|speed_of_light|eV/angstrom**3|m^2|Pa**-1"
    "|count|kilokilom|lambda|__class__|os|inch|psi|lbf|h_bar|Pa\x00|½m|m²|Å"
).split("|")
VALUES = (
    *('""', '" "', "[]", "[[]]", "{}", "{a = 1}", "true", "false", "2024-01-01", "12:30:00"),
    *("1979-05-27T07:32:00Z", "'x'"),
    *('"""\nx\n"""', '"\\ud800"', '"\\U00110000"', '"\\u0000"', '"\\q"', '"unclosed', "unquoted", "= 1", ""),
    *("#", "[1, 2, 3", "{a = "),
    *('["210 GPa"]', '[["a"], 1]', '"[red]"', "'''\x1b[31m'''", '"' + "9" * 10_000 + ' GPa"'),
    *("[" * 200 + "]" * 200, "[1, true, 'x', 1979-05-27]"),
    *(f'"{name}"' for name in (*COUNTER_BODIES, *LAWS)),
    *('"paper"', '"relief"', '"SPHERE"'),
)
PLACES = (
    *("../yield.csv", "../../../../etc/passwd", "/etc/passwd", "/dev/zero", "/dev/urandom", "/dev/stdin"),
    *("/dev/null", "/dev/full"),
    *"missing.csv|.|..||/|sub|sub/|pipe|link-out|link-loop|link-in|link-zero".split("|"),
    "sub/../yield.csv",
    *("yield.csv/", "yield.csv/x", "a\u0000b", "\udcff.csv", "~/x", "~", "file:///etc/passwd"),
    *("http://localhost/x", "C:\\x", "x\n.csv"),
    *("n" * 255, "n" * 256, "n" * 5_000, "d/" * 2_000 + "x", "\x1b[31m.csv", "[red].csv", "<b>.csv", "-"),
    *("--help", "|ls", "$(ls)"),
    *"/proc/self/mem|/proc/self/environ|scene.toml|pickle.npz|/dev/fd/0|/dev/tty".split("|"),
)
SCENES = PLASTIC, LAYERS, SMALL, APPROACH, ROUGH, RARE
"""With keys that no shipped scene has."""
NAMES = (
    *"a b.toml|-x.toml|é.toml|[red].toml|\x1b[31m.toml|x\ny.toml|\udcff.toml".split("|"),
    *("x" * 250, ".toml", "$.toml"),
)
LENGTHS = '"0 um"|"1 um"|"24 um"|"1e-30 m"|"1e-12 m"|"1e30 m"|"-1 um"|"1 km"|"1e-9 um"|"0.2 um"'.split("|")
CODECS = "utf-16", "utf-8-sig", "utf-32", "cp037"
CELLS = (
    *'nan|inf|-inf|-1|1e400|-1e308||x|1,5|1;2|"|"1"|0|1e-320|0x1p3|1_0|١'.split("|"),
    *("9" * 5_000, "\x00"),
)
HEADS = 'x,y,z||x_m;y_m;height_m|y_m, x_m ,height_m|"x_m","y_m","height_m"|x_m,x_m,y_m'.split("|")
EXTENTS = [f"extent = {each}" for each in ('["12 um", "10 um"]', '"12 um"', '["0 m", "1 m"]')]
MATRIX_KEYS = [EXTENTS[0], 'unit = "nm"', EXTENTS[1], 'unit = "N"', "unit = 1", EXTENTS[2]]
CROPS = (
    '[]|[1, 2]|["4 um", "5 um"]|["5.5 um", "5 um"]|["1e30 m", "5 um"]|["-3 um", "5 um"]|["3 N", "5 um"]'
    '|["9 um", "0 um", "6 um", "5 um"]|["12.1 um", "0 um", "6 um", "5 um"]|["1e-30 m", "0 m", "6 um", "5 um"]'
).split("|")
PROCESSING = {
    "form": ('"none"', '"tilt"', '"sphere"', '"quadratic"', '"x"', "true"),
    "missing": ('"harmonic"', '"refuse"', '"harmonic"', "0"),
    "resample": ('"fourier"', '"fourier"', '"harmonic"', "[]"),
    "crop": CROPS,
}
MAPPING = """file = "own.vtu"
length_unit = "m"
stress_unit = "Pa"
axes = { x = "x", z = "-z" }
origin = [0.0, 0.0, 0.0]
step = 1
state = "peak"
pressure = "p_Pa"
mises = "mises_Pa"
displacement = "displacement_m"
"""
NOT_READ = ".neu|.res|.nek5000|.xdmf|.foam|.cgns|.stl|.inp|.png|.txt||.|.VTU".split("|")
MAGIC = b"", b"# vtk DataFile Version 3.0\n", b"<VTKFile ", b"CDF\x01", b"\x89HDF\r\n\x1a\n"
BYTES = (
    *(b"\x00", b"\xff", b"\xed\xa0\x80", b"\xef\xbb\xbf", b"\x1b[31m", b"\x1a", b"\x80"),
    *(b"\xf4\x90\x80\x80", b"\x7f", b"'", b'"'),
)
SHAPES = (
    *("(1000000000000,)", "(-1,)", "(2, 3", "()" * 20_000, "(" * 5_000, "(1,)", "(1.5,)"),
    *("(9999999999999999999999,)", "'"),
)
JSON = (
    *(b"", b"[]", b"{", b"{}", b"null", b"[" * 100_000, b'{"a": NaN}', b"9" * 5_000, b"\xff\xfe"),
    *(b'{"format": "samfem run 0"}', b'{"format": ["samfem run 1"]}'),
)
HISTORIES = (
    *(b"", b"\n", b"cycle\n1,2\n", b"cycle\nx\n", b"cycle\n\xff\n", b'cycle\n"'),
    *(b"cycle\n" + b"1" * 200_000, b"cycle,cycle\n1,2\n", b"a\x00b\n1\n"),
)
