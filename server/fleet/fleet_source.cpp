#include "server/fleet/fleet_source.hpp"

#include <memory>
#include <string>
#include <utility>

#include "server/fleet/fleet_place.hpp"

namespace collided::engine::service {

PlaceSource fleet_source() {
  const auto fleet = std::make_shared<FleetOptions>();
  return {.apply =
              [fleet](Options& options, const Setting& setting, std::span<const std::string> values) {
                return apply_fleet_setting(*fleet, options, setting, values);
              },
          .complete = [fleet](Options& options) { find_shard(*fleet, options); },
          .make =
              [fleet](const Options& options, const dds::Participant& participant, const WorldClock& clock,
                      std::shared_ptr<spdlog::logger> log, std::function<void()> end) {
                return std::make_unique<FleetPlace>(*fleet, options, participant, clock, std::move(log),
                                                    std::move(end));
              }};
}

}  // namespace collided::engine::service
