#include <cmath>

#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/errors.hpp"
#include "collided/client.hpp"
#include "idl/commands.hpp"

// The typed commands, each by Client::command.
namespace collided {
namespace {

namespace names = wire_contract::command;
using client::read_answer;
using client::vector_of;
using nlohmann::json;
using std::chrono::nanoseconds;

/// The arguments as text. Nothing where a name is not UTF-8: with its bytes replaced it could be another name.
std::optional<std::string> text_of(const json& arguments) {
  try {
    return arguments.dump();
  } catch (const json::type_error&) { return std::nullopt; }
}
Error not_utf8(const char* command) {
  return client::bad_input(std::string(command) + ": a name or path is not UTF-8 text");
}
Result<std::string> sent(Client& client, const char* command, const json& arguments, nanoseconds timeout,
                         const Shape& shape = {}, std::function<void(double)> progress = {}) {
  const std::optional<std::string> text = text_of(arguments);
  if (!text) return not_utf8(command);
  return client.command(command, *text, shape, timeout, std::move(progress));
}

json list_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
json list_of(const Pose& pose) {
  const Quat& q = pose.rotation;
  return {pose.position.x(), pose.position.y(), pose.position.z(), q.w(), q.x(), q.y(), q.z()};
}
Pose pose_of(const json& numbers) {
  return {vector_of(numbers), Quat(numbers.at(3).get<double>(), numbers.at(4).get<double>(),
                                   numbers.at(5).get<double>(), numbers.at(6).get<double>())};
}

// JSON has no infinity, so it is a text.
json endless_number(double x) { return std::isinf(x) ? json(x > 0 ? "inf" : "-inf") : json(x); }
double endless_number_of(const json& number) {
  if (!number.is_string()) return number.get<double>();
  const double infinity = std::numeric_limits<double>::infinity();
  return number == "-inf" ? -infinity : infinity;
}
json list_of(const CoveredBox& box) {
  json corners = json::array();
  for (const Vec3* corner : {&box.low, &box.high}) {
    for (const double x : *corner) corners.push_back(endless_number(x));
  }
  return corners;
}
CoveredBox box_of(const json& corners) {
  CoveredBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = endless_number_of(corners.at(static_cast<std::size_t>(axis)));
    box.high[axis] = endless_number_of(corners.at(static_cast<std::size_t>(axis) + 3));
  }
  return box;
}

json arguments_of(const LoadOptions& options) {
  json arguments{{"name", options.name},         {"unit_m", options.unit_m}, {"up", options.up},
                 {"radius_m", options.radius_m}, {"strict", options.strict}, {"mend", options.mend},
                 {"crack_m", options.crack_m},   {"srdf", options.srdf},     {"replace", options.replace}};
  // A server that does not know the word refuses it, so it is said only where it is meant.
  if (!options.solid.empty()) arguments["solid"] = options.solid;
  if (options.solid_by_winding) arguments["solid_by"] = "winding";
  if (options.moving) arguments["moving"] = true;
  if (!options.packages.empty()) arguments["packages"] = options.packages;
  for (const CoveredBox& box : options.covers) arguments["covers"].push_back(list_of(box));
  return arguments;
}
Loaded loaded_of(const json& answer) {
  Loaded loaded{.scene = answer.at("scene"),
                .triangles = answer.at("triangles"),
                .parts = answer.at("parts"),
                .objects = answer.at("objects"),
                .seconds = answer.at("seconds"),
                .placed = answer.at("placed"),
                .notes = answer.at("notes"),
                .mended = answer.at("mended"),
                .refused = answer.at("refused"),
                .warnings = answer.at("warnings"),
                .left_out = answer.at("left_out"),
                .covers = {},
                .version = answer.at("version"),
                .not_kept = answer.value("not_kept", "")};
  for (const json& box : answer.at("covers")) loaded.covers.push_back(box_of(box));
  return loaded;
}

RuleChanged rule_changed(const json& answer, const char* contacts) {
  return {.rules = answer.at("rules"),
          .a_count = answer.at("a_count"),
          .b_count = answer.at("b_count"),
          .contacts = answer.at(contacts),
          .version = answer.at("version"),
          .not_kept = answer.value("not_kept", "")};
}
Attached attached_of(const json& answer) {
  return {.parent = answer.at("parent"), .version = answer.at("version"), .not_kept = answer.value("not_kept", "")};
}

void read_brief(const json& row, ListedObject& object) {
  object.name = row.at("name");
  object.id = row.at("id");
  object.kind = row.at("kind");
  object.moving = row.at("moving");
  object.scene = row.at("scene");
  object.publisher = row.at("publisher");
  if (!row.at("position").is_null()) object.position = vector_of(row.at("position"));
  object.triangles = row.at("triangles");
  object.layers = row.at("layers");
  object.stale = row.at("stale");
  object.attached_to = row.value("attached_to", "");
}
ObjectDetails details_of(const json& answer) {
  ObjectDetails object;
  read_brief(answer, object);
  object.mask = answer.at("mask");
  object.group = answer.at("group");
  if (answer.contains("pose")) object.pose = pose_of(answer.at("pose"));
  object.bounds = {vector_of(answer.at("bounds").at(0)), vector_of(answer.at("bounds").at(1))};
  if (answer.contains("age_ns")) object.age = nanoseconds(answer.at("age_ns").get<std::int64_t>());
  object.contacts = answer.at("contacts");
  object.solid = answer.value("solid", false);
  object.solid_by_winding = answer.value("solid_by", "") == "winding";
  return object;
}

}  // namespace

