// Objects that move along with others.

#include "server/geometry/float_environment.hpp"
#include "server/world/world_state.hpp"

namespace collided::engine {
namespace {

Refusal refused(const ObjectInfo& child, const std::string& why) {
  return {"object '" + child.name + "' cannot be attached: " + why + ". Nothing was attached"};
}

}  // namespace

/// Makes the object's poses follow another publisher's time. Earlier decisions stay; its pairs with other publishers'
/// objects go on from there.
void World::State::give_time_of(std::uint64_t publisher, ObjectId id) {
  const std::uint32_t slot = slot_of(id);
  const std::uint32_t before = rows.source(slot);
  if (sources[before].publisher == publisher) return;
  const std::int64_t decided_ns = sources[before].settled_of(rows[slot].posed_ns);
  const std::uint32_t source = sources.add_object(publisher);
  sources.remove_object(before);
  rows.follow_source(slot, source, sources[source].known_ns, decided_ns);
  attachments.for_each_child(id, [&](const AttachedObject& attached) { give_time_of(publisher, attached.child); });
}

/// An attached object moves as a part of its parent, about the point of the parent that moves straight.
void World::State::take_pivot(ObjectId id) {
  const AttachedObject* const attached = attachments.find(id);
  Vec3 pivot = Vec3::Zero();
  if (attached != nullptr) pivot = place(frame_of(inverse(attached->in_parent)), rows.pivot(slot_of(attached->parent)));
  rows.set_pivot(slot_of(id), pivot);
  attachments.for_each_child(id, [&](const AttachedObject& of) { take_pivot(of.child); });
}

/// Moves what is attached to an object along with it.
void World::State::carry(ObjectId parent, const Pose& pose, std::int64_t time_ns, bool teleport, bool is_streamed) {
  attachments.for_each_child(parent, [&](const AttachedObject& attached) {
    move(attached.child, composed(pose, attached.in_parent), time_ns, teleport, is_streamed);
  });
}

std::optional<Refusal> World::attach(ObjectId child, ObjectId parent, const std::optional<Pose>& in_parent) {
  const OwnFloatEnvironment own_floats;
  State& s = *state_;
  const ObjectInfo* const info = s.rows.find(child);
  const ObjectInfo* const of_parent = s.rows.find(parent);
  if (info == nullptr || of_parent == nullptr) return Refusal{"no such object. Nothing was attached"};
  if (const AttachedObject* there = s.attachments.find(child))
    return refused(*info, "it is attached to '" + there->parent_name + "' already; detach it first");
  if (!info->moving) return refused(*info, "it was added as static and stays where it is");
  if (info->publisher != 0) return refused(*info, "its poses are its publisher's");
  if (!of_parent->moving)
    return refused(*info, "'" + of_parent->name + "' stands still, so there is nothing to follow");
  if (s.attachments.follows(parent, child))
    return refused(*info, child == parent ? std::string("it is the same object as its parent")
                                          : "'" + of_parent->name + "' moves along with it");
  if (s.attachments.all().size() >= Attachments::kMost)
    return refused(*info, std::to_string(Attachments::kMost) + " objects are attached already, the limit");
  const Pose& pose_of_parent = s.rows[slot_of(parent)].pose;
  const Pose relative = in_parent.value_or(composed(inverse(pose_of_parent), s.rows[slot_of(child)].pose));
  s.attachments.add({.child = child,
                     .parent = parent,
                     .child_name = info->name,
                     .parent_name = of_parent->name,
                     .in_parent = relative});
  s.join_parent(child, parent);
  return std::nullopt;
}

/// From now on the object has its parent's time and doubts, and its pose follows from the parent's. That may move it by
/// a rounding, but every server then computes the same pose, whenever it learns about the two.
void World::State::join_parent(ObjectId child, ObjectId parent) {
  const Source& source = sources[rows.source(slot_of(parent))];
  give_time_of(source.publisher, child);
  take_pivot(child);
  const Pose pose = composed(rows[slot_of(parent)].pose, attachments.find(child)->in_parent);
  const Pose& now = rows[slot_of(child)].pose;
  if (pose.position != now.position || pose.rotation.coeffs() != now.rotation.coeffs())
    move(child, pose, sources[rows.source(slot_of(child))].known_ns, true, false);
  set_stale(child, rows[slot_of(parent)].is_stale);
}

bool World::detach(ObjectId child) {
  State& s = *state_;
  if (s.attachments.find(child) == nullptr) return false;
  s.attachments.remove(child);
  s.set_stale(child, false);
  s.give_time_of(0, child);
  s.take_pivot(child);
  return true;
}

/// After objects were removed: a child of a parent that was redefined under its name is attached to the new object; any
/// other child stays where it is.
void World::State::settle_attachments() {
  if (!std::exchange(has_lost_attached, false)) return;
  const auto moving_named = [&](const std::string& name, ObjectId id) -> ObjectId {
    if (rows.find(id) != nullptr) return id;
    const std::optional<ObjectId> again = rows.find(name);
    return again && rows.find(*again)->moving ? *again : 0;
  };
  for (std::size_t i = 0; i < attachments.all().size();) {
    const AttachedObject was = attachments.all()[i];
    const ObjectId child = moving_named(was.child_name, was.child);
    const ObjectId parent = moving_named(was.parent_name, was.parent);
    if (child == was.child && parent == was.parent) {
      ++i;
    } else if (child != 0 && parent != 0 && rows.find(child)->publisher == 0) {
      attachments.replace(i++, child, parent);
      join_parent(child, parent);
    } else {
      attachments.remove(was.child);
      if (child == was.child) set_stale(child, false), give_time_of(0, child), take_pivot(child);
      ended_attachments.push_back({.child = was.child_name, .parent = was.parent_name, .is_child_there = child != 0});
    }
  }
}

const Attachments& World::attachments() const { return state_->attachments; }

std::vector<EndedAttachment> World::take_ended_attachments() { return std::exchange(state_->ended_attachments, {}); }

}  // namespace collided::engine
