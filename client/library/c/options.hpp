#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <collided/robot.hpp>
#include <collided/voxels.hpp>

#include "client/library/c/values.hpp"
#include "idl/answers/commands.hpp"
#include "idl/described_json.hpp"

/// The options that the C interface takes as JSON text, and the small answers that it returns as JSON.
namespace collided {

constexpr auto fields_of(const ConnectOptions*) {
  using T = ConnectOptions;
  return fields<&T::domain, &T::name_space, &T::interface, &T::peers, &T::wait, &T::keys, &T::replicas,
                &T::wait_is_limit>();
}

constexpr auto fields_of(const WatchOptions*) {
  using T = WatchOptions;
  return fields<&T::only, &T::skip, &T::persisted, &T::capacity, &T::since>();
}

constexpr auto fields_of(const PublishOptions*) { return fields<&PublishOptions::lease, &PublishOptions::gap>(); }
template <>
inline constexpr bool kIsRow<PublisherReport::MissingObject> = true;
constexpr auto fields_of(const PublisherReport::MissingObject*) {
  using T = PublisherReport::MissingObject;
  return fields<&T::name, &T::why>();
}
constexpr auto fields_of(const PublisherReport*) {
  using T = PublisherReport;
  return fields<&T::refused, &T::left_out, &T::left_out_count, &T::merged_poses>();
}

template <>
inline constexpr bool kIsRow<JointValue> = true;
constexpr auto fields_of(const JointValue*) { return fields<&JointValue::name, &JointValue::position>(); }

constexpr auto fields_of(const VoxelScan*) {
  using T = VoxelScan;
  return fields<&T::points, &T::refused, &T::far, &T::dropped, &T::occupied, &T::crossed, &T::changed>();
}

namespace c {

/// Options of a watch of standing questions; an empty form means any.
struct StandingWatchWords {
  std::string only;
  std::string skip;
  std::string form;
  std::size_t capacity = StandingWatchOptions{}.capacity;
};
constexpr auto fields_of(const StandingWatchWords*) {
  using T = StandingWatchWords;
  return fields<&T::only, &T::skip, &T::form, &T::capacity>();
}

/// An object of a publisher, newly defined or claimed.
struct PublishedObject : ObjectOptions {
  bool claim = false;
};
constexpr auto fields_of(const PublishedObject*) {
  using T = ObjectOptions;
  return listed(fields<&T::name, &T::scale, &T::pose, &T::layers, &T::mask, &T::group, &T::moving, &T::solid>(),
                field("solid_by", &T::solid_by_winding, kSolidByWords), field("lost", &T::lost_policy),
                fields<&T::unknown, &PublishedObject::claim>());
}

struct ClaimedRobot : PublishedRobotOptions {
  std::string urdf;  // path
};
constexpr auto fields_of(const ClaimedRobot*) {
  using T = PublishedRobotOptions;
  return listed(fields<&ClaimedRobot::urdf, &T::scene, &T::base, &T::joints, &T::beyond_limits>(),
                field("lost", &T::lost_policy));
}
struct RobotMotion {
  std::vector<JointValue> joints;
  std::optional<Pose> base;
  bool teleport = false;
};
constexpr auto fields_of(const RobotMotion*) {
  using T = RobotMotion;
  return fields<&T::joints, &T::base, &T::teleport>();
}

struct VoxelsShown : VoxelOptions {
  std::uint32_t layers = 1;
  LostPolicy lost = LostPolicy::freeze;
};
constexpr auto fields_of(const VoxelsShown*) {
  using T = VoxelOptions;
  return fields<&T::cell_m, &T::unknown, &T::decay, &T::reach_m, &T::clearing_delay, &T::most_blocks,
                &VoxelsShown::layers, &VoxelsShown::lost>();
}

/// The objects moved in collided_what_if.
struct ImaginedObjects {
  std::vector<std::string> objects;
  std::vector<std::vector<std::string>> attached;
  double nearer_m = WhatIfOptions{}.nearer_m;
  bool with_filtered = false;
};
constexpr auto fields_of(const ImaginedObjects*) {
  using T = ImaginedObjects;
  return fields<&T::objects, &T::attached, &T::nearer_m, &T::with_filtered>();
}

/// Reads options from a text, which may be null. Error bad_input for an unknown member or one of the wrong type: a
/// misspelt option must not be ignored.
///
/// what  the owner of the options, for the error
template <Described T>
Result<T> options_of(const char* given, const std::string& what) {
  const auto unfit = [&what](const std::string& why) {
    return Error{ErrorCode::bad_input, what + ": its options: " + why, "nothing was sent"};
  };
  const std::string words = text(given);
  const nlohmann::json json = words.empty() ? nlohmann::json::object() : nlohmann::json::parse(words, nullptr, false);
  if (!json.is_object()) return unfit("they are not a JSON object");
  for (const auto& [name, value] : json.items()) {
    std::string known;
    bool is_known = false;
    visit_fields<T>([&, &wanted = name](const auto& field) {
      is_known |= wanted == field.name;
      known += (known.empty() ? "" : ", ") + std::string(field.name);
    });
    if (!is_known) return unfit("'" + name + "' is unknown; known are " + known);
  }
  try {
    return from_json<T>(json, true);
  } catch (const nlohmann::json::exception& wrong) {
    const std::string why = wrong.what();
    return unfit(why.substr(why.find("] ") + 2));  // skips the JSON library's error number
  }
}

/// Gives the caller a copy of a text, to be freed by collided_free_text; a null target is skipped.
Result<void> hand_out(std::string_view words, char** target);
/// Gives the caller an answer as JSON. Texts of a damaged file may not be UTF-8.
template <class Answer>
Result<void> hand_out_json(const Answer& answer, char** target) {
  if (!target) return {};
  return hand_out(json_of(answer).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), target);
}

}  // namespace c
}  // namespace collided
