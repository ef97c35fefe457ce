#include "client/library/connection/connection.hpp"

#include <algorithm>
#include <random>
#include <utility>

#include "client/library/connection/errors.hpp"
#include "client/library/connection/greeting_turn.hpp"
#include "client/library/connection/local_process.hpp"
#include "client/library/connection/route.hpp"
#include "idl/peers.hpp"
#include "idl/presence.hpp"

namespace collided::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

// A reply written before this reader is matched is lost. Therefore hello is repeated until a reply arrives: at each new
// match, which may make it succeed, and periodically, for a server that starts meanwhile. The period grows, since DDS
// retransmits what a busy server's machine dropped, including all earlier hellos.
constexpr milliseconds kFirstHelloPeriod{20};
constexpr milliseconds kLastHelloPeriod{640};
// Period of polling for a match with the server's reader. It grows, since fifty clients that poll every millisecond
// take the processor time that the server needs to answer them.
constexpr milliseconds kFirstMatchPeriod{1};
constexpr milliseconds kLastMatchPeriod{20};
constexpr milliseconds kSoon{100};
// Extra time for a server on this machine, from when the machine was last seen overloaded.
constexpr milliseconds kAfterCrowd{2'000};
// Factor on the wait for a server if one of that namespace is known to run.
constexpr int kCrowdPatience = 30;
// Period at which a request checks whether a silent server still runs.
constexpr milliseconds kLookPeriod{20};

std::string server_words(const ConnectOptions& options) {
  return "domain " + std::to_string(options.domain) + ", namespace '" + options.name_space + '\'';
}

}  // namespace

std::uint64_t random_number() {
  std::random_device device;
  std::uint64_t number = 0;
  while (number == 0) { number = (std::uint64_t{device()} << 32) | device(); }
  return number;
}

Connection::Connection(const ConnectOptions& options, std::shared_ptr<dds::Participant> participant, bool is_beside)
    : options_(options),
      participant_(std::move(participant)),
      is_beside_(is_beside),
      client_(random_number()),
      requests_(client_,
                [this](const dds::Sample<wire::Reply>& reply) {
                  const bool is_past = reply->epoch < pulse_.epoch();
                  return !known_server_.is_known() ||
                         (!is_past && is_from_server(reply_reader_, reply.info(), reply->server));
                }),
      route_(options.replicas && !is_beside ? make_route(*this) : nullptr),
      reply_topic_(*participant_, options.name_space),
      status_topic_(*participant_, options.name_space),
      reply_reader_(reply_topic_, {.data = [this](dds::Taker<wire::Reply> taker) { requests_.take_replies(taker); },
                                   .partition = wire_contract::reply_partition(client_)}),
      status_reader_(status_topic_, {.data = [this](dds::Taker<wire::Status> taker) { hear_status(taker); }}),
      query_writers_(*participant_, options.name_space, options.keys) {}

Connection::~Connection() = default;

void Connection::hear_status(const dds::Taker<wire::Status>& taker) {
  while (taker.take(incoming_status_)) {
    if (!incoming_status_.info().valid_data) continue;
    if (!known_server_.is_known()) keep_until_greeted(incoming_status_);
    else if (is_from_server_or_its_heir(incoming_status_)) pulse_.hear(incoming_status_);
  }
  if (!route_ || route_->has_company() || !known_server_.is_known()) return;
  try {
    if (status_reader_.matched_writers() > 1) route_->note_company();
  } catch (const dds::DdsError&) {}  // the reader is being deleted
}

/// Keeps statuses until a reply to hello shows which one is the server's.
void Connection::keep_until_greeted(dds::Sample<wire::Status>& status) {
  constexpr std::size_t kMostWriters = 8;
  const std::lock_guard lock(early_mutex_);
  const std::uint64_t writer = status.info().publication_handle;
  if (early_.size() < kMostWriters || early_.contains(writer)) std::swap(early_[writer], status);
}

/// The sender of this reply to hello is the server: its earlier status counts, those of others do not.
void Connection::know_server_by(const dds::Sample<wire::Reply>& reply) {
  EarlyStatuses early;
  {
    const std::lock_guard lock(early_mutex_);
    early.swap(early_);
  }
  pulse_.greeted(reply->server, reply->epoch);
  const std::uint64_t server = dds::participant_of(reply_reader_.get(), reply.info().publication_handle);
  for (auto& [writer, status] : early) {
    if (dds::participant_of(status_reader_.get(), writer) == server) pulse_.hear(status);
  }
  known_server_.greeted(reply_reader_.get(), reply.info().publication_handle);
}

