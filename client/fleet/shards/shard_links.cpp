#include "client/fleet/shards/shard_links.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>

#include "client/library/commands/command.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/commands.hpp"

namespace collided::client {
namespace {

using shards::MapSuccession;
using shards::ShardMap;
using shards::ShardSet;
using shards::SuccessionPhase;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr nanoseconds kLookAgain = std::chrono::seconds(1);
/// While a shard is split, whose steps must have been heard of by all within seconds.
constexpr nanoseconds kLookAgainInChange = milliseconds(200);
/// Of one that was not there before: it is asked again, so others need not wait for it.
constexpr nanoseconds kLookAgainWait = milliseconds(300);

/// Nobody waits longer for a standby, whatever a server says.
constexpr nanoseconds kMostReplaced = std::chrono::seconds(60);

/// What a server says of its place among the shards.
struct SaidPlace {
  std::uint64_t epoch = 0;
  std::string name = {};
  std::uint64_t map = 0;  // fingerprint
  nanoseconds replaced_within = kUsuallyReplaced;
  std::optional<MapSuccession> succession = {};
  std::string fault = {};  // empty: it is a shard, of whatever map
};

SaidPlace read_place(const std::string& answer) {
  const nlohmann::json said = nlohmann::json::parse(answer, nullptr, false);
  if (!said.is_object()) return {.fault = "what the server there says of its shard is no JSON object"};
  SaidPlace place{.epoch = said.value("epoch", std::uint64_t{0}), .name = said.value("name", std::string())};
  // One that is older does not say it.
  place.replaced_within =
      std::clamp(nanoseconds(said.value("replaced_within_ns", std::int64_t{0})), kUsuallyReplaced, kMostReplaced);
  place.map = shards::fingerprint_of(said.value("map", std::string())).value_or(0);
  if (const auto succession = said.find("succession"); succession != said.end()) {
    try {
      place.succession = shards::parse_succession(succession->dump());
    } catch (const shards::ShardMapError& wrong) {
      return {.fault = std::string("what the server there says of a split: ") + wrong.what()};
    }
  }
  return place;
}

SaidPlace place_of(Client& client) {
  const Result<std::string> answer = client.command(wire_contract::command::kShard, "{}");
  if (!answer && answer.error().code == ErrorCode::refused)
    return {.fault = "the server there is not started with --shard: " + answer.error().message};
  if (!answer) return {.fault = answer.error().message};
  return read_place(*answer);
}

}  // namespace

ShardLinks::ShardLinks(ShardMap map, const ConnectOptions& options)
    : options_(options), own_map_(map.fingerprint()), links_(map.size()) {
  known_.emplace(own_map_, map.all());
  view_ = std::make_shared<const ShardView>(ShardView{.asked = map, .held = map, .held_by = own_map_});
}

Result<std::shared_ptr<ShardLinks>> ShardLinks::open(ShardMap map, const ConnectOptions& options) {
  const Clock::time_point deadline = Clock::now() + options.wait;
  std::shared_ptr<ShardLinks> links(new ShardLinks(std::move(map), options));
  // Those that are there may tell of others, which have taken a shard's place.
  for (std::size_t looked = 0; looked < links->links_.size();) {
    std::vector<std::thread> looking;
    for (const std::size_t end = links->links_.size(); looked < end; ++looked) {
      looking.emplace_back([&links = *links, place = looked] { links.look_for(place, links.options_.wait); });
    }
    for (std::thread& one : looking) one.join();
  }
  if (!links->is_one_there(deadline)) {
    return Error{ErrorCode::no_server,
                 "none of " + std::to_string(links->links_.size()) + " shards is there; shard '" +
                     links->view_->held.at(0).name + "': " + links->links_.front().fault,
                 "start them with 'collided --shard MAP:NAME', on this domain and namespace"};
  }
  links->thread_ = std::thread([&links = *links] { links.run(); });
  return links;
}

/// Whether one has said that it is. Where etcd has a split's next map already and the servers have not heard yet that it
/// holds, it waits for that.
bool ShardLinks::is_one_there(Clock::time_point deadline) {
  constexpr milliseconds kAskAgain{50};
  const auto is_there = [](const ShardLink& link) { return link.epoch != 0; };
  while (!std::ranges::any_of(links_, is_there)) {
    const bool is_to_come = newest_ && !fault_of(*newest_).empty() && newest_->phase == SuccessionPhase::joining;
    if (!is_to_come || Clock::now() > deadline) return false;
    std::this_thread::sleep_for(kAskAgain);
    for (std::size_t place = 0; place < links_.size(); ++place) check(place);
  }
  return true;
}

ShardLinks::~ShardLinks() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  over_.notify_all();
  if (thread_.joinable()) thread_.join();
}

