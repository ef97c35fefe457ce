#include "client/cli/server_command.hpp"

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/suggest.hpp"
#include "idl/commands.hpp"

namespace collided::cli {
namespace {

constexpr std::chrono::seconds kCommandTimeout{10};
constexpr std::chrono::minutes kLoadTimeout{10};
constexpr std::chrono::minutes kMenuTimeout{2};  // seven kinds of question, two seconds of exact comparison each
constexpr std::uint64_t kMostNamesCompared = 100'000;

nlohmann::json object_from(const std::string& text, std::string_view command) {
  nlohmann::json answer = nlohmann::json::parse(text, nullptr, false);
  if (!answer.is_object())
    throw Failure(Exit::refused, fmt::format("the server's answer to '{}' is not a JSON object", command));
  return answer;
}

/// Arguments as text. Throws Failure for a name that is not UTF-8: with its bytes replaced it could be another name.
std::string text_of_arguments(const nlohmann::json& arguments) {
  try {
    return arguments.dump();
  } catch (const nlohmann::json::type_error&) { throw bad_use("a name or path is not UTF-8 text"); }
}

std::chrono::nanoseconds command_timeout(const Globals& globals, std::string_view name) {
  if (name == wire_contract::command::kLoad) return timeout_of(globals, std::chrono::seconds(kLoadTimeout));
  if (name == wire_contract::command::kMenu) return timeout_of(globals, std::chrono::seconds(kMenuTimeout));
  return timeout_of(globals, kCommandTimeout);
}

}  // namespace

Failure unfit_answer(const nlohmann::json::exception& why) {
  return Failure(Exit::refused, fmt::format("the server's answer does not fit: {}", why.what()),
                 "server and collide may be of different versions");
}

nlohmann::json server_command(Session& session, const Globals& globals, std::string_view name,
                              const nlohmann::json& arguments, const Shape& shape,
                              std::function<void(double)> progress) {
  const std::chrono::nanoseconds timeout = command_timeout(globals, name);
  const std::string text =
      take(session.client(globals).command(name, text_of_arguments(arguments), shape, timeout, std::move(progress)));
  return object_from(text, name);
}

nlohmann::json server_command_with_bytes(Session& session, const Globals& globals, std::string_view name,
                                         const nlohmann::json& arguments, std::span<const std::byte> bytes) {
  const std::chrono::nanoseconds timeout = command_timeout(globals, name);
  return object_from(
      take(session.client(globals).command_with_bytes(name, text_of_arguments(arguments), bytes, timeout)), name);
}

nlohmann::json upload_command(Session& session, const Globals& globals, std::span<const std::byte> bytes,
                              const std::string& file_name, const nlohmann::json& arguments,
                              std::function<void(double)> progress) {
  const std::chrono::nanoseconds timeout = timeout_of(globals, std::chrono::seconds(kLoadTimeout));
  return object_from(take(session.client(globals).upload(bytes, file_name, text_of_arguments(arguments), timeout,
                                                         std::move(progress))),
                     "load");
}

std::optional<Failure> unknown_object(Session& session, const Globals& globals, const std::string& object) {
  namespace wire = wire_contract::command;
  const nlohmann::json all =
      server_command(session, globals, wire::kList, {{"name", ""}, {"limit", kMostNamesCompared}});
  std::vector<std::string> names;
  std::vector<std::string> below;  // if the name is that of a scene, or of a group in one
  for (const nlohmann::json& entry : all.value("objects", nlohmann::json::array())) {
    names.push_back(text_of(entry, "name"));
    if (names.back() == object) return std::nullopt;
    if (names.back().starts_with(object + "/")) below.push_back(names.back());
  }
  if (!below.empty()) {
    constexpr std::size_t kMostNamed = 3;
    std::string members;
    for (std::size_t at = 0; at < std::min(kMostNamed, below.size()); ++at)
      members += (at == 0 ? ": " : ", ") + below[at];
    return Failure(Exit::refused,
                   fmt::format("'{}' is not one object but {}{}{}", object, counted(below.size(), "object"), members,
                               below.size() > kMostNamed ? ", ..." : ""),
                   fmt::format("collide ls '{}/*' lists them", object));
  }
  std::string message =
      fmt::format("object '{}' is not in the world ({})", object, counted(count_of(all, "count"), "object"));
  const std::vector<std::string> nearest = nearest_names(object, names, 3);
  for (std::size_t at = 0; at < nearest.size(); ++at) message += (at == 0 ? "; nearest names: " : ", ") + nearest[at];
  return Failure(Exit::refused, message);
}

nlohmann::json object_command(Session& session, const Globals& globals, std::string_view command,
                              const std::string& object, const nlohmann::json& arguments) {
  try {
    return server_command(session, globals, command, arguments);
  } catch (const Failure& failure) {
    if (failure.code != Exit::refused) throw;
    if (const std::optional<Failure> unknown = unknown_object(session, globals, object)) throw Failure(*unknown);
    throw;
  }
}

std::vector<double> numbers_of(const nlohmann::json& object, const char* key) {
  std::vector<double> numbers;
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array()) return numbers;
  for (const nlohmann::json& entry : *found) {
    if (!entry.is_number()) break;
    numbers.push_back(entry.get<double>());
  }
  return numbers;
}

nlohmann::json pose_json(const Pose& pose) {
  return {pose.position.x(), pose.position.y(), pose.position.z(), pose.rotation.w(),
          pose.rotation.x(), pose.rotation.y(), pose.rotation.z()};
}

}  // namespace collided::cli
