#include "server/service/questions/clients.hpp"

#include <algorithm>
#include <iterator>

#include "idl/columns.hpp"
#include "server/service/runtime/clock.hpp"

namespace collided::engine::service {

bool Client::write(const wire::Reply& reply) {
  // The writer is set before ready() is true and never taken away, so this needs no lock.
  return (ready() && place_.writer_->write(reply)) || is_departed_;
}

void Client::note_reported(std::uint64_t version) {
  std::uint64_t told = reported_version_.load(std::memory_order_relaxed);
  while (told < version && !reported_version_.compare_exchange_weak(told, version, std::memory_order_relaxed)) {}
}

std::shared_ptr<Client> Clients::meet(std::uint64_t id, std::uint64_t asker, std::uint64_t participant) {
  const std::uint32_t place = wire_contract::reply_place(id);
  std::shared_ptr<Client> client;
  {
    const std::lock_guard lock(mutex_);
    const auto found = clients_.find(id);
    if (found != clients_.end()) {
      if (found->second->asker_ == asker) client = found->second;
    } else if (has_place_for(asker, participant)) {
      client = std::make_shared<Client>(id, asker, participant, places_[place], steady_ns());
      clients_.emplace(id, client);
    } else {
      turned_away_.fetch_add(1, std::memory_order_relaxed);
    }
  }
  if (!client) return nullptr;
  if (!places_[place].opening_.exchange(true)) {
    try {
      open(place);
    } catch (...) {
      places_[place].opening_.store(false);  // the next ask tries again
      throw;
    }
  }
  return client;
}

/// With mutex_ held. The last places are reserved for processes with few clients, so that others cannot shut them out.
bool Clients::has_place_for(std::uint64_t asker, std::uint64_t participant) const {
  std::size_t of_asker = 0, of_participant = 0;
  for (const auto& [id, client] : clients_) {
    of_asker += client->asker_ == asker ? 1 : 0;
    of_participant += client->participant_ == participant ? 1 : 0;
  }
  const std::size_t limit = of_participant < kFew ? kMost : kMost - kReserved;
  return clients_.size() < limit && of_asker < kMostOfOne && of_participant < kMostOfParticipant;
}

void Clients::open(std::uint32_t number) {
  ReplyPlace& place = places_[number];
  place.deaf_since_ns_.store(steady_ns());
  const auto matched = [this, number, &place](std::uint32_t readers) {
    place.listening_.store(readers > 0);
    place.deaf_since_ns_.store(steady_ns());
    if (readers > 0) listening_(number);
  };
  place.writer_.emplace(topic_,
                        dds::WriterOptions{.partition = wire_contract::reply_partition(number), .matched = matched});
  place.open_.store(true, std::memory_order_release);
  // A match before open_ was set found no place ready; asks held since then would wait for ever.
  if (place.listening_.load()) listening_(number);
}

std::shared_ptr<Client> Clients::find(std::uint64_t id) const {
  const std::lock_guard lock(mutex_);
  const auto found = clients_.find(id);
  return found == clients_.end() ? nullptr : found->second;
}

std::shared_ptr<Client> Clients::departed(std::uint64_t id) {
  return std::make_shared<Client>(id, 0, 0, places_[wire_contract::reply_place(id)], steady_ns(), true);
}

Client* Clients::find_ready(std::uint64_t id, std::uint64_t asker) {
  // The listener caches clients without a lock; once any was forgotten, it looks all of them up again.
  const std::uint64_t departures = departures_.load(std::memory_order_acquire);
  if (departures != std::exchange(recent_departures_, departures)) recent_.fill(nullptr);
  std::shared_ptr<Client>& place = recent_[id % kRecent];
  if (!place || place->id() != id) place = find(id);
  if (!place || place->asker_ != asker || !place->ready()) return nullptr;
  return place.get();
}

bool Clients::hold(Client& client, AskPointer& ask) {
  if (client.ready()) return false;
  const std::lock_guard lock(mutex_);
  const std::lock_guard client_lock(client.mutex_);
  if (client.ready()) return false;
  const bool is_full = client.waiting_.size() >= kMostWaiting;
  const std::size_t bytes = wire::room_of(*ask->query);
  const std::size_t freed = is_full ? wire::room_of(*client.waiting_.front()->query) : 0;
  if (bytes > freed && !has_room_for(bytes - freed, client.asker_)) return true;
  client.waiting_bytes_ = client.waiting_bytes_ + bytes - freed;
  client.waiting_.push_back(std::move(ask));
  if (!is_full) return true;
  ask = std::move(client.waiting_.front());
  client.waiting_.erase(client.waiting_.begin());
  return true;
}

/// With mutex_ held.
bool Clients::has_room_for(std::size_t more_bytes, std::uint64_t asker) const {
  std::size_t of_all = more_bytes, of_asker = more_bytes;
  for (const auto& [id, client] : clients_) {
    of_all += client->waiting_bytes_;
    of_asker += client->asker_ == asker ? client->waiting_bytes_ : 0;
  }
  return of_all <= kMostWaitingBytes && of_asker <= kMostBytesOfOne;
}

std::vector<AskPointer> Clients::resume(std::uint32_t place) {
  std::vector<AskPointer> resumed;
  const std::lock_guard lock(mutex_);
  for (const auto& [id, client] : clients_) {
    if (wire_contract::reply_place(id) != place) continue;
    const std::lock_guard client_lock(client->mutex_);
    if (!client->ready()) continue;
    std::move(client->waiting_.begin(), client->waiting_.end(), std::back_inserter(resumed));
    client->waiting_.clear();
    client->waiting_bytes_ = 0;
  }
  return resumed;
}

std::vector<AskPointer> Clients::forget_gone(std::span<const std::uint64_t> owners, std::int64_t now_ns) {
  std::vector<AskPointer> overdue;
  const std::lock_guard lock(mutex_);
  std::erase_if(clients_, [&](const auto& entry) {
    Client& client = *entry.second;
    const std::lock_guard client_lock(client.mutex_);
    // Asks that waited too long are returned even if their client stays.
    const auto late = std::stable_partition(client.waiting_.begin(), client.waiting_.end(), [&](const AskPointer& ask) {
      return now_ns - ask->taken_ns <= kMatchPatienceNs;
    });
    for (auto ask = late; ask != client.waiting_.end(); ++ask) {
      client.waiting_bytes_ -= wire::room_of(*(*ask)->query);
      overdue.push_back(std::move(*ask));
    }
    client.waiting_.erase(late, client.waiting_.end());
    const bool lives = std::find(owners.begin(), owners.end(), client.asker_) != owners.end();
    const std::int64_t deaf_since_ns = std::max(client.place_.deaf_since_ns_.load(), client.met_ns_);
    const bool deaf = !client.place_.listening_.load() && now_ns - deaf_since_ns > kDeafPatienceNs;
    if ((lives && !deaf) || !client.waiting_.empty()) return false;
    departures_.fetch_add(1, std::memory_order_release);
    client.called_off_.store(true);
    return true;
  });
  return overdue;
}

void Clients::call_off_all() {
  const std::lock_guard lock(mutex_);
  for (const auto& [id, client] : clients_) client->called_off_.store(true);
}

std::size_t Clients::size() const {
  const std::lock_guard lock(mutex_);
  return clients_.size();
}

}  // namespace collided::engine::service