Result<std::shared_ptr<Connection>> Connection::open(const ConnectOptions& options, dds::Role role) {
  const Clock::time_point began = Clock::now();
  const GreetingTurn turn(options);
  const nanoseconds wait = std::max(options.wait, nanoseconds(0));
  const Clock::time_point deadline = (options.wait_is_limit ? began : Clock::now()) + wait;
  try {
    const std::shared_ptr<Connection> connection(new Connection(options, join_domain(options, role)));
    // On an overloaded machine, a running server may need longer to answer than a user wants to wait for a missing one.
    constexpr milliseconds kFoundPatience{10'000};
    const Clock::time_point deadline_if_found =
        options.wait_is_limit ? deadline : std::max(deadline, Clock::now() + kFoundPatience);
    if (!connection->greet(deadline, deadline_if_found, QueryRight::greet)) {
      return connection->no_server(Clock::now() - began);
    }
    return connection;
  } catch (const std::invalid_argument& wrong) { return bad_input(wrong.what()); } catch (const dds::KeysError& wrong) {
    return bad_input(wrong.what());
  } catch (const dds::NotAllowedError& refused) { return failure_of(refused); } catch (const dds::DdsError& failed) {
    return Error{ErrorCode::internal, failed.what(), "is '" + options.interface + "' an interface of this machine?"};
  }
}

std::shared_ptr<Connection> Connection::open_beside(const Connection& primary, const std::string& name_space,
                                                    nanoseconds wait) {
  ConnectOptions options = primary.options_;
  options.name_space = name_space;
  const std::shared_ptr<Connection> connection(new Connection(options, primary.participant_, true));
  const Clock::time_point deadline = Clock::now() + wait;
  return connection->greet(deadline, deadline, QueryRight::greet) ? connection : nullptr;
}

namespace {

/// The deadline for a server's answer on an overloaded machine: time in which the server hardly gets a processor does
/// not count.
class CrowdPatience {
 public:
  /// is_plain  reception of a running server is certain: no keys, and no DDS configuration of its own
  CrowdPatience(const ConnectOptions& options, bool is_plain, nanoseconds wait)
      : options_(options), is_plain_(is_plain), wait_(wait) {}

  Clock::time_point deadline(Clock::time_point began, Clock::time_point deadline_if_found) const {
    if (!is_machine_crowded()) return began;
    const bool is_here =
        is_plain_ && wire_contract::is_present_here(options_.domain, options_.name_space, options_.interface);
    if (!is_here) return std::min({Clock::now() + kFirstHelloPeriod, began + 3 * wait_, deadline_if_found});
    // After an overload DDS still has messages to retransmit.
    return std::min(began + kCrowdPatience * wait_, std::max(deadline_if_found, Clock::now() + kAfterCrowd));
  }

 private:
  const ConnectOptions& options_;
  bool is_plain_;
  nanoseconds wait_;
};

}  // namespace

bool Connection::greet(Clock::time_point deadline, Clock::time_point deadline_if_found, QueryRight right) {
  const std::unique_ptr<Requests::Running> hello = requests_.begin();
  if (!hello) { return false; }
  wire::Query& query = hello->query();
  query = {};
  query.request = hello->number();
  query.chunk_count = 1;
  query.kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::hello);
  const bool is_plain = options_.keys.empty() && !participant_->configured_by_environment();
  const CrowdPatience crowd(options_, is_plain, deadline - Clock::now());
  std::uint32_t matched = 0;
  milliseconds match_period = kFirstMatchPeriod;
  milliseconds hello_period = kFirstHelloPeriod;
  const Clock::time_point began = Clock::now();
  Clock::time_point next_hello = began;
  Clock::time_point next_look = began;
  do {
    const std::uint32_t matched_now = query_writers_.matched_readers() + reply_reader_.matched_writers();
    if (matched_now > 0) { deadline = deadline_if_found; }
    if (matched_now != std::exchange(matched, matched_now) || Clock::now() >= next_hello) {
      if (send(query, right)) { return false; }
      next_hello = Clock::now() + hello_period;
      hello_period = std::min(2 * hello_period, kLastHelloPeriod);
    }
    if (!is_beside_ && !options_.wait_is_limit && Clock::now() >= next_look) {
      next_look = Clock::now() + kFirstHelloPeriod;
      deadline = std::max(deadline, crowd.deadline(began, deadline_if_found));
    }
    const auto& replies = hello->wait(std::min(deadline, Clock::now() + match_period));
    if (!replies.empty()) {
      const std::uint64_t server = (**replies.front()).server;
      know_server_by(*replies.front());
      // If two servers answered, the first one counts.
      for (const auto& reply : replies)
        static_cast<void>(is_from_server(reply_reader_, reply->info(), (*reply)->server));
      greeted_server_[query_writers_.place_of(right)].store(server, std::memory_order_release);
      return true;
    }
    if (Clock::now() - began > kSoon) match_period = std::min(2 * match_period, kLastMatchPeriod);
  } while (Clock::now() < deadline);
  return false;
}

