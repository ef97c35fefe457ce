#include "server/service/commands/commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "idl/commands.hpp"
#include "server/intake/mesh/shape_scale.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/service/questions/nearest_word.hpp"
#include "server/service/commands/object_description.hpp"
#include "server/service/questions/validation.hpp"
#include "server/service/runtime/named_thread.hpp"
#include "server/world/query/plan.hpp"
#include "server/world/query/query.hpp"
#include "server/world/solids/declared.hpp"

namespace collided::engine::service {

using nlohmann::json;
using wire_contract::ReplyStatus;
namespace names = wire_contract::command;

namespace {

std::string dump(const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); }

}  // namespace

Commands::Commands(const Collaborators& with, const std::string& uploads)
    : with_(with),
      slow_jobs_(kMostSlowJobs),
      pair_jobs_(kMostPairJobs),
      costly_jobs_(kMostPairJobs),
      geometry_(with.loop.world(), [this](const CommandAsk& ask, ReplyStatus status,
                                          std::string text) { send(ask, status, std::move(text)); }),
      uploads_(
          uploads, with.durable != nullptr ? with.durable->commands_left() : std::vector<CommandAsk>(),
          [this](const CommandAsk& ask, ReplyStatus status, std::string text) { send(ask, status, std::move(text)); },
          [this](CommandAsk ask, const std::string& path, std::uint32_t checksum) {
            load_upload(std::move(ask), path, checksum);
          }) {
  const auto work = [](const char* name, auto& jobs) {
    return named_thread(name, [&jobs] {
      while (std::optional<SlowJob> job = jobs.pop()) (*job)();
    });
  };
  slow_thread_ = work("loads", slow_jobs_);
  pair_thread_ = work("pairs", pair_jobs_);
  costly_thread_ = work("costly pairs", costly_jobs_);
}

Commands::~Commands() { stop(); }

void Commands::stop() {
  stopping_.store(true);
  // Waits for the calls of run() that passed the check before; later ones see stopping_ and refuse.
  { const std::unique_lock alone(gate_); }
  geometry_.stop();
  uploads_.stop();
  end_awaited();
  slow_jobs_.close();
  if (slow_thread_.joinable()) slow_thread_.join();
  pair_jobs_.close();
  if (pair_thread_.joinable()) pair_thread_.join();
  // Closed only now: the thread for pairs may have passed one on until it ended.
  costly_jobs_.close();
  if (costly_thread_.joinable()) costly_thread_.join();
  forget_recordings();
}

/// Sends the result of the work, or the refusal that it threw.
void Commands::answer(const CommandAsk& ask, const std::function<json()>& work) {
  answer_text(ask, [&] { return dump(work()); });
}

void Commands::answer_text(const CommandAsk& ask, const std::function<std::string()>& work) {
  const auto refuse = [&](const std::string& error, const std::string& hint) {
    send(ask, ReplyStatus::refused, refusal_text(error, hint));
  };
  try {
    send(ask, ReplyStatus::ok, work());
  } catch (const BadCommand& bad) { refuse(bad.what(), bad.hint); } catch (const std::bad_alloc&) {
    // On the world's thread half of a change may be in the world by now: the caller ends the process.
    if (with_.loop.runs_here()) throw;
    refuse("not enough memory", "");
  } catch (const std::exception& failed) { refuse(failed.what(), ""); }
}

/// Sends an answer to the client. A command that is carried out again has none: its refusal is a loss, and reported in
/// the log.
void Commands::send(const CommandAsk& ask, ReplyStatus status, std::string text) {
  if (ask.client != 0) return answering_->send_text(ask.client, ask.request, status, std::move(text));
  if (ask.request == 0) return answer_followed(status, text);
  if (status != ReplyStatus::refused) return;
  const json refusal = json::parse(text, nullptr, false);
  if (with_.durable != nullptr && refusal.is_object())
    with_.durable->not_restored(ask.request, refusal.value("error", text));
  with_.loop.say("what was added before the crash cannot be added again: " + text);
}

