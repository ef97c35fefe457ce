#include "server/world/groups/members.hpp"

#include "server/world/query/stale_reach.hpp"

namespace collided::engine {

bool Members::may_meet(std::uint32_t a, std::uint32_t b) const {
  const Member& first = members_[a];
  const Member& second = members_[b];
  if (!engine::may_meet(*first.info, *second.info)) return false;
  return !snapshot_.pair_rules || !snapshot_.pair_rules->allows(first.rule_fit, second.rule_fit);
}

std::uint32_t Members::add(ObjectId id) {
  const std::uint32_t slot = slot_of(id);
  Member& member = members_.emplace_back();
  member.info = snapshot_.objects[slot];
  if (member.info->scene_part != kNoScenePart) {
    add_part(member);
  } else {
    member.placed.frame = snapshot_.frame(slot);
    member.pose = snapshot_.poses[slot];
    member.placed.bounds = snapshot_.bounds(slot);
    if (snapshot_.has_given_poses) member.placed.pose = &member.pose;
  }
  if (snapshot_.pair_rules) member.rule_fit = snapshot_.pair_rules->fit_of(member.info->name);
  member.placed.info = member.info.get();
  member.reach = member.placed.bounds;
  if (const std::optional<Aabb> region = unknown_region(snapshot_, id)) {
    member.reach.extend(*region);
    member.is_stale = true;
  }
  return static_cast<std::uint32_t>(members_.size() - 1);
}

void Members::add_part(Member& member) {
  const std::uint32_t part = member.info->scene_part;
  for (const auto& scene : snapshot_.scenes) {
    if (part >= scene->parts.size() || scene->part_objects[part] != member.info->id) continue;
    member.scene = scene;
    member.placed.bounds = (*part_meshes_.bounds_of(scene))[part];
    return;
  }
}

const Placed& Members::placed(std::uint32_t number, Deadline& deadline) {
  Member& member = members_[number];
  if (!member.scene || member.info->mesh) return member.placed;
  auto own = std::make_shared<ObjectInfo>(*member.info);
  own->mesh = part_meshes_.mesh_of(member.scene, own->scene_part, [&deadline] { return deadline.is_over(); });
  member.info = std::move(own);
  member.placed.info = member.info.get();
  return member.placed;
}

void Members::set_pose(std::uint32_t number, const Pose& pose) {
  Member& member = members_[number];
  member.pose = pose;
  member.placed.frame = frame_of(pose);
  member.placed.pose = &member.pose;
  member.placed.bounds = bounds_of(*member.info, member.placed.frame);
  member.reach = member.placed.bounds;
  member.is_stale = false;
}

}  // namespace collided::engine
