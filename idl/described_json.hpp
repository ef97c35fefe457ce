#pragma once

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <collided/geometry.hpp>
#include <nlohmann/json.hpp>

#include "idl/described.hpp"

/// Writes described answers as JSON, and reads them from it.
namespace collided {

template <class Value>
nlohmann::json json_of(const Value& value) {
  using Json = nlohmann::json;
  // Adding 0 turns -0 into 0.
  if constexpr (std::is_same_v<Value, double>)
    return std::isfinite(value) ? Json(value + 0.0) : Json(value < 0 ? "-inf" : "inf");
  else if constexpr (std::is_same_v<Value, std::chrono::nanoseconds>) return value.count();
  else if constexpr (std::is_same_v<Value, Vec3>) return json_of(std::vector{value.x(), value.y(), value.z()});
  else if constexpr (requires { value.w(); })  // a rotation
    return json_of(std::vector{value.w(), value.x(), value.y(), value.z()});
  else if constexpr (requires { value.rotation; }) {  // a pose
    const auto& [p, q] = value;
    return json_of(std::vector{p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
  } else if constexpr (kIsList<Value>) {
    Json list = Json::array();
    for (const auto& one : value) list.push_back(json_of(one));
    return list;
  } else if constexpr (kIsRow<Value>) {
    Json row = Json::array();
    visit_fields<Value>([&](const auto& field) {
      const Json member = json_of(field.of(value));
      if (member.is_array()) row.insert(row.end(), member.begin(), member.end());
      else row.push_back(member);
    });
    return row;
  } else if constexpr (Described<Value>) {
    Json object = Json::object();
    visit_fields<Value>([&](const auto& field) {
      if (is_there(field, value)) object[field.name] = json_of_field(field, value);
    });
    return object;
  } else return value;
}

/// Writes a field that is present.
template <class T, class Member>
nlohmann::json json_of_field(const DescribedField<T, Member>& field, const std::type_identity_t<T>& answer) {
  const Member& value = field.of(answer);
  if constexpr (std::is_enum_v<Member>) return field.word(value);
  else if constexpr (std::is_same_v<Member, bool>)
    return field.words.empty() ? nlohmann::json(value) : nlohmann::json(field.words[0]);
  else if constexpr (std::is_same_v<Member, std::chrono::nanoseconds>)
    return field.written == Written::in_seconds ? json_of(static_cast<double>(value.count()) / 1e9) : json_of(value);
  else if constexpr (!kIsOptional<Member>) return json_of(value);
  else if (field.written == Written::as_list)
    return value ? nlohmann::json::array({json_of(*value)}) : nlohmann::json::array();
  else return value ? json_of(*value) : nlohmann::json(nullptr);
}

// ---- reading -------------------------------------------------------------------------------------------------------

/// A place in an answer; the enclosing place must outlive it.
struct JsonPlace {
  bool may_lack = false;  // missing members keep their default values
  const JsonPlace* around = nullptr;
  const char* name = nullptr;  // null: the place is an element of a list
  std::size_t number = 0;      // its index

  JsonPlace at(const char* member) const { return {.may_lack = may_lack, .around = this, .name = member}; }
  JsonPlace at(std::size_t i) const { return {.may_lack = may_lack, .around = this, .number = i}; }
  std::string path() const {
    if (around == nullptr) return {};
    const std::string before = around->path();
    return (before.empty() ? "" : before + "/") + (name != nullptr ? name : std::to_string(number));
  }
};

/// Throws nlohmann::json::exception with the place of the mismatch: "inside/3/clearance is missing".
[[noreturn]] inline void refuse_json(const JsonPlace& place, const char* why) {
  throw nlohmann::json::other_error::create(501, place.path() + why, nullptr);
}

template <class Value>
void read_json(const nlohmann::json& json, const JsonPlace& place, Value& value) {
  if constexpr (std::is_same_v<Value, double>) {
    if (!json.is_number() && json != "inf" && json != "-inf") refuse_json(place, " is not a number");
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    value = json.is_number() ? json.get<double>() : json == "inf" ? kInfinity : -kInfinity;
  } else if constexpr (std::is_same_v<Value, std::chrono::nanoseconds>) {
    std::int64_t ns = 0;
    read_json(json, place, ns);
    value = std::chrono::nanoseconds(ns);
  } else if constexpr (std::is_same_v<Value, Vec3> || std::is_same_v<Value, Pose>) {
    std::vector<double> n;
    read_json(json, place, n);
    if (n.size() != (std::is_same_v<Value, Vec3> ? 3u : 7u)) refuse_json(place, " has another count of numbers");
    if constexpr (std::is_same_v<Value, Vec3>) value = Vec3(n[0], n[1], n[2]);
    else value = {.position = {n[0], n[1], n[2]}, .rotation = Quat(n[3], n[4], n[5], n[6])};
  } else if constexpr (kIsList<Value>) {
    if (!json.is_array()) refuse_json(place, " is not a list");
    for (std::size_t i = 0; i < json.size(); ++i) read_json(json[i], place.at(i), value.emplace_back());
  } else if constexpr (kIsRow<Value>) {
    if (!json.is_array()) refuse_json(place, " is not a list");
    std::size_t at = 0;
    visit_fields<Value>([&](const auto& field) {
      auto& member = value.*field.member;
      constexpr std::size_t kNumbers = std::is_same_v<std::remove_reference_t<decltype(member)>, Vec3> ? 3 : 1;
      if (at + kNumbers > json.size()) refuse_json(place, " has too few numbers");
      const auto first = json.begin() + static_cast<std::ptrdiff_t>(std::exchange(at, at + kNumbers));
      if constexpr (kNumbers == 1) read_json(*first, place.at(field.name), member);
      else read_json(nlohmann::json(first, first + kNumbers), place.at(field.name), member);
    });
  } else if constexpr (Described<Value>) {
    if (!json.is_object()) refuse_json(place, " is not an object");
    visit_fields<Value>([&](const auto& field) { read_field(json, place, field, value); });
  } else {
    if (json.type() != nlohmann::json(value).type() && !(std::is_integral_v<Value> && json.is_number_integer()))
      refuse_json(place, " is of another type");
    if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>) {
      const bool fits = json.is_number_unsigned() ? std::in_range<Value>(json.get<std::uint64_t>())
                                                  : std::in_range<Value>(json.get<std::int64_t>());
      if (!fits) refuse_json(place, " is out of range");
    }
    value = json.get<Value>();
  }
}

template <class T, class Member>
void read_field(const nlohmann::json& json, const JsonPlace& parent, const DescribedField<T, Member>& field,
                std::type_identity_t<T>& answer) {
  if (field.only_if != nullptr && !field.only_if(answer)) return;
  const JsonPlace place = parent.at(field.name);
  const auto found = json.find(field.name);
  if constexpr (std::is_same_v<Member, bool>) {
    if (!field.words.empty()) {
      answer.*field.member = found != json.end();
      if (found != json.end() && *found != field.words[0]) refuse_json(place, " is a word that is not known");
      return;
    }
  }
  if (found == json.end()) {
    if (kIsOptional<Member> || field.written == Written::unless_default || place.may_lack) return;
    refuse_json(place, " is missing");
  }
  Member& value = answer.*field.member;
  if constexpr (std::is_enum_v<Member>) {
    constexpr int kMostCodes = 256;
    int code = 0;
    while (code < kMostCodes && *found != field.word(static_cast<Member>(code))) ++code;
    // Codes without a word have an empty one, as has the code 0 of some enumerations.
    if (code == kMostCodes || (code > 0 && *found == "")) refuse_json(place, " is a word that is not known");
    value = static_cast<Member>(code);
  } else if constexpr (kIsOptional<Member>) {
    if (field.written == Written::or_null && found->is_null()) return;
    if (field.written != Written::as_list) read_json(*found, place, value.emplace());
    else if (!found->empty()) read_json(found->front(), place.at(std::size_t{0}), value.emplace());
  } else {
    read_json(*found, place, value);
  }
}

/// Reads an answer; members that T does not have are ignored. Throws nlohmann::json::exception.
///
/// may_lack  missing members keep their default values
template <class T>
T from_json(const nlohmann::json& json, bool may_lack = false) {
  T answer{};
  read_json(json, {.may_lack = may_lack}, answer);
  return answer;
}

}  // namespace collided
