#pragma once

#include <chrono>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <collided/geometry.hpp>
#include <nlohmann/json.hpp>

/// Answers as structs, each with one list of its fields, from which its JSON is written and read:
///
///     constexpr auto fields_of(const Crate*) { return std::tuple(field("name", &Crate::name)); }
namespace collided {

/// always          it is written, and must be there when it is read
/// unless_default  where it has the value that a new answer has, it is not written
/// as_list         an optional value as a list of one or none
enum class Written { always, unless_default, as_list };

/// A member of T, and how it stands in JSON: a time in nanoseconds, a vector as three numbers, a pose as seven (w first), an
/// infinite number as "inf", an optional member that has no value not at all, a code as its word.
template <class T, class Member>
struct DescribedField {
  const char* name;
  Member T::*member;
  Written written = Written::always;
  std::span<const char* const> words = {};  // of an enumeration, by its codes; empty: name_of() has them
  bool (*only_if)(const T&) = nullptr;      // it is there where this is true of the members before it; null: always

  const Member& of(const T& answer) const { return answer.*member; }
  /// The word for an enumeration's code; empty: it has none.
  std::string_view word(Member code) const {
    if constexpr (requires { name_of(code); }) {
      if (words.empty()) return name_of(code);
    }
    const auto number = static_cast<std::size_t>(code);
    return number < words.size() ? words[number] : "";
  }
};
template <class T, class Member>
constexpr DescribedField<T, Member> field(const char* name, Member T::*member, Written written = Written::always) {
  return {.name = name, .member = member, .written = written};
}
template <class T, class Code>
constexpr DescribedField<T, Code> field(const char* name, Code T::*member, std::span<const char* const> words) {
  return {.name = name, .member = member, .words = words};
}
/// kCondition  a bool member of T, or a function of T: whether the field is there
template <auto kCondition, class T, class Member>
constexpr DescribedField<T, Member> field_if(const char* name, Member T::*member,
                                             std::span<const char* const> words = {}) {
  return {.name = name, .member = member, .words = words, .only_if = [](const T& answer) {
            return static_cast<bool>(std::invoke(kCondition, answer));
          }};
}

void fields_of() = delete;  // each answer has its own
template <class T>
concept Described = requires(const T* none) {
  fields_of(none);
};
/// A described type that stands in JSON as one list of its fields' numbers, without names.
template <class T>
inline constexpr bool kIsRow = false;
template <class T>
inline constexpr bool kIsList = false;
template <class T>
inline constexpr bool kIsList<std::vector<T>> = true;
template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;

template <Described T, class Visit>
void visit_fields(const Visit& visit) {
  std::apply([&](const auto&... fields) { (visit(fields), ...); }, fields_of(static_cast<const T*>(nullptr)));
}

/// False: the answer has no such member.
template <class T, class Member>
bool is_there(const DescribedField<T, Member>& field, const T& answer) {
  if (field.only_if != nullptr && !field.only_if(answer)) return false;
  if constexpr (kIsOptional<Member>) return field.written == Written::as_list || field.of(answer).has_value();
  else if constexpr (kIsList<Member>) return field.written != Written::unless_default || !field.of(answer).empty();
  else if constexpr (std::equality_comparable<Member>)
    return field.written != Written::unless_default || field.of(answer) != field.of(T{});
  else return true;
}

// ---- writing -------------------------------------------------------------------------------------------------------

template <class Value>
nlohmann::json json_of(const Value& value) {
  using Json = nlohmann::json;
  // Adding 0 turns -0 into 0.
  if constexpr (std::is_same_v<Value, double>) return std::isfinite(value) ? Json(value + 0.0) : Json("inf");
  else if constexpr (std::is_same_v<Value, std::chrono::nanoseconds>) return value.count();
  else if constexpr (std::is_same_v<Value, Vec3>) return json_of(std::vector{value.x(), value.y(), value.z()});
  else if constexpr (std::is_same_v<Value, Pose>) {
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

/// Of a field that is there.
template <class T, class Member>
nlohmann::json json_of_field(const DescribedField<T, Member>& field, const T& answer) {
  const Member& value = field.of(answer);
  if constexpr (std::is_enum_v<Member>) return field.word(value);
  else if constexpr (!kIsOptional<Member>) return json_of(value);
  else if (field.written != Written::as_list) return json_of(*value);
  else return value ? nlohmann::json::array({json_of(*value)}) : nlohmann::json::array();
}

// ---- reading -------------------------------------------------------------------------------------------------------

/// Throws nlohmann::json::exception with the place of what does not fit: "inside/3/clearance is missing".
[[noreturn]] inline void refuse_json(const std::string& path, const char* why) {
  throw nlohmann::json::other_error::create(501, path + why, nullptr);
}

template <class Value>
void read_json(const nlohmann::json& json, const std::string& path, Value& value) {
  if constexpr (std::is_same_v<Value, double>) {
    if (!json.is_number() && json != "inf") refuse_json(path, " is not a number");
    value = json.is_number() ? json.get<double>() : std::numeric_limits<double>::infinity();
  } else if constexpr (std::is_same_v<Value, std::chrono::nanoseconds>) {
    std::int64_t ns = 0;
    read_json(json, path, ns);
    value = std::chrono::nanoseconds(ns);
  } else if constexpr (std::is_same_v<Value, Vec3> || std::is_same_v<Value, Pose>) {
    std::vector<double> n;
    read_json(json, path, n);
    if (n.size() != (std::is_same_v<Value, Vec3> ? 3u : 7u)) refuse_json(path, " has another count of numbers");
    if constexpr (std::is_same_v<Value, Vec3>) value = Vec3(n[0], n[1], n[2]);
    else value = {.position = {n[0], n[1], n[2]}, .rotation = Quat(n[3], n[4], n[5], n[6])};
  } else if constexpr (kIsList<Value>) {
    if (!json.is_array()) refuse_json(path, " is not a list");
    for (std::size_t i = 0; i < json.size(); ++i)
      read_json(json[i], path + "/" + std::to_string(i), value.emplace_back());
  } else if constexpr (kIsRow<Value>) {
    if (!json.is_array()) refuse_json(path, " is not a list");
    std::size_t at = 0;
    visit_fields<Value>([&](const auto& field) {
      auto& member = value.*field.member;
      constexpr std::size_t kNumbers = std::is_same_v<std::remove_reference_t<decltype(member)>, Vec3> ? 3 : 1;
      if (at + kNumbers > json.size()) refuse_json(path, " has too few numbers");
      const auto first = json.begin() + static_cast<std::ptrdiff_t>(std::exchange(at, at + kNumbers));
      const std::string place = path + "/" + field.name;
      if constexpr (kNumbers == 1) read_json(*first, place, member);
      else read_json(nlohmann::json(first, first + kNumbers), place, member);
    });
  } else if constexpr (Described<Value>) {
    if (!json.is_object()) refuse_json(path, " is not an object");
    visit_fields<Value>([&](const auto& field) { read_field(json, path, field, value); });
  } else {
    if (json.type() != nlohmann::json(value).type() && !(std::is_integral_v<Value> && json.is_number_integer()))
      refuse_json(path, " is of another type");
    value = json.get<Value>();
  }
}

template <class T, class Member>
void read_field(const nlohmann::json& json, const std::string& path, const DescribedField<T, Member>& field,
                T& answer) {
  if (field.only_if != nullptr && !field.only_if(answer)) return;
  const std::string place = path.empty() ? field.name : path + "/" + field.name;
  const auto found = json.find(field.name);
  if (found == json.end()) {
    if (kIsOptional<Member> || field.written == Written::unless_default) return;
    refuse_json(place, " is missing");
  }
  Member& value = answer.*field.member;
  if constexpr (std::is_enum_v<Member>) {
    constexpr int kMostCodes = 256;
    int code = 0;
    while (code < kMostCodes && *found != field.word(static_cast<Member>(code))) ++code;
    // The word of no code is empty, as is that of the code 0 of some enumerations.
    if (code == kMostCodes || (code > 0 && *found == "")) refuse_json(place, " is a word that is not known");
    value = static_cast<Member>(code);
  } else if constexpr (kIsOptional<Member>) {
    if (field.written != Written::as_list) read_json(*found, place, value.emplace());
    else if (!found->empty()) read_json(found->front(), place + "/0", value.emplace());
  } else {
    read_json(*found, place, value);
  }
}

/// An answer as it was written; members that T does not have are passed over. Throws nlohmann::json::exception.
template <Described T>
T from_json(const nlohmann::json& json) {
  T answer;
  read_json(json, "", answer);
  return answer;
}

}  // namespace collided