/// What the keys of whoever sent the command do not allow, or no replica does; empty where it is allowed.
std::string Commands::why_not_allowed(const CommandAsk& ask, const Arguments& arguments) const {
  constexpr std::array kWhat{"greet", "ask", "change the world", "send files"};
  const std::string& command = arguments.command();
  const wire_contract::QueryRight right = names::right_for(command, arguments.has("upload"));
  if (!ask.from.has(right))
    return fmt::format("the keys give no right to {}. Nothing was done", kWhat[static_cast<std::size_t>(right)]);
  if (with_.is_replica && ask.client != 0 && right != wire_contract::QueryRight::ask)
    return "this is a replica: what changes the world goes to its primary. Nothing was done";
  const bool only_looks = right == wire_contract::QueryRight::ask || right == wire_contract::QueryRight::greet;
  if (!ask.from.peer || ask.from.peer->objects.empty() || only_looks) return {};
  // What comes or goes by these is known later; they look at each object. A file does nothing until it is loaded.
  for (const char* later : {names::kRemove, names::kProbe, names::kLoad, names::kClear, names::kUpload, names::kPiece,
                            names::kFence, names::kAttach, names::kDetach}) {
    if (command == later) return {};
  }
  const bool is_one_object = command == names::kAdd || command == names::kMove;
  if (is_one_object && ask.from.peer->may_name(arguments.text("name"))) return {};
  return fmt::format("the keys of '{}' are for {}. Nothing was done", ask.from.peer->name,
                     fmt::join(ask.from.peer->objects, ", "));
}

/// The commands of the world's thread; null: it is none.
Commands::Change Commands::change_of(std::string_view command) {
  static const std::vector<std::pair<std::string, Change>> kChanges{
      {names::kGet, &Commands::get},
      {names::kAdd, &Commands::add},
      {names::kMove, &Commands::move},
      {names::kRemove, &Commands::remove},
      {names::kClear, &Commands::clear},
      {names::kProbe, &Commands::probe},
      {names::kProbes, &Commands::probes},
      {names::kAcceptLoss, &Commands::accept_loss},
      {names::kLeftOut, &Commands::left_out},
      {names::kFence, &Commands::fence},
      {names::kFences, &Commands::fences},
      {names::kAllow, &Commands::allow},
      {names::kDeny, &Commands::deny},
      {names::kAttach, &Commands::attach},
      {names::kDetach, &Commands::detach},
      {names::kSettled, &Commands::settled},
      {names::kSuccession, &Commands::succession},
  };
  const auto found = std::ranges::find(kChanges, command, &std::pair<std::string, Change>::first);
  return found == kChanges.end() ? nullptr : found->second;
}

