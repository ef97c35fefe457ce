#include "server/service/ingest/sequence_watermark.hpp"

namespace collided::engine::service {

void SequenceWatermark::note(std::uint64_t sequence, std::int64_t now_ns) {
  if (through_ == 0) through_ = sequence;  // earlier samples came before this server knew the publisher
  if (sequence > through_) {
    if (ahead_.empty()) gap_since_ns_ = now_ns;
    const auto place = std::lower_bound(ahead_.begin(), ahead_.end(), sequence);
    if (place == ahead_.end() || *place != sequence) ahead_.insert(place, sequence);
  }
  // Each topic is in order, so numbers that both have passed cannot come any more.
  through_ = std::max(through_, std::min(definitions_, poses_));
  absorb();
  if (ahead_.size() > kMostAhead) {
    through_ = ahead_.front();
    absorb();
    gap_since_ns_ = now_ns;
  }
}

void SequenceWatermark::settle(std::int64_t now_ns) {
  if (ahead_.empty() || now_ns - gap_since_ns_ < kGapPatienceNs) return;
  through_ = ahead_.back();
  ahead_.clear();
}

void SequenceWatermark::absorb() {
  auto next = ahead_.begin();
  while (next != ahead_.end() && *next <= through_ + 1) {
    through_ = std::max(through_, *next);
    ++next;
  }
  ahead_.erase(ahead_.begin(), next);
}

}  // namespace collided::engine::service
