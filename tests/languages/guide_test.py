#!/usr/bin/env python3
"""Runs the Python of a guide, as one session: every line after >>> with the output that stands below it.

usage: guide_test.py GUIDE DOMAIN LEAST
"""

import doctest
import os
import re
import sys

path, domain, least = sys.argv[1], sys.argv[2], int(sys.argv[3])
os.environ["COLLIDED_DOMAIN"] = domain
with open(path, encoding="utf-8") as file:
    blocks = re.findall(r"^```pycon\n(.*?)^```", file.read(), re.M | re.S)
session = "\n".join(blocks)
test = doctest.DocTestParser().get_doctest(session, {}, os.path.basename(path), path, 0)
runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
runner.run(test)
result = runner.summarize()
print(f"{path}: {result.attempted} lines, {result.failed} wrong")
sys.exit(1 if result.failed or result.attempted < least else 0)
