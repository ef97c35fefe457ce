#pragma once

#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace collided::engine::service {

/// Maps a publisher's object number to a place in a table. Numbers come from the publisher's pool, so most are small
/// and dense, and one array access finds them; huge ones cost a hash look-up.
class NumberIndex {
 public:
  /// Result of find() for an unknown number.
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// The place of a number, or kNone.
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
  /// Like clear(), but keeps the memory and costs only as much as `numbers`, which must be all known numbers.
  void forget(const std::vector<std::uint32_t>& numbers) {
    for (const std::uint32_t number : numbers) {
      if (number < kDenseNumbers) dense_[number] = kNone;
    }
    sparse_.clear();
  }

 private:
  static constexpr std::uint32_t kDenseNumbers = 1 << 18;  // bounds the array to 1 MiB, whatever a publisher sends
  void grow(std::uint32_t number) {
    std::size_t size = 64;
    while (size <= number) size *= 2;
    dense_.resize(size, kNone);
  }
  std::vector<std::uint32_t> dense_;
  std::unordered_map<std::uint32_t, std::uint32_t> sparse_;
};

/// Records by a publisher's object number. Pointers to them stay valid until clear().
template <class Record>
class ObjectNumbers {
 public:
  /// Null if the number is not known.
  Record* find(std::uint32_t number) {
    const std::uint32_t place = index_.find(number);
    return place == NumberIndex::kNone ? nullptr : &records_[place];
  }
  /// For a number that find() does not know.
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
