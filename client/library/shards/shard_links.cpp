#include "client/library/shards/shard_links.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>

#include "client/library/connection/errors.hpp"
#include "idl/commands.hpp"

namespace collided::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr nanoseconds kLookAgain = std::chrono::seconds(1);
/// Of one that was not there before: it is asked again, so others need not wait for it.
constexpr nanoseconds kLookAgainWait = milliseconds(300);

std::string hexadecimal(std::uint64_t fingerprint) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(fingerprint));
  return text.data();
}

/// What a server says of its place among the shards.
struct SaidPlace {
  std::uint64_t epoch = 0;
  std::string fault;  // empty: it is the shard
};

SaidPlace place_of(Client& client, const std::string& name, std::uint64_t fingerprint) {
  const Result<std::string> answer = client.command(wire_contract::command::kShard, "{}");
  if (!answer && answer.error().code == ErrorCode::refused)
    return {.fault = "the server there is not started with --shard: " + answer.error().message};
  if (!answer) return {.fault = answer.error().message};
  const nlohmann::json said = nlohmann::json::parse(*answer, nullptr, false);
  if (!said.is_object()) return {.fault = "what the server there says of its shard is no JSON object"};
  const std::string said_name = said.value("name", std::string());
  const std::string said_map = said.value("map", std::string());
  if (said_name != name) return {.fault = "the server there is shard '" + said_name + '\''};
  if (said_map != hexadecimal(fingerprint))
    return {.fault = "the server there is shard '" + said_name + "' of another map (" + said_map + ", this one is " +
                     hexadecimal(fingerprint) + ')'};
  return {.epoch = said.value("epoch", std::uint64_t{0}), .fault = {}};
}

}  // namespace

ShardLinks::ShardLinks(shards::ShardMap map, const ConnectOptions& options)
    : map_(std::move(map)), options_(options), links_(map_.size()) {}

Result<std::shared_ptr<ShardLinks>> ShardLinks::open(shards::ShardMap map, const ConnectOptions& options) {
  std::shared_ptr<ShardLinks> links(new ShardLinks(std::move(map), options));
  std::vector<std::thread> looking;
  for (std::size_t place = 0; place < links->map_.size(); ++place) {
    looking.emplace_back([&links = *links, place] { links.look_for(place, links.options_.wait); });
  }
  for (std::thread& one : looking) one.join();
  const bool is_one_there = std::ranges::any_of(links->links_, [](const ShardLink& link) { return link.epoch != 0; });
  if (!is_one_there) {
    return Error{ErrorCode::no_server,
                 "none of " + std::to_string(links->map_.size()) + " shards is there; shard '" +
                     links->map_.at(0).name + "': " + links->links_.front().fault,
                 "start them with 'collided --shard FILE:NAME', on this domain and namespace"};
  }
  links->thread_ = std::thread([&links = *links] { links.run(); });
  return links;
}

ShardLinks::~ShardLinks() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  over_.notify_all();
  if (thread_.joinable()) thread_.join();
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

std::uint64_t ShardLinks::epoch(std::size_t place) const {
  const std::lock_guard lock(mutex_);
  return links_[place].epoch;
}

std::string ShardLinks::fault(std::size_t place) const {
  const std::lock_guard lock(mutex_);
  return links_[place].fault;
}

bool ShardLinks::check(std::size_t place) {
  std::shared_ptr<Client> client;
  {
    const std::lock_guard lock(mutex_);
    client = links_[place].client;
  }
  if (!client) return false;
  const SaidPlace said = place_of(*client, map_.at(place).name, map_.fingerprint());
  const std::lock_guard lock(mutex_);
  links_[place].epoch = said.epoch;
  links_[place].fault = said.fault;
  return said.fault.empty();
}

void ShardLinks::look_for(std::size_t place, nanoseconds wait) {
  ConnectOptions options = options_;
  options.name_space = shards::shard_namespace(options_.name_space, map_.at(place).name);
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
    client = links_[place].client;
    epoch = links_[place].epoch;
  }
  if (!client) return look_for(place, kLookAgainWait);
  const Result<ServerStatus> status = client->status();
  if (status && status->epoch != epoch) check(place);
}

void ShardLinks::run() {
  std::unique_lock lock(mutex_);
  while (!over_.wait_for(lock, kLookAgain, [&] { return is_over_; })) {
    for (std::size_t place = 0; place < links_.size() && !is_over_; ++place) {
      lock.unlock();
      look_again(place);
      lock.lock();
    }
  }
}

}  // namespace collided::client
