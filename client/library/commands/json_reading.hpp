#pragma once

#include <string>
#include <type_traits>

#include <nlohmann/json.hpp>

#include "collided/client.hpp"
#include "idl/described_json.hpp"

namespace collided::client {

/// Three numbers of a command's answer as a vector. Like all access to JSON it throws nlohmann::json::exception if
/// something is missing or has another type; read_answer turns that into an Error.
inline Vec3 vector_of(const nlohmann::json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

/// Returns read(json) for the JSON in an answer's text. Passes on an existing Error, and returns an Error if the answer
/// is not of the command's form.
template <class Read>
auto read_answer(const Result<std::string>& text, const char* command, Read&& read)
    -> Result<decltype(read(std::declval<const nlohmann::json&>()))> {
  if (!text) { return text.error(); }
  try {
    const nlohmann::json json = nlohmann::json::parse(*text);
    if constexpr (std::is_void_v<decltype(read(json))>) {
      read(json);
      return {};
    } else {
      return read(json);
    }
  } catch (const nlohmann::json::exception& unfit) {
    return Error{ErrorCode::internal, std::string(command) + ": the server's answer does not fit: " + unfit.what(),
                 "server and library may be of different versions"};
  }
}

/// Reads an answer that is one described struct.
template <Described Answer>
Result<Answer> read_answer(const Result<std::string>& text, const char* command) {
  return read_answer(text, command, [](const nlohmann::json& json) { return from_json<Answer>(json); });
}

}  // namespace collided::client
