#!/usr/bin/env python3
"""Runs a command on DDS domains that no other test uses, with COLLIDED_DOMAIN set to the first of them, and with an empty
state folder: a server keeps its world under the number of its domain, and the next test may get the same.

usage: in_own_domain.py [--domains COUNT] COMMAND...    '{domain}', '{domain2}', ... in an argument are their numbers

A claim is an abstract socket, as in tests/service/own_domain.hpp. It is held until the command and all its children have
ended, so the domain is free again only when nothing speaks there any more.
"""

import os
import shutil
import socket
import sys
import tempfile

# tests/service/own_domain.hpp claims those below; Cyclone DDS has no ports for a full domain above 230.
FIRST, LAST = 191, 230


def claim(domain: int) -> socket.socket | None:
    one = socket.socket(socket.AF_UNIX)
    try:
        one.bind(f"\0collided_test_domain_{domain}")
    except OSError:
        one.close()
        return None
    one.set_inheritable(True)
    return one


def main() -> None:
    words = sys.argv[1:]
    count = 1
    if words[0] == "--domains":
        count, words = int(words[1]), words[2:]
    places = LAST - FIRST + 2 - count
    for attempt in range(places):
        domain = FIRST + (os.getpid() + attempt) % places
        # Kept in a name: a claim ends when its socket is collected.
        claims = [claim(domain + k) for k in range(count)]
        if all(claims):
            os.environ["COLLIDED_DOMAIN"] = str(domain)
            # Named by the domain, which is claimed, so that what is left of an earlier test is found and removed.
            state = os.path.join(tempfile.gettempdir(), f"collided_test_state_{os.getuid()}_{domain}")
            shutil.rmtree(state, ignore_errors=True)
            os.environ["XDG_STATE_HOME"] = state
            for k in range(count):
                name = "{domain}" if k == 0 else f"{{domain{k + 1}}}"
                words = [word.replace(name, str(domain + k)) for word in words]
            os.execvp(words[0], words)
        for one in claims:
            if one:
                one.close()
    sys.exit(f"in_own_domain.py: every domain from {FIRST} to {LAST} is in use by another test")


main()
