#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace collided::engine::service {

/// A queue in memory that only grows: once it has held as many items, passing more through allocates nothing.
/// (std::deque frees and allocates a block each time that it moves past one.)
template <class Item>
class Ring {
 public:
  explicit Ring(std::size_t room = 16) : items_(room) {}

  bool empty() const { return count_ == 0; }
  std::size_t size() const { return count_; }
  void push_back(Item item) {
    if (count_ == items_.size()) grow();
    items_[(first_ + count_) % items_.size()] = std::move(item);
    ++count_;
  }
  /// The ring must not be empty.
  const Item& front() const { return items_[first_]; }
  /// The ring must not be empty.
  Item pop_front() {
    Item item = std::exchange(items_[first_], Item{});
    first_ = (first_ + 1) % items_.size();
    --count_;
    return item;
  }

 private:
  void grow() {
    std::vector<Item> more(2 * items_.size());
    for (std::size_t i = 0; i < count_; ++i) more[i] = std::move(items_[(first_ + i) % items_.size()]);
    items_ = std::move(more);
    first_ = 0;
  }

  std::vector<Item> items_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace collided::engine::service
