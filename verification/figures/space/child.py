# SPDX-License-Identifier: MIT
"""The process that draws, started by `offscreen`: NAME.png of the pictures of a run, or one as NAME.html."""

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
    made = ((name, PICTURES[name](found)) for name in ([options.name] if options.name else PICTURES))
    pictures = [(name, picture) for name, picture in made if picture is not None][
        : 1 if options.one else None
    ]
    ending = "html" if options.page else "png"
    for name, _ in pictures:
        (options.into / f"{name}.{ending}").touch()  # empty until it is drawn: `offscreen` counts them
    for name, picture in pictures:
        if (outside := outside_of_model(found.run)) is not None:
            note = "; ".join(filter(None, (picture.note, outside_in_words(outside))))
            picture = replace(picture, note=note)
        content = page(picture).encode() if options.page else encoded(drawn(picture))
        (options.into / f"{name}.{ending}").write_bytes(content)


if __name__ == "__main__":
    try:
        main()
    except FolderError as error:
        print(error, file=sys.stderr)
        sys.exit(2)  # as `offscreen` knows it
