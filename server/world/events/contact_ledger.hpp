#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

#include "server/exact_phase/motion/body_motion.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/events/contact_links.hpp"
#include "server/world/events/events.hpp"
#include "server/world/events/pair_index.hpp"

namespace collided::engine {

/// Two touching objects as the exact phase found them; the contact's normal points from a to b, and a < b.
struct FoundContact {
  ObjectId a = 0;
  ObjectId b = 0;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  Contact contact;
  std::optional<Contact> surface = {};  // only if it differs from `contact`
  double bracket_low_s = 0;  // begin of the contact, seconds before the step's world time: between high and low
  double bracket_high_s = 0;
  Contained contained = Contained::none;
  // set if the two (for a contact that begins contained: their surfaces) separated again within the step
  double parted_low_s = 0;
  double parted_high_s = 0;
  Vec3 relative_velocity = Vec3::Zero();  // velocity of b relative to a at the contact's point
  double velocity_error = 0;              // |truth - relative_velocity| <= velocity_error
};

/// Sets b's velocity relative to a from those of the two points; the error covers the rounding of the difference.
inline void set_velocity(FoundContact& found, const BodyMotion::PointVelocity& of_a,
                         const BodyMotion::PointVelocity& of_b) {
  found.relative_velocity = of_b.mps - of_a.mps;
  found.velocity_error =
      (of_a.error_mps + of_b.error_mps) * (1 + kBoundSlack) + 2 * kRoundoff * (of_a.mps.norm() + of_b.mps.norm());
}

/// Why a contact ends, and when, in seconds before the step's world time. Reason `none`: it continues.
struct ContactEnd {
  EndReason reason = EndReason::none;
  double bracket_low_s = 0;
  double bracket_high_s = 0;
};

/// The contacts that hold, the pairs in doubt, and the events that change them.
/// Always: `began` and `ended` alternate per pair; sequences grow one by one; the events of one step are ordered by
/// pair, so they do not depend on the order in which contacts were found.
/// threads  the writer's only
class ContactLedger {
 public:
  /// of_fences: its pairs are an object a and a fence b that contains it.
  explicit ContactLedger(bool of_fences = false) : is_of_fences_(of_fences) {}