void Commands::run(CommandAsk ask) {
  // Held until the command is handed on, so that stop() does not end a thread under it.
  const std::shared_lock on_its_way(gate_);
  if (stopping_.load())
    return send(ask, ReplyStatus::refused, refusal_text("the server is stopping. Nothing was done"));
  std::optional<Arguments> arguments;
  try {
    arguments.emplace(ask.text);
  } catch (const BadCommand& bad) {
    send(ask, ReplyStatus::refused, refusal_text(bad.what()));
    return;
  }
  const std::string& command = arguments->command();
  if (const std::string reason = why_not_allowed(ask, *arguments); !reason.empty())
    return send(ask, ReplyStatus::refused, refusal_text(reason));
  if (const Change change = change_of(command)) return on_world_thread(std::move(ask), change, arguments->is_durable());
  if (command == names::kList) return answer(ask, [&] { return list(*arguments); });
  if (command == names::kPlan) return answer(ask, [&] { return plan(*arguments); });
  if (command == names::kCovers) return answer(ask, [&] { return covers(*arguments); });
  if (command == names::kShard) return answer(ask, [&] { return shard(*arguments); });
  if (command == names::kAllowed) return answer(ask, [&] { return allowed(*arguments); });
  if (command == names::kAudit) return answer(ask, [&] { return audit(*arguments); });
  if (command == names::kFigures) return answer(ask, [&] { return figures(*arguments); });
  if (command == names::kSteps) return answer(ask, [&] { return steps(*arguments); });
  if (command == names::kHandOver) {
    return answer(ask, [&]() -> json {
      arguments->allow_only({"to"});
      return {{"to", with_.hand_over(arguments->text("to"))}};
    });
  }
  if (command == names::kSampled) return answer(ask, [&] { return sampled(ask, *arguments); });
  if (command == names::kUpload || command == names::kPiece || (command == names::kLoad && arguments->has("upload"))) {
    return uploads_.take(std::move(ask));
  }
  if (command == names::kLoad) return load_later(std::move(ask), *arguments);
  if (command == names::kMenu) return menu_later(std::move(ask), *arguments);
  if (command == names::kPair) return pair_later(std::move(ask), *arguments);
  if (command == names::kExplain) return explain_later(std::move(ask), *arguments);
  if (command == names::kClearance) return clearance_later(std::move(ask), *arguments);
  if (command == names::kRecording) return recording_later(std::move(ask), *arguments);
  if (command == names::kPoses) {
    return answer_text(ask, [&] {
      arguments->allow_only({});
      return encode_poses(*with_.loop.world().newest());
    });
  }
  if (command == names::kShapes || command == names::kSurface || command == names::kMore)
    return geometry_.take(std::move(ask));
  answer(ask, [&]() -> json {
    const std::vector<std::string> known{
        names::kLoad,       names::kClear,     names::kAdd,       names::kMove,   names::kRemove,  names::kList,
        names::kGet,        names::kPlan,      names::kAudit,     names::kMenu,   names::kPair,    names::kExplain,
        names::kProbe,      names::kProbes,    names::kFigures,   names::kSteps,  names::kShapes,  names::kSurface,
        names::kMore,       names::kPoses,     names::kRecording, names::kCovers, names::kUpload,  names::kPiece,
        names::kAcceptLoss, names::kClearance, names::kLeftOut,   names::kFence,  names::kFences,  names::kAllow,
        names::kDeny,       names::kAllowed,   names::kAttach,    names::kDetach, names::kSampled, names::kHandOver,
        names::kSettled,    names::kShard,     names::kSuccession};
    throw BadCommand(fmt::format("unknown command {}{}", printable(command), did_you_mean(command, known)));
  });
}

/// Has the world's thread carry out a command. A change is answered once it is on the disk; one that looks is answered
/// at once.
void Commands::on_world_thread(CommandAsk ask, Change change, bool is_durable) {
  const auto shared = std::make_shared<CommandAsk>(std::move(ask));
  const bool is_change = change != &Commands::get && change != &Commands::probes && change != &Commands::left_out &&
                         change != &Commands::fences && change != &Commands::settled;
  once_there_is_room(*shared, is_durable && is_change, [this, shared, change, is_change, is_durable] {
    const bool taken = with_.inbox.push_job([this, shared, change, is_change, is_durable] {
      const auto work = [&] { return (this->*change)(*shared, Arguments(shared->text)); };
      is_change ? answer_once_kept(*shared, work, is_durable) : answer(*shared, work);
    });
    if (!taken) { send(*shared, ReplyStatus::refused, refusal_text("too many commands wait already", "ask again")); }
  });
}

// ---- commands that look

