#include "client/library/shards/shard_links.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "client/library/connection/errors.hpp"

namespace collided::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr nanoseconds kLookAgain = std::chrono::seconds(1);
/// Of one that was not there before: it is asked again, so others need not wait for it.
constexpr nanoseconds kLookAgainWait = milliseconds(300);

}  // namespace

ShardLinks::ShardLinks(shards::ShardMap map, const ConnectOptions& options)
    : map_(std::move(map)), options_(options), clients_(map_.size()), connections_(map_.size()), faults_(map_.size()) {}

Result<std::shared_ptr<ShardLinks>> ShardLinks::open(shards::ShardMap map, const ConnectOptions& options) {
  std::shared_ptr<ShardLinks> links(new ShardLinks(std::move(map), options));
  std::vector<std::thread> looking;
  for (std::size_t place = 0; place < links->map_.size(); ++place) {
    looking.emplace_back([&links = *links, place] { links.look_for(place, links.options_.wait); });
  }
  for (std::thread& one : looking) one.join();
  const bool is_one_there = std::ranges::any_of(links->clients_, [](const auto& client) { return client != nullptr; });
  if (!is_one_there) {
    return Error{ErrorCode::no_server,
                 "none of " + std::to_string(links->map_.size()) + " shards is there; shard '" +
                     links->map_.at(0).name + "': " + links->faults_.front(),
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
  return clients_[place];
}

std::shared_ptr<Connection> ShardLinks::connection(std::size_t place) const {
  const std::lock_guard lock(mutex_);
  return connections_[place];
}

bool ShardLinks::answers(std::size_t place) const {
  const std::shared_ptr<Connection> found = connection(place);
  return found != nullptr && !found->pulse().silent();
}

std::string ShardLinks::fault(std::size_t place) const {
  const std::lock_guard lock(mutex_);
  return faults_[place];
}

void ShardLinks::look_for(std::size_t place, nanoseconds wait) {
  ConnectOptions options = options_;
  options.name_space = shards::shard_namespace(options_.name_space, map_.at(place).name);
  options.wait = wait;
  const Result<std::shared_ptr<Connection>> found = Connection::open(options);
  const std::lock_guard lock(mutex_);
  if (found) {
    connections_[place] = *found;
    clients_[place] = std::make_shared<Client>(Client::over(*found));
    faults_[place].clear();
  } else {
    faults_[place] = found.error().message;
  }
}

void ShardLinks::run() {
  std::unique_lock lock(mutex_);
  while (!over_.wait_for(lock, kLookAgain, [&] { return is_over_; })) {
    for (std::size_t place = 0; place < clients_.size() && !is_over_; ++place) {
      if (clients_[place]) continue;
      lock.unlock();
      look_for(place, kLookAgainWait);
      lock.lock();
    }
  }
}

}  // namespace collided::client
