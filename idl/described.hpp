#pragma once

#include <array>
#include <chrono>
#include <concepts>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

/// Answers as structs, each with one list of its fields that defines its JSON (idl/described_json.hpp):
///
///     constexpr auto fields_of(const Crate*) {
///       return listed(fields<&Crate::name, &Crate::weight_kg>(), field("colour", &Crate::paint, kPaintWords));
///     }
namespace collided {

/// always          written, and required when read
/// unless_default  not written if it has its default value
/// as_list         an optional value as a list of one or none
/// or_null         an optional value, null where there is none
/// in_seconds      a time as a number of seconds; not read
enum class Written { always, unless_default, as_list, or_null, in_seconds };

/// The words for an enumeration's codes, if they are the same in all answers.
template <class Code>
inline constexpr std::span<const char* const> kWordsOf{};

/// A member of T and its form in JSON: a time in nanoseconds, a vector as three numbers, a pose as seven (w first), an
/// infinite number as "inf", a code as its word. An optional member without a value is omitted.
template <class T, class Member>
struct DescribedField {
  const char* name;
  Member T::*member;
  Written written = Written::always;
  // Words of an enumeration by its codes; empty: name_of() or kWordsOf has them. A bool with a word is written as that
  // word, or omitted.
  std::span<const char* const> words = {};
  bool (*only_if)(const T&) = nullptr;  // present if this is true of the members before it; null: always

  const Member& of(const T& answer) const { return answer.*member; }
  /// The word for an enumeration's code; empty: none.
  std::string_view word(Member code) const {
    if constexpr (requires { name_of(code); }) {
      if (words.empty()) return name_of(code);
    }
    const std::span<const char* const> known = words.empty() ? kWordsOf<Member> : words;
    const auto number = static_cast<std::size_t>(code);
    return number < known.size() ? known[number] : "";
  }
};

template <auto kMember>
constexpr std::string_view text_of_member() {
  return __PRETTY_FUNCTION__;
}
/// A member's name in JSON: a length loses its unit (error_m: "error"), a time gets its unit (age: "age_ns").
template <auto kMember, class Member>
inline constexpr auto kNameInJson = [] {
  constexpr std::string_view text = text_of_member<kMember>();
  constexpr std::string_view unit = std::is_same_v<Member, std::chrono::nanoseconds> ||
                                            std::is_same_v<Member, std::optional<std::chrono::nanoseconds>>
                                        ? "_ns"
                                        : "";
  constexpr std::size_t last = text.find_first_of(";]", text.rfind("kMember = "));
  constexpr std::size_t first = text.rfind(':', last) + 1;
  constexpr std::size_t end = text.substr(0, last).ends_with("_m") ? last - 2 : last;
  std::array<char, end - first + unit.size() + 1> name{};
  std::size_t at = 0;
  for (const std::string_view part : {text.substr(first, end - first), unit}) {
    for (const char c : part) name[at++] = c;
  }
  return name;
}();

template <class T, class Member>
constexpr DescribedField<T, Member> field(const char* name, Member T::*member, Written written = Written::always) {
  return {.name = name, .member = member, .written = written};
}
template <class T, class Code>
constexpr DescribedField<T, Code> field(const char* name, Code T::*member, std::span<const char* const> words) {
  return {.name = name, .member = member, .words = words};
}
/// Members by their own names.
template <auto... kMembers>
constexpr auto fields(Written written = Written::always) {
  const auto one = [&]<auto kMember, class T, class Member>(Member T::*member) {
    const bool is_bare = written == Written::in_seconds;
    return field(is_bare ? kNameInJson<kMember, void>.data() : kNameInJson<kMember, Member>.data(), member, written);
  };
  return std::tuple(one.template operator()<kMembers>(kMembers)...);
}
template <auto... kMembers>
constexpr auto unless_default() {
  return fields<kMembers...>(Written::unless_default);
}
template <auto... kMembers>
constexpr auto in_seconds() {
  return fields<kMembers...>(Written::in_seconds);
}
/// kCondition  a bool member of T, or a function of T: true if the fields are present
template <auto kCondition, class T, class Member>
constexpr DescribedField<T, Member> field_if(DescribedField<T, Member> field) {
  field.only_if = [](const T& answer) { return static_cast<bool>(std::invoke(kCondition, answer)); };
  return field;
}
template <auto kCondition, class T, class Member>
constexpr auto field_if(const char* name, Member T::*member, std::span<const char* const> words = {}) {
  return field_if<kCondition>(field(name, member, words));
}
template <auto kCondition, auto... kMembers>
constexpr auto fields_if() {
  return std::apply([](auto... field) { return std::tuple(field_if<kCondition>(field)...); }, fields<kMembers...>());
}
/// Joins single fields and lists into one list.
template <class... Parts>
constexpr auto listed(const Parts&... parts) {
  const auto as_tuple = []<class Part>(const Part& part) {
    if constexpr (requires { part.member; }) return std::tuple(part);
    else return part;
  };
  return std::tuple_cat(as_tuple(parts)...);
}

void fields_of() = delete;  // each answer defines its own
template <class T>
concept Described = requires(const T* none) {
  fields_of(none);
};
/// A described type whose JSON is one list of its fields' numbers, without names.
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

/// Returns false if the answer has no such member.
template <class T, class Member>
bool is_there(const DescribedField<T, Member>& field, const std::type_identity_t<T>& answer) {
  if (field.only_if != nullptr && !field.only_if(answer)) return false;
  if constexpr (std::is_same_v<Member, bool>) {
    if (!field.words.empty()) return field.of(answer);
  }
  if constexpr (kIsOptional<Member>) {
    return field.written == Written::as_list || field.written == Written::or_null || field.of(answer).has_value();
  } else if constexpr (kIsList<Member>) {
    return field.written != Written::unless_default || !field.of(answer).empty();
  } else if constexpr (std::equality_comparable<Member>) {
    return field.written != Written::unless_default || field.of(answer) != field.of(T{});
  } else {
    return true;
  }
}

}  // namespace collided
