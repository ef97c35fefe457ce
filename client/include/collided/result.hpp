#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

/// What a call gives: a value, or the error that stands in its place.
#pragma GCC visibility push(default)

namespace collided {

enum class ErrorCode { bad_input, no_server, timeout, refused, disconnected, internal };

/// What went wrong and what to do next, ready to print.
struct Error {
  ErrorCode code = ErrorCode::internal;
  std::string message;
  std::string hint;  // may be empty
};

/// A value or the error that stands in its place.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}
  explicit operator bool() const { return state_.index() == 0; }
  T& operator*() { return std::get<0>(state_); }
  const T& operator*() const { return std::get<0>(state_); }
  T* operator->() { return &std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }
  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

/// Success without a value, or the error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}
  explicit operator bool() const { return !error_; }
  const Error& error() const { return *error_; }

 private:
  std::optional<Error> error_;
};

}  // namespace collided

#pragma GCC visibility pop
