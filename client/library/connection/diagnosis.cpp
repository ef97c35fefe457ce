#include "collided/diagnosis.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>
#include <thread>

#include <nlohmann/json.hpp>

#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/connection.hpp"
#include "client/library/connection/errors.hpp"
#include "client/library/connection/machine_findings.hpp"
#include "idl/answers/figures.hpp"
#include "idl/clocks.hpp"
#include "idl/columns.hpp"
#include "idl/commands.hpp"

namespace collided {
namespace {

using client::Clock;
using client::Connection;
using client::words;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

nanoseconds rounded(nanoseconds time) {
  // Such a measurement has at most three significant digits.
  std::int64_t unit = 1;
  while (std::abs(time.count()) / unit >= 1'000) unit *= 10;
  return nanoseconds(time.count() / unit * unit);
}

/// The servers that send statuses on this namespace. It collects long enough for every server, however busy, to send
/// two.
class Servers {
 public:
  struct SeenServer {
    std::uint32_t pid = 0;
    std::string version;
    std::uint32_t heard = 0;
    nanoseconds step_lasting{0};                                      // as of the newest status
    std::int64_t skew_ns = std::numeric_limits<std::int64_t>::max();  // local minus remote clock, by the fastest status
  };

  explicit Servers(const Connection& connection)
      : topic_(connection.participant(), connection.options().name_space), reader_(topic_) {
    const Clock::time_point deadline = Clock::now() + nanoseconds(8 * wire_contract::kStatusPeriodNs);
    dds::WaitSet waitset(connection.participant());
    waitset.attach(reader_, 1);
    while (Clock::now() < deadline) {
      waitset.wait(std::max<std::int64_t>(0, nanoseconds(deadline - Clock::now()).count()));
      take();
    }
    // DDS may still deliver the last status of an ended server.
    std::erase_if(servers_, [](const auto& entry) { return entry.second.heard < 2; });
  }
  const std::map<std::uint64_t, SeenServer>& all() const { return servers_; }

 private:
  void take() {
    dds::Sample<wire::Status> status;
    while (reader_.take(status)) {
      if (!status.info().valid_data) continue;
      SeenServer& server = servers_[status->server];
      server.pid = status->pid;
      server.version = status->server_version;
      server.step_lasting = nanoseconds(wire::busy_ns(*status));
      // The first one may have been sent long before its receipt.
      if (++server.heard > 1)
        server.skew_ns = std::min(server.skew_ns, wire_contract::since_1970_ns() - status.info().source_timestamp);
    }
  }
  dds::Topic<wire::Status> topic_;
  dds::Reader<wire::Status> reader_;
  std::map<std::uint64_t, SeenServer> servers_;
};

Finding server_finding(const std::map<std::uint64_t, Servers::SeenServer>& servers, const ConnectOptions& options,
                       nanoseconds found_in) {
  if (servers.size() <= 1) {
    const std::string pid = servers.empty() ? "" : " (pid " + std::to_string(servers.begin()->second.pid) + ')';
    return {Health::ok, "server", "server found in " + words(rounded(found_in)) + pid, ""};
  }
  std::string pids;
  for (const auto& [number, server] : servers) pids += (pids.empty() ? "" : ", ") + std::to_string(server.pid);
  return {Health::fail, "server",
          std::to_string(servers.size()) + " servers share namespace '" + options.name_space + "' (pid " + pids +
              "): answers may differ",
          "stop all but one, or give each a --namespace of its own"};
}

Finding no_server_finding(const Error& error) {
  std::string remedy = error.hint;
  for (const std::string& server : client::servers_here()) remedy += "\non this machine: " + server;
  return {Health::fail, "server", error.message, remedy};
}

/// Reports a long step: questions are answered, but about the state before it.
std::optional<Finding> busy_finding(const std::map<std::uint64_t, Servers::SeenServer>& servers) {
  constexpr nanoseconds kLong = milliseconds(500);
  for (const auto& [number, server] : servers) {
    if (server.step_lasting < kLong) continue;
    return Finding{Health::warn, "busy",
                   "the server is busy: its step has lasted " + words(rounded(server.step_lasting)) +
                       ". It answers about the state before, and applies no poses meanwhile",
                   "collide top --steps 20 shows what takes long; fewer or simpler movers, or coarser meshes, help"};
  }
  return std::nullopt;
}

std::optional<Finding> clock_finding(const std::map<std::uint64_t, Servers::SeenServer>& servers) {
  if (servers.size() != 1 || servers.begin()->second.skew_ns == std::numeric_limits<std::int64_t>::max())
    return std::nullopt;
  constexpr nanoseconds kNoticed = milliseconds(20);  // ages and event times are shown to the millisecond
  const nanoseconds skew(servers.begin()->second.skew_ns);
  if (skew < kNoticed && skew > -kNoticed) {
    return Finding{Health::ok, "clock", "clock skew below " + words(rounded(std::max(skew, -skew))), ""};
  }
  return Finding{Health::warn, "clock",
                 "the server's clock is " + words(rounded(std::max(skew, -skew))) +
                     (skew < nanoseconds(0) ? " ahead" : " behind") + "; times and ages that it tells are off by that",
                 "let both machines follow one time server (chrony, systemd-timesyncd)"};
}

std::string tenths_of_ms(std::int64_t ns) {
  const std::int64_t tenths = (ns + 50'000) / 100'000;
  return std::to_string(tenths / 10) + '.' + std::to_string(tenths % 10) + " ms";
}

/// Compares the delays between stamp and receipt for batches of different publishers. Transport times differ little, so
/// a large difference means that clocks differ, or that a publisher sends old poses.
std::optional<Finding> publisher_clocks_finding(Connection& connection) {
  constexpr std::int64_t kNoticedNs = 5'000'000;
  constexpr const char* kFigures = wire_contract::command::kFigures;
  const Result<Figures> figures = client::read_answer<Figures>(
      client::command(connection, kFigures, nlohmann::json::object(), std::chrono::seconds(2)), kFigures);
  if (!figures || figures->clocks.size() < 2) return std::nullopt;
  const auto [ahead, behind] = std::ranges::minmax_element(figures->clocks, {}, &PublisherClock::behind_ns);
  const std::int64_t apart_ns = behind->behind_ns - ahead->behind_ns;
  if (apart_ns < kNoticedNs) {
    return Finding{Health::ok, "publisher_clocks",
                   "the stamps of " + std::to_string(figures->clocks.size()) + " publishers agree within " +
                       tenths_of_ms(apart_ns),
                   ""};
  }
  return Finding{Health::warn, "publisher_clocks",
                 "the stamps of '" + ahead->publisher + "' are " + tenths_of_ms(apart_ns) + " ahead of those of '" +
                     behind->publisher + "'; when their objects met is off by that",
                 "let both machines follow one time server (PTP, chrony), stamp poses with when they were taken, or "
                 "start collided with --clock-error " +
                     std::to_string(apart_ns / 1'000'000 + 1) + "ms"};
}

std::optional<Finding> version_finding(const std::map<std::uint64_t, Servers::SeenServer>& servers) {
  for (const auto& [number, server] : servers) {
    if (server.version == library_version()) continue;
    return Finding{Health::warn, "versions",
                   "the server is version " + server.version + ", this is " + std::string(library_version()),
                   "install the same version on both sides"};
  }
  return std::nullopt;
}

/// Times 1,000 empty questions, one after the other.
Finding round_trip_finding(Connection& connection) {
  constexpr std::size_t kTrips = 1'000, kMostLost = 3;
  std::vector<nanoseconds> times;
  std::size_t lost = 0;
  for (std::size_t i = 0; i < kTrips && lost < kMostLost; ++i) {
    const std::unique_ptr<client::Requests::Running> trip = connection.requests().begin();
    if (!trip) break;
    wire::Query& query = trip->query();
    query = {};
    query.request = trip->number();
    query.chunk_count = 1;
    query.kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::hello);
    const Clock::time_point start = Clock::now();
    const bool back =
        !connection.send(query, Connection::QueryRight::greet) && !trip->wait(start + std::chrono::seconds(1)).empty();
    if (back) times.push_back(Clock::now() - start);
    lost += back ? 0 : 1;
  }
  std::sort(times.begin(), times.end());
  const auto part = [&](std::size_t percent) { return words(rounded(times[times.size() * percent / 100])); };
  const std::string count = std::to_string(times.size()) + " of " + std::to_string(times.size() + lost) + " back";
  if (lost == 0 && !times.empty())
    return {Health::ok, "round_trip", "reliable round trip " + part(50) + ", p99 " + part(99) + "; " + count, ""};
  return {Health::fail, "round_trip", "reliable round trip: " + count + " within 1 s each",
          "is the server overloaded, or the network cut?"};
}

Finding losses_finding(std::uint64_t dropped) {
  if (dropped == 0) return {Health::ok, "losses", "no datagram dropped meanwhile", ""};
  return {Health::warn, "losses",
          std::to_string(dropped) + " datagrams dropped on this machine meanwhile, for full buffers",
          "larger receive buffers, fewer programs, or smaller batches"};
}

/// Statuses reveal a second server; this also reveals a process that only answers in the server's place.
std::optional<Finding> strangers_finding(const Strangers& strangers, std::size_t servers) {
  if (servers != 1 || !strangers.speak_now) return std::nullopt;
  return Finding{Health::warn, "strangers",
                 std::to_string(strangers.samples) +
                     " replies, events or statuses came from a process that is not the server; none was taken",
                 "see who is on the domain: anybody who reaches it can write there"};
}

void ask_server(Connection& connection, nanoseconds found_in, std::vector<Finding>& findings) {
  const std::optional<std::uint64_t> dropped_before = client::dropped_datagrams();
  const Servers servers(connection);
  findings.push_back(server_finding(servers.all(), connection.options(), found_in));
  if (auto finding = busy_finding(servers.all())) findings.push_back(*finding);
  if (auto finding = version_finding(servers.all())) findings.push_back(*finding);
  if (auto finding = clock_finding(servers.all())) findings.push_back(*finding);
  if (servers.all().size() == 1) {
    if (auto finding = publisher_clocks_finding(connection)) findings.push_back(*finding);
  }
  findings.push_back(round_trip_finding(connection));
  if (auto finding = strangers_finding(connection.strangers(), servers.all().size())) findings.push_back(*finding);
  const std::optional<std::uint64_t> dropped = client::dropped_datagrams();
  if (dropped && dropped_before) findings.push_back(losses_finding(*dropped - *dropped_before));
}

}  // namespace

std::vector<Finding> diagnose(const ConnectOptions& options) {
  std::vector<Finding> findings;
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  if (uri != nullptr && *uri != 0) {
    findings.push_back({Health::warn, "configuration",
                        "CYCLONEDDS_URI is set and used as it is; --interface and --peer are not",
                        "unset CYCLONEDDS_URI"});
  } else if (auto finding = client::interface_finding(options.interface)) {
    findings.push_back(*finding);
  }
  if (auto finding = client::buffer_finding()) findings.push_back(*finding);
  findings.push_back(client::places_finding(options.domain));
  const Clock::time_point start = Clock::now();
  const Result<std::shared_ptr<Connection>> connection = Connection::open(options);
  const nanoseconds found_in = Clock::now() - start;
  if (!connection) {
    findings.push_back(no_server_finding(connection.error()));
    return findings;
  }
  try {
    ask_server(**connection, found_in, findings);
  } catch (const dds::DdsError& failed) { findings.push_back({Health::fail, "server", failed.what(), ""}); }
  return findings;
}

}  // namespace collided
