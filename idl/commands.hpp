#pragma once

#include <cstdint>

/// Commands travel as queries of kind `command`: text = {"command": NAME, ...arguments}. The reply's text is the
/// answer, one JSON object. A refusal has ReplyStatus::refused and the text {"error": MESSAGE, "hint": NEXT_STEP}, the
/// hint only where there is one. Poses are [x, y, z, qw, qx, qy, qz] in metres; a name may be a glob (* ? [..]) where
/// that is said. The answer of a command that changes the world has not_kept (why it would not outlive a crash) where
/// that is so, and keeps_nothing (true) where the server has no folder to keep anything in. Each command stands here with
/// its answer (->), members or a struct whose members idl/answers lists; command_table.hpp has its arguments and its right.
namespace collided::wire_contract::command {

/// Loads a file into the world. -> Loaded, and tiles {read, of, triangles_of_file} where the file is in tiles.
/// Replies of status `progress` with {"fraction": f} may come before.
inline constexpr const char* kLoad = "load";

/// Announces a file that the server cannot read itself. -> upload (number), piece_bytes
inline constexpr const char* kUpload = "upload";

/// A piece of an announced file is the query's blob. Pieces may come in any order and more than once.
/// -> missing (number of pieces that have yet to come)
inline constexpr const char* kPiece = "piece";
inline constexpr std::uint64_t kUploadPieceBytes = std::uint64_t{256} << 10;

/// -> Cleared (kept: also objects that the keys are not for), and detached as of `remove`
inline constexpr const char* kClear = "clear";

/// The shape is the query's blob. -> name, and Added
inline constexpr const char* kAdd = "add";

/// -> name, and Moved. Refused for an object of a live publisher.
inline constexpr const char* kMove = "move";

/// -> Removed, and detached [names] (what was attached to them and stays; only where there is any).
/// Refused for objects of a live publisher.
inline constexpr const char* kRemove = "remove";

/// -> ObjectList, each object with bounds [low, high] where they were requested (null for a side without end, or in place
/// of both where there is no triangle)
inline constexpr const char* kList = "list";

/// -> ObjectDetails, and shape [{sphere|box|capsule|mesh ...}], bounds as in list, velocity, in_doubt [names],
/// name_wanted_by [publishers] (the last two only where there are any), version
inline constexpr const char* kGet = "get";

/// -> objects [{name, why}] (at most 20 that the publisher has defined and the world does not have), count (of all of
/// those), merged (poses replaced by newer ones of the same object while the server had too many), refused (why the
/// server takes nothing of this publisher; missing: it does), version
inline constexpr const char* kLeftOut = "left_out";

/// -> settled_ns (world time up to which every contact is decided: by the publishers that have objects here; where none has,
///    the server's clock), event_sequence (all are told up to this one), epoch; heir_of (whose place it took), told_from
inline constexpr const char* kSettled = "settled";

/// -> Plan, and scenes [{scene, load, tiles}]. load: the arguments of the command load that would bring the scene back;
/// null for a file that a client sent
inline constexpr const char* kPlan = "plan";

/// -> covers (as in load, of all that is loaded; null: none was ever stated, so all of space is covered), version
inline constexpr const char* kCovers = "covers";

/// Of one of several servers that share a world: -> name (of the shard), map (fingerprint of the shard map, 16 hexadecimal
/// digits), epoch, replaced_within_ns (a standby takes this server's place within so long), succession (as the command of that name has it; only where there is one), watches and watches_behind (how
/// many have asked for `settled` within the last seconds, and how many of those do not watch all shards of the next map;
/// only with succession). Refused by a server that holds all of its world
inline constexpr const char* kShard = "shard";

/// What becomes of the shards, sent to each of them; see idl/shards/shard_split.hpp. What has a revision that is not
/// higher than the last one is refused, and what does not begin with the map that holds here. With phase `done` a server
/// that is no shard of the next map covers nothing from then on. -> version
inline constexpr const char* kSuccession = "succession";

/// -> Audit
inline constexpr const char* kAudit = "audit";

/// What the server has done since its start. -> Figures
inline constexpr const char* kFigures = "figures";

/// The newest steps of the world, the oldest first. -> NewestSteps
inline constexpr const char* kSteps = "steps";
inline constexpr std::uint64_t kMostSteps = 256;

/// Some of the questions that other clients ask, at most 20 a second: from the first call on they are sampled, and two seconds
/// after the last one no longer.
/// -> questions [{sequence, kind, ago_ns, answer (hit, miss, undecided, invalid), of a ray origin, direction, length (absent:
///    endless), of a sphere center, radius, of a box center, half, orientation (w x y z), of near point, reach (absent:
///    endless), of inside point; of the first hit object, distance, error, at, normal}], since (for the next call)
inline constexpr const char* kSampled = "sampled";

/// Sets a probe, in place of one of that name, or removes probes. -> probes [names], version
inline constexpr const char* kProbe = "probe";

/// -> probes [{probe, object, origin, direction, reach_m, back_m, state, clearance, error, met, triangle, point, normal}],
/// version
inline constexpr const char* kProbes = "probes";

/// Adds or removes standing questions. The shape of a region is a prism or the query's blob: solid shapes and closed meshes,
/// in the world or in the frame of the object that it moves along with.
/// -> standing [names] (not of many), count, version, parts (of bands: parts of loaded scenes that the globs match, which
/// have no bands; absent: none)
inline constexpr const char* kFence = "fence";
/// Text of a reply that answers no request (its number is 0): the client has gone, and with it the standing questions that
/// it had added without `keep`. Nobody waits for it; recordings have it.
inline constexpr const char* kClientGone = R"({"gone":true})";

/// -> standing [ListedStanding], or with outlines [OutlinedStanding], count, bytes (of memory for all), version
inline constexpr const char* kFences = "fences";

/// How two objects stand to each other.
/// -> PairAnswer. triangle_pairs, pair_count and cut are absent where no triangles
///    meet; `opinion` has FCL's touches and distance, each absent where it gives none
inline constexpr const char* kPair = "pair";

/// Why two objects touch or do not, and why events do or do not say so.
/// -> as pair without triangles and certificate, and the members of ExplainedPair
/// With ray: why it meets what it meets -> ExplainedRay. With standing or event: ExplainedStanding, ExplainedEvent.
inline constexpr const char* kExplain = "explain";

/// Rules of which pairs may touch: their contacts are none, and end with reason `allowed`. The last rule that fits a pair
/// decides, at most 64. -> RuleChanged, its contacts as `ended`
inline constexpr const char* kAllow = "allow";
/// Takes back the rule of these two, and what other rules allow of them.
/// -> RuleChanged, its contacts as `began`
inline constexpr const char* kDeny = "deny";
/// -> rules [ListedRule] in their order, version
inline constexpr const char* kAllowed = "allowed";

/// The nearest pairs of two groups, each object of one with each of the other. A group is named by an object, a scene
/// (all that was loaded with it) or a glob.
/// -> ClearanceAnswer
inline constexpr const char* kClearance = "clearance";

/// An object that no publisher has moves along with another one, until one of the two is removed or the first is
/// detached. -> child, parent, pose, version
inline constexpr const char* kAttach = "attach";
/// The child stays where it is. -> child, parent (that it had), version
inline constexpr const char* kDetach = "detach";

/// -> losses [text] (what had been acknowledged before a crash and is missing), accepted (the world counts as whole
/// without it from now on)
inline constexpr const char* kAcceptLoss = "accept_loss";

/// A server that stands by takes this one's place, and this one ends. -> to (its name). Refused where none is ready.
inline constexpr const char* kHandOver = "handover";
/// What a server that hands over tells those that follow it, on change_v2; no client can send it. to (number of the server
/// that takes the place), applied [[publisher, sequence_number]] (how far the one that hands over has come)
inline constexpr const char* kTakeOver = "take_over";

/// The flight recorder.
/// -> number, bytes, messages, dropped, path (on the server's machine), from_ns, to_ns; the file is an MCAP recording.
/// With number: up to 1 MiB of that file, as it is and not as JSON. The newest four can be fetched.
inline constexpr const char* kRecording = "recording";

/// What each way of answering costs. Takes seconds. -> Menu
/// With `of` the questions are the query's blob, little-endian doubles, of each ray 7 (from, direction, length), sphere 4
/// (centre, radius), box 10 (centre, half sizes, rotation w x y z), near 4 (point, reach); a length and a reach may be
/// infinite. At most kMostMenuQuestions.
inline constexpr std::uint64_t kMostMenuQuestions = 10'000;
inline constexpr const char* kMenu = "menu";

/// The commands of viewers. Their answers are no JSON but FlatBuffers of idl/geometry.fbs. All but that of kPoses come
/// as a Page, the first of as many as the answer needs; kMore asks for the others. A longer answer is refused.
inline constexpr std::uint64_t kMaxGeometryBytes = std::uint64_t{512} << 20;

/// -> Page of ShownObjects
inline constexpr const char* kShapes = "shapes";

/// -> Page of a Surface
inline constexpr const char* kSurface = "surface";

/// -> Page. A buffer of which no page is asked for any more is kept for half a minute.
inline constexpr const char* kMore = "more";

/// -> Poses of all moving objects, up to 400,000
inline constexpr const char* kPoses = "poses";

}  // namespace collided::wire_contract::command
