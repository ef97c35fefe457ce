#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>

/// The answers of etcd's gateway.
namespace collided::etcd {

using nlohmann::json;

/// Why one member gave no answer, in a few words.
struct NoAnswer : std::runtime_error {
  /// The source of a refusal that a retry will not change.
  enum class Refusal : std::uint8_t { none, member, cluster };
  explicit NoAnswer(const std::string& why, Refusal who = Refusal::none) : std::runtime_error(why), refusal(who) {}
  Refusal refusal;
};

/// The part of an answer under this name; each throws NoAnswer where there is none of that kind.
const json& object_in(const json& answer, const char* name);
const json& array_in(const json& answer, const char* name);
const std::string& text_in(const json& answer, const char* name);
/// Numbers of 64 bits are texts in the gateway's JSON; 0 is omitted.
std::int64_t number_in(const json& answer, const char* name);
/// Bytes are texts in base64; an empty value is omitted.
std::string bytes_in(const json& answer, const char* name);
/// A false value is omitted.
bool is_set_in(const json& answer, const char* name);

}  // namespace collided::etcd