json Commands::list(const Arguments& arguments) const {
  arguments.allow_only({"name", "moving", "limit", "bounds"});
  const bool has_bounds = arguments.truth("bounds", false);
  const std::string glob = arguments.text("name");
  const std::optional<bool> moving =
      arguments.has("moving") ? std::optional(arguments.truth("moving", false)) : std::nullopt;
  const std::uint64_t limit = arguments.whole("limit", 10'000, 1'000'000);
  const SnapshotRing::Lease state = with_.loop.world().newest();
  json objects = json::array();
  std::uint64_t count = 0;
  for (const auto& info : state->objects) {
    if (!info || (moving && info->moving != *moving)) continue;
    if (!glob.empty() && !glob_matches(glob, info->name)) continue;
    if (count++ >= limit) continue;
    objects.push_back(describe_briefly(*state, *info, with_.loop.publisher_name(info->publisher)));
    if (has_bounds) objects.back()["bounds"] = bounds_of(*state, *info);
  }
  return {{"objects", objects}, {"count", count}, {"version", state->version}};
}

/// Which structures the server builds for this world, and which it leaves out and why.
json Commands::plan(const Arguments& arguments) const {
  arguments.allow_only({});
  const SnapshotRing::Lease state = with_.loop.world().newest();
  json structures = json::array();
  std::vector<PlanRow> rows = plan_of(*state, with_.loop.contacts_wanted());
  rows.push_back(plan_of_probes(with_.loop.probe_count(), with_.loop.probes_wanted()));
  if (const std::uint64_t cut_short = with_.loop.sums().fences_cut_short.get(); cut_short > 0)
    rows.push_back(plan_of_cut_searches(cut_short));
  if (with_.durable == nullptr) {
    rows.push_back({.structure = "journal",
                    .built = false,
                    .reason = "no folder to keep it in, so what commands do is lost with a crash",
                    .saves = ""});
  }
  for (const PlanRow& row : rows) {
    structures.push_back(
        {{"structure", row.structure}, {"built", row.built}, {"why", row.reason}, {"saves", row.saves}});
  }
  json pairs = json::array();
  for (const PairRow& row : pair_table()) pairs.push_back({{"a", row.a}, {"b", row.b}, {"how", row.how}});
  std::uint64_t bytes = 0;
  json scenes = json::array();
  for (const auto& scene : state->scenes) {
    bytes += scene->bytes();
    scenes.push_back({{"scene", scene->name}, {"load", json::parse(scene->source, nullptr, false)}});
    if (scene->tiles) scenes.back()["tiles"] = tiles_json(*scene->tiles);
    // An uploaded file is the server's own copy, which goes with the scene.
    if (scenes.back()["load"].is_discarded() || scenes.back()["load"].contains("foreign"))
      scenes.back()["load"] = nullptr;
  }
  return {{"structures", structures}, {"pairs", pairs}, {"scenes", scenes}, {"bytes", bytes}};
}

json Commands::covers_json(const std::vector<Aabb>& boxes) {
  json list = json::array();
  const auto number = [](double x) { return std::isinf(x) ? json(x > 0 ? "inf" : "-inf") : json(x); };
  for (const Aabb& box : boxes) {
    json corners = json::array();
    for (const Vec3* corner : {&box.low, &box.high}) {
      for (const double x : *corner) corners.push_back(number(x));
    }
    list.push_back(std::move(corners));
  }
  return list;
}

json Commands::covers(const Arguments& arguments) const {
  arguments.allow_only({});
  const SnapshotRing::Lease state = with_.loop.world().newest();
  return {{"covers", state->covers ? covers_json(*state->covers) : json(nullptr)}, {"version", state->version}};
}

json Commands::get(const CommandAsk&, const Arguments& arguments) {
  arguments.allow_only({"name"});
  const ObjectInfo& info = *with_.loop.world().info(find_object(arguments.text("name")));
  const SnapshotRing::Lease state = with_.loop.world().newest();
  json object = describe_briefly(*state, info, with_.loop.publisher_name(info.publisher));
  describe_fully(*state, info, with_.clock.now_ns(), object);
  if (const auto velocity = with_.loop.publishers().velocity(info.id)) object["velocity"] = *velocity;
  json contacts = json::array();
  json in_doubt = json::array();
  for (const OpenContact& contact : with_.loop.world().contacts()) {
    if (contact.a != info.id && contact.b != info.id) continue;
    const ObjectInfo* other = with_.loop.world().info(contact.a == info.id ? contact.b : contact.a);
    if (other) (contact.doubt == Doubt::none ? contacts : in_doubt).push_back(other->name);
  }
  object["contacts"] = contacts;
  if (!in_doubt.empty()) object["in_doubt"] = in_doubt;
  json waiting = json::array();
  for (const std::uint64_t publisher : with_.loop.publishers().waiting_for(info.name))
    waiting.push_back(with_.loop.publisher_name(publisher));
  if (!waiting.empty()) object["name_wanted_by"] = waiting;
  object["version"] = state->version;
  return object;
}

/// Objects that a publisher has sent and the world lacks.
json Commands::left_out(const CommandAsk&, const Arguments& arguments) {
  constexpr std::size_t kMost = 20;
  arguments.allow_only({"publisher"});
  const std::uint64_t publisher = arguments.whole("publisher", 0, std::numeric_limits<std::uint64_t>::max());
  json objects = json::array();
  for (const Publishers::LeftOut& object : with_.loop.publishers().left_out(publisher, kMost))
    objects.push_back({{"name", object.name}, {"why", object.why}});
  json answer{{"objects", objects},
              {"count", with_.loop.publishers().left_out_count(publisher)},
              {"merged", with_.loop.publishers().merged_poses(publisher)},
              {"version", with_.loop.world().newest()->version}};
  if (std::string why = with_.why_refused ? with_.why_refused(publisher) : std::string(); !why.empty())
    answer["refused"] = std::move(why);
  return answer;
}

json Commands::settled(const CommandAsk& ask, const Arguments& arguments) {
  arguments.allow_only({"watch", "map"});
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
  if (with_.shard != nullptr && arguments.has("watch"))
    shard_watchers_.heard(ask.client, arguments.whole("watch", 0, kMost), arguments.text("map"), steady_ns());
  const SnapshotRing::Lease newest = with_.loop.world().newest();
  json answer{{"settled_ns", with_.loop.settled_ns()},
              {"event_sequence", with_.loop.world().last_event_sequence()},
              {"epoch", newest->epoch}};
  if (const std::uint64_t predecessor = with_.predecessor ? with_.predecessor() : 0; predecessor != 0) {
    answer["heir_of"] = predecessor;
    answer["told_from"] = with_.loop.told_from();
  }
  return answer;
}

// ---- commands that change the world

/// The object of that name, of which the newest snapshot is then sure to have a row.
ObjectId Commands::find_object(const std::string& name) const {
  if (const std::optional<ObjectId> id = with_.loop.world().find(name)) {
    // Defined since the last step: a step puts it into the snapshot.
    const SnapshotRing::Lease state = with_.loop.world().newest();
    if (state->objects.find(*id) == nullptr) with_.loop.step_now();
    return *id;
  }
  std::vector<std::string_view> others;
  for (const auto& info : with_.loop.world().objects()) {
    if (info) others.push_back(info->name);
  }
  throw BadCommand(unknown_object(name, others));
}

void Commands::refuse_if_live(const ObjectInfo& info) const {
  if (info.publisher == 0 || !with_.loop.publishers().is_live(info.publisher)) return;
  throw BadCommand(fmt::format("object {} belongs to publisher {}, which lives", printable(info.name),
                               printable(with_.loop.publisher_name(info.publisher))),
                   "its publisher moves and removes it");
}

/// Makes the change visible by a step; returns the new version.
std::uint64_t Commands::step() {
  with_.loop.note_change();
  with_.loop.step_now();
  return with_.loop.world().newest()->version;
}

std::uint32_t Commands::ended_count() const {
  const auto& events = with_.loop.world().events();
  return static_cast<std::uint32_t>(
      std::count_if(events.begin(), events.end(), [](const Event& event) { return event.kind == EventKind::ended; }));
}

namespace {

/// Makes the object's mesh solid; returns what makes it more than a border. Throws BadCommand where it bounds no solid.
/// Primitives are solid without it.
std::string declare_solid(ObjectDefinition& definition, SolidBy by) {
  if (!definition.shape.mesh) return {};
  DeclaredMesh declared = declare_solid_at_once(definition.shape.mesh, by);
  if (!declared.solid && !declared.winding)
    throw BadCommand(
        fmt::format("add: {} is not solid: {}. Nothing was added", printable(definition.name), declared.refusal),
        "without --solid it is a surface; --solid=winding decides by winding number; collide check FILE says more");
  definition.indexed = std::move(declared.indexed);
  definition.solid = std::move(declared.solid);
  definition.winding = std::move(declared.winding);
  return declared.warning;
}

}  // namespace

json Commands::add(const CommandAsk& ask, const Arguments& arguments) {
  arguments.allow_only({"name", "pose", "layers", "mask", "group", "moving", "scale", "durable", "solid", "solid_by"});
  constexpr std::uint64_t kBits = 0xffffffff;
  const Filter filter{.layers = static_cast<std::uint32_t>(arguments.whole("layers", 1, kBits)),
                      .mask = static_cast<std::uint32_t>(arguments.whole("mask", kBits, kBits)),
                      .group = static_cast<std::uint32_t>(arguments.whole("group", 0, kBits))};
  const std::string name = arguments.text("name");
  if (!is_good_name(name))
    throw BadCommand(fmt::format("add: the name {} is empty, longer than 255 bytes or not text", printable(name)));
  DecodedShape decoded = decode_shape(ask.blob);
  if (!decoded.shape) throw BadCommand("add: " + decoded.refusal);
  if (decoded.shape->empty()) throw BadCommand("add: the shape is empty");
  // Scaled here, on the way in: a shape in the world has no factors.
  if (const std::optional<Vec3> factor = arguments.vector("scale"); factor && *factor != Vec3::Ones()) {
    if (const std::string reason = scale(*decoded.shape, *factor); !reason.empty()) throw BadCommand("add: " + reason);
  }
  ObjectDefinition definition{.name = name,
                              .scene = {},
                              .shape = std::move(*decoded.shape),
                              .pose = arguments.pose("pose").value_or(Pose{}),
                              .filter = filter,
                              .moving = arguments.truth("moving", true)};
  std::string warning;
  const SolidBy by = arguments.is_solid_by_winding() ? SolidBy::winding : SolidBy::closing;
  if (arguments.truth("solid", false)) warning = declare_solid(definition, by);
  const std::variant<ObjectId, Refusal> defined = with_.loop.world().define(definition);
  if (const auto* refusal = std::get_if<Refusal>(&defined)) throw BadCommand(refusal->reason);
  if (with_.durable != nullptr) with_.durable->object_added(name, ask);
  json answer{{"name", name}, {"id", std::get<ObjectId>(defined)}, {"version", step()}};
  if (!warning.empty()) answer["warning"] = warning;
  return answer;
}

json Commands::move(const CommandAsk& ask, const Arguments& arguments) {
  arguments.allow_only({"name", "pose", "teleport", "durable"});
  World& world = with_.loop.world();
  const std::string name = arguments.text("name");
  const std::optional<Pose> pose = arguments.pose("pose");
  if (!pose) throw BadCommand("move: without a pose", "a pose is [x, y, z, qw, qx, qy, qz]");
  const bool teleport = arguments.truth("teleport", false);
  const ObjectId id = find_object(name);
  refuse_if_live(*world.info(id));
  if (const AttachedObject* attached = world.attachments().find(id))
    throw BadCommand(
        fmt::format("object {} is attached to {}, which moves it", printable(name), printable(attached->parent_name)),
        "collide detach " + name);
  // A step examines one motion of an object only, so an earlier one is examined first.
  if (world.has_moved(id)) with_.loop.step_now();
  const Vec3 before = world.newest()->poses[slot_of(id)].position;
  if (!world.move(id, *pose, with_.clock.now_ns(), teleport)) {
    throw BadCommand(fmt::format("object {} is a part of scene {} and stays where it is", printable(name),
                                 printable(world.info(id)->rare->scene)));
  }
  const ObjectInfo& info = *world.info(id);
  if (with_.durable != nullptr && info.publisher == 0) {
    // When it is carried out again the object is placed, not moved: its motion was over before the crash.
    json again = json::parse(ask.text);
    again["teleport"] = true;
    with_.durable->object_moved(info.rare->scene, name, {0, 0, again.dump(), {}});
  }
  const std::uint64_t version = step();
  json began = json::array();
  json ended = json::array();
  for (const Event& event : world.events()) {
    if (event.of.a != id && event.of.b != id) continue;
    const ObjectInfo* other = world.info(event.of.a == id ? event.of.b : event.of.a);
    if (event.kind == EventKind::began) began.push_back(other ? other->name : std::string());
    if (event.kind == EventKind::ended) ended.push_back(other ? other->name : std::string());
  }
  return {{"name", name},
          {"moved_m", (pose->position - before).norm()},
          {"began", began},
          {"ended", ended},
          {"version", version}};
}

}  // namespace collided::engine::service
