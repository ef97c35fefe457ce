#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <collided/client.hpp>
#include <collided/shards.hpp>

#include "client/cli/failure.hpp"
#include "client/cli/io.hpp"
#include "client/cli/output/output.hpp"

namespace collided::cli {

/// The options that every verb has, as the user wrote them.
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
  std::string keys;
  std::string etcd_keys;
  std::string shards;  // a shard map: a file, or its address in etcd
  std::optional<std::chrono::nanoseconds> wait;
  std::optional<std::chrono::nanoseconds> timeout;
};

struct OwnParts;

/// The process's connection to the server, made when a verb first needs it. The verbs of `collide -` share it. One
/// thread.
class Session {
 public:
  Session(Io& session_io, const OwnParts& program) : io(session_io), own(program) {}

  /// The client, connected on first use. Throws Failure (no_server) if no server answers.
  Client& client(const Globals& globals);
  /// The shards of the map of --shards, connected on first use. Throws Failure if none answers.
  ShardedClient& sharded(const Globals& globals);
  /// Warns, once, if another process publishes in the server's place.
  void warn_of_strangers();

  /// Whether the verbs of many lines share it, so that the connection outlives a verb.
  bool has_many_verbs = false;
  /// "line 3: " before the messages of that line.
  std::string where;
  /// The words of the command line or, for many lines, the options given before them and the words of the current one.
  std::vector<std::string> words;

  Io& io;
  const OwnParts& own;

 private:
  std::optional<Client> client_;
  std::optional<ShardedClient> sharded_;
  std::string sharded_by_;  // its map, as in --shards
  bool has_warned_ = false;
};

/// A printer in the form of the options, else of COLLIDE_OUTPUT, else a table on a terminal and plain elsewhere.
Printer make_printer(Io& io, const Globals& globals);

/// Whether that stream is coloured, by --color, NO_COLOR, CLICOLOR_FORCE and TERM.
bool color_wanted(const Io& io, const Globals& globals, bool stream_is_terminal);

/// Where to connect: each option from its flag, else its COLLIDED_ variable, else ROS_DOMAIN_ID for the domain, else
/// the default.
ConnectOptions connect_options(const Io& io, const Globals& globals);

/// The time of --timeout, or `otherwise`.
std::chrono::nanoseconds timeout_of(const Globals& globals,
                                    std::chrono::nanoseconds otherwise = std::chrono::seconds(2));

/// A library's error as a Failure, with its exit code.
Failure as_failure(const Error& error);

/// Prints "error: ..." on standard error, with the hint indented below.
void print_failure(Io& io, const Globals& globals, const Failure& failure);

/// Prints "error: TEXT" on standard error, for one line of many; the others continue.
void print_error(Io& io, std::string_view text);

/// Prints "warning: TEXT" on standard error, for input that is accepted but probably a mistake. Prints nothing for an
/// empty text.
void print_warning(Io& io, std::string_view text);

/// Prints a line on standard error, unless -q.
void print_hint(Io& io, const Globals& globals, std::string_view text);

/// The value of a result; throws its error as a Failure.
template <class T>
T take(Result<T> result) {
  if (!result) throw as_failure(result.error());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

}  // namespace collided::cli