std::shared_ptr<const ShardView> ShardLinks::view() const {
  const std::lock_guard lock(mutex_);
  return view_;
}

std::shared_ptr<Client> ShardLinks::shard(std::size_t place) const {
  const std::lock_guard lock(mutex_);
  return links_[place].epoch != 0 ? links_[place].client : nullptr;
}

std::shared_ptr<Connection> ShardLinks::connection(std::size_t place) const {
  const std::lock_guard lock(mutex_);
  return links_[place].epoch != 0 ? links_[place].connection : nullptr;
}

bool ShardLinks::answers(std::size_t place) const {
  const std::shared_ptr<Connection> found = connection(place);
  return found != nullptr && !found->pulse().silent();
}

bool ShardLinks::may_answer(std::size_t place) const {
  const std::shared_ptr<Connection> found = connection(place);
  return found != nullptr && Clock::now() - found->pulse().last_heard() < replaced_within(place);
}

nanoseconds ShardLinks::replaced_within(std::size_t place) const {
  const std::lock_guard lock(mutex_);
  return links_[place].replaced_within;
}

std::uint64_t ShardLinks::epoch(std::size_t place) const {
  const std::lock_guard lock(mutex_);
  return links_[place].epoch;
}

std::string ShardLinks::fault(std::size_t place) const {
  const std::lock_guard lock(mutex_);
  return links_[place].fault;
}

/// Why the map that this was opened with is not that of a server that says so; empty: it is.
std::string ShardLinks::fault_of(const MapSuccession& said) const {
  const bool is_to_come = said.next.fingerprint() == own_map_ && !known_.contains(said.from);
  if (!is_to_come) return {};
  if (said.phase == SuccessionPhase::joining) return "its shard is being split, and this map does not hold yet";
  if (said.phase == SuccessionPhase::withdrawn) return "a split to this map was taken back";
  return {};
}

bool ShardLinks::check(std::size_t place) {
  std::shared_ptr<Client> client;
  {
    const std::lock_guard lock(mutex_);
    client = links_[place].client;
  }
  if (!client) return false;
  SaidPlace said = place_of(*client);
  const std::lock_guard lock(mutex_);
  if (said.succession) learn(*said.succession);
  const std::string& name = view_->held.at(place).name;
  const bool is_known =
      known_.contains(said.map) || (said.succession && (known_.contains(said.succession->from) ||
                                                        known_.contains(said.succession->next.fingerprint())));
  if (said.fault.empty() && said.succession) said.fault = fault_of(*said.succession);
  if (said.fault.empty() && said.name != name) said.fault = "the server there is shard '" + said.name + '\'';
  if (said.fault.empty() && !is_known)
    said.fault = "the server there is shard '" + said.name + "' of another map (" + shards::fingerprint_text(said.map) +
                 ", this one is " + shards::fingerprint_text(own_map_) + ')';
  links_[place].epoch = said.fault.empty() ? said.epoch : 0;
  links_[place].fault = said.fault;
  if (said.fault.empty()) links_[place].replaced_within = said.replaced_within;
  return said.fault.empty();
}

/// Takes the newest that is told of a split. Under the mutex.
void ShardLinks::learn(const MapSuccession& said) {
  if (newest_ && said.revision <= newest_->revision) return;
  newest_ = said;
  // Where only the next map is known, those before it are of no interest.
  if (!known_.contains(said.from)) return;
  try {
    show(said);
  } catch (const shards::ShardMapError& wrong) {
    // All of what is known goes on; what the shard that was split held is not covered.
    for (ShardLink& link : links_) link.fault = wrong.what();
  }
}

