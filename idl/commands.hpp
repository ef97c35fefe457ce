#pragma once

#include <cstdint>

/// Commands travel as queries of kind `command`: text = {"command": NAME, ...arguments}. The reply's text is the
/// answer, one JSON object. A refusal has ReplyStatus::refused and the text {"error": MESSAGE, "hint": NEXT_STEP}; the
/// hint is optional. Poses are [x, y, z, qw, qx, qy, qz] in metres; a name may be a glob (* ? [..]) where stated. The
/// answer of a command that changes the world also has not_kept (why it would not survive a crash) if it would not, and
/// keeps_nothing (true) if the server has no folder for its state.
/// This file lists each command with its answer (->): members, or a struct whose members idl/answers lists.
/// command_table.hpp has its arguments and its right.
namespace collided::wire_contract::command {

/// Loads a file into the world. -> Loaded, and for a tiled file tiles {read, of, triangles_of_file}. Replies of status
/// `progress` with {"fraction": f} may precede it.
inline constexpr const char* kLoad = "load";

/// Announces a file that the server cannot read itself. -> upload (number), piece_bytes
inline constexpr const char* kUpload = "upload";

/// The query's blob is a piece of an announced file. Pieces may come in any order and more than once.
/// -> missing (number of missing pieces)
inline constexpr const char* kPiece = "piece";
inline constexpr std::uint64_t kUploadPieceBytes = std::uint64_t{256} << 10;

/// -> Cleared (kept: also objects that the keys do not permit), and detached as for `remove`
inline constexpr const char* kClear = "clear";

/// The query's blob is the shape. -> name, and Added
inline constexpr const char* kAdd = "add";

/// -> name, and Moved. Refused for an object of a live publisher.
inline constexpr const char* kMove = "move";

/// -> Removed, and detached [names] (objects that were attached to them and stay; only if there are any).
/// Refused for objects of a live publisher.
inline constexpr const char* kRemove = "remove";

/// -> ObjectList; if requested, each object with bounds [low, high] (null for an infinite side, or instead of both if
/// there is no triangle)
inline constexpr const char* kList = "list";

/// -> ObjectDetails, and shape [{sphere|box|capsule|mesh ...}], bounds as in list, velocity, in_doubt [names],
/// name_wanted_by [publishers] (the last two only if there are any), version
inline constexpr const char* kGet = "get";

/// -> objects [{name, why}] (at most 20 that the publisher has defined and the world does not have), count (of all of
/// them), merged (poses replaced by newer ones of the same object because the server had too many), refused (why the
/// server accepts nothing from this publisher; absent: it does), version
inline constexpr const char* kLeftOut = "left_out";

/// While a shard is split: a watch of several shards reports which map it watches. -> {}
inline constexpr const char* kWatching = "watching";

/// -> Plan, and scenes [{scene, load, tiles}]. load: arguments of the command load that restore the scene; null for a
/// file that a client sent
inline constexpr const char* kPlan = "plan";

/// -> covers (as in load, for all loaded scenes; null: never stated, so all of space is covered), version
inline constexpr const char* kCovers = "covers";

/// State of a shard. Refused by a server that holds a whole world.
/// -> name (of the shard), map (fingerprint of the shard map, 16 hexadecimal digits), epoch, replaced_within_ns (time
/// in which a standby takes over), succession (as in that command; only if there is one), watches and watches_behind
/// (how many watches have sent `watching` within the last seconds, and how many of those do not watch all shards of
/// the next map; only with succession)
inline constexpr const char* kShard = "shard";

/// A change of the shard map, sent to each shard; see idl/shards/shard_split.hpp. Refused if its revision is not higher
/// than the last one, or if it does not start from the map in force here. After phase `done`, a server that is not a
/// shard of the next map covers nothing. -> version
inline constexpr const char* kSuccession = "succession";

/// -> Audit
inline constexpr const char* kAudit = "audit";

/// Statistics since the server's start. -> Figures
inline constexpr const char* kFigures = "figures";

/// The newest steps of the world, oldest first. -> NewestSteps
inline constexpr const char* kSteps = "steps";
inline constexpr std::uint64_t kMostSteps = 256;

/// Samples of the questions of other clients, at most 20 a second. Sampling starts with the first call and stops two
/// seconds after the last one. -> questions [{sequence, kind, ago_ns, answer (hit, miss, undecided, invalid), of a ray
/// origin, direction, length (absent:
///    endless), of a sphere center, radius, of a box center, half, orientation (w x y z), of near point, reach (absent:
///    endless), of inside point; of the first hit object, distance, error, at, normal}], since (for the next call)
inline constexpr const char* kSampled = "sampled";

/// Sets a probe, replacing one of that name, or removes probes. -> probes [names], version
inline constexpr const char* kProbe = "probe";

/// -> probes [{probe, object, origin, direction, reach_m, back_m, state, clearance, error, met, triangle, point, normal}],
/// version
inline constexpr const char* kProbes = "probes";

/// Adds or removes standing questions. The shape of a region is a prism or the query's blob: solid shapes and closed
/// meshes, in the world or in the frame of the object that it moves along with.
/// -> standing [names] (not for many), count, version, parts (for bands: number of parts of loaded scenes that the
/// globs match, which have no bands; absent: none)
inline constexpr const char* kFence = "fence";
/// Text of a reply without a request (number 0): the client has disconnected, and the standing questions that it had
/// added without `keep` are removed. No client waits for it; it is for recordings.
inline constexpr const char* kClientGone = R"({"gone":true})";

/// -> standing [ListedStanding], or with outlines [OutlinedStanding], count, bytes (of memory for all), version
inline constexpr const char* kFences = "fences";

/// Contact, depth or distance of two objects.
/// -> PairAnswer. triangle_pairs, pair_count and cut are absent if no triangles touch; `opinion` has FCL's touches and
/// distance, each absent if it gives none
inline constexpr const char* kPair = "pair";

/// Why two objects touch or not, and why events report it or not.
/// -> as pair without triangles and certificate, and the members of ExplainedPair
/// With ray: why it hits what it hits -> ExplainedRay. With standing or event: ExplainedStanding, ExplainedEvent.
inline constexpr const char* kExplain = "explain";

/// Allows pairs to touch: their contacts are no longer reported, and end with reason `allowed`. The last of at most 64
/// rules that matches a pair decides. -> RuleChanged, its contacts as `ended`
inline constexpr const char* kAllow = "allow";
/// Removes the rule for these two, and what other rules allow for them.
/// -> RuleChanged, its contacts as `began`
inline constexpr const char* kDeny = "deny";
/// -> rules [ListedRule] in their order, version
inline constexpr const char* kAllowed = "allowed";

/// The nearest pairs of two groups, each object of one with each of the other. A group is named by an object, a scene
/// (all its objects) or a glob.
/// -> ClearanceAnswer
inline constexpr const char* kClearance = "clearance";

/// Lets an object without a publisher move along with another one, until one of the two is removed or the first is
/// detached. -> child, parent, pose, version
inline constexpr const char* kAttach = "attach";
/// Detaches the child, which stays where it is. -> child, parent (before), version
inline constexpr const char* kDetach = "detach";

/// -> losses [text] (acknowledged before a crash, but missing), accepted (the world counts as complete without them
/// from now on)
inline constexpr const char* kAcceptLoss = "accept_loss";

/// Hands over to a standby, and this server ends. -> to (name of the standby). Refused if none is ready.
inline constexpr const char* kHandOver = "handover";
/// Sent on change_v2 by a server that hands over to its followers; clients cannot send it. to (number of the new
/// primary), applied [[publisher, sequence_number]] (the samples that the old one has applied)
inline constexpr const char* kTakeOver = "take_over";

/// The flight recorder. -> number, bytes, messages, dropped, path (on the server's machine), from_ns, to_ns; the file
/// is an MCAP recording. With number: up to 1 MiB of that file, as raw bytes instead of JSON. The newest four can be
/// fetched.
inline constexpr const char* kRecording = "recording";

/// Measures the cost of each method of answering. Takes seconds. -> Menu
/// With `of` the query's blob has the questions as little-endian doubles: for each ray 7 (from, direction, length),
/// sphere 4 (centre, radius), box 10 (centre, half sizes, rotation w x y z), near 4 (point, reach). A length and a
/// reach may be infinite. At most kMostMenuQuestions.
inline constexpr std::uint64_t kMostMenuQuestions = 10'000;
inline constexpr const char* kMenu = "menu";

/// The commands of viewers. Their answers are FlatBuffers of idl/geometry.fbs, not JSON. All except kPoses answer with
/// the first Page of the result; kMore fetches the others. A larger result is refused.
inline constexpr std::uint64_t kMaxGeometryBytes = std::uint64_t{512} << 20;

/// -> Page of ShownObjects
inline constexpr const char* kShapes = "shapes";

/// -> Page of a Surface
inline constexpr const char* kSurface = "surface";

/// -> Page of a scene file (scene.fbs) with its table Frozen: the newest state of the world
inline constexpr const char* kSnapshot = "snapshot";

/// -> Page. A buffer is kept for half a minute after the last request for one of its pages.
inline constexpr const char* kMore = "more";

/// -> Poses of all moving objects, up to 400,000
inline constexpr const char* kPoses = "poses";

}  // namespace collided::wire_contract::command
