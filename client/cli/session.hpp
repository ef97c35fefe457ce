#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <collided/client.hpp>

#include "client/cli/failure.hpp"
#include "client/cli/io.hpp"
#include "client/cli/output/output.hpp"

namespace collided::cli {

/// The options that every verb knows, as the user wrote them.
struct Globals {
  bool json = false;
  bool csv = false;
  bool plain = false;
  bool table = false;
  bool header = false;
  bool quiet = false;
  bool verbose = false;
  bool exit_zero = false;
  std::string fields;
  std::string color = "auto";
  std::string domain;
  std::string name_space;
  std::string interface;
  std::vector<std::string> peers;
  std::string wait;
  std::string timeout;
};

/// One process's connection, made when a verb first needs it and shared by the verbs of `collide -`.
class Session {
 public:
  explicit Session(Io& session_io) : io(session_io) {}

  /// Connects on first use; throws Failure (no_server) when nobody answers.
  Client& client(const Globals& globals);

  Io& io;

 private:
  std::optional<Client> client_;
};

/// The output form: flag, then COLLIDE_OUTPUT, then table on a terminal and plain elsewhere.
Printer make_printer(Io& io, const Globals& globals);

/// True where --color, NO_COLOR, CLICOLOR_FORCE and TERM allow colour on that stream.
bool color_wanted(const Io& io, const Globals& globals, bool stream_is_terminal);

/// Domain, namespace, interface: flag > COLLIDED_* > ROS_DOMAIN_ID > default.
ConnectOptions connect_options(const Io& io, const Globals& globals);

/// --timeout, default 2 s.
std::chrono::nanoseconds timeout_of(const Globals& globals,
                                    std::chrono::nanoseconds otherwise = std::chrono::seconds(2));

/// The library's error as the end of a verb.
Failure as_failure(const Error& error);

/// "error: ..." with the hint indented below.
void print_failure(Io& io, const Globals& globals, const Failure& failure);

/// "warning: TEXT" on standard error: for what is done as asked and is surely not meant. Nothing for an empty text.
void print_warning(Io& io, std::string_view text);

/// A line on stderr unless -q.
void print_hint(Io& io, const Globals& globals, std::string_view text);

/// The value, or the library's error thrown as Failure.
template <class T>
T take(Result<T> result) {
  if (!result) throw as_failure(result.error());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

}  // namespace collided::cli