  /// Sets which pairs are allowed to touch: their contacts are ignored. Empty: none.
  void set_allowed(std::function<bool(ObjectId, ObjectId)> is_allowed) { is_allowed_ = std::move(is_allowed); }
  /// Sets which objects have flat faces, by id; the answer for an object must not change. Empty: none.
  void set_has_faces(std::function<bool(ObjectId)> has_faces) { has_faces_ = std::move(has_faces); }
  /// Ends the contacts and doubts of pairs that have become allowed to touch.
  void end_allowed();
  /// Starts a step: drops the last step's events. persisted_wanted: touches() writes an event for continuing contacts.
  void begin_step(std::int64_t world_time_ns, bool persisted_wanted);
  /// The pair touches at the end of this step.
  void touches(const FoundContact& found);
  /// Ends an open contact.
  void parts(ObjectId a, ObjectId b, EndReason reason, double bracket_low_s, double bracket_high_s);
  /// In an open contact, one object came to lie within the other, or no longer does.
  void changes_containment(ObjectId a, ObjectId b, Contained to, const ContactEnd& when) {
    changes_containment(number_of(a, b), to, when);
  }
  /// It is unknown whether the pair touches; an open contact or doubt of it stays as reported. found.contact is `none`.
  void doubts(const FoundContact& found, Doubt why);
  /// It was unknown whether the pair touched within this step; it is apart at the step's end.
  void doubted_and_parted(const FoundContact& found, Doubt why);
  /// The object's publisher is lost, and the object may have moved on. Whatever touches its last pose, now or later, is
  /// in doubt until the publisher is found again and the pair is decided, or the object is removed.
  void lose(ObjectId object);
  void find_again(ObjectId object) { lost_.erase(object); }
  /// True if the pair is in doubt because an object was lost, and neither is lost any more.
  bool is_found_again(ObjectId a, ObjectId b) const;
  /// Ends a doubt: the two are apart.
  void decided_apart(ObjectId a, ObjectId b, double bracket_low_s, double bracket_high_s);
  /// The pair touched within this step and is apart again at its end.
  ///
  /// as_one  the two events are parts of one
  void touched_and_parted(const FoundContact& found, bool as_one = false);
  /// Ends every contact of the object.
  void end_object(ObjectId object, EndReason reason);
  /// Ends every contact of these objects that was not found again in this step and for which end_of(contact).reason is
  /// not `none`. The cost depends only on the number of these objects' contacts.
  template <class EndOf>
  void end_unfound(std::span<const std::uint32_t> slots, EndOf&& end_of) {
    endings_.clear();
    const auto look_at = [&](std::uint32_t number) {
      if (found_in_step_[number] == step_ || has_lost(open_[number].a, open_[number].b)) return true;
      const ContactEnd of = end_of(open_[number]);
      if (of.reason != EndReason::none) endings_.push_back({{open_[number].a, open_[number].b}, of});
      return true;
    };
    for (const std::uint32_t slot : slots) links_.for_each(slot, look_at);
    for (const Ending& ending : endings_) {
      // If both objects are named, the contact is listed twice.
      const std::uint32_t number = number_of(ending.pair.a, ending.pair.b);
      if (number != PairIndex::kNone) end(number, ending.end);
    }
  }
  /// Replaces the surface of a contact found in this step; retell_corrected() writes it into the events.
  void correct(std::size_t index, const Contact& surface) { open_[index].surface = surface; }
  void retell_corrected();
  /// Changes the end of contacts that ended in this step from separation to `removed` if is_unsure(contact), that is,
  /// if the two may touch elsewhere.
  void retell_unsure(const std::function<bool(const OpenContact&)>& is_unsure);
  /// Orders and numbers this step's events.
  void finish_step();

  bool holds(ObjectId a, ObjectId b) const;
  /// Prefetches the first entry that holds() reads.
  [[gnu::always_inline]] void prefetch(ObjectId a, ObjectId b) const { index_.prefetch(a, b); }
  /// Prefetches the contact of the two, if there is one. Looks it up, so call prefetch() some time before.
  [[gnu::always_inline]] void prefetch_contact(ObjectId a, ObjectId b) const {
    const std::uint32_t number = index_.guess(a, b);
    if (number != PairIndex::kNone) prefetch_contact(number);
  }
  [[gnu::always_inline]] void prefetch_contact(std::uint32_t number) const {
    const auto* contact = reinterpret_cast<const char*>(&open_[number]);
    for (std::size_t byte = 0; byte < sizeof(OpenContact); byte += 64) __builtin_prefetch(contact + byte);
    __builtin_prefetch(&found_in_step_[number]);
  }
  /// The contact or doubt of the two, valid until the next change; null if there is none.
  const OpenContact* find(ObjectId a, ObjectId b) const {
    const std::uint32_t number = number_of(a, b);
    return number == PairIndex::kNone ? nullptr : &open_[number];
  }
  bool is_in_doubt(ObjectId a, ObjectId b) const;
  /// Which of the two was within the other when their contact was last found; none if they have none.
  Contained contained(ObjectId a, ObjectId b) const;
  /// True if the pair is in contact or in doubt.
  bool is_open(ObjectId a, ObjectId b) const { return number_of(a, b) != PairIndex::kNone; }
  /// True if the pair is allowed to touch. Not thread-safe if any pair is.
  bool passes(ObjectId a, ObjectId b) const { return is_allowed_ && is_allowed_(a, b); }
  /// True if one of the two is lost: then any contact found is in doubt.
  bool has_lost(ObjectId a, ObjectId b) const { return !lost_.empty() && (lost_.contains(a) || lost_.contains(b)); }
  /// The state of a found contact, or of a doubt, when it begins.
  OpenContact opened(const FoundContact& found) const;
  OpenContact doubted(const FoundContact& found, Doubt why) const;
  std::size_t doubt_count() const { return doubt_count_; }
  /// Whether open()[index] was found in this step.
  bool found(std::size_t index) const { return found_in_step_[index] == step_; }
  /// Number of the object's certain contacts at flat faces, with bodies that have some, and with neither object within
  /// the other. Constant time.
  std::uint32_t face_count(std::uint32_t slot) const { return links_.face_count(slot); }
  /// Calls visit(index into open()) for these contacts, until one call returns false.
  template <class Visit>
  void for_each_at_faces(std::uint32_t slot, Visit&& visit) const {
    links_.for_each_at_faces(slot, visit);
  }
  /// Calls visit(index into open()) for the contacts and doubts of the object in that slot, until one call returns
  /// false.
  template <class Visit>
  void for_each_of(std::uint32_t slot, Visit&& visit) const {
    links_.for_each(slot, visit);
  }
  /// The same by the id of an object or a fence.
  template <class Visit>
  void for_each_with(ObjectId id, Visit&& visit) const {
    links_.for_each(place_of(id), visit);
  }
  /// Slots of the objects with a contact or doubt found in this step; each once.
  const std::vector<std::uint32_t>& found_slots() const { return found_slots_; }
  const std::vector<Event>& events() const { return events_; }
  const std::vector<OpenContact>& open() const { return open_; }
  std::uint64_t last_sequence() const { return last_sequence_; }

