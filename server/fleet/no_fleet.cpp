#include <memory>
#include <optional>
#include <span>
#include <string>

#include "server/fleet/fleet_source.hpp"

// In place of fleet_source.cpp in a program that is built without the fleet.
namespace collided::engine::service {

PlaceSource fleet_source() {
  return {
      .apply = [](Options&, const Setting& setting, std::span<const std::string> values) -> std::optional<std::string> {
        if (values[0] == setting.fallback) return std::nullopt;
        return "the default alone, since this collided is built without the fleet (COLLIDED_FLEET)";
      },
      .complete = [](Options&) {},
      .make = [](const Options& options, const dds::Participant&, const WorldClock&,
                 const std::shared_ptr<spdlog::logger>&,
                 const std::function<void()>&) { return std::make_unique<Place>(options.name_space); }};
}

}  // namespace collided::engine::service
