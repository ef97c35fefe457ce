#include "client/cli/verbs/recorded_explanation.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include <collided/recording.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "client/cli/command.hpp"
#include "client/cli/input/time_text.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/progress.hpp"
#include "client/cli/server_aside.hpp"
#include "client/cli/server_command.hpp"
#include "client/cli/verbs/recorded_standing.hpp"
#include "client/cli/verbs/undo.hpp"
#include "idl/answers/explanation.hpp"
#include "idl/commands.hpp"
#include "idl/glob.hpp"
#include "idl/instant.hpp"

namespace collided::cli {
namespace {

using std::chrono::nanoseconds;

/// An instant is certain once all publishers have reported a later one.
constexpr std::chrono::milliseconds kAfter{500};
/// Poses from before the interval are applied at its beginning: the question concerns a later part.
constexpr std::chrono::seconds kBefore{1};
/// Interval before an event, so that the moving objects have a path.
constexpr std::chrono::seconds kBeforeEvent{2};

void shift_times(nlohmann::json& answer, nanoseconds back) {
  // Members with a time in the world; others that end in _ns are durations.
  constexpr std::array<std::string_view, 10> kTimes{"time_ns",        "from_ns",     "to_ns",    "low_ns",
                                                    "high_ns",        "began_ns",    "since_ns", "world_time_ns",
                                                    "motion_from_ns", "motion_to_ns"};
  if (answer.is_object()) {
    for (const auto& [key, value] : answer.items()) {
      const bool is_time = std::find(kTimes.begin(), kTimes.end(), key) != kTimes.end();
      if (is_time && value.is_number_integer() && value.get<std::int64_t>() != 0)
        value = value.get<std::int64_t>() - back.count();
    }
  }
  if (answer.is_structured()) {
    for (nlohmann::json& member : answer) shift_times(member, back);
  }
}

/// The interval of a recording to replay, since 1970.
struct ReplayedSpan {
  nanoseconds from{0};
  nanoseconds to{0};
};

/// A recording's world in a server of this program's own.
class RecordedServer {
 public:
  /// recorded  the recording's span and its scenes
  RecordedServer(Session& session, const Globals& globals, const RecordedWorld& world, const RecordedEvents& recorded)
      : outer_(session),
        outer_globals_(globals),
        world_(world),
        server_(session, globals, "explain", words(world, recorded)) {
    if (!world.scenes.empty() || !recorded.scenes.empty()) return;
    for (const std::string& scene : take(client().status()).scenes)
      server_command(server_.session(), server_.globals(), wire_contract::command::kClear, {{"scene", scene}});
  }

  Client& client() { return server_.session().client(server_.globals()); }

  /// Replays an interval and asks at its end; returns the answer in the recording's time.
  ///
  /// ask  receives how far the replay's times are behind the recording's
  nlohmann::json answer_after(const ReplayedSpan& stretch,
                              const std::function<nlohmann::json(Session&, const Globals&, nanoseconds shift)>& ask) {
    nlohmann::json answer;
    std::exception_ptr failed;
    ReplayOptions options{.path = world_.path};
    options.from = RunTime{.offset = stretch.from};
    options.to = RunTime{.offset = stretch.to};
    options.at_end = [&](nanoseconds shift) {
      try {
        answer = ask(server_.session(), server_.globals(), shift);
        shift_times(answer, shift);
      } catch (...) { failed = std::current_exception(); }
    };
    Progress progress(outer_.io, outer_globals_);
    const auto begun = std::chrono::steady_clock::now();
    const std::chrono::duration<double> whole = stretch.to - stretch.from;
    options.go_on = [&] {
      const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - begun;
      progress.show(0, "replaying", std::min(1.0, gone / whole));
      return !stop_requested.load();
    };
    const ReplayReport report = take(replay(connect_options(outer_.io, server_.globals()), options));
    progress.clear();
    for (const std::string& warning : report.warnings)
      print_hint(outer_.io, outer_globals_, "warning: " + printable(warning));
    if (failed) std::rethrow_exception(failed);
    if (report.stopped) throw Failure(Exit::interrupted, "");
    answer["version"] = 0;  // that of the replayed world is meaningless for the recorded one
    return answer;
  }