Result<Added> Client::add(const ObjectOptions& object, nanoseconds timeout) {
  // Without one the server would hear of no shape at all.
  if (object.shape.empty()) return client::bad_input("add: object '" + object.name + "': its shape has no part");
  json arguments{{"name", object.name},    {"pose", list_of(object.pose)}, {"layers", object.layers},
                 {"mask", object.mask},    {"group", object.group},        {"scale", list_of(object.scale)},
                 {"moving", object.moving}};
  if (object.solid) arguments["solid"] = true;
  if (object.solid_by_winding) arguments["solid_by"] = "winding";
  return read_answer(sent(*this, names::kAdd, arguments, timeout, object.shape), "add", [](const json& answer) {
    return Added{.id = answer.at("id"),
                 .version = answer.at("version"),
                 .not_kept = answer.value("not_kept", ""),
                 .warning = answer.value("warning", "")};
  });
}

Result<Moved> Client::move(const std::string& name, const Pose& pose, bool teleport, nanoseconds timeout) {
  return read_answer(
      sent(*this, names::kMove, {{"name", name}, {"pose", list_of(pose)}, {"teleport", teleport}}, timeout), "move",
      [](const json& answer) {
        return Moved{.distance_m = answer.at("moved_m"),
                     .began = answer.at("began"),
                     .ended = answer.at("ended"),
                     .version = answer.at("version"),
                     .not_kept = answer.value("not_kept", "")};
      });
}

Result<Removed> Client::remove(const std::string& name, nanoseconds timeout) {
  return read_answer(sent(*this, names::kRemove, {{"name", name}}, timeout), "remove", [](const json& answer) {
    return Removed{.names = answer.at("removed"),
                   .contacts_ended = answer.at("ended"),
                   .version = answer.at("version"),
                   .not_kept = answer.value("not_kept", "")};
  });
}

Result<RuleChanged> Client::allow(const std::string& a, const std::string& b, const std::string& because,
                                  nanoseconds timeout) {
  return read_answer(sent(*this, names::kAllow, {{"a", a}, {"b", b}, {"because", because}}, timeout), "allow",
                     [](const json& answer) { return rule_changed(answer, "ended"); });
}

