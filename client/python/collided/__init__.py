"""Client of a Collided server: what does a ray, a sphere or a box meet, what touches what, and when did it begin.

    import collided
    with collided.connect() as c:
        answers = c.rays(origins, directions)      # (n, 3) arrays, metres, world coordinates
        print(answers.distance, answers.object)

Metres everywhere; quaternions (w, x, y, z); times in seconds as float, world times in nanoseconds since 1970 as int.
Calls raise a collided.Error, whose text says what to do next. An answer may be *undecided*, which is neither true nor
false: bool() of it raises. numpy is used where it is installed, and not needed.

It lies over the C interface of the client library (collided.h) by ctypes; nothing is compiled. The library is found as
libcollided_client.so.1 where the system looks, or where the environment variable COLLIDED_LIBRARY points.
"""

from ._answers import Answer, Answers, Hit, Undecided, Verdict
from ._asking import PairAnswer
from ._client import Client, Status, connect
from ._errors import BadInput, Disconnected, Error, InternalError, NoServer, Refused, Timeout
from ._explanations import (
    ExplainedApproach,
    ExplainedBody,
    ExplainedEvent,
    ExplainedGap,
    ExplainedMeeting,
    ExplainedMiss,
    ExplainedNews,
    ExplainedObject,
    ExplainedPair,
    ExplainedRay,
    ExplainedStale,
    ExplainedStanding,
)
from ._events import Event, StandingEvent
from ._groups import Clearance, ClearancePair
from ._library import version
from ._publisher import Publisher, PublisherReport
from ._recordings import RecordedStandingEvents, recorded_standing_events
from ._shapes import (
    Box,
    Capsule,
    Cloud,
    Cone,
    Cylinder,
    Ellipsoid,
    HalfSpace,
    HeightField,
    Hull,
    Mesh,
    Polyline,
    Shape,
    Sphere,
)
from ._standing import StandingWatch
from ._voxels import Voxels, VoxelScan
from ._watch import Watch

__version__ = version()

__all__ = [
    "Answer",
    "Answers",
    "BadInput",
    "Box",
    "Capsule",
    "Clearance",
    "ClearancePair",
    "Client",
    "Cloud",
    "Cone",
    "Cylinder",
    "Disconnected",
    "Ellipsoid",
    "Error",
    "Event",
    "ExplainedApproach",
    "ExplainedBody",
    "ExplainedEvent",
    "ExplainedGap",
    "ExplainedMeeting",
    "ExplainedMiss",
    "ExplainedNews",
    "ExplainedObject",
    "ExplainedPair",
    "ExplainedRay",
    "ExplainedStale",
    "ExplainedStanding",
    "HalfSpace",
    "HeightField",
    "Hit",
    "Hull",
    "InternalError",
    "Mesh",
    "NoServer",
    "PairAnswer",
    "Polyline",
    "Publisher",
    "PublisherReport",
    "RecordedStandingEvents",
    "Refused",
    "Shape",
    "Sphere",
    "StandingEvent",
    "StandingWatch",
    "Status",
    "Timeout",
    "Undecided",
    "Verdict",
    "VoxelScan",
    "Voxels",
    "Watch",
    "connect",
    "recorded_standing_events",
    "version",
]
