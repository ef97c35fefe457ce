#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <type_traits>
#include <utility>

#include "server/service/commands/command_arguments.hpp"
#include "server/service/questions/answering.hpp"

namespace collided::engine::service {

/// A command's handler and its thread. It throws BadCommand to refuse.
struct BoundCommand {
  using Work = std::function<nlohmann::json(const CommandAsk&, const Arguments&)>;
  using HandOn = std::function<void(CommandAsk, const Arguments&)>;

  const char* name;
  bool is_on_world_thread = false;  // else `work` runs on the thread that asks
  Work work = {};                   // returns the answer
  HandOn hand_on = {};              // instead of `work`: another thread sends the answer later
};

/// The handler of a family takes the command and its arguments, only the arguments, or nothing.
template <class Family, class Handler>
BoundCommand::Work work_of(Family* family, Handler handler) {
  return [family, handler](const CommandAsk& ask, const Arguments& arguments) -> nlohmann::json {
    if constexpr (std::is_invocable_v<Handler, Family*, const CommandAsk&, const Arguments&>)
      return std::invoke(handler, family, ask, arguments);
    else if constexpr (std::is_invocable_v<Handler, Family*, const Arguments&>)
      return std::invoke(handler, family, arguments);
    else return std::invoke(handler, family);
  };
}

/// Answered on the thread that asks, so it reads a snapshot only.
template <class Family, class Handler>
BoundCommand on_asking_thread(const char* name, Family* family, Handler handler) {
  return {.name = name, .work = work_of(family, handler)};
}

template <class Family, class Handler>
BoundCommand on_world_thread(const char* name, Family* family, Handler handler) {
  return {.name = name, .is_on_world_thread = true, .work = work_of(family, handler)};
}

/// Passed on to a thread for slow work.
template <class Family, class Handler>
BoundCommand handed_on(const char* name, Family* family, Handler handler) {
  return {.name = name, .hand_on = [family, handler](CommandAsk ask, const Arguments& arguments) {
            std::invoke(handler, family, std::move(ask), arguments);
          }};
}

}  // namespace collided::engine::service
