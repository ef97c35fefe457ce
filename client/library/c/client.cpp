#include <algorithm>
#include <iterator>

#include "client/library/c/event_fields.hpp"
#include "client/library/c/options.hpp"
#include "client/library/connection/described_status.hpp"

using namespace collided;
using namespace collided::c;

namespace collided {

template <>
inline constexpr const char* kWordsOf<RunTime::Since>[] = {"1970", "begin", "end"};
constexpr auto fields_of(const RunTime*) { return fields<&RunTime::since, &RunTime::offset>(); }
constexpr auto fields_of(const RecordedEventsOptions*) {
  using T = RecordedEventsOptions;
  return fields<&T::only, &T::skip, &T::from, &T::to>();
}

namespace c {

struct ReadRecording : RecordedEventsOptions {
  std::string path;
};
constexpr auto fields_of(const ReadRecording*) {
  return listed(fields<&ReadRecording::path>(), fields_of(static_cast<const RecordedEventsOptions*>(nullptr)));
}

/// The options of collided_connect, and those of one function beside them.
template <class Own>
struct Connecting : ConnectOptions, Own {};

struct NoMore {};
constexpr auto fields_of(const NoMore*) { return std::tuple<>(); }

struct ReplayWords {
  std::string path;
  double rate = ReplayOptions{}.rate;
  bool ask = false;
  std::optional<RunTime> from, to;
};
constexpr auto fields_of(const ReplayWords*) {
  using T = ReplayWords;
  return fields<&T::path, &T::rate, &T::ask, &T::from, &T::to>();
}

struct FetchWords {
  std::chrono::nanoseconds last{0};
  std::string path;
};
constexpr auto fields_of(const FetchWords*) { return fields<&FetchWords::last, &FetchWords::path>(); }

template <class Own>
constexpr auto fields_of(const Connecting<Own>*) {
  return listed(fields_of(static_cast<const ConnectOptions*>(nullptr)), fields_of(static_cast<const Own*>(nullptr)));
}

struct Findings {
  std::vector<Finding> findings;
};
constexpr auto fields_of(const Findings*) { return fields<&Findings::findings>(); }

struct Fetched {
  std::uint64_t bytes = 0;
};
constexpr auto fields_of(const Fetched*) { return fields<&Fetched::bytes>(); }

}  // namespace c
}  // namespace collided

namespace {

/// Returns the status with its times also in nanoseconds, since members in seconds lack digits.
Result<void> hand_out_status(Client& client, char** answer) {
  const Result<ServerStatus> status = client.status();
  if (!status) return status.error();
  nlohmann::json json = json_of(*status);
  json["world_time_ns"] = status->world_time.count();
  json["step_lasting_ns"] = status->step_lasting.count();
  json["age_ns"] = status->age.count();
  for (std::size_t i = 0; i < status->publishers.size(); ++i)
    json["publishers"][i]["silent_ns"] = status->publishers[i].silent.count();
  return hand_out(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), answer);
}

/// Gives the caller the answer of a function, or passes on its error.
template <class Answer>
Result<void> hand_out_result(const Result<Answer>& said, char** answer) {
  return said ? hand_out_json(*said, answer) : Result<void>(said.error());
}

/// The options of a function, without any of collided_connect from the environment, as collided_connect has it.
template <class Own>
Result<Connecting<Own>> connecting(const char* arguments, const std::string& name) {
  Result<Connecting<Own>> given = options_of<Connecting<Own>>(arguments, name);
  if (!given) return given;
  const nlohmann::json json = nlohmann::json::parse(text(arguments), nullptr, false);
  bool is_chosen = false;
  visit_fields<ConnectOptions>([&](const auto& field) { is_chosen |= json.is_object() && json.contains(field.name); });
  if (is_chosen) return given;
  const Result<ConnectOptions> found = ConnectOptions::from_environment();
  if (!found) return found.error();
  static_cast<ConnectOptions&>(*given) = *found;
  return given;
}

Result<void> diagnose_for(const char* arguments, char** answer) {
  const auto given = connecting<NoMore>(arguments, "diagnose");
  return given ? hand_out_json(Findings{diagnose(*given)}, answer) : Result<void>(given.error());
}

Result<void> fleet_for(const char* arguments, char** answer) {
  const auto given = connecting<NoMore>(arguments, "fleet");
  return given ? hand_out_result(fleet(*given), answer) : Result<void>(given.error());
}

Result<void> replay_for(const char* arguments, char** answer) {
  const auto given = connecting<ReplayWords>(arguments, "replay");
  if (!given) return given.error();
  const ReplayOptions how{
      .path = given->path, .rate = given->rate, .ask = given->ask, .from = given->from, .to = given->to};
  return hand_out_result(replay(*given, how), answer);
}

Result<void> fetch_for(const char* arguments, char** answer) {
  const auto given = connecting<FetchWords>(arguments, "fetch_recording");
  if (!given) return given.error();
  const Result<std::uint64_t> bytes = fetch_recording(*given, given->last, given->path);
  return bytes ? hand_out_json(Fetched{*bytes}, answer) : Result<void>(bytes.error());
}

template <auto kRead>
Result<void> read_for(const char* arguments, char** answer) {
  const Result<ReadRecording> given = options_of<ReadRecording>(arguments, "recorded events");
  return given ? hand_out_result(kRead(given->path, *given), answer) : Result<void>(given.error());
}

struct LibraryCall {
  std::string_view name;
  Result<void> (*carry_out)(const char* arguments, char** answer);
};
constexpr LibraryCall kLibraryCalls[] = {
    {"diagnose", diagnose_for},
    {"fleet", fleet_for},
    {"replay", replay_for},
    {"fetch_recording", fetch_for},
    {"recorded_events", read_for<recorded_events>},
    {"recorded_standing", read_for<recorded_standing_events>},
};

}  // namespace

extern "C" {

int collided_connect(const char* options, collided_client** client, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    *client = nullptr;
    const Result<ConnectOptions> made =
        text(options).empty() ? ConnectOptions::from_environment() : options_of<ConnectOptions>(options, "connect");
    if (!made) return made.error();
    Result<Client> connected = Client::connect(*made);
    if (!connected) return connected.error();
    *client = new collided_client{std::move(*connected)};
    return {};
  });
}

void collided_close(collided_client* client) { delete client; }

int collided_command(collided_client* client, const char* name, const char* arguments, const collided_part* parts,
                     size_t part_count, int64_t timeout_ns, char** answer, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!client) return missing("client");
    if (answer) *answer = nullptr;
    if (text(name) == "status") return hand_out_status(client->client, answer);
    const Result<Shape> shape = shape_of(parts, part_count);
    if (!shape) return shape.error();
    const std::chrono::nanoseconds timeout(timeout_ns != 0 ? timeout_ns : 10'000'000'000);
    const Result<std::string> said = client->client.command(text(name), text(arguments), *shape, timeout);
    if (!said) return said.error();
    return hand_out(*said, answer);
  });
}

int collided_library(const char* name, const char* arguments, char** answer, collided_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (answer) *answer = nullptr;
    const std::string wanted = text(name);
    const auto found = std::ranges::find(kLibraryCalls, std::string_view(wanted), &LibraryCall::name);
    if (found != std::end(kLibraryCalls)) return found->carry_out(arguments, answer);
    std::string known;
    for (const LibraryCall& call : kLibraryCalls) known += (known.empty() ? "" : ", ") + std::string(call.name);
    return Error{ErrorCode::bad_input, "the library has no function '" + wanted + "'; known are " + known,
                 "nothing was done"};
  });
}

}  // extern "C"
