#!/usr/bin/env python3
"""Runs the commands of a Markdown page and compares what they print with what the page shows.

usage: run_page.py [--update] BIN_DIR PAGE...

Every ```sh block is a script, run with `set -e` in a folder of the page's own that has config, data and examples of the
repository, and the programs of BIN_DIR in its PATH. A block right after it shows its standard output. There a line "..."
stands for any lines; durations may differ. A block after a line `<!-- not run: REASON -->` is left alone. --update writes
what was printed into the page, and keeps the place of its "...".
exit code: 0 all as shown, 1 not so, 77 no Python with numpy
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^(?P<skip><!-- not run: [^\n]* -->\n)?```sh\n(?P<script>.*?)```\n"
                   r"(?:\n?```(?:text|json)\n(?P<shown>.*?)```\n)?", re.DOTALL | re.MULTILINE)
DURATION = re.compile(r"[\d.]+(?= (ms|s)\b)|(?<=took )[\d:]+")


def python_with_numpy():
    for python in (sys.executable, "/usr/bin/python3"):
        if subprocess.run([python, "-c", "import numpy"], stderr=subprocess.DEVNULL).returncode == 0:
            return python
    print("skipped: no python3 with numpy here")
    sys.exit(77)


def workplace(folder, bin_dir):
    """A folder that the page's paths begin at, and the environment of its commands."""
    for name in ("config", "data", "examples"):
        (folder / name).symlink_to(ROOT / name)
    # A link to an environment's python3 elsewhere would not find the environment's packages.
    python_folder = pathlib.Path(python_with_numpy()).parent
    return dict(os.environ, PATH=f"{bin_dir}:{python_folder}:{os.environ['PATH']}", PYTHONDONTWRITEBYTECODE="1")


def same(shown, printed):
    """Whether the lines agree but for durations and what "..." stands for."""
    neutral = lambda text: [re.sub(r"\s+", " ", DURATION.sub("#", line)).strip() for line in text.splitlines()]
    shown, printed = neutral(shown), neutral(printed)
    if "..." not in shown:
        return shown == printed
    gap = shown.index("...")
    after = shown[gap + 1 :]
    return (len(printed) >= gap + len(after) and printed[:gap] == shown[:gap]
            and printed[len(printed) - len(after) :] == after)


def abridged(shown, printed):
    """The new output with "..." where the old one has it."""
    old, new = shown.splitlines(), printed.splitlines()
    if "..." in old:
        gap = old.index("...")
        new = new[:gap] + ["..."] + new[len(new) - (len(old) - gap - 1) :]
    return "".join(line.rstrip() + "\n" for line in new)


def run_page(page, bin_dir, update):
    text, good, ran = page.read_text(encoding="utf-8"), True, 0
    with tempfile.TemporaryDirectory(prefix="tubebin_page_") as folder:
        environment = workplace(pathlib.Path(folder), bin_dir)

        def run(block):
            nonlocal good, ran
            if block["skip"]:
                return block[0]
            ran += 1
            result = subprocess.run(["bash", "-ec", block["script"]], cwd=folder, env=environment, capture_output=True,
                                    text=True)
            place = f"{page.relative_to(ROOT)}:{text.count(chr(10), 0, block.start('script')) + 1}"
            if result.returncode != 0:
                print(f"{place}: exit code {result.returncode}\n{result.stdout}{result.stderr}")
                good = False
            elif block["shown"] is not None and not same(block["shown"], result.stdout):
                print(f"{place}: prints\n{result.stdout}instead of\n{block['shown']}")
                good = update
                start, end = block.start("shown") - block.start(), block.end("shown") - block.start()
                return block[0][:start] + abridged(block["shown"], result.stdout) + block[0][end:]
            return block[0]

        new_text = BLOCK.sub(run, text)
    if update and new_text != text:
        page.write_text(new_text, encoding="utf-8")
    if ran == 0:
        print(f"{page}: has no commands")
    return good and ran > 0


arguments = sys.argv[1:]
update = arguments[:1] == ["--update"]
bin_dir, *pages = arguments[update:]
results = [run_page(pathlib.Path(page).resolve(), pathlib.Path(bin_dir).resolve(), update) for page in pages]
if not all(results) and not update:
    print(f"where the change is meant: tests/apps/run_page.py --update {bin_dir} {' '.join(pages)}")
sys.exit(0 if all(results) else 1)
