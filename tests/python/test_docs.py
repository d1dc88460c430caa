"""The Python blocks of README.md and docs/ print what the pages show.

On each page the `$ barwave` commands of the console blocks are run first, in a folder with runs/ and the files that the page shows; then the
Python blocks in order, as one program. A `text` block after a Python block is its output. UPDATE_DOCS=1 rewrites these blocks.
"""

import contextlib
import io
import os
import re
import shlex
import shutil
import subprocess

import pytest

from conftest import ROOT

FENCE = re.compile(r"(?:^<!-- file: (?P<file>.+?) -->\n)?^```(?P<language>\w*)\n(?P<text>.*?)^```$", re.M | re.S)
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
WITH_PYTHON = [page for page in PAGES if "```python" in page.read_text()]


def prepare(program, page, folder):
    """Files and results that the page has before its Python code."""
    (folder / "runs").mkdir()
    for scene in (ROOT / "runs").glob("*.toml"):
        shutil.copy(scene, folder / "runs")
    blocks = list(FENCE.finditer(page.read_text()))
    for block in blocks:
        if block["file"]:
            (folder / block["file"]).write_text(block["text"])
    for block in blocks:
        if block["language"] == "console":
            for line in block["text"].splitlines():
                if line.startswith("$ barwave "):
                    subprocess.run([program, *shlex.split(line)[2:]], cwd=folder, capture_output=True, check=False)


@pytest.mark.parametrize("page", WITH_PYTHON, ids=lambda page: page.stem)
def test_python_blocks_print_what_is_shown(program, page, tmp_path, monkeypatch):
    prepare(program, page, tmp_path)
    monkeypatch.chdir(tmp_path)
    text, names, fresh = page.read_text(), {}, []
    blocks = list(FENCE.finditer(text))
    for block, following in zip(blocks, [*blocks[1:], None]):
        if block["language"] != "python":
            continue
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block["text"], str(page), "exec"), names)
        if following is not None and following["language"] == "text":
            fresh.append((following, printed.getvalue()))
    assert fresh, "no output is shown"
    if "UPDATE_DOCS" in os.environ:
        for block, printed in reversed(fresh):
            text = text[: block.start("text")] + printed + text[block.end("text") :]
        page.write_text(text)
    for block, printed in fresh:
        assert printed == block["text"] or "UPDATE_DOCS" in os.environ
