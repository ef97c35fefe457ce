#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "tests/service/server_fixture.hpp"

namespace collided::testing_support {

/// Standing questions of a real server.
class StandingTest : public ServerTest {
 protected:
  using Names = std::vector<std::string>;

  static StandingWatch watch_standing(Client& client, const StandingWatchOptions& options = {}) {
    Result<StandingWatch> watch = client.watch_standing(options);
    EXPECT_TRUE(watch) << watch.error().message;
    EXPECT_TRUE(test::eventually([&] { return watch->in_step(); }));
    return std::move(*watch);
  }
  static StandingEvent next(StandingWatch& watch, milliseconds wait = seconds(20)) {
    const std::optional<StandingEvent> event = watch.next(wait);
    EXPECT_TRUE(event) << "no event in time";
    return event.value_or(StandingEvent{});
  }
  static void expect(const StandingEvent& event, StandingEventKind kind, const std::string& object,
                     const std::string& other, double band_m = 0) {
    EXPECT_EQ(event.kind, kind) << name_of(event.kind);
    EXPECT_EQ(event.object, object);
    EXPECT_EQ(event.other, other);
    EXPECT_EQ(event.band_m, band_m);
  }
  static Names names(Client& client, const std::string& glob = {}, std::optional<StandingForm> form = {}) {
    Names names;
    const Result<std::vector<ListedStanding>> listed = client.standing(glob, form);
    if (!listed) return {listed.error().message};
    for (const ListedStanding& one : *listed) names.push_back(one.name);
    std::sort(names.begin(), names.end());
    return names;
  }
  /// What all of such a name hold: "drone", or of bands "drone person 2".
  static Names held(Client& client, const std::string& name) {
    Names all;
    const Result<std::vector<ListedStanding>> listed = client.standing(name);
    if (!listed) return {listed.error().message};
    for (const ListedStanding& one : *listed) {
      for (const HeldObject& held : one.holds) {
        const std::string band = " " + held.other + " " + std::to_string(held.band_m).substr(0, 1);
        all.push_back(held.object + (one.form == StandingForm::bands ? band : ""));
      }
    }
    return all;
  }

  static Standing box(const std::string& name, const Vec3& low, const Vec3& high) {
    return {.name = name, .of = Region{.shape = {BoxShape{.half_m = (high - low) / 2, .center = (low + high) / 2}}}};
  }
  static Standing dock() { return box("dock", {5, -1, 1}, {7, 1, 3}); }
  /// Between drones and persons.
  static Standing close(std::vector<double> bands_m, std::chrono::nanoseconds dwell = {}) {
    return {.name = "close",
            .only = "drone*",
            .of = Bands{.around = "person*", .bands_m = std::move(bands_m), .dwell = dwell}};
  }
  static Standing escape() {
    return {.name = "escape", .only = "door*", .of = Nearest{.to = "person", .within_m = 50}};
  }
  static Standing kept(Standing standing) {
    standing.keep = true;
    return standing;
  }
  static Standing named(const std::string& name, Standing standing) {
    standing.name = name;
    return standing;
  }
};

}  // namespace collided::testing_support
