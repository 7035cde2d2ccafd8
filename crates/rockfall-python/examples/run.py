"""Runs the notebooks and writes them, with what they show, to a folder: python run.py FOLDER [NAME ...].

Pictures are also written as PNG files. Ends with an error if a cell fails. With the environment variable ROCKFALL_SMALL, the
notebooks are smaller. Needs nbclient and ipykernel.
"""

from __future__ import annotations

import base64
import pathlib
import sys
import time

import nbclient
import nbformat

HERE = pathlib.Path(__file__).resolve().parent


def run(path: pathlib.Path, folder: pathlib.Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    start = time.monotonic()
    nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(folder)}}).execute()
    nbformat.write(notebook, folder / path.name)
    pictures = 0
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            picture = output.get("data", {}).get("image/png")
            if picture:
                (folder / f"{path.stem}-{pictures}.png").write_bytes(base64.b64decode(picture))
                pictures += 1
    print(f"{path.stem}: {time.monotonic() - start:.1f} s, {pictures} pictures", flush=True)


def main() -> None:
    folder = pathlib.Path(sys.argv[1]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    notebooks = sorted(HERE.glob("*.ipynb"))
    names = sys.argv[2:] or [path.stem for path in notebooks]
    for path in notebooks:
        if path.stem in names:
            run(path, folder)


main()
