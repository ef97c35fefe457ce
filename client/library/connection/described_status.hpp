#pragma once

#include "collided/client.hpp"
#include "idl/described.hpp"

/// A server's status as JSON, with the names of `collide status --json` and the page.
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

}  // namespace collided
