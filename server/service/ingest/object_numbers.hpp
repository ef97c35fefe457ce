#pragma once

#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace collided::engine::service {

/// Places by a publisher's object number. Numbers come from the publisher's pool, so they are small and dense as a rule
/// and found by one look; huge ones cost a hash.
class NumberIndex {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  std::uint32_t find(std::uint32_t number) const {
    if (number < dense_.size()) return dense_[number];
    if (number < kDenseNumbers) return kNone;
    const auto found = sparse_.find(number);
    return found == sparse_.end() ? kNone : found->second;
  }
  void set(std::uint32_t number, std::uint32_t place) {
    if (number < kDenseNumbers) {
      if (number >= dense_.size()) grow(number);
      dense_[number] = place;
    } else {
      sparse_[number] = place;
    }
  }
  void clear() {
    dense_.clear();
    sparse_.clear();
  }
  /// The same at the cost of these numbers, which are all that are set; the memory stays.
  void forget(const std::vector<std::uint32_t>& numbers) {
    for (const std::uint32_t number : numbers) {
      if (number < kDenseNumbers) dense_[number] = kNone;
    }
    sparse_.clear();
  }

 private:
  static constexpr std::uint32_t kDenseNumbers = 1 << 18;  // 1 MiB of look-up at most, whatever a publisher sends
  void grow(std::uint32_t number) {
    std::size_t size = 64;
    while (size <= number) size *= 2;
    dense_.resize(size, kNone);
  }
  std::vector<std::uint32_t> dense_;
  std::unordered_map<std::uint32_t, std::uint32_t> sparse_;
};

/// Records by a publisher's object number.
template <class Record>
class ObjectNumbers {
 public:
  Record* find(std::uint32_t number) {
    const std::uint32_t place = index_.find(number);
    return place == NumberIndex::kNone ? nullptr : &records_[place];
  }
  Record& add(std::uint32_t number) {
    index_.set(number, static_cast<std::uint32_t>(records_.size()));
    return records_.emplace_back();
  }
  std::deque<Record>& records() { return records_; }
  const std::deque<Record>& records() const { return records_; }
  void clear() {
    index_.clear();
    records_.clear();
  }

 private:
  NumberIndex index_;
  std::deque<Record> records_;
};

}  // namespace collided::engine::service
