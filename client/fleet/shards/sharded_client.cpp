#include "client/library/connection/errors.hpp"
#include "client/fleet/shards/map_reading.hpp"
#include "client/fleet/shards/shard_links.hpp"
#include "client/fleet/shards/shard_pairs.hpp"
#include "client/fleet/shards/shard_questions.hpp"
#include "client/fleet/shards/sharded_publishing.hpp"
#include "client/fleet/shards/sharded_watching.hpp"
#include "collided/shards.hpp"
#include "idl/topics.hpp"

namespace collided {

using std::chrono::nanoseconds;

ShardedPublisher::ShardedPublisher(std::unique_ptr<client::ShardedPublishing> state) : state_(std::move(state)) {}
ShardedPublisher::~ShardedPublisher() = default;
ShardedPublisher::ShardedPublisher(ShardedPublisher&&) noexcept = default;
ShardedPublisher& ShardedPublisher::operator=(ShardedPublisher&&) noexcept = default;

Result<ShardedPublisher::Object> ShardedPublisher::add(const ObjectOptions& options) { return state_->add(options); }
Result<void> ShardedPublisher::remove(Object object) { return state_->remove(object); }
Result<void> ShardedPublisher::move(Object object, const Pose& pose, bool teleport) {
  return state_->move(object, pose, teleport);
}
Result<FlushReport> ShardedPublisher::flush(nanoseconds source_time) { return state_->flush(source_time); }
Result<void> ShardedPublisher::keep_alive(nanoseconds source_time) { return state_->keep_alive(source_time); }
Result<void> ShardedPublisher::wait_applied(nanoseconds timeout) { return state_->wait_applied(timeout); }
Result<PublisherReport> ShardedPublisher::report(nanoseconds timeout) { return state_->report(timeout); }
std::size_t ShardedPublisher::copies() const { return state_->copies(); }

ShardedWatch::ShardedWatch(std::unique_ptr<client::ShardedWatching> state) : Subscription(std::move(state)) {}
client::ShardedWatching& ShardedWatch::state() const { return static_cast<client::ShardedWatching&>(source()); }
nanoseconds ShardedWatch::settled() const { return state().settled(); }
std::size_t ShardedWatch::open_contacts() const { return state().open_contacts(); }

ShardedClient::ShardedClient(std::shared_ptr<client::ShardLinks> links) : links_(std::move(links)) {}
ShardedClient::~ShardedClient() = default;
ShardedClient::ShardedClient(ShardedClient&&) noexcept = default;
ShardedClient& ShardedClient::operator=(ShardedClient&&) noexcept = default;

Result<ShardedClient> ShardedClient::connect(const std::string& map, const ConnectOptions& options) {
  Result<shards::KeptShardMap> kept = client::read_map(map, options);
  if (!kept) return kept.error();
  Result<std::shared_ptr<client::ShardLinks>> links = client::ShardLinks::open(std::move(kept->map), options);
  if (!links) return links.error();
  return ShardedClient(std::move(*links));
}

Result<ShardedPublisher> ShardedClient::publish(const std::string& publisher_name, const PublishOptions& options) {
  Result<std::unique_ptr<client::ShardedPublishing>> state =
      client::ShardedPublishing::start(links_, publisher_name, options);
  if (!state) return state.error();
  return ShardedPublisher(std::move(*state));
}

Result<ShardedWatch> ShardedClient::watch(const WatchOptions& options) {
  if (options.persisted)
    return client::bad_input("watch: contacts that go on are not told of a world on several shards");
  if (options.since) return client::bad_input("watch: a world on several shards has no flight recorder of its own");
  return ShardedWatch(std::make_unique<client::ShardedWatching>(links_, options));
}

template <Question Q>
Result<Answers> ShardedClient::ask_all(std::span<const Q> questions, const AskOptions& options) {
  return client::ask_shards(*links_, questions, options);
}
template Result<Answers> ShardedClient::ask_all(std::span<const RayQuestion>, const AskOptions&);
template Result<Answers> ShardedClient::ask_all(std::span<const SphereQuestion>, const AskOptions&);
template Result<Answers> ShardedClient::ask_all(std::span<const BoxQuestion>, const AskOptions&);
template Result<Answers> ShardedClient::ask_all(std::span<const NearQuestion>, const AskOptions&);
template Result<Answers> ShardedClient::ask_all(std::span<const InsideQuestion>, const AskOptions&);

Result<ShardedPairAnswer> ShardedClient::pair(const std::string& a, const std::string& b, const PairOptions& options) {
  return client::pair_of_shards(*links_, a, b, options);
}
Result<ShardedClearanceAnswer> ShardedClient::clearance(const std::string& from, const ClearanceOptions& options) {
  return client::clearance_of_shards(*links_, from, options);
}

std::vector<ShardState> ShardedClient::shards() {
  const std::shared_ptr<const client::ShardView> view = links_->view();
  const shards::ShardMap& map = view->held;
  std::vector<ShardState> states;
  for (std::size_t place = 0; place < map.size(); ++place) {
    if ((map.all() & shards::set_of(place)) == 0) continue;
    const shards::ShardEntry& shard = map.at(place);
    ShardState& state = states.emplace_back();
    state.name = shard.name;
    state.name_space = shards::shard_namespace(links_->options().name_space, shard.name);
    state.low = Vec3(shard.box.low.data());
    state.high = Vec3(shard.box.high.data());
    state.fault = links_->fault(place);
    const std::shared_ptr<Client> client = links_->shard(place);
    if (!client) continue;
    const Result<ServerStatus> status = client->status();
    if (!status) {
      state.fault = status.error().message;
      continue;
    }
    const bool is_silent = status->age.count() > wire_contract::kStatusLostNs;
    state.is_there = !is_silent && (status->epoch == links_->epoch(place) || links_->check(place));
    state.fault = is_silent ? "it is silent for " + client::words(status->age) : links_->fault(place);
    state.state = status->state;
    state.objects = status->objects;
    state.static_triangles = status->static_triangles;
  }
  return states;
}

}  // namespace collided
