#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>

#include <collided/geometry.hpp>

#include "client/cli/output/output.hpp"
#include "idl/described_json.hpp"

namespace collided::cli {

/// JSON as it is printed; bytes that are not UTF-8 become U+FFFD.
inline RawJson raw_json(const nlohmann::json& value) {
  return {value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

/// The form of vectors in a record: as three columns of CSV, or as JSON like other lists.
enum class Vectors { columns, json };

/// A described answer's members in their order, lists as JSON.
template <Described T>
Record record_of(const T& answer, Vectors vectors = Vectors::columns) {
  Record record;
  visit_fields<T>([&](const auto& field) {
    using Member = std::remove_cvref_t<decltype(field.of(answer))>;
    constexpr bool kIsVector = std::is_same_v<Member, Vec3> || std::is_same_v<Member, std::optional<Vec3>>;
    Value& value = record.emplace_back(Field{field.name, {}}).value;
    if (kIsVector && vectors == Vectors::columns) value = MaybeVector();
    if (!is_there(field, answer)) return;
    const Member& member = field.of(answer);
    if constexpr (kIsVector) {
      const std::optional<Vec3> vector = member;
      if (vectors == Vectors::json) value = raw_json(json_of_field(field, answer));
      else if (vector) value = MaybeVector(*vector);
    } else if constexpr (std::is_enum_v<Member>) value = std::string_view(field.word(member));
    else if constexpr (std::is_same_v<Member, std::chrono::nanoseconds>) {
      if (field.written == Written::in_seconds) value = static_cast<double>(member.count()) / 1e9;
      else value = std::int64_t{member.count()};
    } else if constexpr (std::is_unsigned_v<Member> && !std::is_same_v<Member, bool>) value = std::uint64_t{member};
    else if constexpr (std::is_constructible_v<Value, Member>) value = member;
    else value = raw_json(json_of_field(field, answer));
  });
  return record;
}

/// The field of that name, which must exist.
inline Record::iterator place_of(Record& record, std::string_view name) {
  return std::find_if(record.begin(), record.end(), [&](const Field& field) { return field.name == name; });
}

}  // namespace collided::cli
