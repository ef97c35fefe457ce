#include "server/world/objects/snapshot.hpp"

#include <utility>

#include "server/world/objects/contact_search.hpp"

namespace collided::engine {

Aabb Snapshot::bounds(std::uint32_t slot) const {
  const ObjectInfo* info = objects[slot].get();
  return info == nullptr || info->scene_part != kNoScenePart ? Aabb{} : bounds_of(*info, frame(slot));
}

SnapshotRing::Lease::Lease(const Lease& other) : ring_(other.ring_), index_(other.index_) {
  if (ring_ != nullptr) ring_->states_[index_].readers.fetch_add(1, std::memory_order_relaxed);
}

SnapshotRing::Lease& SnapshotRing::Lease::operator=(Lease other) noexcept {
  std::swap(ring_, other.ring_);
  std::swap(index_, other.index_);
  return *this;
}

SnapshotRing::Lease::~Lease() {
  // Release: everything this reader read happens before the writer finds the count at zero and fills the state.
  if (ring_ != nullptr) ring_->states_[index_].readers.fetch_sub(1, std::memory_order_release);
}

SnapshotRing::Lease SnapshotRing::newest() const {
  // Count first, then check: if the state is still the newest, the writer had not taken it for filling before it could
  // see the count; if not, give the count back and try the newer one. Both steps are sequentially consistent, because
  // the writer does the reverse: it publishes, then reads the counts.
  for (;;) {
    const std::uint32_t index = newest_.load(std::memory_order_seq_cst);
    states_[index].readers.fetch_add(1, std::memory_order_seq_cst);
    if (newest_.load(std::memory_order_seq_cst) == index) return Lease(this, index);
    states_[index].readers.fetch_sub(1, std::memory_order_release);
  }
}

Snapshot* SnapshotRing::writable() {
  const std::uint32_t newest = newest_.load(std::memory_order_relaxed);
  // The first free state: while no reader holds one for long, two states alternate, so the others take no memory and
  // the one being written is still in the cache.
  for (std::uint32_t index = 0; index < kStates; ++index) {
    if (index == newest) continue;
    if (states_[index].readers.load(std::memory_order_seq_cst) == 0) {
      filling_ = index;
      return &states_[index].snapshot;
    }
  }
  return nullptr;
}

void SnapshotRing::publish() { newest_.store(filling_, std::memory_order_seq_cst); }

}  // namespace collided::engine
