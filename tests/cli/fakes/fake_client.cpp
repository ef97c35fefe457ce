#include "tests/cli/fakes/fake_client.hpp"

#include <memory>
#include <span>
#include <thread>

#include <gtest/gtest.h>

#include "tests/cli/fakes/known_arguments.hpp"

namespace collided {
namespace fake {
namespace {

std::unique_ptr<Server> the_server = std::make_unique<Server>();

}  // namespace

Server& server() { return *the_server; }

void reset() { the_server = std::make_unique<Server>(); }

Hit hit(const std::string& object, double distance_m, const Vec3& point) {
  Hit hit;
  hit.object = object;
  hit.distance_m = distance_m;
  hit.error_m = 4.4e-16;
  hit.point_error_m = 4.5e-16;
  hit.point = point;
  hit.normal = {0, 0, 1};
  return hit;
}

Answer hit_answer(std::vector<Hit> hits) {
  Answer answer;
  answer.verdict = hits.empty() ? Verdict::miss : Verdict::hit;
  answer.hits = std::move(hits);
  answer.cost = {7, 2, 0};
  return answer;
}

/// What a test has put into a queue; once that is empty, nothing comes for a moment.
template <class News>
class Queued : public Subscription<News>::Source {
 public:
  explicit Queued(std::deque<News>& queue) : queue_(queue) {}
  std::optional<News> next(std::chrono::nanoseconds wait) override {
    {
      const std::lock_guard lock(fake::server().mutex);
      if (!queue_.empty()) {
        News news = queue_.front();
        queue_.pop_front();
        return news;
      }
    }
    std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(wait, std::chrono::milliseconds(5)));
    return std::nullopt;
  }
  SubscriptionHealth health() const override { return {}; }

 private:
  std::deque<News>& queue_;
};

}  // namespace fake

struct Client::State {};
struct Watch::State : fake::Queued<Event> {
  State() : Queued(fake::server().events) {}
};
struct Publisher::State {
  std::size_t index = 0;
};

namespace {

template <class Question, class Respond>
Result<Answers> answer_all(std::span<const Question> questions, const AskOptions& options, const Respond& respond) {
  const std::lock_guard lock(fake::server().mutex);
  fake::Server& server = fake::server();
  server.last_options = options;
  server.request_sizes.push_back(questions.size());
  if (server.ask_error) return *server.ask_error;
  Answers answers;
  answers.version = server.version;
  answers.epoch = server.epoch;
  answers.compute = std::chrono::microseconds(41);
  answers.oldest_pose_age = std::chrono::microseconds(2100);
  for (const Question& question : questions) answers.answers.push_back(respond ? respond(question, options) : Answer{});
  return answers;
}

template <class T>
std::future<Result<T>> ready(Result<T> result) {
  std::promise<Result<T>> promise;
  promise.set_value(std::move(result));
  return promise.get_future();
}

}  // namespace

Result<Client> Client::connect(const ConnectOptions& options) {
  fake::Server& server = fake::server();
  server.connected_with = options;
  ++server.connect_count;
  if (server.connect_error) return *server.connect_error;
  return Client(std::make_unique<State>());
}
Client Client::over(std::shared_ptr<client::Connection>) { return Client(std::make_unique<State>()); }
Client::Client(std::unique_ptr<State> state) : state_(std::move(state)) {}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;

template <>
Result<Answers> Client::ask_all(std::span<const RayQuestion> questions, const AskOptions& options, Answers&&) {
  return answer_all(questions, options, fake::server().ray);
}
template <>
Result<Answers> Client::ask_all(std::span<const SphereQuestion> questions, const AskOptions& options, Answers&&) {
  return answer_all(questions, options, fake::server().sphere);
}
template <>
Result<Answers> Client::ask_all(std::span<const BoxQuestion> questions, const AskOptions& options, Answers&&) {
  return answer_all(questions, options, fake::server().box);
}
template <>
Result<Answers> Client::ask_all(std::span<const NearQuestion> questions, const AskOptions& options, Answers&&) {
  return answer_all(questions, options, fake::server().near);
}
// No test gives it answers of its own.
template <>
Result<Answers> Client::ask_all(std::span<const InsideQuestion> questions, const AskOptions& options, Answers&&) {
  const std::function<Answer(const InsideQuestion&, const AskOptions&)> respond;
  return answer_all(questions, options, respond);
}

Result<Answers> Client::sweep(const Shape& shape, std::span<const SweepQuestion> motions, const AskOptions& options) {
  std::function<Answer(const SweepQuestion&, const AskOptions&)> respond;
  if (fake::server().sweep) {
    respond = [&](const SweepQuestion& motion, const AskOptions& asked) {
      return fake::server().sweep(shape, motion, asked);
    };
  }
  return answer_all(motions, options, respond);
}

