#pragma once

#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "server/exact_phase/motion/body_motion.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/events/events.hpp"

namespace collided::engine {

/// Two touching objects as the exact phase found them; the contact's normal points from a to b, a < b.
struct FoundContact {
  ObjectId a = 0;
  ObjectId b = 0;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  Contact contact;
  double bracket_low_s = 0;  // before the step's world time
  double bracket_high_s = 0;
  double parted_low_s = 0;  // where it parted again on the way
  double parted_high_s = 0;
  Vec3 relative_velocity = Vec3::Zero();  // of b against a at the contact's point
  double velocity_error = 0;              // |truth - relative_velocity| <= velocity_error
};

inline void set_velocity(FoundContact& found, const BodyMotion::PointVelocity& of_a, const BodyMotion::PointVelocity& of_b) {
  found.relative_velocity = of_b.mps - of_a.mps;
  found.velocity_error = (of_a.error_mps + of_b.error_mps) * (1 + kBoundSlack) + 2 * kRoundoff * (of_a.mps.norm() + of_b.mps.norm());
}

/// Why a contact is over and when, in seconds before the step's world time; none: it is not.
struct ContactEnd {
  EndReason reason = EndReason::none;
  double bracket_low_s = 0;
  double bracket_high_s = 0;
};

/// The contacts that hold and the pairs in doubt, and the events that change them. Always: per pair began and ended alternate; sequences grow
/// one by one; events of one step are ordered by pair, so they do not hang on the order of finding.
/// Writer's thread only.
class ContactLedger {
 public:
  void begin_step(std::int64_t world_time_ns, bool persisted_wanted);
  /// The pair touches at the end of this step.
  void touches(const FoundContact& found);
  /// A contact that holds is looked at again: where and how deep, without an event.
  void goes_on(const FoundContact& found);
  /// A contact that holds is over.
  void parts(ObjectId a, ObjectId b, EndReason reason, double bracket_low_s, double bracket_high_s);
  /// It is not known whether the pair touches; what is told of it already goes on. found.contact is none.
  void doubts(const FoundContact& found, Doubt why);
  /// It was not known within this step, and is apart at its end.
  void doubted_and_parted(const FoundContact& found, Doubt why);
  /// The object's publisher is lost, and the object may have gone on: whatever touches its last place, now or later, is in
  /// doubt until the publisher is found again and the pair is decided, or the object is removed.
  void lose(ObjectId object);
  void find_again(ObjectId object) { lost_.erase(object); }
  /// In doubt because one was lost, and neither is any more.
  bool is_found_again(ObjectId a, ObjectId b) const;
  /// A doubt is over: the two are apart.
  void decided_apart(ObjectId a, ObjectId b, double bracket_low_s, double bracket_high_s);
  /// The pair touched within this step and is apart again.
  void touched_and_parted(const FoundContact& found);
  /// Every contact of the object ends.
  void end_object(ObjectId object, EndReason reason);
  /// Every contact for which end_of(contact).reason is not `none` and that was not found again this step ends.
  template <class EndOf>
  void end_unfound(EndOf&& end_of) {
    for (std::size_t i = 0; i < open_.size();) {
      const bool goes_on = found_in_step_[i] == step_ || has_lost(open_[i].a, open_[i].b);
      const ContactEnd of = goes_on ? ContactEnd{} : end_of(open_[i]);
      if (of.reason == EndReason::none) {
        ++i;
      } else {
        end(i, of);
      }
    }
  }
  /// Another surface for a contact found in this step; retell_corrected() puts it into the contact's event.
  void correct(std::size_t index, const Contact& surface) { open_[index].surface = surface; }
  void retell_corrected();
  /// Orders and numbers this step's events.
  void finish_step();

  bool holds(ObjectId a, ObjectId b) const;
  bool is_in_doubt(ObjectId a, ObjectId b) const;
  /// Held or in doubt.
  bool is_open(ObjectId a, ObjectId b) const { return index_.contains({a, b}); }
  std::size_t doubt_count() const { return doubt_count_; }
  /// Whether open()[index] was found in this step.
  bool found(std::size_t index) const { return found_in_step_[index] == step_; }
  const std::vector<Event>& events() const { return events_; }
  const std::vector<OpenContact>& open() const { return open_; }
  std::uint64_t last_sequence() const { return last_sequence_; }

 private:
  struct Pair {
    ObjectId a;
    ObjectId b;
    bool operator==(const Pair&) const = default;
  };
  struct PairHash {
    std::size_t operator()(const Pair& pair) const;
  };

  bool has_lost(ObjectId a, ObjectId b) const { return !lost_.empty() && (lost_.contains(a) || lost_.contains(b)); }
  void end(std::size_t index, const ContactEnd& of);
  void open(const OpenContact& opened, const FoundContact& found);
  void end_doubt(const FoundContact& found);
  void passed(const OpenContact& opened, const FoundContact& found, EndReason reason);

  std::vector<OpenContact> open_;
  std::vector<std::uint64_t> found_in_step_;  // beside open_
  std::unordered_map<Pair, std::size_t, PairHash> index_;
  std::unordered_set<ObjectId> lost_;
  std::vector<Event> events_;
  std::uint64_t step_ = 0;
  std::uint64_t last_sequence_ = 0;
  std::size_t doubt_count_ = 0;
  std::int64_t world_time_ns_ = 0;
  bool persisted_wanted_ = false;
};

}  // namespace collided::engine
