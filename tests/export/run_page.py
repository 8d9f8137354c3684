#!/usr/bin/env python3
"""Run the Python examples of a Markdown page, each by itself; pictures go into a folder instead of onto a screen.

usage: run_page.py PAGE PICTURES (in the folder that the examples' paths begin at)
exit code: 0 all ran and showed something, 1 one failed, 77 a package that they need is missing
"""
import re
import sys
import traceback

try:
    import matplotlib
    import numpy  # noqa: F401
    import pycocotools  # noqa: F401
except ImportError as error:
    print(error)
    sys.exit(77)

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402

page, pictures = sys.argv[1:]
examples = re.findall(r"```python\n(.*?)```", open(page, encoding="utf-8").read(), re.DOTALL)
assert examples, f"{page} has no examples"
for number, example in enumerate(examples, 1):
    shown = []
    plt.show = lambda: (plt.savefig(f"{pictures}/{number}.png"), shown.append(number), plt.close("all"))
    try:
        exec(compile(example, f"{page}, example {number}", "exec"), {})
    except Exception:
        traceback.print_exc()
        sys.exit(1)
    assert shown, f"example {number} of {page} shows no picture"