template <Question Q>
std::future<Result<Answers>> Client::ask_async(std::vector<Q> questions, AskOptions options) {
  return ready(ask(questions, options));
}
template std::future<Result<Answers>> Client::ask_async(std::vector<RayQuestion>, AskOptions);
template std::future<Result<Answers>> Client::ask_async(std::vector<SphereQuestion>, AskOptions);
template std::future<Result<Answers>> Client::ask_async(std::vector<BoxQuestion>, AskOptions);
template std::future<Result<Answers>> Client::ask_async(std::vector<NearQuestion>, AskOptions);
template std::future<Result<Answers>> Client::ask_async(std::vector<InsideQuestion>, AskOptions);

ShardedClient::ShardedClient(std::shared_ptr<client::ShardLinks> links) : links_(std::move(links)) {}
ShardedClient::~ShardedClient() = default;
ShardedClient::ShardedClient(ShardedClient&&) noexcept = default;
ShardedClient& ShardedClient::operator=(ShardedClient&&) noexcept = default;
Result<ShardedClient> ShardedClient::connect(const std::string& map_file, const ConnectOptions& options) {
  fake::server().shard_map = map_file;
  fake::server().connected_with = options;
  if (fake::server().connect_error) return *fake::server().connect_error;
  return ShardedClient(nullptr);
}
Result<ShardSplitReport> split_shard(const std::string& map_file, const std::string& next_file, const ConnectOptions&,
                                     const ShardSplitOptions& how) {
  return fake::server().split(map_file, next_file, how);
}
std::vector<ShardState> ShardedClient::shards() { return fake::server().shards; }
/// As that of one server, without what several do not have in common.
template <Question Q>
Result<Answers> ShardedClient::ask_all(std::span<const Q> questions, const AskOptions& options) {
  Result<Client> client = Client::connect({});
  Result<Answers> answers = client->ask(questions, options);
  if (answers) answers->epoch = answers->version = 0;
  return answers;
}

template Result<Answers> ShardedClient::ask_all(std::span<const RayQuestion>, const AskOptions&);
template Result<Answers> ShardedClient::ask_all(std::span<const SphereQuestion>, const AskOptions&);
template Result<Answers> ShardedClient::ask_all(std::span<const BoxQuestion>, const AskOptions&);
template Result<Answers> ShardedClient::ask_all(std::span<const NearQuestion>, const AskOptions&);
template Result<Answers> ShardedClient::ask_all(std::span<const InsideQuestion>, const AskOptions&);

Result<std::string> Client::command(std::string_view name, std::string_view json_arguments, const Shape& shape,
                                    std::chrono::nanoseconds, std::function<void(double)>) {
  const std::lock_guard lock(fake::server().mutex);
  const std::string text(name);
  if (!fake::server().command) return Error{ErrorCode::refused, "no command '" + text + "'", ""};
  const nlohmann::json arguments = nlohmann::json::parse(json_arguments);
  EXPECT_EQ(test::unknown_argument(text, arguments), "") << "is in idl/command_table.hpp";
  return fake::server().command(text, arguments, shape);
}

Result<std::string> Client::command_with_bytes(std::string_view name, std::string_view json_arguments,
                                               std::span<const std::byte> bytes, std::chrono::nanoseconds timeout) {
  fake::server().bytes.assign(bytes.begin(), bytes.end());
  return command(name, json_arguments, {}, timeout);
}

Result<std::string> Client::upload(std::span<const std::byte> bytes, std::string_view file_name,
                                   std::string_view json_arguments, std::chrono::nanoseconds,
                                   std::function<void(double)>) {
  const std::lock_guard lock(fake::server().mutex);
  nlohmann::json arguments = nlohmann::json::parse(json_arguments);
  arguments["uploaded"] =
      std::string(file_name) + ":" + std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return fake::server().command("load", arguments, {});
}

Result<ShardedPairAnswer> ShardedClient::pair(const std::string& a, const std::string& b, const PairOptions& options) {
  if (fake::server().sharded_pair) return *fake::server().sharded_pair;
  Result<PairAnswer> of_one = Client::connect({})->pair(a, b, options);
  if (!of_one) return of_one.error();
  return ShardedPairAnswer{*of_one};
}
Result<ShardedClearanceAnswer> ShardedClient::clearance(const std::string& from, const ClearanceOptions& options) {
  if (fake::server().sharded_clearance) return *fake::server().sharded_clearance;
  Result<ClearanceAnswer> of_one = Client::connect({})->clearance(from, options);
  if (!of_one) return of_one.error();
  return ShardedClearanceAnswer{*of_one};
}

