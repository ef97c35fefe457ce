#include "server/fleet/world_comparison.hpp"

#include <algorithm>
#include <utility>

namespace collided::engine::service {

void WorldComparison::note_own(const InstantDigest& digest, std::shared_ptr<const Snapshot> state) {
  own_.push_back({digest, std::move(state)});
  if (own_.size() > kMost) own_.pop_front();
  compare();
}

void WorldComparison::hear(const InstantDigest& digest) {
  if (digest.time_ns == 0 || (!others_.empty() && digest.time_ns <= others_.back().time_ns)) return;
  others_.push_back(digest);
  if (others_.size() > kMost) others_.pop_front();
  compare();
}

void WorldComparison::begin_anew() {
  others_.clear();
  differing_ = 0;
}

void WorldComparison::compare() {
  for (const Own& own : own_) {
    if (own.digest.time_ns <= compared_to_ns_) continue;
    const auto other = std::ranges::find(others_, own.digest.time_ns, &InstantDigest::time_ns);
    if (other == others_.end()) continue;
    compared_to_ns_ = own.digest.time_ns;
    ++compared_;
    if (other->digest == own.digest.digest) {
      differing_ = 0;
      continue;
    }
    ++differing_;
    differed_at_ns_ = own.digest.time_ns;
    constexpr std::size_t kPublished = 2 * (WorldDigest::kGroups - WorldDigest::kUnpublishedGroups);
    only_unpublished_differed_ = std::equal(own.digest.digest.sums.begin(), own.digest.digest.sums.begin() + kPublished,
                                            other->digest.sums.begin());
    object_ = first_difference(*own.state, own.digest.digest, other->digest);
  }
}

}  // namespace collided::engine::service
