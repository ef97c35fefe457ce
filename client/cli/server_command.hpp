#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "client/cli/session.hpp"
#include "idl/described_json.hpp"

namespace collided::cli {

Failure unfit_answer(const nlohmann::json::exception& why);

/// Sends a command and returns its answer. Throws Failure, with the server's message if it refuses.
nlohmann::json server_command(Session& session, const Globals& globals, std::string_view name,
                              const nlohmann::json& arguments, const Shape& shape = {},
                              std::function<void(double)> progress = {});

/// The JSON as an answer; missing members keep their default values. Throws Failure if one is of another type.
template <class Answer>
Answer answer_in(const nlohmann::json& json) {
  try {
    return from_json<Answer>(json, true);
  } catch (const nlohmann::json::exception& unfit) { throw unfit_answer(unfit); }
}

/// Sends a command and returns its answer. Throws Failure.
template <class Answer>
Answer server_answer(Session& session, const Globals& globals, std::string_view name, const nlohmann::json& arguments) {
  return answer_in<Answer>(server_command(session, globals, name, arguments));
}

/// The same for a command with bytes.
nlohmann::json server_command_with_bytes(Session& session, const Globals& globals, std::string_view name,
                                         const nlohmann::json& arguments, std::span<const std::byte> bytes);

/// The same for the command load, with the file's bytes instead of its path.
nlohmann::json upload_command(Session& session, const Globals& globals, std::span<const std::byte> bytes,
                              const std::string& file_name, const nlohmann::json& arguments,
                              std::function<void(double)> progress);

/// A Failure with the nearest names if the world has no object of that name; else nothing.
std::optional<Failure> unknown_object(Session& session, const Globals& globals, const std::string& object);

/// The same for a command about one object. For an unknown name the Failure contains "not in the world" and the nearest
/// names.
nlohmann::json object_command(Session& session, const Globals& globals, std::string_view command,
                              const std::string& object, const nlohmann::json& arguments);

/// A member of a JSON answer; empty, 0 or false if it is missing or of another type.
template <class Member>
Member member_of(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  try {
    return found == object.end() ? Member() : from_json<Member>(*found);
  } catch (const nlohmann::json::exception&) { return Member(); }
}
inline std::string text_of(const nlohmann::json& object, const char* key) {
  return member_of<std::string>(object, key);
}
inline std::uint64_t count_of(const nlohmann::json& object, const char* key) {
  return member_of<std::uint64_t>(object, key);
}
inline double number_of(const nlohmann::json& object, const char* key) { return member_of<double>(object, key); }
inline bool flag_of(const nlohmann::json& object, const char* key) { return member_of<bool>(object, key); }
inline std::vector<std::string> texts_of(const nlohmann::json& object, const char* key) {
  return member_of<std::vector<std::string>>(object, key);
}
/// The first numbers of an array member; fewer if it is shorter.
std::vector<double> numbers_of(const nlohmann::json& object, const char* key);

/// A pose as the JSON array [x, y, z, qw, qx, qy, qz].
nlohmann::json pose_json(const Pose& pose);

}  // namespace collided::cli