Result<PairAnswer> Client::pair(const std::string& a, const std::string& b, const PairOptions& options) {
  if (!fake::server().pair) return Error{ErrorCode::refused, "no pairs", ""};
  return fake::server().pair(a, b, options);
}

Result<ClearanceAnswer> Client::clearance(const std::string& from, const ClearanceOptions& options) {
  if (!fake::server().clearance) return Error{ErrorCode::refused, "no clearances", ""};
  return fake::server().clearance(from, options);
}

Result<WhatIfAnswers> Client::what_if(const WhatIfConfigurations& configurations, const WhatIfOptions& options) {
  if (!fake::server().what_if) return Error{ErrorCode::refused, "no what-ifs", ""};
  return fake::server().what_if(configurations, options);
}

Result<ShownObjects> Client::shapes(const ShapesOptions& options, const ShownObjects*) {
  if (!fake::server().shapes) return Error{ErrorCode::refused, "no shapes", ""};
  return fake::server().shapes(options);
}

Result<void> Client::add_probe(const Probe& probe) {
  fake::server().probes.push_back(probe);
  return {};
}
Result<std::size_t> Client::remove_probes(const std::string& name) {
  return std::erase_if(fake::server().probes, [&](const Probe& probe) { return probe.name == name; });
}
Result<std::vector<ProbeReading>> Client::probes(const std::string&) {
  return std::vector<ProbeReading>(fake::server().readings.begin(), fake::server().readings.end());
}
Result<Poses> Client::poses(std::chrono::nanoseconds) {
  if (!fake::server().poses) return Error{ErrorCode::refused, "no poses", ""};
  return fake::server().poses();
}
Result<ProbeWatch> Client::watch_probes(const WatchOptions& options) {
  fake::server().probes_watched_with = options;
  return ProbeWatch(std::make_unique<fake::Queued<ProbeReading>>(fake::server().readings));
}

Result<AddedStanding> Client::add(const Standing& standing) {
  fake::server().standing.push_back(standing);
  return AddedStanding{.parts = fake::server().standing_parts};
}
Result<std::size_t> Client::remove_standing(const std::string& name, std::optional<StandingForm> form) {
  return std::erase_if(fake::server().standing, [&](const Standing& standing) {
    return standing.name == name && (!form || standing.form() == *form);
  });
}
Result<std::vector<ListedStanding>> Client::standing(const std::string&, std::optional<StandingForm> form) {
  std::vector<ListedStanding> listed = fake::server().listed_standing;
  std::erase_if(listed, [&](const ListedStanding& standing) { return form && standing.form != *form; });
  return listed;
}
Result<StandingWatch> Client::watch_standing(const StandingWatchOptions& options) {
  fake::server().standing_watched_with = options;
  return StandingWatch(std::make_unique<fake::Queued<StandingEvent>>(fake::server().standing_events));
}

Result<ServerStatus> Client::status() {
  const std::lock_guard lock(fake::server().mutex);
  return fake::server().status;
}

Strangers Client::strangers() const {
  const std::lock_guard lock(fake::server().mutex);
  return fake::server().strangers;
}

Result<Watch> Client::watch(const WatchOptions& options) {
  fake::server().watched_with = options;
  return Watch(std::make_unique<Watch::State>());
}
Watch::Watch(std::unique_ptr<State> state) : Subscription(std::move(state)) {}
std::size_t Watch::open_contacts() const { return 0; }
std::chrono::nanoseconds Watch::tells_since() const { return fake::server().tells_since; }

namespace {

std::size_t new_publisher(const std::string& name, const PublishOptions& options, bool is_sharded) {
  fake::Published& published = fake::server().publishers.emplace_back();
  published.options = options;
  published.publisher = name;
  published.is_sharded = is_sharded;
  return fake::server().publishers.size() - 1;
}

std::uint32_t add_object(std::size_t publisher, const ObjectOptions& options) {
  auto& objects = fake::server().publishers[publisher].objects;
  const auto handle = static_cast<std::uint32_t>(objects.size() + 1);
  objects[handle] = options;
  return handle;
}

Result<void> move_object(std::size_t publisher, std::uint32_t object, const Pose& pose) {
  fake::server().publishers[publisher].pending[object] = pose;
  if (fake::server().on_move) {
    if (auto error = fake::server().on_move()) return *error;
  }
  return {};
}

std::uint64_t flush_batch(std::size_t publisher, std::chrono::nanoseconds source_time) {
  fake::Published& published = fake::server().publishers[publisher];
  published.stamps.push_back(source_time);
  published.batches.push_back(std::move(published.pending));
  published.pending.clear();
  if (fake::server().on_flush) fake::server().on_flush(published);
  return std::uint64_t{published.batches.size()};
}

Result<void> sign_of_life(std::chrono::nanoseconds source_time) {
  if (fake::server().on_keep_alive) fake::server().on_keep_alive(source_time);
  return {};
}

Result<void> left_out() {
  const std::optional<Error>& error = fake::server().left_out;
  return error ? Result<void>(*error) : Result<void>();
}

}  // namespace

