#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <variant>

/// Results of calls: a value, or the error in its place. The library throws no exceptions of its own.
#pragma GCC visibility push(default)

namespace collided {

/// Kinds of errors, which tell a program how to react.
/// bad_input     the arguments are invalid, or a local file cannot be read or written; nothing was sent
/// no_server     no server answered while connecting, or it does not offer the requested feature
/// timeout       no answer in time although the server is alive, or its queue stayed full
/// refused       the server refused the request, or too many requests of this client are waiting
/// disconnected  the server is silent or was replaced by another one; the connection resumes by itself
/// internal      DDS failed, or the answer cannot be read: server and library may be of different versions
enum class ErrorCode { bad_input, no_server, timeout, refused, disconnected, internal };

/// An error and its remedy, ready to print.
struct Error {
  ErrorCode code = ErrorCode::internal;
  std::string message;  // where, what, which value and which limit
  std::string hint;     // the next step or the consequence; may be empty
  /// refused: the server expects to have capacity after this time. Questions are retried automatically within their
  /// timeout. 0: a retry alone does not help.
  std::chrono::milliseconds retry_after{0};
};

/// A value, or the error in its place. Test it before use, and never read the value of an error or the error of a
/// value. Use it from one thread at a time.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}
  /// True if there is a value.
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
  /// True on success.
  explicit operator bool() const { return !error_; }
  const Error& error() const { return *error_; }

 private:
  std::optional<Error> error_;
};

}  // namespace collided

#pragma GCC visibility pop
