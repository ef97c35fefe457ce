#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "server/world/objects/column.hpp"

namespace collided::engine {

/// Which open contacts each object has: two-way lists through the contacts, so that what happens to one object costs
/// its own contacts and not all of them. Contacts are known by number, objects by slot.
/// Always: the numbers are 0 .. count - 1.
class ContactLinks {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// The next number is the contact of these two.
  void add(std::uint32_t slot_a, std::uint32_t slot_b) {
    for (const std::uint32_t slot : {slot_a, slot_b}) {
      const auto link = static_cast<std::uint32_t>(links_.size());
      if (slot >= first_.size()) first_.resize(slot + 1, kNone);
      reserve_column(links_, links_.size() + 1, 4);
      const std::uint32_t after = first_[slot];
      if (after != kNone) links_[after].before = link;
      links_.push_back({slot, kNone, after});
      first_[slot] = link;
    }
  }
  /// Removes a contact; the last one gets its number.
  void remove(std::uint32_t number) {
    for (const std::uint32_t side : {0, 1}) {
      const Link& gone = links_[2 * number + side];
      (gone.before != kNone ? links_[gone.before].after : first_[gone.slot]) = gone.after;
      if (gone.after != kNone) links_[gone.after].before = gone.before;
    }
    const auto last = static_cast<std::uint32_t>(links_.size() / 2 - 1);
    if (number != last) {
      for (const std::uint32_t side : {0, 1}) {
        const std::uint32_t link = 2 * number + side;
        const Link& moved = links_[link] = links_[2 * last + side];
        (moved.before != kNone ? links_[moved.before].after : first_[moved.slot]) = link;
        if (moved.after != kNone) links_[moved.after].before = link;
      }
    }
    links_.resize(links_.size() - 2);
  }
  /// Gives memory back that most of the contacts took which are gone.
  void give_back() { links_.shrink_to_fit(); }
  /// The object has two contacts or more.
  bool has_several(std::uint32_t slot) const {
    return slot < first_.size() && first_[slot] != kNone && links_[first_[slot]].after != kNone;
  }
  /// Calls visit(number) for the object's contacts, the latest first, until one returns false; the visit must not add
  /// or remove any.
  template <class Visit>
  void for_each(std::uint32_t slot, Visit&& visit) const {
    if (slot >= first_.size()) return;
    for (std::uint32_t link = first_[slot]; link != kNone; link = links_[link].after) {
      if (!visit(link / 2)) return;
    }
  }

 private:
  struct Link {
    std::uint32_t slot;
    std::uint32_t before;
    std::uint32_t after;
  };

  std::vector<std::uint32_t> first_;  // by slot
  std::vector<Link> links_;           // two a contact, one for each object
};

}  // namespace collided::engine
