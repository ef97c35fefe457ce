"""Commands as JSON, which several of a Client's calls are made of."""

from __future__ import annotations

import ctypes
import json
from typing import Any

from ._library import Owned, call, encoded, library, nanoseconds


class Commanding(Owned):
    """What sends commands to a server."""

    def command(self, name: str, /, timeout: float = 10.0, **arguments: Any) -> dict[str, Any]:
        """Sends any command; its answer as a dictionary."""
        text = encoded(json.dumps(arguments), "the arguments")
        said = ctypes.c_void_p()
        call("command", self._handle, encoded(name, "the command"), text, nanoseconds(timeout, "timeout"), ctypes.byref(said))
        try:
            answer = ctypes.string_at(said) if said else b""
        finally:
            library.collided_free_text(said)
        decoded = json.loads(answer) if answer else {}
        return decoded if isinstance(decoded, dict) else {"answer": decoded}