Result<RuleChanged> Client::deny(const std::string& a, const std::string& b, nanoseconds timeout) {
  return read_answer(sent(*this, names::kDeny, {{"a", a}, {"b", b}}, timeout), "deny",
                     [](const json& answer) { return rule_changed(answer, "began"); });
}

Result<std::vector<ListedRule>> Client::rules(nanoseconds timeout) {
  return read_answer(command(names::kAllowed, "{}", {}, timeout), "rules", [](const json& answer) {
    std::vector<ListedRule> rules;
    for (const json& rule : answer.at("rules"))
      rules.push_back(
          {.a = rule.at("a"), .b = rule.at("b"), .because = rule.at("because"), .allows = rule.at("allows")});
    return rules;
  });
}

Result<Attached> Client::attach(const std::string& child, const std::string& parent, nanoseconds timeout) {
  return read_answer(sent(*this, names::kAttach, {{"child", child}, {"parent", parent}}, timeout), "attach",
                     attached_of);
}

Result<Attached> Client::detach(const std::string& child, nanoseconds timeout) {
  return read_answer(sent(*this, names::kDetach, {{"child", child}}, timeout), "detach", attached_of);
}

Result<Loaded> Client::load(const std::string& path, const LoadOptions& options, std::function<void(double)> progress) {
  json arguments = arguments_of(options);
  arguments["path"] = path;
  return read_answer(sent(*this, names::kLoad, arguments, options.timeout, {}, std::move(progress)), "load", loaded_of);
}

Result<Loaded> Client::load(std::span<const std::byte> bytes, std::string_view file_name, const LoadOptions& options,
                            std::function<void(double)> progress) {
  const std::optional<std::string> text = text_of(arguments_of(options));
  if (!text) return not_utf8("load");
  return read_answer(upload(bytes, file_name, *text, options.timeout, std::move(progress)), "load", loaded_of);
}

Result<Cleared> Client::clear(const ClearOptions& options, nanoseconds timeout) {
  return read_answer(sent(*this, names::kClear, {{"scene", options.scene}, {"moving", options.moving}}, timeout),
                     "clear", [](const json& answer) {
                       return Cleared{.removed = answer.at("removed"),
                                      .kept = answer.at("kept"),
                                      .contacts_ended = answer.at("ended"),
                                      .version = answer.at("version"),
                                      .not_kept = answer.value("not_kept", "")};
                     });
}

Result<ObjectList> Client::list(const ListOptions& options, nanoseconds timeout) {
  json arguments{{"name", options.name}, {"limit", options.limit}};
  if (options.moving) arguments["moving"] = *options.moving;
  const std::optional<std::string> text = text_of(arguments);
  if (!text) return not_utf8("list");
  return read_answer(command(names::kList, *text, {}, timeout), "list", [](const json& answer) {
    ObjectList list{.objects = {}, .count = answer.at("count"), .version = answer.at("version")};
    for (const json& row : answer.at("objects")) read_brief(row, list.objects.emplace_back());
    return list;
  });
}

Result<ObjectDetails> Client::get(const std::string& name, nanoseconds timeout) {
  const std::optional<std::string> text = text_of({{"name", name}});
  if (!text) return not_utf8("get");
  return read_answer(command(names::kGet, *text, {}, timeout), "get", details_of);
}

Result<Plan> Client::plan(nanoseconds timeout) {
  return read_answer(command(names::kPlan, "{}", {}, timeout), "plan", [](const json& answer) {
    Plan plan{.structures = {}, .pairs = {}, .bytes = answer.at("bytes")};
    for (const json& row : answer.at("structures")) {
      plan.structures.push_back({.structure = row.at("structure"),
                                 .built = row.at("built"),
                                 .reason = row.at("why"),
                                 .saves = row.at("saves")});
    }
    for (const json& row : answer.at("pairs"))
      plan.pairs.push_back({.a = row.at("a"), .b = row.at("b"), .how = row.at("how")});
    return plan;
  });
}

}  // namespace collided
