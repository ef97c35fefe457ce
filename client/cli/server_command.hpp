#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "client/cli/session.hpp"

namespace collided::cli {

/// Sends a command and returns its answer. Throws Failure, with the server's message where it refuses.
nlohmann::json server_command(Session& session, const Globals& globals, std::string_view name,
                              const nlohmann::json& arguments, const Shape& shape = {},
                              std::function<void(double)> progress = {});

/// The same for a command that takes bytes.
nlohmann::json server_command_with_bytes(Session& session, const Globals& globals, std::string_view name,
                                         const nlohmann::json& arguments, std::span<const std::byte> bytes);

/// The same for the command load, with the file's bytes instead of its path.
nlohmann::json upload_command(Session& session, const Globals& globals, std::span<const std::byte> bytes,
                              const std::string& file_name, const nlohmann::json& arguments,
                              std::function<void(double)> progress);

/// A Failure with the nearest names, where the world has no object of that name; else nothing.
std::optional<Failure> unknown_object(Session& session, const Globals& globals, const std::string& object);

/// The same for a command about one object. For an unknown name the Failure says "not in the world" and names the
/// nearest ones.
nlohmann::json object_command(Session& session, const Globals& globals, std::string_view command,
                              const std::string& object, const nlohmann::json& arguments);

/// Members of a JSON answer; empty, 0 or false where they are missing or of another type.
std::string text_of(const nlohmann::json& object, const char* key);
std::uint64_t count_of(const nlohmann::json& object, const char* key);
double number_of(const nlohmann::json& object, const char* key);
bool flag_of(const nlohmann::json& object, const char* key);
std::vector<std::string> texts_of(const nlohmann::json& object, const char* key);
/// The first numbers of an array member; fewer where it is shorter.
std::vector<double> numbers_of(const nlohmann::json& object, const char* key);

/// A pose as the JSON array [x, y, z, qw, qx, qy, qz].
nlohmann::json pose_json(const Pose& pose);

}  // namespace collided::cli
