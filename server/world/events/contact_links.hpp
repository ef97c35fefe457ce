#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "server/world/objects/column.hpp"

namespace collided::engine {

/// The open contacts of each object: doubly linked lists through the contacts, so that a change of one object costs its
/// own contacts only. Contacts are known by number, objects by slot. Each object has two lists: its contacts at flat
/// faces, and the others.
/// Always: the numbers are 0 .. count - 1.
class ContactLinks {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// One of the two objects of a contact.
  struct LinkedSide {
    std::uint32_t slot = 0;
    bool meets_faces = false;  // the other one has flat faces
  };

  /// Adds the contact of these two under the next number. is_at_faces: see set_at_faces().
  void add(const LinkedSide& a, const LinkedSide& b, bool is_at_faces) {
    for (const LinkedSide& side : {a, b}) {
      if (side.slot >= lists_.size()) {
        reserve_column(lists_, side.slot + 1);
        lists_.resize(side.slot + 1);
      }
      reserve_column(links_, links_.size() + 1, 4);
      links_.push_back({.slot = side.slot & kSlotBits, .meets_faces = side.meets_faces});
      put_first(static_cast<std::uint32_t>(links_.size() - 1), side.meets_faces && is_at_faces);
    }
  }
  /// Sets whether the contact counts as one at flat faces, for each of its objects whose partner has flat faces.
  void set_at_faces(std::uint32_t number, bool is_at_faces) {
    for (const std::uint32_t link : {2 * number, 2 * number + 1}) {
      if (!links_[link].meets_faces || (links_[link].is_at_faces != 0) == is_at_faces) continue;
      take_out(link);
      put_first(link, is_at_faces);
    }
  }
  /// Removes a contact; the last one gets its number.
  void remove(std::uint32_t number) {
    for (const std::uint32_t side : {0, 1}) take_out(2 * number + side);
    const auto last = static_cast<std::uint32_t>(links_.size() / 2 - 1);
    if (number != last) {
      for (const std::uint32_t side : {0, 1}) {
        const std::uint32_t link = 2 * number + side;
        const Link& moved = links_[link] = links_[2 * last + side];
        (moved.before != kNone ? links_[moved.before].after : first_of(moved)) = link;
        if (moved.after != kNone) links_[moved.after].before = link;
      }
    }
    links_.resize(links_.size() - 2);
  }
  /// Gives back memory if most of it belonged to removed contacts.
  void give_back() {
    links_.shrink_to_fit();
    while (!lists_.empty() && lists_.back().first[0] == kNone && lists_.back().first[1] == kNone) lists_.pop_back();
    lists_.shrink_to_fit();
  }
  /// Number of the object's contacts at flat faces.
  std::uint32_t face_count(std::uint32_t slot) const { return slot < lists_.size() ? lists_[slot].face_count : 0; }
  /// Calls visit(number) for these, the latest first, until one call returns false; the visit must not add or remove
  /// any.
  template <class Visit>
  void for_each_at_faces(std::uint32_t slot, Visit&& visit) const {
    if (slot < lists_.size()) visit_from(lists_[slot].first[1], visit);
  }
  /// The same for all contacts of the object: those at flat faces, then the others.
  template <class Visit>
  void for_each(std::uint32_t slot, Visit&& visit) const {
    if (slot < lists_.size() && visit_from(lists_[slot].first[1], visit)) visit_from(lists_[slot].first[0], visit);
  }

 private:
  static constexpr std::uint32_t kSlotBits = (1U << 30) - 1;  // far more than fit into memory
  struct Link {
    std::uint32_t slot : 30 = 0;
    std::uint32_t meets_faces : 1 = 0;
    std::uint32_t is_at_faces : 1 = 0;  // the list that holds it
    std::uint32_t before = kNone;
    std::uint32_t after = kNone;
  };
  struct LinkLists {
    std::uint32_t first[2] = {kNone, kNone};  // first of the other contacts, first of those at flat faces
    std::uint32_t face_count = 0;
  };

  std::uint32_t& first_of(const Link& link) { return lists_[link.slot].first[link.is_at_faces]; }
  void put_first(std::uint32_t number, bool is_at_faces) {
    Link& link = links_[number];
    link.is_at_faces = is_at_faces;
    lists_[link.slot].face_count += link.is_at_faces;
    std::uint32_t& first = first_of(link);
    if (first != kNone) links_[first].before = number;
    link.before = kNone;
    link.after = first;
    first = number;
  }
  void take_out(std::uint32_t number) {
    const Link& gone = links_[number];
    lists_[gone.slot].face_count -= gone.is_at_faces;
    (gone.before != kNone ? links_[gone.before].after : first_of(gone)) = gone.after;
    if (gone.after != kNone) links_[gone.after].before = gone.before;
  }
  template <class Visit>
  bool visit_from(std::uint32_t first, Visit&& visit) const {
    for (std::uint32_t link = first; link != kNone; link = links_[link].after) {
      if (!visit(link / 2)) return false;
    }
    return true;
  }

  std::vector<LinkLists> lists_;  // by slot
  std::vector<Link> links_;       // two per contact, one for each object
};

}  // namespace collided::engine
