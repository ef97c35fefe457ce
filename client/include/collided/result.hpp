#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <variant>

/// What calls return: a value, or the error that stands in its place. The library throws no exceptions of its own.
#pragma GCC visibility push(default)

namespace collided {

/// What kind of error it is, for a program to decide what to do.
/// bad_input     the arguments cannot be meant, or a local file cannot be read or written; nothing was sent
/// no_server     no server answered while connecting, or it does not offer what was asked for
/// timeout       no answer in time although the server lives, or its queue stayed full
/// refused       the server refused the request, or too many requests of this client wait already
/// disconnected  the server has been silent or was replaced by another one; the connection resumes by itself
/// internal      DDS failed, or the answer cannot be read: server and library may be of different versions
enum class ErrorCode { bad_input, no_server, timeout, refused, disconnected, internal };

/// What went wrong and what to do next, ready to print.
struct Error {
  ErrorCode code = ErrorCode::internal;
  std::string message;  // where, what, which value and which limit
  std::string hint;     // the next step or the consequence; may be empty
  /// refused: the server expects to have room after so long. Questions wait and are asked again by themselves within
  /// their timeout. 0: asking again does not help by itself.
  std::chrono::milliseconds retry_after{0};
};

/// A value or the error that stands in its place. Test it before use: the value of an error, or the error of a value,
/// must not be read. Like any value, it is for one thread at a time.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}
  /// True where there is a value.
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
  /// True for success.
  explicit operator bool() const { return !error_; }
  const Error& error() const { return *error_; }

 private:
  std::optional<Error> error_;
};

}  // namespace collided

#pragma GCC visibility pop
