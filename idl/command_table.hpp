#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "idl/commands.hpp"
#include "idl/topics.hpp"

/// Every command with its right, the state it changes, and its arguments. All code that depends on a command's name
/// uses this table. The families in server/service/commands bind the handlers and thereby the threads.
namespace collided::wire_contract::command {

enum class ArgumentType : std::uint8_t {
  text,
  texts,    // a list
  truth,    // true or false
  whole,    // a whole number from 0 on
  number,   // finite
  numbers,  // a list
  vector,   // three numbers
  pose,     // [x, y, z, qw, qx, qy, qz]
  boxes     // [[low 3, high 3], ...] in metres, a side without end as the text "inf" or "-inf"
};

/// An argument of a command. Null counts as absent.
struct ArgumentSpec {
  const char* name;
  ArgumentType type;
  const char* meaning = "";                                        // unit, range, and anything that name and type leave
                                                                   // open
  double otherwise = 0;                                            // default of a number, a whole number or a truth
  std::uint64_t most = std::numeric_limits<std::uint64_t>::max();  // of a whole number
};

/// The largest whole number that a JSON reader with doubles keeps exactly.
inline constexpr std::uint64_t kMostExact = std::uint64_t{1} << 53;

namespace arguments {

using enum ArgumentType;

inline constexpr double kEndless = std::numeric_limits<double>::infinity();
inline constexpr std::uint64_t kBits = 0xffffffff;
inline constexpr std::uint64_t kMostNs = std::uint64_t{1} << 60;

// ---- shared by several commands

inline constexpr ArgumentSpec kOnly{"only", text, "glob of the objects that count; absent: all"};
inline constexpr ArgumentSpec kSkip{"skip", text, "glob of the objects that do not"};
inline constexpr ArgumentSpec kMask{"mask", whole, "layers; absent: all", kBits, kBits};
inline constexpr ArgumentSpec kGlob{"name", text, "glob; absent: all"};
inline constexpr ArgumentSpec kMoving{"moving", truth,
                                      "only objects that move, or only those that do not; absent: both"};
inline constexpr ArgumentSpec kAsOf{"as_of", text, "instant, see instant.hpp; absent: the latest"};
inline constexpr ArgumentSpec kOpinion{"opinion", text, "fcl: that library is asked too, in a process of its own"};
inline constexpr ArgumentSpec kDeadline{"deadline_ns", whole,
                                        "from when the server takes the command, then late; absent: none", 0, kMostNs};
inline constexpr ArgumentSpec kHysteresis{"hysteresis", number, "m"};
inline constexpr ArgumentSpec kKeep{
    "keep", truth, "it stays until it is removed, and outlives the server; else it goes with the client"};
inline constexpr ArgumentSpec kSolidBy{
    "solid_by", text, "winding: a mesh that does not close is solid by its winding number; absent: it is refused"};

// ---- objects and scenes

inline constexpr ArgumentSpec kLoad[]{
    {"path", text, "on the server's machine; or upload"},
    {"name", text, "absent: the file's stem"},
    {"unit_m", number, "m, above 0", 1},
    {"up", text, "y or z; absent: as the format says"},
    {"radius_m", number, "m"},
    {"strict", truth},
    {"replace", truth, "the scene of that name"},
    {"mend", truth},
    {"crack_m", number, "m, from 0 on"},
    {"srdf", text, "path"},
    {"foreign", truth},
    {"covers", boxes, "where its geometry is complete"},
    {"crc32", whole, "of the file; absent: whatever it holds is taken", 0, kBits},
    {"solid", text, "glob of the parts and objects whose meshes are solid"},
    kSolidBy,
    {"moving", truth, "its objects take poses, so that a publisher can claim them"},
    {"packages", texts, "NAME=DIR"},
    {"upload", whole, "number of the uploaded file, in place of a path", 0, kMostExact}};
inline constexpr ArgumentSpec kUpload[]{{"file", text, "its name, with the ending"},
                                        {"bytes", whole, "", 0, kMostExact},
                                        {"checksum", whole, "CRC-32 of all of it", 0, kBits}};
inline constexpr ArgumentSpec kPiece[]{{"upload", whole, "its number", 0, kMostExact},
                                       {"first", whole, "byte, a multiple of piece_bytes", 0, kMostExact},
                                       {"checksum", whole, "CRC-32 of the piece", 0, kBits}};
inline constexpr ArgumentSpec kClear[]{{"scene", text, "absent: all"},
                                       {"moving", truth, "also or, without scene, only moving objects"}};
inline constexpr ArgumentSpec kAdd[]{{"name", text},
                                     {"pose", pose, "absent: at the world's origin"},
                                     {"layers", whole, "bits", 1, kBits},
                                     {"mask", whole, "bits", kBits, kBits},
                                     {"group", whole, "", 0, kBits},
                                     {"moving", truth, "", true},
                                     {"scale", vector, "factors"},
                                     {"solid", truth, "its mesh is; refused where that does not close"},
                                     kSolidBy};
inline constexpr ArgumentSpec kMove[]{
    {"name", text}, {"pose", pose, "needed"}, {"teleport", truth, "it passes nothing on its way"}};
inline constexpr ArgumentSpec kRemove[]{{"name", text, "glob"}};
inline constexpr ArgumentSpec kList[]{
    kGlob, kMoving, {"limit", whole, "", 10'000, 1'000'000}, {"bounds", truth, "with them"}};
inline constexpr ArgumentSpec kGet[]{{"name", text}};
inline constexpr ArgumentSpec kLeftOut[]{{"publisher", whole, "its number"}};
inline constexpr ArgumentSpec kAttach[]{
    {"child", text}, {"parent", text}, {"pose", pose, "of the child in the parent's frame; absent: as they are"}};
inline constexpr ArgumentSpec kDetach[]{{"child", text}};

// ---- probes, standing questions and rules

inline constexpr ArgumentSpec kProbe[]{{"name", text, "with remove a glob"},
                                       {"object", text, "that carries it"},
                                       {"origin", vector, "m, in the object's frame; absent: its origin"},
                                       {"direction", vector, "in the object's frame; absent: 0, 0, -1"},
                                       {"reach_m", number, "m", kEndless},
                                       {"back_m", number, "m"},
                                       {"remove", truth}};
inline constexpr ArgumentSpec kProbes[]{kGlob};
inline constexpr ArgumentSpec kFence[]{
    {"name", text},
    kOnly,
    kSkip,
    kMask,
    {"detect", texts, "of enter, exit, cross; absent: all"},
    {"to", text, "object that carries it"},
    {"prism", numbers, "[low, high, x, y, x, y, ...] in m; absent: the shape is the query's blob"},
    kKeep};
inline constexpr ArgumentSpec kManyFences[]{
    {"many", truth, "the query's blob has fences one after the other, see packed_fences.hpp"}};
inline constexpr ArgumentSpec kMargin[]{
    {"name", text}, {"around", text, "glob of the objects that have the bands"},
    kOnly,          kSkip,
    kMask,          {"bands", numbers, "m, widest first; at most 8 with 0, contact, which is added"},
    kHysteresis,    {"dwell_ns", whole, "how long a change must last", 0, std::uint64_t{1} << 62},
    kKeep};
inline constexpr ArgumentSpec kNearest[]{{"name", text},
                                         {"to", text, "object; or point"},
                                         {"point", vector, "m"},
                                         kOnly,
                                         kSkip,
                                         kMask,
                                         {"within", number, "m"},
                                         kHysteresis,
                                         kKeep};
inline constexpr ArgumentSpec kForm{"form", text, "of this form alone: region, bands, nearest; absent: of all"};
inline constexpr ArgumentSpec kRemovedFences[]{kGlob, kForm, {"remove", truth}};
inline constexpr ArgumentSpec kFences[]{kGlob,
                                        kForm,
                                        {"limit", whole, "", 10'000, 1'000'000},
                                        {"outlines", truth, "regions and bands as pictures show them; at most 1,000"},
                                        {"lines", truth, "with outlines: their lines too"}};
inline constexpr ArgumentSpec kAllow[]{{"a", text, "glob"}, {"b", text, "glob"}, {"because", text}};
inline constexpr ArgumentSpec kDeny[]{{"a", text, "glob"}, {"b", text, "glob"}};

// ---- measuring and explaining

inline constexpr ArgumentSpec kPair[]{{"a", text},
                                      {"b", text},
                                      {"certificate", truth},
                                      {"triangles", truth},
                                      {"most", whole, "triangle pairs reported", 10'000, kMaxTrianglePairs},
                                      kAsOf,
                                      kOpinion,
                                      kDeadline};
inline constexpr ArgumentSpec kClearance[]{
    {"from", text, "object, scene or glob"},
    {"to", text, "object, scene or glob; absent: everything outside `from`"},
    {"skip", text, "glob; left out of both"},
    {"most", whole, "pairs reported; with certificates up to 1,000", 1, 10'000},
    {"nearer_m", number, "m; only pairs not surely farther apart", kEndless},
    {"with_filtered", truth, "pairs that masks and groups let pass through each other too"},
    {"certificate", truth},
    kAsOf,
    kDeadline,
    {"progress", truth, "replies of status `progress` come before, as of load"}};
inline constexpr ArgumentSpec kMostOthers{"most", whole, "misses, or objects outside, that are reported", 3, 1'000};
inline constexpr ArgumentSpec kWhyNot{"why_not", text, "object that is explained in any case"};
inline constexpr ArgumentSpec kExplainPair[]{
    {"a", text},
    {"b", text},
    {"last_ns", whole, "how far back their paths are searched; absent: as far as poses are remembered", 0,
     std::uint64_t{1} << 62},
    kAsOf,
    kDeadline};
inline constexpr ArgumentSpec kExplainRay[]{{"ray", numbers, "origin 3 (m), direction 3"},
                                            {"length", number, "m", kEndless},
                                            kOnly,
                                            kSkip,
                                            kMask,
                                            kMostOthers,
                                            kWhyNot,
                                            kAsOf,
                                            kDeadline};
inline constexpr ArgumentSpec kExplainStanding[]{
    {"standing", text, "name of a region or a question for the nearest"}, kWhyNot, kMostOthers, kDeadline};
inline constexpr ArgumentSpec kExplainEvent[]{
    {"event", whole, "its sequence"}, {"of", text, "contacts or standing; absent: contacts"}, kDeadline};
inline constexpr ArgumentSpec kMenu[]{{"questions", whole, "of each kind", 1'000, 100'000},
                                      {"seed", whole, "", 1},
                                      {"of", text, "ray, sphere, box or near: the query's blob has the questions"},
                                      kOpinion,
                                      kDeadline};

// ---- the server itself

inline constexpr ArgumentSpec kSteps[]{{"last", whole, "how many", kMostSteps, kMostSteps}};
inline constexpr ArgumentSpec kSampled[]{
    {"since", whole, "sequence of the last one known; absent: all that are kept, 64", 0, kMostExact}};
inline constexpr ArgumentSpec kRecording[]{
    {"last_s", number, "0 to 86,400; 0: only what publishers and commands have brought into the world", 30},
    {"number", whole, "of a recording that was made: a page of it is the answer"},
    {"offset", whole, "byte of that file", 0, std::uint64_t{1} << 40}};
inline constexpr ArgumentSpec kAcceptLoss[]{{"show", truth, "nothing is accepted"}};
inline constexpr ArgumentSpec kHandOver[]{{"to", text, "member of the fleet; absent: any that is ready"}};
inline constexpr ArgumentSpec kWatching[]{
    {"watch", whole, "number of a watch of several shards"},
    {"map", text, "fingerprint of the newest shard map all of whose shards it watches"}};
inline constexpr ArgumentSpec kSuccession[]{{"revision", whole}, {"phase", text}, {"from", text}, {"map", text}};

// ---- viewers

inline constexpr ArgumentSpec kShapes[]{kOnly, kSkip, kMask, kMoving};
inline constexpr ArgumentSpec kSurface[]{
    {"surface", whole, "its number, as a Run has it"},
    {"epoch", whole, "of that Run"},
    {"edges", truth, "with them"},
    {"crease_cosine", number, "-1 to 1; an edge is a crease beyond this cosine of the angle between its normals", 0.5}};
inline constexpr ArgumentSpec kMore[]{{"transfer", whole, "its number"},
                                      {"first", whole, "byte", 0, kMaxGeometryBytes}};

}  // namespace arguments

/// The kind of state that a command changes, under which the inventory keeps it over a restart. A command that changes
/// something also takes `durable` (true: it is refused if it would not outlive the server).
enum class Changes : std::uint8_t {
  nothing,
  scenes,
  objects,
  attachments,
  probes,
  fences,
  rules,
  shard_map,
  losses  // accepts the losses of a crash
};

/// The objects that a client's keys must permit, if the command does more than read.
enum class KeyedObjects : std::uint8_t {
  all,
  named,  // the object in the argument `name`
  each    // each object that the command affects, checked by its handler; an uploaded file has no effect until it is
          // loaded
};

/// Arguments that replace a command's usual ones if the argument `given` is present and not false.
struct CommandForm {
  const char* given;
  std::span<const ArgumentSpec> arguments;
};

struct CommandSpec {
  const char* name;
  QueryRight right;
  Changes changes = Changes::nothing;
  KeyedObjects objects = KeyedObjects::all;
  std::span<const ArgumentSpec> arguments = {};
  std::span<const CommandForm> forms = {};
  bool answers_bytes = false;  // the answer may be FlatBuffers or a piece of a file, not JSON
  bool is_of_fleet = false;    // missing in a server built without the fleet

  constexpr bool changes_world() const { return changes != Changes::nothing; }
  /// True if a replay needs the command to reproduce the world.
  constexpr bool is_recorded_change() const {
    return changes_world() && changes != Changes::shard_map && changes != Changes::losses;
  }
};

namespace table {

using enum QueryRight;
using enum Changes;
using enum KeyedObjects;

inline constexpr CommandForm kFenceForms[]{{"remove", arguments::kRemovedFences},
                                           {"many", arguments::kManyFences},
                                           {"bands", arguments::kMargin},
                                           {"within", arguments::kNearest}};
inline constexpr CommandForm kExplainForms[]{
    {"standing", arguments::kExplainStanding}, {"ray", arguments::kExplainRay}, {"event", arguments::kExplainEvent}};

inline constexpr CommandSpec kCommands[]{
    {kLoad, change, scenes, each, arguments::kLoad},
    {kClear, change, scenes, each, arguments::kClear},
    {kAdd, change, objects, named, arguments::kAdd},
    {kMove, change, objects, named, arguments::kMove},
    {kRemove, change, objects, each, arguments::kRemove},
    {kList, ask, nothing, all, arguments::kList},
    {kGet, ask, nothing, all, arguments::kGet},
    {kPlan, ask, nothing, all},
    {kAudit, ask, nothing, all},
    {kMenu, ask, nothing, all, arguments::kMenu},
    {kPair, ask, nothing, all, arguments::kPair},
    {kExplain, ask, nothing, all, arguments::kExplainPair, kExplainForms},
    {kProbe, change, probes, each, arguments::kProbe},
    {kProbes, ask, nothing, all, arguments::kProbes},
    {kFigures, ask, nothing, all},
    {kSteps, ask, nothing, all, arguments::kSteps},
    {kShapes, ask, nothing, all, arguments::kShapes, {}, true},
    {kSurface, ask, nothing, all, arguments::kSurface, {}, true},
    {kSnapshot, ask, nothing, all, {}, {}, true},
    {kMore, ask, nothing, all, arguments::kMore, {}, true},
    {kPoses, ask, nothing, all, {}, {}, true},
    {kRecording, change, nothing, all, arguments::kRecording, {}, true},
    {kCovers, ask, nothing, all},
    {kUpload, upload, nothing, each, arguments::kUpload},
    {kPiece, upload, nothing, each, arguments::kPiece},
    {kAcceptLoss, change, losses, all, arguments::kAcceptLoss},
    {kClearance, ask, nothing, all, arguments::kClearance},
    {kLeftOut, greet, nothing, all, arguments::kLeftOut},
    {kFence, change, fences, each, arguments::kFence, kFenceForms},
    {kFences, ask, nothing, all, arguments::kFences},
    {kAllow, change, rules, all, arguments::kAllow},
    {kDeny, change, rules, all, arguments::kDeny},
    {kAllowed, ask, nothing, all},
    {kAttach, change, attachments, each, arguments::kAttach},
    {kDetach, change, attachments, each, arguments::kDetach},
    {kSampled, change, nothing, all, arguments::kSampled},
    {kHandOver, change, nothing, all, arguments::kHandOver, {}, false, true},
    {kWatching, ask, nothing, all, arguments::kWatching, {}, false, true},
    {kShard, ask, nothing, all, {}, {}, false, true},
    {kSuccession, change, shard_map, all, arguments::kSuccession, {}, false, true},
};

/// The specification of a standing question within the bytes of `many`.
inline constexpr CommandSpec kPackedFence{
    kFence, change, fences, each, arguments::kFence, std::span(kFenceForms).last<2>()};

}  // namespace table

using table::kCommands;
using table::kPackedFence;

/// The specification of a command; null: unknown name.
constexpr const CommandSpec* find_command(std::string_view name) {
  for (const CommandSpec& spec : kCommands)
    if (name == spec.name) return &spec;
  return nullptr;
}

/// The right that a command needs. A publisher asks left_out about its own objects only, so the right to greet suffices
/// for it.
///
/// has_upload  its arguments name an upload
constexpr QueryRight right_for(std::string_view name, bool has_upload) {
  if (name == kLoad && has_upload) return QueryRight::upload;
  const CommandSpec* const spec = find_command(name);
  return spec != nullptr ? spec->right : QueryRight::ask;
}

}  // namespace collided::wire_contract::command
