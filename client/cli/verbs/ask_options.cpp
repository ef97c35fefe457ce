#include "client/cli/verbs/ask_options.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/time_text.hpp"
#include "client/cli/server_command.hpp"
#include "idl/commands.hpp"

namespace collided::cli {

namespace {

Importance parse_importance(const std::string& text) {
  if (text.empty() || text == "normal") return Importance::normal;
  if (text == "low") return Importance::low;
  if (text == "high") return Importance::high;
  throw bad_use("--importance " + text + " is not known; allowed: low, normal, high");
}

std::uint32_t parse_max_hits(const std::string& text) {
  const std::uint64_t count = parse_count(text, 1);
  if (count > 0xffffffff) throw bad_use("--max-hits " + text + " is above 4294967295");
  return static_cast<std::uint32_t>(count);
}

}  // namespace

void declare_ask_options(CLI::App& app, AskOptions& options) {
  option(app, "--only GLOB", options.only, "Objects whose name matches this glob (* ? [..])");
  option(app, "--skip GLOB", options.skip, "Not objects whose name matches this glob");
  option(app, "--mask", options.mask, "Layers that may answer: bits, 0x3 or 0b11");
  read_option(app, "--max-hits N", options.max_hits, "Hits of one question; with more it is undecided (1000)",
              parse_max_hits);
  option(app, "--within", Measure::length, options.error_m, "Error that is good enough: 1um (0: exact on doubt)");
  option(app, "--deadline", options.deadline, "Answers later than this are undecided: 200us");
  declare_importance(app, options.importance);
  declare_instant(app, options.as_of,
                  "All objects at one instant: settled, -2s (before now), 2026-11-22T12:03:10.5Z (latest: each at its "
                  "newest pose)");
  app.add_flag("--fresh", options.fresh, "Answer after this connection's own last write");
}

void declare_importance(CLI::App& app, Importance& importance) {
  read_option(app, "--importance LEVEL", importance, "low: refused first by an overloaded server; high: never (normal)",
              parse_importance);
}

void declare_instant(CLI::App& app, Instant& instant, std::string meaning) {
  read_option(app, "--as-of TIME", instant, std::move(meaning), parse_instant);
}

void declare_mesh_reading(CLI::App& app, MeshReading& reading) {
  option(app, "--unit UNIT", reading.unit, "Of the file of a mesh or hull: mm, in, ... or metres a unit");
  option(app, "--up AXIS", reading.up, "Axis of that file that points up: y or z")->check(CLI::IsMember({"y", "z"}));
}

Instant parse_instant(const std::string& text) {
  if (text.empty() || text == "latest") return {};
  if (text == "settled") return {.kind = Instant::Kind::settled};
  constexpr const char* kInstants = "latest, settled, -2s, 2026-11-22T12:03:10.5Z or seconds since 1970";
  const RunTime time = parse_time("--as-of", text, kInstants);
  if (time.since == RunTime::Since::begin) throw bad_use("--as-of " + text + " is no instant", kInstants);
  if (time.since == RunTime::Since::end) return {.kind = Instant::Kind::back, .time = -time.offset};
  return {.kind = Instant::Kind::at, .time = time.offset};
}

void hint_at_unknown_names(Session& session, const Globals& globals, std::string_view option, const std::string& glob) {
  if (glob.empty() || globals.quiet || !globals.shards.empty()) return;
  try {
    const nlohmann::json listed =
        server_command(session, globals, wire_contract::command::kList, {{"name", glob}, {"limit", 0}});
    if (count_of(listed, "count") > 0) return;
  } catch (const Failure&) {
    return;  // the question is answered; only the hint is missing
  }
  print_hint(session.io, globals, fmt::format("no object's name matches {}'{}'", option, printable(glob)));
}

}  // namespace collided::cli
