#include "client/library/connection/requests.hpp"

namespace collided::client {

Requests::Requests(std::uint64_t client, IsFromServer is_from_server)
    : client_(client), is_from_server_(std::move(is_from_server)), uses_(kMost, 0) {
  for (std::size_t slot = kMost; slot > 0; --slot) { free_.push_back(slot - 1); }
  for (auto& sample : next_) { sample = pool_.get(); }
}

std::unique_ptr<Requests::Running> Requests::begin() {
  const std::lock_guard lock(mutex_);
  if (free_.empty()) { return nullptr; }
  const std::size_t index = free_.back();
  free_.pop_back();
  Slot* slot = slots_[index].load(std::memory_order_relaxed);
  if (slot == nullptr) {
    slot = owned_.emplace_back(std::make_unique<Slot>()).get();
    slots_[index].store(slot, std::memory_order_release);
  }
  const std::uint64_t number = ++uses_[index] * kMost + index;
  const std::lock_guard slot_lock(slot->mutex);
  slot->request = number;
  return std::make_unique<Running>(*this, *slot, number);
}

void Requests::end(Running& running) {
  recycle(running.taken_);
  {
    const std::lock_guard slot_lock(running.slot_.mutex);
    running.slot_.request = 0;
    recycle(running.slot_.replies);
  }
  const std::lock_guard lock(mutex_);
  free_.push_back(running.number_ % kMost);
}

void Requests::recycle(std::vector<SamplePool<wire::Reply>::Pointer>& replies) {
  for (auto& reply : replies) { pool_.put(std::move(reply)); }
  replies.clear();
}

const std::vector<SamplePool<wire::Reply>::Pointer>& Requests::Running::wait(Clock::time_point deadline) {
  requests_.recycle(taken_);
  if (spins_) {
    requests_.spin_.wait(deadline, [this] { return slot_.has_replies.load(std::memory_order_acquire); });
  }
  std::unique_lock lock(slot_.mutex);
  slot_.came.wait_until(lock, deadline, [this] { return !slot_.replies.empty(); });
  std::swap(taken_, slot_.replies);
  slot_.has_replies.store(false, std::memory_order_relaxed);
  return taken_;
}

void Requests::take_replies(const dds::Taker<wire::Reply>& taker) {
  std::size_t count = 0;
  do {
    std::array<dds::Sample<wire::Reply>*, std::tuple_size_v<decltype(next_)>> room{};
    for (std::size_t i = 0; i < room.size(); ++i) { room[i] = next_[i].get(); }
    count = taker.take(room);
    for (std::size_t i = 0; i < count; ++i) {
      const dds::Sample<wire::Reply>& reply = *next_[i];
      if (reply.info().valid_data && reply->client == client_ && is_from_server_(reply)) {
        hand_over(std::exchange(next_[i], pool_.get()));
      }
    }
  } while (count == next_.size());
}

void Requests::hand_over(SamplePool<wire::Reply>::Pointer reply) {
  const std::uint64_t number = (*reply)->request;
  Slot* const slot = slots_[number % kMost].load(std::memory_order_acquire);
  if (slot != nullptr) {
    std::unique_lock lock(slot->mutex);
    if (slot->request == number) {
      slot->replies.push_back(std::move(reply));
      slot->has_replies.store(true, std::memory_order_release);
      lock.unlock();
      slot->came.notify_one();
      return;
    }
  }
  pool_.put(std::move(reply));
}

}  // namespace collided::client