Error Connection::no_server(nanoseconds waited) {
  const std::size_t seen = participant_->others_seen();
  std::string hint = "seen on this domain: " + std::to_string(seen) + (seen == 1 ? " participant" : " participants") +
                     (seen > 0 ? ", none of ours" : "") + "; start a server with 'collided'";
  if (!options_.keys.empty()) { hint += "; with keys only a server of the same authority is seen"; }
  if (participant_->configured_by_environment()) { hint += "; CYCLONEDDS_URI is set and was used as it is"; }
  if (query_writers_.matched_readers() > 0)
    hint = "a server is seen there and has not answered: it has just died, or this machine has more to do than it can";
  else if (wire_contract::is_present_here(options_.domain, options_.name_space))
    hint =
        "a server of that namespace runs on this machine and was not heard: it may have another --interface, keys or a "
        "configuration of DDS of its own, or this machine has more to do than it can";
  // Waits longer than requested only if a server may exist; the message then states the time.
  const nanoseconds most = std::max(options_.wait, nanoseconds(0));
  const bool is_longer = waited > most + kSoon;
  return {ErrorCode::no_server,
          "no collided answered in " + words(is_longer ? floor<milliseconds>(waited) : options_.wait) + " on " +
              server_words(options_),
          hint};
}

Error Connection::disconnected() const {
  return {
      ErrorCode::disconnected,
      "the server on " + server_words(options_) + " has been silent for " + words(Clock::now() - pulse_.last_heard()),
      "it has stopped, hangs or is cut off; the connection resumes by itself when it is back"};
}

/// True if the server is silent and not merely starved: on an overloaded machine its messages may be late, and so may
/// their reception. A silent server on another machine counts as gone, and so does a replica, since another server can
/// be asked.
bool Connection::is_gone() const {
  if (!pulse_.silent()) return false;
  if (is_beside_) return true;
  if (options_.interface != "lo" || Clock::now() - pulse_.last_heard() >= nanoseconds(wire_contract::kForgottenNs))
    return true;
  // Before its first status the server's process number is unknown.
  return pulse_.pid() == 0 ? !is_machine_crowded() : !runs_here(pulse_.pid(), "collided");
}

bool Connection::is_from_server(const dds::ReaderBase& reader, const dds_sample_info_t& info, std::uint64_t server) {
  const KnownServer::Origin origin =
      known_server_.origin_of(reader.get(), info.publication_handle, pulse_.may_have_heir());
  // A process may run several servers in succession.
  if (origin == KnownServer::Origin::server && server == pulse_.server()) pulse_.hear_message();
  return origin != KnownServer::Origin::stranger;
}

bool Connection::is_from_server(const dds::ReaderBase& reader, const dds_sample_info_t& info, std::uint64_t server,
                                std::uint64_t epoch) {
  const bool is_heirs = server != pulse_.server() && epoch > pulse_.epoch() && pulse_.may_have_heir();
  if (known_server_.is_known() && is_heirs) {
    pulse_.greeted(server, epoch);
    known_server_.greeted(reader.get(), info.publication_handle);
  }
  return is_from_server(reader, info, server);
}

/// A server that publishes while the known one is silent has replaced it.
bool Connection::is_from_server_or_its_heir(const dds::Sample<wire::Status>& status) {
  const dds_sample_info_t& info = status.info();
  if (pulse_.is_heir(*status)) known_server_.greeted(status_reader_.get(), info.publication_handle);
  return is_from_server(status_reader_, info, status->server);
}

std::optional<Error> Connection::ready(Clock::time_point deadline, QueryRight right) {
  const std::atomic<std::uint64_t>& greeted = greeted_server_[query_writers_.place_of(right)];
  const std::uint64_t server = pulse_.server();
  if (is_gone()) { return disconnected(); }
  if (server == greeted.load(std::memory_order_acquire)) { return std::nullopt; }
  const std::lock_guard lock(greeting_mutex_);
  if (pulse_.server() == greeted.load(std::memory_order_acquire)) { return std::nullopt; }
  if (auto error = query_writers_.open(right)) { return error; }
  if (is_beside_) deadline = std::min(deadline, Clock::now() + nanoseconds(wire_contract::kStatusLostNs));
  if (greet(deadline, deadline, right)) { return std::nullopt; }
  return disconnected();
}

std::optional<Error> Connection::send(wire::Query& query, QueryRight right) {
  query.client = client_;
  return query_writers_.write(query, right);
}

Connection::Waited Connection::wait(Requests::Running& request, Clock::time_point deadline, std::uint64_t server,
                                    const std::string& what) {
  const nanoseconds lost(wire_contract::kStatusLostNs);
  while (true) {
    const Clock::time_point look = std::max(pulse_.last_heard() + lost, Clock::now() + kLookPeriod);
    const auto& replies = request.wait(std::min(deadline, look));
    if (!replies.empty()) return {&replies};
    if (pulse_.server() != server) {
      return {.error = Error{ErrorCode::disconnected, what + ": the server was replaced by another one meanwhile",
                             "ask again; the new server is connected already"}};
    }
    if (Clock::now() >= deadline) {
      return {.error = Error{
                  ErrorCode::timeout,
                  what + ": no answer in time; the server " + (pulse_.is_busy() ? "is busy with a long step" : "lives"),
                  "a longer timeout, fewer questions or a deadline may help"}};
    }
    if (is_gone()) { return {.error = disconnected()}; }
  }
}

WriteBarrier Connection::last_write() const {
  const std::lock_guard lock(barrier_mutex_);
  return last_write_;
}

void Connection::note_write(const WriteBarrier& barrier) {
  const std::lock_guard lock(barrier_mutex_);
  last_write_ = barrier;
}

}  // namespace collided::client