Result<Publisher> Client::publish(const std::string& publisher_name, const PublishOptions& options) {
  return Publisher(std::make_unique<Publisher::State>(Publisher::State{new_publisher(publisher_name, options, false)}));
}
Publisher::Publisher(std::unique_ptr<State> state) : state_(std::move(state)) {}
Publisher::~Publisher() = default;
Publisher::Publisher(Publisher&&) noexcept = default;
Publisher& Publisher::operator=(Publisher&&) noexcept = default;
Result<Publisher::Object> Publisher::add(const ObjectOptions& options) { return add_object(state_->index, options); }
Result<Publisher::Object> Publisher::claim(const std::string& name, const Pose& pose, LostPolicy lost_policy) {
  return add({.name = name, .pose = pose, .lost_policy = lost_policy});
}
Result<void> Publisher::remove(Object object) {
  fake::server().publishers[state_->index].objects.erase(object);
  return {};
}
Result<void> Publisher::reshape(Object object, const Shape& shape) {
  fake::server().publishers[state_->index].objects[object].shape = shape;
  return {};
}
Result<void> Publisher::move(Object object, const Pose& pose, bool) { return move_object(state_->index, object, pose); }
Result<FlushReport> Publisher::flush(std::chrono::nanoseconds source_time) {
  return FlushReport{.sequence = flush_batch(state_->index, source_time), .lost = fake::server().lost};
}
void Publisher::stream() { fake::server().publishers[state_->index].is_streamed = true; }
Result<void> Publisher::keep_alive(std::chrono::nanoseconds source_time) { return sign_of_life(source_time); }
Result<void> Publisher::wait_applied(std::chrono::nanoseconds) { return left_out(); }
Result<PublisherReport> Publisher::report(std::chrono::nanoseconds) { return fake::server().report; }

namespace client {
class ShardedPublishing {
 public:
  std::size_t index = 0;
};
class ShardedWatching : public fake::Queued<Event> {
 public:
  ShardedWatching() : Queued(fake::server().events) {}
  SubscriptionHealth health() const override { return {.resyncs = fake::server().shard_gaps}; }
};
}  // namespace client

Result<ShardedPublisher> ShardedClient::publish(const std::string& publisher_name, const PublishOptions& options) {
  return ShardedPublisher(std::make_unique<client::ShardedPublishing>(
      client::ShardedPublishing{new_publisher(publisher_name, options, true)}));
}
ShardedPublisher::ShardedPublisher(std::unique_ptr<client::ShardedPublishing> state) : state_(std::move(state)) {}
ShardedPublisher::~ShardedPublisher() = default;
ShardedPublisher::ShardedPublisher(ShardedPublisher&&) noexcept = default;
ShardedPublisher& ShardedPublisher::operator=(ShardedPublisher&&) noexcept = default;
Result<ShardedPublisher::Object> ShardedPublisher::add(const ObjectOptions& options) {
  return add_object(state_->index, options);
}
Result<void> ShardedPublisher::move(Object object, const Pose& pose, bool) {
  return move_object(state_->index, object, pose);
}
Result<FlushReport> ShardedPublisher::flush(std::chrono::nanoseconds source_time) {
  return FlushReport{.sequence = flush_batch(state_->index, source_time), .lost = fake::server().lost};
}
Result<void> ShardedPublisher::keep_alive(std::chrono::nanoseconds source_time) { return sign_of_life(source_time); }
Result<void> ShardedPublisher::wait_applied(std::chrono::nanoseconds) { return left_out(); }
Result<PublisherReport> ShardedPublisher::report(std::chrono::nanoseconds) { return fake::server().report; }

Result<ShardedWatch> ShardedClient::watch(const WatchOptions& options) {
  fake::server().watched_with = options;
  return ShardedWatch(std::make_unique<client::ShardedWatching>());
}
ShardedWatch::ShardedWatch(std::unique_ptr<client::ShardedWatching> state) : Subscription(std::move(state)) {}

std::string_view library_version() { return "0.1.0"; }

}  // namespace collided
