"""Client of a Collided server: what does a ray, a sphere or a box hit, which objects touch, and since when?

    import collided
    with collided.connect() as c:
        answers = c.rays(origins, directions)      # (n, 3) arrays, metres, world coordinates
        print(answers.distance, answers.object)

connect() makes a Client with these functions:
    questions           rays, spheres, boxes, nearest, inside, ray, sphere, sweep, what_if
    two objects         pair, clearance
    why                 explain_ray, explain_pair, explain_standing, explain_event
    events              watch, watch_standing, watch_probes
    standing questions  add_region, add_bands, add_nearest, remove_standing, standing
    the world           add, move, remove, attach, detach, allow, deny, rules, load, clear, list, get, plan
    probes              add_probe, remove_probes, probes
    own objects         publish makes a Publisher; its robot() moves a robot by joints, its voxels() is a grid of cells for scans
    everything else     status, command

Functions without a Client: recorded_events and recorded_standing_events read a recording, fetch_recording and replay make one
and publish it again, diagnose finds why programs do not hear each other, fleet lists the servers of a namespace.

Units      metres, world coordinates; quaternions (w, x, y, z); poses (x, y, z, w, x, y, z); times in seconds as float, world
           times in nanoseconds since 1970 as int, with _ns at the end of their names
Errors     calls raise a collided.Error, with the next step in its text: BadInput, NoServer, Timeout, Refused, Disconnected
Undecided  an answer may be neither true nor false: bool() of it raises Undecided
Answers    frozen dataclasses; their help lists the members
Arrays     of numpy if it is installed, else of Python; contiguous float64 is not copied

The package uses the C interface of the client library (collided.h) through ctypes; nothing is compiled. It loads
libcollided_client.so.2 from the system's library path, or the file in the environment variable COLLIDED_LIBRARY.
"""

from types import FunctionType

from . import _schema
from ._answers import Answer, Answers
from ._client import Client, connect
from ._described import Undecided, Verdict
from ._errors import BadInput, Disconnected, Error, InternalError, NoServer, Refused, Timeout
from ._events import Event, StandingEvent
from ._library import version
from ._publisher import Publisher, PublisherReport
from ._recordings import diagnose, fetch_recording, fleet, recorded_events, recorded_standing_events, replay
from ._schema import *
from ._shapes import (
    Box, Capsule, Cloud, Cone, Cylinder, Ellipsoid, HalfSpace, HeightField, Hull, Mesh, Polyline, Shape, Sphere,
)
from ._robot import PublishedRobot
from ._voxels import Voxels
from ._watch import ProbeWatch, StandingWatch, Watch

__version__ = version()

__all__ = [
    "connect", "Client", "version",
    "Answers", "Answer", "Verdict", "Undecided",
    "Watch", "Event", "StandingWatch", "StandingEvent", "ProbeWatch",
    "recorded_events", "recorded_standing_events", "fetch_recording", "replay", "diagnose", "fleet",
    "Publisher", "PublisherReport", "PublishedRobot", "Voxels",
    "Shape", "Box", "Capsule", "Cloud", "Cone", "Cylinder", "Ellipsoid", "HalfSpace", "HeightField", "Hull", "Mesh",
    "Polyline", "Sphere",
    "Error", "BadInput", "NoServer", "Timeout", "Refused", "Disconnected", "InternalError",
]
__all__ += _schema.__all__

# Help and tracebacks then show the package's name only.
for _name in __all__:
    if isinstance(globals()[_name], (type, FunctionType)):
        globals()[_name].__module__ = __name__