 private:
  bool has_faces(ObjectId id) const { return has_faces_ && has_faces_(id); }

  struct Pair {
    ObjectId a;
    ObjectId b;
  };
  struct Ending {
    Pair pair;
    ContactEnd end;
  };

  /// Slot under which the contacts of an object or fence are linked.
  std::uint32_t place_of(ObjectId id) const {
    return is_of_fences_ ? 2 * slot_of(id) + (is_fence(id) ? 1 : 0) : slot_of(id);
  }
  std::uint32_t number_of(ObjectId a, ObjectId b) const {
    return index_.find(a, b, [&](std::uint32_t number) { return open_[number].a == a && open_[number].b == b; });
  }
  bool is_doubt(std::uint32_t number) const { return open_[number].doubt != Doubt::none; }
  void join_nearest();
  void mark_found(std::uint32_t number);
  void note_found_slot(std::uint32_t slot);
  void end(std::uint32_t number, const ContactEnd& of);
  void open(const OpenContact& opened, const FoundContact& found);
  void goes_on(std::uint32_t number, const FoundContact& found);
  void changes_containment(std::uint32_t number, Contained to, const ContactEnd& when);
  void passed(const OpenContact& opened, const FoundContact& found, EndReason reason, bool as_one = false);

  bool is_of_fences_ = false;
  std::vector<OpenContact> open_;
  std::vector<std::uint64_t> found_in_step_;  // step that last found open_[i]; parallel to open_
  PairIndex index_;                           // of the pairs in open_
  ContactLinks links_;                        // of the contacts in open_
  std::vector<std::uint32_t> found_slots_;
  std::vector<std::uint8_t> is_slot_found_;    // by slot: listed in found_slots_
  std::vector<Ending> endings_;                // reused from step to step
  std::vector<std::uint64_t> ended_episodes_;  // reused from step to step
  std::unordered_set<ObjectId> lost_;
  std::vector<Event> events_;
  std::uint64_t step_ = 0;
  std::uint64_t last_sequence_ = 0;
  std::size_t doubt_count_ = 0;
  std::int64_t world_time_ns_ = 0;
  bool persisted_wanted_ = false;
  std::function<bool(ObjectId, ObjectId)> is_allowed_;
  std::function<bool(ObjectId)> has_faces_;
};

}  // namespace collided::engine