 private:
  static std::vector<std::string> words(const RecordedWorld& world, const RecordedEvents& recorded) {
    std::vector<std::string> words{"--flight-recorder", "off"};
    for (const std::string& scene : world.scenes) words.push_back(std::filesystem::absolute(scene).string());
    const bool is_embedded = recorded.scenes.empty() || recorded.scenes == std::vector<std::string>{"warehouse"};
    if (world.scenes.empty() && !is_embedded) {
      throw bad_use(fmt::format("{}: its server had loaded {}", printable(world.path),
                                printable(fmt::format("{}", fmt::join(recorded.scenes, ", ")))),
                    "a recording holds no scenes; --scene FILE names the file of each");
    }
    return words;
  }

  Session& outer_;
  const Globals& outer_globals_;
  const RecordedWorld& world_;
  ServerAside server_;
};

RecordedEvents read(Session& session, const Globals& globals, const RecordedWorld& world) {
  RecordedEvents recorded = take(recorded_events(world.path));
  for (const std::string& warning : recorded.warnings)
    print_hint(session.io, globals, "warning: " + printable(warning));
  return recorded;
}

nanoseconds instant_of(const RecordedWorld& world, const RecordedEvents& recorded) {
  if (world.as_of.empty()) return recorded.end;
  constexpr const char* kTimes =
      "2026-11-22T12:03:10.5Z, seconds since 1970, +2s after the begin or -2s before the end";
  const RunTime time = parse_time("--as-of", world.as_of, kTimes);
  nanoseconds instant = time.offset;
  if (time.since == RunTime::Since::begin) instant += recorded.begin;
  if (time.since == RunTime::Since::end) instant += recorded.end;
  if (instant < recorded.begin || instant > recorded.end) {
    throw bad_use(fmt::format("--as-of {} is not in {}", world.as_of, printable(world.path)),
                  fmt::format("it was recorded from {} to {}", clock_text(recorded.begin), clock_text(recorded.end)));
  }
  return instant;
}

ReplayedSpan stretch_about(nanoseconds low, nanoseconds high, nanoseconds lead, const RecordedEvents& recorded) {
  return {.from = std::max(recorded.begin, low - lead - kBefore), .to = std::min(recorded.end, high + kAfter)};
}

Event recorded_event(const RecordedWorld& world, const RecordedEvents& recorded, std::uint64_t sequence) {
  const auto is_it = [&](const Event& event) { return event.kind != EventKind::open && event.sequence == sequence; };
  // Of several runs of a server the last one counts.
  const auto found = std::find_if(recorded.events.rbegin(), recorded.events.rend(), is_it);
  if (found == recorded.events.rend()) {
    throw Failure(Exit::no, fmt::format("no event {} of contacts in {}", sequence, printable(world.path)),
                  fmt::format("collide events {} lists those that it has", shell_word(world.path)));
  }
  return *found;
}

/// The replay's event that matches the recorded one: of the same two, and nearest in time.
std::optional<Event> same_event(Watch& watch, const Event& recorded, nanoseconds shift) {
  constexpr std::chrono::seconds kPatience{2};
  constexpr std::chrono::milliseconds kQuiet{300};
  constexpr std::chrono::seconds kMostApart{1};
  std::optional<Event> best;
  const auto apart = [&](const Event& event) { return std::chrono::abs(happened(event) - shift - happened(recorded)); };
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < end) {
    const std::optional<Event> event = watch.next(kQuiet);
    if (!event && best) break;
    if (!event || event->kind != recorded.kind) continue;
    if (std::minmax(event->a, event->b) != std::minmax(recorded.a, recorded.b)) continue;
    if (apart(*event) <= kMostApart && (!best || apart(*event) < apart(*best))) best = event;
  }
  return best;
}

/// Which of the two comes first depends on the server's numbers for them.
void swap_sides(nlohmann::json& answer) {
  std::swap(answer.at("a"), answer.at("b"));
  std::swap(answer.at("a_triangle"), answer.at("b_triangle"));
  for (nlohmann::json& number : answer.at("normal")) number = -number.get<double>();
  std::reverse(answer.at("bodies").begin(), answer.at("bodies").end());
}

}  // namespace

