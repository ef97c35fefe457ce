#pragma once

#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace collided::service {

/// Records by a publisher's object number. Numbers come from the publisher's pool, so they are small and dense as a
/// rule and found by one look; huge ones cost a hash.
template <class Record>
class ObjectNumbers {
 public:
  Record* find(std::uint32_t number) {
    if (number < dense_.size()) return dense_[number] == kNone ? nullptr : &records_[dense_[number]];
    const auto found = sparse_.find(number);
    return found == sparse_.end() ? nullptr : &records_[found->second];
  }
  Record& add(std::uint32_t number) {
    const auto index = static_cast<std::uint32_t>(records_.size());
    records_.emplace_back();
    if (number < kDenseNumbers) {
      if (number >= dense_.size()) grow(number);
      dense_[number] = index;
    } else {
      sparse_[number] = index;
    }
    return records_.back();
  }
  std::deque<Record>& records() { return records_; }
  const std::deque<Record>& records() const { return records_; }
  void clear() {
    dense_.clear();
    sparse_.clear();
    records_.clear();
  }

 private:
  static constexpr std::uint32_t kDenseNumbers = 1 << 18;  // 1 MiB of look-up at most, whatever a publisher sends
  static constexpr std::uint32_t kNone = 0xffffffff;
  void grow(std::uint32_t number) {
    std::size_t size = 64;
    while (size <= number) size *= 2;
    dense_.resize(size, kNone);
  }
  std::vector<std::uint32_t> dense_;
  std::unordered_map<std::uint32_t, std::uint32_t> sparse_;
  std::deque<Record> records_;
};

}  // namespace collided::service
