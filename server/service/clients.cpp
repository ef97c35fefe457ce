#include "server/service/clients.hpp"

#include <algorithm>

#include "server/service/clock.hpp"

namespace collided::service {

bool Client::write(const wire::Reply& reply) {
  // Set once before anybody writes, and never taken away while the client is held.
  return listening_.load() && writer_->write(reply);
}

void Client::note_told(std::uint64_t version) {
  std::uint64_t told = told_version_.load(std::memory_order_relaxed);
  while (told < version && !told_version_.compare_exchange_weak(told, version, std::memory_order_relaxed)) {
  }
}

std::shared_ptr<Client> Clients::meet(std::uint64_t id, std::uint64_t asker) {
  std::shared_ptr<Client> client;
  bool made = false;
  {
    const std::lock_guard lock(mutex_);
    const auto found = clients_.find(id);
    if (found != clients_.end()) {
      client = found->second;
    } else if (clients_.size() < kMost) {
      client = std::make_shared<Client>(id);
      clients_.emplace(id, client);
      made = true;
    }
  }
  if (!client) return nullptr;
  client->asker_.store(asker);
  if (made) open_writer(client);
  return client;
}

void Clients::open_writer(const std::shared_ptr<Client>& client) {
  Client* raw = client.get();  // outlives its writer, and so the callback
  raw->deaf_since_ns_.store(steady_ns());
  dds::Writer<wire::Reply> writer(
      topic_, {.partition = wire_contract::reply_partition(raw->id()), .matched = [this, raw](std::uint32_t readers) {
                 raw->listening_.store(readers > 0);
                 raw->deaf_since_ns_.store(steady_ns());
                 if (readers > 0) listening_(raw->id());
               }});
  {
    const std::lock_guard lock(raw->mutex_);
    raw->writer_.emplace(std::move(writer));
    raw->open_.store(true, std::memory_order_release);
  }
  // The match may have come before the writer was in its place; asks held meanwhile would wait for ever.
  if (raw->listening_.load()) listening_(raw->id());
}

std::shared_ptr<Client> Clients::find(std::uint64_t id) const {
  const std::lock_guard lock(mutex_);
  const auto found = clients_.find(id);
  return found == clients_.end() ? nullptr : found->second;
}

Client* Clients::find_ready(std::uint64_t id, std::uint64_t asker) {
  const std::uint64_t departures = departures_.load(std::memory_order_acquire);
  if (departures != std::exchange(recent_departures_, departures)) recent_.fill(nullptr);
  std::shared_ptr<Client>& place = recent_[id % kRecent];
  if (!place || place->id() != id) place = find(id);
  if (!place || !place->ready()) return nullptr;
  place->asker_.store(asker);
  return place.get();
}

bool Clients::hold(Client& client, AskPointer& ask) {
  if (client.ready()) return false;
  const std::lock_guard lock(client.mutex_);
  if (client.ready()) return false;
  if (client.waiting_.size() >= kMostWaiting) client.waiting_.erase(client.waiting_.begin());
  client.waiting_.push_back(std::move(ask));
  return true;
}

std::vector<AskPointer> Clients::resume(std::uint64_t id) {
  const std::shared_ptr<Client> client = find(id);
  if (!client) return {};
  const std::lock_guard lock(client->mutex_);
  return client->ready() ? std::exchange(client->waiting_, {}) : std::vector<AskPointer>{};
}

std::vector<AskPointer> Clients::sweep(std::span<const std::uint64_t> askers, std::int64_t now_ns) {
  bury();
  std::vector<AskPointer> overdue;
  const std::lock_guard lock(mutex_);
  std::erase_if(clients_, [&](const auto& entry) {
    Client& client = *entry.second;
    const std::lock_guard client_lock(client.mutex_);
    const auto late = std::stable_partition(client.waiting_.begin(), client.waiting_.end(), [&](const AskPointer& ask) {
      return now_ns - ask->taken_ns <= kMatchPatienceNs;
    });
    std::move(late, client.waiting_.end(), std::back_inserter(overdue));
    client.waiting_.erase(late, client.waiting_.end());
    const bool lives = std::find(askers.begin(), askers.end(), client.asker_.load()) != askers.end();
    const bool deaf = !client.listening_.load() && now_ns - client.deaf_since_ns_.load() > kDeafPatienceNs;
    if ((lives && !deaf) || !client.waiting_.empty()) return false;
    gone_.push_back(entry.second);
    departures_.fetch_add(1, std::memory_order_release);
    return true;
  });
  return overdue;
}

/// Deletes those gone whom no thread answers any more; after the lock is free, since their writers take time.
void Clients::bury() {
  std::vector<std::shared_ptr<Client>> unheld;
  const std::lock_guard lock(mutex_);
  const auto held = std::partition(gone_.begin(), gone_.end(), [](const auto& client) { return client.use_count() > 1; });
  std::move(held, gone_.end(), std::back_inserter(unheld));
  gone_.erase(held, gone_.end());
}

std::size_t Clients::size() const {
  const std::lock_guard lock(mutex_);
  return clients_.size();
}

}  // namespace collided::service
