#include "client/cli/verbs/ask_options.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/input/number.hpp"
#include "client/cli/input/time_text.hpp"
#include "client/cli/server_command.hpp"
#include "idl/commands.hpp"

namespace collided::cli {

void declare_ask_options(CLI::App& app, AskTexts& texts) {
  app.add_option("--only", texts.only, "Objects whose name matches this glob (* ? [..])");
  app.add_option("--skip", texts.skip, "Not objects whose name matches this glob");
  app.add_option("--mask", texts.mask, "Layers that may answer: bits, 0x3 or 0b11");
  app.add_option("--max-hits", texts.max_hits, "Hits of one question; with more it is undecided (1000)");
  app.add_option("--within", texts.within, "Error that is good enough: 1um (0: exact on doubt)");
  app.add_option("--deadline", texts.deadline, "Answers later than this are undecided: 200us");
  app.add_option("--importance", texts.importance, "low: refused first by an overloaded server; high: never (normal)");
  app.add_option("--as-of", texts.as_of,
                 "All objects at one instant: settled, -2s (before now), 2026-11-22T12:03:10.5Z (latest: each at its "
                 "newest pose)");
  app.add_flag("--fresh", texts.fresh, "Answer after this connection's own last write");
}

void declare_mesh_reading(CLI::App& app, MeshReading& reading) {
  app.add_option("--unit", reading.unit, "Of the file of a mesh or hull: mm, in, ... or metres a unit");
  app.add_option("--up", reading.up, "Axis of that file that points up: y or z")->check(CLI::IsMember({"y", "z"}));
}

Importance parse_importance(const std::string& text) {
  if (text.empty() || text == "normal") return Importance::normal;
  if (text == "low") return Importance::low;
  if (text == "high") return Importance::high;
  throw bad_use("--importance " + text + " is not known; allowed: low, normal, high");
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

AskOptions ask_options_of(const AskTexts& texts, const Globals& globals) {
  AskOptions options;
  options.only = texts.only;
  options.skip = texts.skip;
  if (!texts.mask.empty()) options.mask = parse_bits(texts.mask);
  if (!texts.max_hits.empty()) {
    const std::uint64_t count = parse_count(texts.max_hits, 1);
    if (count > 0xffffffff) throw bad_use("--max-hits " + texts.max_hits + " is above 4294967295");
    options.max_hits = static_cast<std::uint32_t>(count);
  }
  if (!texts.within.empty()) options.error_m = parse_finite(texts.within, Measure::length);
  if (options.error_m < 0) throw bad_use("--within " + texts.within + " is below 0");
  if (!texts.deadline.empty()) options.deadline = parse_duration(texts.deadline);
  options.timeout = timeout_of(globals);
  options.fresh = texts.fresh;
  options.as_of = parse_instant(texts.as_of);
  options.importance = parse_importance(texts.importance);
  return options;
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
