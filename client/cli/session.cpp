#include "client/cli/session.hpp"

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/output/terminal_width.hpp"
#include "idl/etcd_option.hpp"
#include "idl/terminal_text.hpp"

namespace collided::cli {
namespace {

Format format_by_name(const std::string& name) {
  if (name == "table") return Format::table;
  if (name == "plain") return Format::plain;
  if (name == "json") return Format::json;
  if (name == "csv") return Format::csv;
  throw bad_use(fmt::format("COLLIDE_OUTPUT is '{}'; allowed: table, plain, json, csv", name));
}

Format chosen_format(const Io& io, const Globals& globals) {
  if (globals.json + globals.csv + globals.plain + globals.table > 1) {
    throw bad_use("--json, --csv, --plain and --table exclude each other");
  }
  if (globals.json) return Format::json;
  if (globals.csv) return Format::csv;
  if (globals.plain) return Format::plain;
  if (globals.table) return Format::table;
  const std::string by_environment = io.env("COLLIDE_OUTPUT");
  if (!by_environment.empty()) return format_by_name(by_environment);
  return io.out_is_terminal ? Format::table : Format::plain;
}

std::vector<std::string> field_names(const std::string& list) {
  std::vector<std::string> names;
  std::size_t begin = 0;
  while (begin <= list.size() && !list.empty()) {
    const std::size_t comma = std::min(list.find(',', begin), list.size());
    if (comma > begin) names.push_back(list.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return names;
}

}  // namespace

Client& Session::client(const Globals& globals) {
  if (!client_) client_.emplace(take(Client::connect(connect_options(io, globals))));
  return *client_;
}

ShardedClient& Session::sharded(const Globals& globals) {
  if (!sharded_ || sharded_by_ != globals.shards)
    sharded_.emplace(take(ShardedClient::connect(globals.shards, connect_options(io, globals))));
  sharded_by_ = globals.shards;
  return *sharded_;
}

void Session::warn_of_strangers() {
  if (!client_ || has_warned_) return;
  const Strangers strangers = client_->strangers();
  if (!strangers.speak_now) return;
  has_warned_ = true;
  print_warning(io,
                fmt::format("a second server speaks on this namespace, or somebody who plays one: {} of its messages "
                            "came, none was taken (collide doctor)",
                            strangers.samples));
}

bool color_wanted(const Io& io, const Globals& globals, bool stream_is_terminal) {
  if (globals.color == "always") return true;
  if (globals.color == "never") return false;
  if (!io.env("NO_COLOR").empty()) return false;
  const std::string forced = io.env("CLICOLOR_FORCE");
  if (!forced.empty() && forced != "0") return true;
  return stream_is_terminal && io.env("TERM") != "dumb";
}

Printer make_printer(Io& io, const Globals& globals) {
  return {io.out, chosen_format(io, globals), field_names(globals.fields),
          Appearance{.color = color_wanted(io, globals, io.out_is_terminal),
                     .digits = globals.verbose ? Digits::all : Digits::rounded,
                     .width = terminal_width(io),
                     .header = globals.header}};
}

ConnectOptions connect_options(const Io& io, const Globals& globals) {
  ConnectOptions options = take(ConnectOptions::from_environment([&](const char* name) {
    const std::string_view which = name;
    if (which == "COLLIDED_DOMAIN" && !globals.domain.empty()) return globals.domain;
    if (which == "COLLIDED_NAMESPACE" && !globals.name_space.empty()) return globals.name_space;
    if (which == "COLLIDED_INTERFACE" && !globals.interface.empty()) return globals.interface;
    if (which == "COLLIDED_KEYS" && !globals.keys.empty()) return globals.keys;
    if (which == etcd::kEtcdKeysVariable && !globals.etcd_keys.empty()) return globals.etcd_keys;
    return io.env(name);
  }));
  options.peers = globals.peers;
  options.wait_is_limit = globals.wait.has_value();
  options.wait = globals.wait.value_or(options.wait);
  return options;
}

std::chrono::nanoseconds timeout_of(const Globals& globals, std::chrono::nanoseconds otherwise) {
  return globals.timeout.value_or(otherwise);
}

Failure as_failure(const Error& error) {
  switch (error.code) {
    case ErrorCode::bad_input: return {Exit::bad_use, error.message, error.hint};
    case ErrorCode::no_server:
    case ErrorCode::disconnected:
    case ErrorCode::timeout: return {Exit::no_server, error.message, error.hint};
    case ErrorCode::refused: return {Exit::refused, error.message, error.hint};
    case ErrorCode::internal: break;
  }
  return {Exit::refused, "inside collide: " + error.message, error.hint};
}

void print_failure(Io& io, const Globals& globals, const Failure& failure) {
  if (failure.is_printed) return;
  const bool color = color_wanted(io, globals, io.err_is_terminal);
  const char* word = failure.code == Exit::interrupted ? "interrupted" : "error";
  io.err << (color ? fmt::format("\x1b[31m{}:\x1b[0m ", word) : fmt::format("{}: ", word))
         << wire_contract::terminal_text(failure.what()) << '\n';
  std::string_view hint = failure.hint;
  while (!hint.empty() && !globals.quiet) {
    const std::size_t end = std::min(hint.find('\n'), hint.size());
    io.err << "       " << wire_contract::terminal_text(hint.substr(0, end)) << '\n';
    hint.remove_prefix(std::min(end + 1, hint.size()));
  }
  io.err.flush();
}

void print_error(Io& io, std::string_view text) { io.err << "error: " << wire_contract::terminal_text(text) << '\n'; }

void print_warning(Io& io, std::string_view text) {
  if (!text.empty()) io.err << "warning: " << wire_contract::terminal_text(text) << '\n';
}

void print_hint(Io& io, const Globals& globals, std::string_view text) {
  if (!globals.quiet) io.err << wire_contract::terminal_text(text) << '\n';
}

}  // namespace collided::cli
