#pragma once

#include <collided/client.hpp>
#include <collided/fleet.hpp>
#include <collided/recording.hpp>

#include "idl/described.hpp"

/// Answers of the library itself as JSON. A server's status has the names of `collide status --json` and the page.
namespace collided {

constexpr auto fields_of(const PublisherInfo*) {
  using T = PublisherInfo;
  return listed(fields<&T::name, &T::applied_sequence>(), in_seconds<&T::silent>(), fields<&T::lost>());
}
constexpr auto fields_of(const ServerStatus*) {
  using T = ServerStatus;
  return listed(fields<&T::state, &T::version_text, &T::pid>(), field("namespace", &T::name_space), fields<&T::epoch>(),
                field("world", &T::version), in_seconds<&T::world_time>(),
                fields<&T::scenes, &T::static_triangles, &T::objects, &T::moving, &T::contacts, &T::contacts_truncated,
                       &T::poses_applied, &T::poses_dropped, &T::questions_answered, &T::questions_refused,
                       &T::undecided_answers, &T::last_event_sequence>(),
                in_seconds<&T::step_lasting, &T::age>(), fields<&T::publishers>());
}

template <>
inline constexpr const char* kWordsOf<Health>[] = {"ok", "warn", "fail"};
constexpr auto fields_of(const Finding*) {
  using T = Finding;
  return fields<&T::health, &T::about, &T::text, &T::remedy>();
}
constexpr auto fields_of(const FleetMember*) {
  using T = FleetMember;
  return fields<&T::server, &T::epoch, &T::role, &T::state, &T::name, &T::host, &T::pid, &T::version_text, &T::started,
                &T::up, &T::version, &T::lag, &T::scene_fingerprint, &T::world_hash, &T::hash_time, &T::clock_ahead,
                &T::alarm>();
}
constexpr auto fields_of(const Fleet*) { return fields<&Fleet::members, &Fleet::findings>(); }

constexpr auto fields_of(const RecordedEvents*) {
  using T = RecordedEvents;
  return fields<&T::events, &T::begin, &T::end, &T::scenes, &T::lost, &T::warnings>();
}
constexpr auto fields_of(const RecordedStandingEvents*) {
  using T = RecordedStandingEvents;
  return fields<&T::events, &T::begin, &T::end, &T::lost, &T::warnings>();
}
constexpr auto fields_of(const ReplayReport*) {
  using T = ReplayReport;
  return fields<&T::samples, &T::commands, &T::questions, &T::equal, &T::not_compared, &T::why_not_compared,
                &T::differences, &T::warnings, &T::stopped, &T::standing>();
}

}  // namespace collided
