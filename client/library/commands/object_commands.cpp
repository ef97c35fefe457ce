#include <limits>

#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/errors.hpp"
#include "collided/client.hpp"
#include "idl/answers/commands.hpp"
#include "idl/commands.hpp"

// The typed commands, which all use Client::command.
namespace collided {
namespace {

namespace names = wire_contract::command;
using client::read_answer;
using nlohmann::json;
using std::chrono::nanoseconds;

/// The arguments as text. Error if a name is not UTF-8: with replaced bytes it could be another name.
Result<std::string> text_of(const char* command, const json& arguments) {
  try {
    return arguments.dump();
  } catch (const json::type_error&) {
    return client::bad_input(std::string(command) + ": a name or path is not UTF-8 text");
  }
}

Result<std::string> answer_text(Client& client, const char* name, const json& arguments, nanoseconds timeout,
                                const Shape& shape = {}, std::function<void(double)> progress = {}) {
  const Result<std::string> text = text_of(name, arguments);
  return text ? client.command(name, *text, shape, timeout, std::move(progress)) : text;
}

Result<RuleChanged> rule_changed(const Result<std::string>& text, const char* command, const char* contacts) {
  return read_answer(text, command, [contacts](const json& answer) {
    auto changed = from_json<RuleChanged>(answer);
    changed.contacts = answer.at(contacts);
    return changed;
  });
}

ObjectDetails details_of(const json& answer) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  auto object = from_json<ObjectDetails>(answer);
  if (answer.at("bounds").is_null()) return object;
  for (std::size_t corner = 0; corner < 2; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      const json& number = answer["bounds"].at(corner).at(static_cast<std::size_t>(axis));
      object.bounds[corner][axis] = number.is_null() ? (corner == 0 ? -kInfinity : kInfinity) : number.get<double>();
    }
  }
  return object;
}

}  // namespace

Result<Added> Client::add(const ObjectOptions& object, nanoseconds timeout) {
  // Without one the server would not receive a shape.
  if (object.shape.empty()) return client::bad_input("add: object '" + object.name + "': its shape has no part");
  json arguments{{"name", object.name},    {"pose", json_of(object.pose)}, {"layers", object.layers},
                 {"mask", object.mask},    {"group", object.group},        {"scale", json_of(object.scale)},
                 {"moving", object.moving}};
  if (object.solid) arguments["solid"] = true;
  if (object.solid_by_winding) arguments["solid_by"] = "winding";
  return read_answer<Added>(answer_text(*this, names::kAdd, arguments, timeout, object.shape), names::kAdd);
}

Result<Moved> Client::move(const std::string& name, const Pose& pose, bool teleport, nanoseconds timeout) {
  const json arguments{{"name", name}, {"pose", json_of(pose)}, {"teleport", teleport}};
  return read_answer<Moved>(answer_text(*this, names::kMove, arguments, timeout), names::kMove);
}

Result<Removed> Client::remove(const std::string& name, nanoseconds timeout) {
  return read_answer<Removed>(answer_text(*this, names::kRemove, {{"name", name}}, timeout), names::kRemove);
}

Result<RuleChanged> Client::allow(const std::string& a, const std::string& b, const std::string& because,
                                  nanoseconds timeout) {
  const json arguments{{"a", a}, {"b", b}, {"because", because}};
  return rule_changed(answer_text(*this, names::kAllow, arguments, timeout), names::kAllow, "ended");
}

Result<RuleChanged> Client::deny(const std::string& a, const std::string& b, nanoseconds timeout) {
  return rule_changed(answer_text(*this, names::kDeny, {{"a", a}, {"b", b}}, timeout), names::kDeny, "began");
}

Result<std::vector<ListedRule>> Client::rules(nanoseconds timeout) {
  return read_answer(command(names::kAllowed, "{}", {}, timeout), "rules",
                     [](const json& answer) { return from_json<std::vector<ListedRule>>(answer.at("rules")); });
}

Result<Attached> Client::attach(const std::string& child, const std::string& parent, nanoseconds timeout) {
  const json arguments{{"child", child}, {"parent", parent}};
  return read_answer<Attached>(answer_text(*this, names::kAttach, arguments, timeout), names::kAttach);
}

Result<Attached> Client::detach(const std::string& child, nanoseconds timeout) {
  return read_answer<Attached>(answer_text(*this, names::kDetach, {{"child", child}}, timeout), names::kDetach);
}

Result<Loaded> Client::load(const std::string& path, const LoadOptions& options, std::function<void(double)> progress) {
  json arguments = json_of(options);
  arguments["path"] = path;
  return read_answer<Loaded>(answer_text(*this, names::kLoad, arguments, options.timeout, {}, std::move(progress)),
                             names::kLoad);
}

Result<Loaded> Client::load(std::span<const std::byte> bytes, std::string_view file_name, const LoadOptions& options,
                            std::function<void(double)> progress) {
  const Result<std::string> text = text_of(names::kLoad, json_of(options));
  if (!text) return text.error();
  return read_answer<Loaded>(upload(bytes, file_name, *text, options.timeout, std::move(progress)), names::kLoad);
}

Result<Cleared> Client::clear(const ClearOptions& options, nanoseconds timeout) {
  const json arguments{{"scene", options.scene}, {"moving", options.moving}};
  return read_answer<Cleared>(answer_text(*this, names::kClear, arguments, timeout), names::kClear);
}

Result<ObjectList> Client::list(const ListOptions& options, nanoseconds timeout) {
  json arguments{{"name", options.name}, {"limit", options.limit}};
  if (options.moving) arguments["moving"] = *options.moving;
  return read_answer<ObjectList>(answer_text(*this, names::kList, arguments, timeout), names::kList);
}

Result<ObjectDetails> Client::get(const std::string& name, nanoseconds timeout) {
  return read_answer(answer_text(*this, names::kGet, {{"name", name}}, timeout), names::kGet, details_of);
}

Result<Plan> Client::plan(nanoseconds timeout) {
  return read_answer<Plan>(command(names::kPlan, "{}", {}, timeout), names::kPlan);
}

}  // namespace collided
