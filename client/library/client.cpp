#include "client/library/asking/ask.hpp"
#include "client/library/asking/clearance.hpp"
#include "client/library/asking/pair.hpp"
#include "client/library/asking/what_if.hpp"
#include "client/library/commands/command.hpp"
#include "client/library/commands/geometry.hpp"
#include "client/library/commands/upload.hpp"
#include "client/library/connection/errors.hpp"
#include "client/library/connection/workers.hpp"
#include "client/library/publishing/publisher.hpp"
#include "client/library/watching/probes.hpp"
#include "client/library/watching/standing.hpp"
#include "client/library/watching/watch.hpp"
#include "collided/client.hpp"

namespace collided {

struct [[gnu::visibility("hidden")]] Client::State {
  std::shared_ptr<client::Connection> connection;
  client::Workers workers;  // destroyed first, since its tasks use the connection

  template <Question Q>
  std::future<Result<Answers>> ask_later(std::vector<Q> questions, AskOptions options) {
    // Shared, since a std::function must be copyable.
    auto promise = std::make_shared<std::promise<Result<Answers>>>();
    std::future<Result<Answers>> answers = promise->get_future();
    auto task = [this, promise, questions = std::move(questions), options = std::move(options)] {
      promise->set_value(client::ask(*connection, std::span<const Q>(questions), options));
    };
    if (!workers.run(std::move(task))) {
      promise->set_value(Error{ErrorCode::refused,
                               std::to_string(client::Workers::kMostWaiting) + " asynchronous requests wait already",
                               client::kNothingSent});
    }
    return answers;
  }
};

Client::Client(std::unique_ptr<State> state) : state_(std::move(state)) {}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;

Result<Client> Client::connect() {
  const Result<ConnectOptions> options = ConnectOptions::from_environment();
  if (!options) return options.error();
  return connect(*options);
}

Result<Client> Client::connect(const ConnectOptions& options) {
  Result<std::shared_ptr<client::Connection>> connection = client::Connection::open(options);
  if (!connection) { return connection.error(); }
  return over(std::move(*connection));
}

Client Client::over(std::shared_ptr<client::Connection> connection) {
  auto state = std::make_unique<State>();
  state->connection = std::move(connection);
  return Client(std::move(state));
}

template <Question Q>
Result<Answers> Client::ask_all(std::span<const Q> questions, const AskOptions& options, Answers&& earlier) {
  return client::ask(*state_->connection, questions, options, std::move(earlier));
}
template <Question Q>
std::future<Result<Answers>> Client::ask_async(std::vector<Q> questions, AskOptions options) {
  return state_->ask_later(std::move(questions), std::move(options));
}
#define COLLIDED_QUESTION(Q)                                                                  \
  template Result<Answers> Client::ask_all(std::span<const Q>, const AskOptions&, Answers&&); \
  template std::future<Result<Answers>> Client::ask_async(std::vector<Q>, AskOptions)
COLLIDED_QUESTION(RayQuestion);
COLLIDED_QUESTION(SphereQuestion);
COLLIDED_QUESTION(BoxQuestion);
COLLIDED_QUESTION(NearQuestion);
COLLIDED_QUESTION(InsideQuestion);
#undef COLLIDED_QUESTION

Result<Answers> Client::sweep(const Shape& shape, std::span<const SweepQuestion> motions, const AskOptions& options) {
  return client::sweep(*state_->connection, shape, motions, options);
}

Result<WhatIfAnswers> Client::what_if(const WhatIfConfigurations& configurations, const WhatIfOptions& options) {
  return client::what_if(*state_->connection, configurations, options);
}

Result<Watch> Client::watch(const WatchOptions& options) { return watch(options, {}); }

Result<Watch> Client::watch(const WatchOptions& options, std::function<void(const Event&)> callback) {
  Result<std::unique_ptr<Watch::State>> state = Watch::State::start(state_->connection, options, std::move(callback));
  if (!state) { return state.error(); }
  return Watch(std::move(*state));
}

Result<PairAnswer> Client::pair(const std::string& a, const std::string& b, const PairOptions& options) {
  return client::pair(*state_->connection, a, b, options);
}

Result<ClearanceAnswer> Client::clearance(const std::string& from, const ClearanceOptions& options) {
  return client::clearance(*state_->connection, from, options);
}

Result<void> Client::add_probe(const Probe& probe) { return client::add_probe(*state_->connection, probe); }
Result<std::size_t> Client::remove_probes(const std::string& name) {
  return client::remove_probes(*state_->connection, name);
}
Result<std::vector<ProbeReading>> Client::probes(const std::string& name_glob) {
  return client::read_probes(*state_->connection, name_glob);
}

Result<AddedStanding> Client::add(const Standing& standing) {
  return client::add_standing(*state_->connection, standing);
}
Result<void> Client::add(std::span<const Standing> standing) {
  return client::add_standing(*state_->connection, standing);
}
Result<std::size_t> Client::remove_standing(const std::string& name, std::optional<StandingForm> form) {
  return client::remove_standing(*state_->connection, name, form);
}
Result<std::vector<ListedStanding>> Client::standing(const std::string& name_glob, std::optional<StandingForm> form) {
  return client::list_standing(*state_->connection, name_glob, form);
}
Result<StandingWatch> Client::watch_standing(const StandingWatchOptions& options) {
  return client::watch_standing(state_->connection, options);
}

Result<ProbeWatch> Client::watch_probes(const WatchOptions& options) {
  Result<std::unique_ptr<client::ProbeReader>> reader = client::ProbeReader::start(state_->connection, options);
  if (!reader) return reader.error();
  return ProbeWatch(std::move(*reader));
}

Result<ShownObjects> Client::shapes(const ShapesOptions& options, const ShownObjects* earlier) {
  return client::shapes(*state_->connection, options, earlier);
}

Result<Poses> Client::poses(std::chrono::nanoseconds timeout) { return client::poses(*state_->connection, timeout); }

Result<Publisher> Client::publish(const std::string& publisher_name, const PublishOptions& options) {
  Result<std::unique_ptr<Publisher::State>> state =
      Publisher::State::start(state_->connection, publisher_name, options);
  if (!state) { return state.error(); }
  return Publisher(std::move(*state));
}

Result<std::string> Client::command(std::string_view name, std::string_view json_arguments, const Shape& shape,
                                    std::chrono::nanoseconds timeout, std::function<void(double)> progress) {
  return client::command(*state_->connection, name, json_arguments, shape, timeout, progress);
}

Result<std::string> Client::command_with_bytes(std::string_view name, std::string_view json_arguments,
                                               std::span<const std::byte> bytes, std::chrono::nanoseconds timeout) {
  const std::span blob(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  return client::command_with_blob(*state_->connection, name, json_arguments, blob, timeout, {});
}

Result<std::string> Client::upload(std::span<const std::byte> bytes, std::string_view file_name,
                                   std::string_view json_arguments, std::chrono::nanoseconds timeout,
                                   std::function<void(double)> progress) {
  return client::upload(*state_->connection, bytes, file_name, json_arguments, timeout, progress);
}

Result<ServerStatus> Client::status() {
  if (std::optional<ServerStatus> status = state_->connection->pulse().status()) { return std::move(*status); }
  // Right after connecting, the first status may still be in flight.
  const auto first = client::Clock::now() + std::chrono::nanoseconds(wire_contract::kStatusLostNs);
  state_->connection->pulse().wait_for_status(first);
  if (std::optional<ServerStatus> status = state_->connection->pulse().status()) { return std::move(*status); }
  return state_->connection->disconnected();
}

Strangers Client::strangers() const { return state_->connection->strangers(); }

std::string_view library_version() { return COLLIDED_VERSION; }

}  // namespace collided
