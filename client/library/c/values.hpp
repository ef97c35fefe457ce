#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <string>
#include <string_view>

#include <collided.h>
#include <collided/client.hpp>

/// Values that cross the C interface: structs that may be older than this library, texts that may be null, errors.
namespace collided::c {

/// The caller's struct in this library's version: members missing in the caller's header are as in `defaults`.
template <class T>
T taken(const T* given, const T& defaults = {}) {
  T value = defaults;
  if (given) std::memcpy(&value, given, std::min<std::size_t>(given->size, sizeof value));
  return value;
}

/// Writes the first `size` bytes of `value`, the size of the caller's struct.
template <class T>
void give(T value, void* target, std::uint32_t size) {
  value.size = size;
  std::memcpy(target, &value, std::min<std::size_t>(size, sizeof value));
}
template <class T>
void give(const T& value, T* target) {
  if (target) give(value, target, target->size);
}

inline std::string text(const char* given) { return given ? given : ""; }

/// Copies a text, truncated to the array, never within a UTF-8 character.
template <std::size_t N>
void put_text(std::string_view from, char (&to)[N]) {
  std::size_t length = std::min(from.size(), N - 1);
  while (length < from.size() && length > 0 && (static_cast<unsigned char>(from[length]) & 0xc0U) == 0x80) --length;
  std::copy_n(from.data(), length, to);
  to[length] = 0;
}

inline Vec3 vector(const double* numbers) { return {numbers[0], numbers[1], numbers[2]}; }
inline Quat rotation(const double* numbers) {
  return numbers ? Quat(numbers[0], numbers[1], numbers[2], numbers[3]) : Quat::Identity();
}
inline void put(const Vec3& from, double* to) { std::copy_n(from.data(), 3, to); }

/// Fills the caller's error and returns its code.
int fail(const Error& error, collided_error* target);
Error missing(std::string_view what);
/// Error bad_input: a kind is outside of 0 to `last`.
Error unknown_kind(const std::string& what, std::int32_t kind, std::int32_t last);
/// Fills the caller's error with the report of a successful call; an empty text: nothing to report.
void note(std::string_view text, collided_error* target);

/// Runs a call and turns its Result, or any exception, into a code.
template <class Call>
int guarded(collided_error* error, const Call& call) noexcept {
  try {
    const auto result = call();
    return result ? static_cast<int>(COLLIDED_OK) : fail(result.error(), error);
  } catch (const std::exception& thrown) { return fail({ErrorCode::internal, thrown.what(), ""}, error); } catch (...) {
    return fail({ErrorCode::internal, "an unknown exception", ""}, error);
  }
}

AskOptions ask_options(const collided_ask_options* options);
/// Error bad_input for invalid parts.
Result<Shape> shape_of(const collided_part* parts, std::size_t part_count);

}  // namespace collided::c

struct collided_client {
  collided::Client client;
};
struct collided_publisher {
  collided::Publisher publisher;
};