void ShardLinks::show(const MapSuccession& said) {
  // A name may come back with another box, after a split that was taken back: then it has another place.
  const auto place_of = [](const ShardMap& all, const shards::ShardEntry& shard) -> std::optional<std::size_t> {
    for (std::size_t place = 0; place < all.size(); ++place) {
      const shards::ShardEntry& known = all.at(place);
      if (known.name == shard.name && known.box.low == shard.box.low && known.box.high == shard.box.high) return place;
    }
    return std::nullopt;
  };
  ShardMap all = view_->held;
  ShardSet next = 0;
  std::vector<shards::ShardEntry> unknown;
  for (std::size_t i = 0; i < said.next.size(); ++i) {
    const shards::ShardEntry& shard = said.next.at(i);
    const std::optional<std::size_t> there = place_of(all, shard);
    next |= shards::set_of(there ? *there : all.size() + unknown.size());
    if (!there) unknown.push_back(shard);
  }
  all = all.with(unknown);
  const ShardSet before = known_.at(said.from);
  known_.insert_or_assign(said.next.fingerprint(), next);
  const bool is_in_force = said.phase == SuccessionPhase::in_force || said.phase == SuccessionPhase::done;
  ShardSet held = before | next;
  if (said.phase == SuccessionPhase::done) held = next;
  if (said.phase == SuccessionPhase::withdrawn) held = before;
  links_.resize(all.size());
  view_ = std::make_shared<const ShardView>(
      ShardView{.asked = all.limited_to(is_in_force ? next : before),
                .held = all.limited_to(held),
                .held_by = said.phase == SuccessionPhase::withdrawn ? said.from : said.next.fingerprint()});
}

void ShardLinks::look_for(std::size_t place, nanoseconds wait) {
  ConnectOptions options = options_;
  options.name_space = shards::shard_namespace(options_.name_space, view()->held.at(place).name);
  options.wait = wait;
  // A replica holds no map.
  options.replicas = false;
  const Result<std::shared_ptr<Connection>> found = Connection::open(options);
  {
    const std::lock_guard lock(mutex_);
    if (found) {
      links_[place].connection = *found;
      links_[place].client = std::make_shared<Client>(Client::over(*found));
    } else {
      links_[place].fault = found.error().message;
    }
  }
  check(place);
}

void ShardLinks::look_again(std::size_t place) {
  std::shared_ptr<Client> client;
  std::uint64_t epoch = 0;
  {
    const std::lock_guard lock(mutex_);
    if ((view_->held.all() & shards::set_of(place)) == 0) return;
    client = links_[place].client;
    epoch = links_[place].epoch;
  }
  if (!client) return look_for(place, kLookAgainWait);
  const Result<ServerStatus> status = client->status();
  if (status && status->epoch != epoch) check(place);
}

/// Asks the next shard that is there whether one is split.
void ShardLinks::ask_for_news() {
  std::shared_ptr<Connection> asked;
  {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < links_.size() && !asked; ++i) {
      asked_last_ = (asked_last_ + 1) % links_.size();
      const ShardLink& link = links_[asked_last_];
      const bool is_held = (view_->held.all() & shards::set_of(asked_last_)) != 0;
      if (is_held && link.epoch != 0 && !link.connection->pulse().silent()) asked = link.connection;
    }
  }
  if (!asked) return;
  const Result<std::string> answer =
      command(*asked, wire_contract::command::kShard, nlohmann::json::object(), kLookAgainWait);
  if (!answer) return;
  const SaidPlace said = read_place(*answer);
  const std::lock_guard lock(mutex_);
  if (said.succession) learn(*said.succession);
}

/// Whether a split is under way. Under the mutex.
bool ShardLinks::is_changing() const {
  return newest_ && (newest_->phase == SuccessionPhase::joining || newest_->phase == SuccessionPhase::in_force);
}

void ShardLinks::run() {
  std::unique_lock lock(mutex_);
  while (!over_.wait_for(lock, is_changing() ? kLookAgainInChange : kLookAgain, [&] { return is_over_; })) {
    lock.unlock();
    ask_for_news();
    lock.lock();
    for (std::size_t place = 0; place < links_.size() && !is_over_; ++place) {
      lock.unlock();
      look_again(place);
      lock.lock();
    }
  }
}

}  // namespace collided::client
