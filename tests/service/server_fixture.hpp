#pragma once

#include "collided/client.hpp"
#include "tests/service/eventually.hpp"
#include "tests/service/server_process.hpp"

namespace collided::testing_support {

/// The real server, asked through the client library.
class ServerTest : public ServerProcess {
 protected:
  Client connect(const std::string& name_space = "collided") {
    Result<Client> client = Client::connect({.domain = domain_, .name_space = name_space, .wait = seconds(10)});
    EXPECT_TRUE(client) << client.error().message << " " << client.error().hint;
    return std::move(*client);
  }
  static Watch watch(Client& client) {
    Result<Watch> watch = client.watch();
    EXPECT_TRUE(watch) << watch.error().message;
    // Until a status has vouched for what holds, events count as part of it.
    EXPECT_TRUE(test::eventually([&] { return watch->in_step(); }));
    return std::move(*watch);
  }
  /// The lease is longer than any pause of a crowded machine; a test of losses gives its own.
  static Publisher publish(Client& client, const std::string& name, milliseconds lease = seconds(60)) {
    Result<Publisher> publisher = client.publish(name, {.lease = lease});
    EXPECT_TRUE(publisher) << publisher.error().message;
    return std::move(*publisher);
  }
  static Event next(Watch& watch, milliseconds wait = seconds(20)) {
    const std::optional<Event> event = watch.next(wait);
    EXPECT_TRUE(event) << "no event in time";
    return event.value_or(Event{});
  }
  /// A ball of radius 0.1 m.
  static Publisher::Object add_ball(Publisher& publisher, const std::string& name, const Pose& pose,
                                    LostPolicy lost_policy = LostPolicy::remove) {
    const Result<Publisher::Object> added = publisher.add(
        {.name = name, .shape = {SphereShape{.radius_m = 0.1}}, .pose = pose, .lost_policy = lost_policy});
    EXPECT_TRUE(added) << added.error().message;
    return *added;
  }
  static void move(Publisher& publisher, Publisher::Object object, const Pose& pose) {
    EXPECT_TRUE(publisher.move(object, pose));
    EXPECT_TRUE(publisher.flush());
  }
  static Pose at(double x, double y, double z) { return {.position = {x, y, z}}; }
};

}  // namespace collided::testing_support
