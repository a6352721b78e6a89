# SPDX-License-Identifier: MIT
"""The process that draws, in a folder of its own: started by `offscreen`, it writes NAME.png of the
pictures that a run has, or one of them as NAME.html.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from verification.figures.space.meshes import Found
from verification.figures.space.pictures import PICTURES
from verification.figures.space.view import drawn, page
from verification.figures.style import encoded
from verification.runs.files import FolderError, of_last_load, read_run
from verification.runs.model_range import outside_in_words, outside_of_model


def main() -> None:
    """Draw what the arguments say."""
    parser = argparse.ArgumentParser()
    parser.add_argument("run", type=Path)
    parser.add_argument("into", type=Path)
    parser.add_argument("--name", choices=tuple(PICTURES), help="this picture alone")
    parser.add_argument("--one", action="store_true", help="the first that the run has")
    parser.add_argument("--page", action="store_true", help="as HTML")
    options = parser.parse_args()
    found = Found(of_last_load(read_run(options.run)))
    for name in [options.name] if options.name else PICTURES:
        picture = PICTURES[name](found)
        if picture is None:
            continue
        if (outside := outside_of_model(found.run)) is not None:
            note = "; ".join(filter(None, (picture.note, outside_in_words(outside))))
            picture = replace(picture, note=note)
        if options.page:
            (options.into / f"{name}.html").write_text(page(picture), encoding="utf-8")
        else:
            (options.into / f"{name}.png").write_bytes(encoded(drawn(picture)))
        if options.one:
            return


if __name__ == "__main__":
    try:
        main()
    except FolderError as error:
        print(error, file=sys.stderr)
        sys.exit(2)  # as `offscreen` knows it
