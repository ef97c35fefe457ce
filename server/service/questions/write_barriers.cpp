#include "server/service/questions/write_barriers.hpp"

#include <algorithm>
#include <utility>

namespace collided::engine::service {

bool WriteBarriers::reached(const wire::Query& query) const {
  const std::uint64_t applied = applied_locked(query.barrier_publisher);
  return applied != 0 && applied >= query.barrier_sequence;
}

WriteBarriers::Outcome WriteBarriers::pass(AskPointer& ask) {
  if ((*ask->query).barrier_publisher == 0 || ask->passed_barrier) return Outcome::passed;
  const std::lock_guard lock(mutex_);
  if (reached(*ask->query)) return Outcome::passed;
  if (!has_room_for(ask->from.participant)) return Outcome::full;
  waiting_.push_back(std::move(ask));
  return Outcome::parked;
}

/// The last places are reserved for processes with few waiting questions, so that others cannot take them all.
bool WriteBarriers::has_room_for(std::uint64_t participant) const {
  const auto own = static_cast<std::size_t>(
      std::ranges::count_if(waiting_, [&](const AskPointer& ask) { return ask->from.participant == participant; }));
  return own < kMostOfOne && waiting_.size() < (own < kFew ? kMost : kMost - kReserved);
}

void WriteBarriers::update(const Applied& applied) {
  const std::lock_guard lock(mutex_);
  applied_ = applied;
}

std::uint64_t WriteBarriers::applied_locked(std::uint64_t publisher) const {
  const auto found = std::lower_bound(applied_.begin(), applied_.end(), Applied::value_type{publisher, 0});
  return found != applied_.end() && found->first == publisher ? found->second : 0;
}

template <class Chosen>
std::vector<AskPointer> WriteBarriers::take_if(Chosen&& chosen) {
  const std::lock_guard lock(mutex_);
  std::vector<AskPointer> taken;
  const auto rest =
      std::stable_partition(waiting_.begin(), waiting_.end(), [&](const AskPointer& ask) { return !chosen(*ask); });
  std::move(rest, waiting_.end(), std::back_inserter(taken));
  waiting_.erase(rest, waiting_.end());
  return taken;
}

std::vector<AskPointer> WriteBarriers::take_ready() {
  std::vector<AskPointer> ready = take_if([&](const Ask& ask) { return reached(*ask.query); });
  for (AskPointer& ask : ready) ask->passed_barrier = true;
  return ready;
}

std::vector<AskPointer> WriteBarriers::take_overdue(std::int64_t now_ns) {
  return take_if([&](const Ask& ask) {
    const std::int64_t deadline_ns = ask.query->deadline_ns;
    const std::int64_t patience_ns = deadline_ns > 0 ? std::min(deadline_ns, kPatienceNs) : kPatienceNs;
    return now_ns - ask.taken_ns > patience_ns;
  });
}

std::vector<AskPointer> WriteBarriers::take_all() {
  return take_if([](const Ask&) { return true; });
}

std::uint64_t WriteBarriers::applied(std::uint64_t publisher) const {
  const std::lock_guard lock(mutex_);
  return applied_locked(publisher);
}

bool WriteBarriers::empty() const {
  const std::lock_guard lock(mutex_);
  return waiting_.empty();
}

}  // namespace collided::engine::service