nlohmann::json explain_recorded(Session& session, const Globals& globals, const RecordedWorld& world,
                                nlohmann::json arguments, nanoseconds lead, const AskExplanation& ask) {
  const RecordedEvents recorded = read(session, globals, world);
  const nanoseconds instant = instant_of(world, recorded);
  RecordedServer server(session, globals, world, recorded);
  const auto ask_then = [&](Session& its_own, const Globals& its_globals, nanoseconds shift) {
    if (!world.as_of.empty()) {
      const auto at = wire_contract::AskedInstant::Kind::at;
      arguments["as_of"] = wire_contract::text_of({.kind = at, .ns = (instant + shift).count()});
    }
    return ask(its_own, its_globals, arguments);
  };
  return server.answer_after(stretch_about(instant, instant, lead, recorded), ask_then);
}

nlohmann::json explain_recorded_standing(Session& session, const Globals& globals, const RecordedWorld& world,
                                         nlohmann::json arguments, const AskExplanation& ask) {
  // For the nearest, the last of the others may be the one that was nearest then.
  constexpr std::uint64_t kMostOthers = 1'000;
  const std::uint64_t most = arguments.value("most", std::uint64_t{3});
  arguments["most"] = std::max(most, kMostOthers);
  const RecordedEvents recorded = read(session, globals, world);
  const nanoseconds instant = instant_of(world, recorded);
  RecordedServer server(session, globals, world, recorded);
  const auto ask_then = [&](Session& its_own, const Globals& its_globals, nanoseconds) {
    try {
      return ask(its_own, its_globals, arguments);
    } catch (const Failure& failed) {
      if (failed.code != Exit::refused) throw;
      throw Failure(failed.code, fmt::format("{}: {}", printable(world.path), failed.what()),
                    fmt::format("collide events {} --of standing lists what was reported; earlier versions did not "
                                "record which questions there were",
                                shell_word(world.path)));
    }
  };
  // Its reports are in the recording, so nothing needs to move again in time.
  const nlohmann::json answer = server.answer_after({.from = instant, .to = instant}, ask_then);
  auto explained = from_json<ExplainedStanding>(answer);
  put_recorded_news(explained, world.path, world.as_of.empty() ? nanoseconds::max() : instant, most);
  return json_of(explained);
}

nlohmann::json explain_recorded_event(Session& session, const Globals& globals, const RecordedWorld& world,
                                      std::uint64_t sequence, const AskExplanation& ask) {
  const RecordedEvents recorded = read(session, globals, world);
  const Event event = recorded_event(world, recorded, sequence);
  RecordedServer server(session, globals, world, recorded);
  Watch watch = take(server.client().watch({.only = wire_contract::glob_of(event.a)}));
  const auto ask_of_it = [&](Session& its_own, const Globals& its_globals, nanoseconds shift) {
    const std::optional<Event> again = same_event(watch, event, shift);
    if (!again) {
      throw Failure(Exit::undecided,
                    fmt::format("replaying {} did not bring event {} again", printable(world.path), sequence),
                    "the recording may lack what moved the two, or scenes (--scene)");
    }
    nlohmann::json answer = ask(its_own, its_globals, {{"event", again->sequence}});
    if (again->a != event.a) swap_sides(answer);
    answer["sequence"] = sequence;
    answer["episode"] = event.episode;
    return answer;
  };
  return server.answer_after(stretch_about(happened(event), happened(event), kBeforeEvent, recorded), ask_of_it);
}

}  // namespace collided::cli
