// Explanations by a real server, of geometry whose truth is known by hand.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

class ServerExplain : public testing_support::ServerTest {
 protected:
  static json explained(Client& client, const json& arguments) {
    Result<std::string> text = client.command("explain", arguments.dump());
    EXPECT_TRUE(text) << text.error().message << " " << text.error().hint;
    return text ? json::parse(*text) : json();
  }
  static std::string refusal(Client& client, const json& arguments) {
    const Result<std::string> text = client.command("explain", arguments.dump());
    EXPECT_FALSE(text) << arguments;
    return text ? std::string() : text.error().message;
  }
  /// Moves the object for 0.4 s by the publisher's clock, however long this takes. The time when it is there, since 1970.
  static std::chrono::nanoseconds fly(Publisher& publisher, Publisher::Object object, const Pose& to) {
    const std::chrono::nanoseconds began = std::chrono::system_clock::now().time_since_epoch();
    EXPECT_TRUE(publisher.flush(began));
    std::this_thread::sleep_for(400ms);
    EXPECT_TRUE(publisher.move(object, to));
    EXPECT_TRUE(publisher.flush(began + 400ms));
    return began + 400ms;
  }
  static void add_sphere(Client& client, const std::string& name, double radius_m, const Vec3& at,
                         std::uint32_t layers = 1) {
    const auto added = client.add(
        {.name = name, .shape = {SphereShape{.radius_m = radius_m}}, .pose = {.position = at}, .layers = layers});
    ASSERT_TRUE(added) << added.error().message;
  }
};

// The ray along x passes balls whose distances are those of their centres from the x axis, less their radii.
TEST_F(ServerExplain, ARaySaysWhatItMetAndWhatItPassed) {
  start();
  Client client = connect();
  add_sphere(client, "near", 0.5, {3, 0, 50}, 2);
  add_sphere(client, "wall", 1, {8, 0, 50});
  add_sphere(client, "behind", 1, {12, 0, 50});
  add_sphere(client, "tower", 1, {5, 0, 51.032});
  const json answer = explained(client, {{"ray", {0, 0, 50, 1, 0, 0}}, {"mask", 1}, {"most", 1}});
  EXPECT_EQ(answer.at("answer"), "hit");
  ASSERT_EQ(answer.at("met").size(), 2u);
  EXPECT_EQ(answer.at("met")[0].at("object"), "wall");
  EXPECT_DOUBLE_EQ(answer.at("met")[0].at("distance").get<double>(), 7);
  EXPECT_EQ(answer.at("met")[0].at("level"), "double");
  EXPECT_EQ(answer.at("met")[1].at("object"), "behind");
  ASSERT_EQ(answer.at("left_out").size(), 1u);
  EXPECT_EQ(answer.at("left_out")[0].at("object"), "near");
  EXPECT_EQ(answer.at("left_out")[0].at("why"), "its layers 0x2 are not in the mask 0x1");
  ASSERT_EQ(answer.at("misses").size(), 1u);
  const json& miss = answer.at("misses")[0];
  EXPECT_EQ(miss.at("object"), "tower");
  EXPECT_NEAR(miss.at("distance").get<double>(), 0.032, miss.at("error").get<double>() + 1e-14);
  EXPECT_LT(miss.at("error").get<double>(), 1e-12);
  EXPECT_NEAR(miss.at("along").get<double>(), 5, 1e-6);
  EXPECT_EQ(miss.at("where"), "beside");
  for (const json& bad :
       {json{{"ray", {0, 0, 0, 0, 0, 0}}}, json{{"ray", {0, 0, 0, 1, 0}}},
        json{{"ray", {0, 0, 0, 1, 0, 0}}, {"length", -1}}, json{{"ray", {0, 0, 0, 1, 0, 0}}, {"last_ns", 5}},
        json{{"ray", {0, 0, 0, 1, 0, 0}}, {"why_not", "nobody"}}})
    EXPECT_FALSE(refusal(client, bad).empty()) << bad;
}

// What passes a fixed ray is explained at an instant between two poses, where it was in the way.
TEST_F(ServerExplain, AnInstantOfThePastIsExplainedAsItWas) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "flight");
  const Publisher::Object drone = add_ball(publisher, "drone", at(5, -4, 50));
  const std::int64_t end_ns = fly(publisher, drone, at(5, 4, 50)).count();
  ASSERT_TRUE(publisher.wait_applied(20s));
  const json ray{0, 0, 50, 1, 0, 0};
  const json now = explained(client, {{"ray", ray}});
  EXPECT_EQ(now.at("answer"), "miss");
  EXPECT_NEAR(now.at("misses")[0].at("distance").get<double>(), 3.9, 1e-9);
  // Half of the way before its end it is on the ray.
  bool was_hit = false;
  double least_m = 10;
  for (int back_ms = 0; back_ms < 400; back_ms += 5) {
    const json then =
        explained(client, {{"ray", ray}, {"as_of", std::to_string(end_ns - std::int64_t{1'000'000} * back_ms)}});
    was_hit = was_hit || then.at("answer") == "hit";
    if (then.at("answer") == "miss" && !then.at("misses").empty())
      least_m = std::min(least_m, then.at("misses")[0].at("distance").get<double>());
  }
  EXPECT_TRUE(was_hit);
  EXPECT_LT(least_m, 0.2);
  // The two of a pair likewise: the path ends at the instant.
  add_sphere(client, "post", 0.1, {5, 4, 50.5});
  const json pair = explained(client, {{"a", "drone"}, {"b", "post"}});
  EXPECT_NEAR(pair.at("distance").get<double>(), 0.3, 1e-9);
  EXPECT_NE(refusal(client, {{"ray", ray}, {"as_of", "-9000000000000"}}).find("this server remembers poses"),
            std::string::npos);
}

// A box from 4 to 6 in each direction: what is in it is 1 m and a radius from the nearest way out.
TEST_F(ServerExplain, AFenceSaysWhoIsInHowDeepAndWhoIsNot) {
  start();
  Client client = connect();
  const BoxShape box{.half_m = {1, 1, 1}, .center = {5, 5, 50}};
  ASSERT_TRUE(client.add(Standing{.name = "dock", .only = "ball*", .of = Region{.shape = {box}}}));
  Publisher publisher = publish(client, "pilot");
  const Publisher::Object in = add_ball(publisher, "ball_in", at(5, 5, 50.5));
  add_ball(publisher, "ball_out", at(8, 5, 50));
  add_ball(publisher, "cart", at(5, 5, 50));
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));
  move(publisher, in, at(5, 5, 50.25));
  ASSERT_TRUE(publisher.wait_applied(20s));
  const json answer = explained(client, {{"standing", "dock"}, {"why_not", "ball_out"}});
  EXPECT_EQ(answer.at("looked_at"), 2);
  ASSERT_EQ(answer.at("holds").size(), 1u);
  EXPECT_EQ(answer.at("holds")[0].at("object"), "ball_in");
  EXPECT_NEAR(answer.at("holds")[0].at("clearance").get<double>(), -(0.75 + 0.1), 1e-9);
  ASSERT_EQ(answer.at("left_out").size(), 1u);
  EXPECT_EQ(answer.at("left_out")[0].at("object"), "cart");
  EXPECT_EQ(answer.at("left_out")[0].at("why"), "the fence looks at 'ball*' alone");
  EXPECT_EQ(answer.at("asked_for").at("answer"), "outside");
  EXPECT_NEAR(answer.at("asked_for").at("clearance").get<double>(), 1.9, 1e-9);
  ASSERT_EQ(answer.at("events").size(), 1u);
  EXPECT_EQ(answer.at("events")[0].at("what"), "enter");
  EXPECT_EQ(answer.at("events")[0].at("object"), "ball_in");
  // Its event explained.
  const json event = explained(client, {{"event", answer.at("events")[0].at("sequence")}, {"of", "standing"}});
  EXPECT_EQ(event.at("what"), "enter");
  EXPECT_EQ(event.at("b"), "dock");
  EXPECT_FALSE(event.at("why_wide").empty());
  EXPECT_NE(refusal(client, {{"standing", "gate"}}).find("no standing question 'gate'"), std::string::npos);
  ASSERT_TRUE(client.add(Standing{.name = "close", .only = "cart", .of = Bands{.around = "ball_in", .bands_m = {2}}}));
  EXPECT_NE(refusal(client, {{"standing", "close"}}).find("is a margin"), std::string::npos);
}

// A ball goes 8 m along x towards another: they touch after 2.8 of 6 m, within one motion.
TEST_F(ServerExplain, AnEventSaysWhatDecidedAndWhyItsBracketIsWide) {
  start();
  Client client = connect();
  add_sphere(client, "post", 0.1, {0, 0, 50});
  Watch watch = this->watch(client);
  Publisher publisher = publish(client, "flight");
  const Publisher::Object drone = add_ball(publisher, "drone", at(-3, 0, 50));
  fly(publisher, drone, at(3, 0, 50));
  const Event began = next(watch);
  ASSERT_EQ(began.kind, EventKind::began);
  const json answer = explained(client, {{"event", began.sequence}});
  EXPECT_EQ(answer.at("what"), "began");
  const std::int64_t low_ns = answer.at("low_ns").get<std::int64_t>();
  const std::int64_t high_ns = answer.at("high_ns").get<std::int64_t>();
  EXPECT_LE(low_ns, high_ns);
  ASSERT_EQ(answer.at("bodies").size(), 2u);
  bool has_drone = false;
  for (const json& body : answer.at("bodies")) {
    EXPECT_TRUE(body.at("remembered").get<bool>());
    if (body.at("object") != "drone") continue;
    has_drone = true;
    EXPECT_EQ(body.at("publisher"), "flight");
    EXPECT_NEAR(body.at("pose")[0].get<double>(), -0.2, 1e-3);
    const std::int64_t from_ns = body.at("motion_from_ns").get<std::int64_t>();
    const std::int64_t to_ns = body.at("motion_to_ns").get<std::int64_t>();
    EXPECT_LE(from_ns, low_ns);
    EXPECT_GE(to_ns, high_ns);
    EXPECT_GT(to_ns - from_ns, 1'000'000);
  }
  EXPECT_TRUE(has_drone);
  EXPECT_EQ(answer.at("why_wide").size(), 1u);
  EXPECT_NE(answer.at("why_wide")[0].get<std::string>().find("found on the way between two poses of 'drone'"),
            std::string::npos)
      << answer.at("why_wide");
  // At 15 m/s a bracket of a microsecond is 15 um long.
  EXPECT_LT(std::abs(answer.at("before").at("clearance").get<double>()), 1e-4);
  EXPECT_LT(std::abs(answer.at("after").at("clearance").get<double>()), 1e-4);
  EXPECT_NE(refusal(client, {{"event", 999}}).find("no event 999: those of contacts from 1 to"), std::string::npos);
  EXPECT_NE(refusal(client, {{"event", 1}, {"of", "standing"}}).find("there was none of standing questions so far"),
            std::string::npos);
}

// The calls of the library say the same in numbers and names.
TEST_F(ServerExplain, TheLibraryReadsWhatIsExplained) {
  start();
  Client client = connect();
  add_sphere(client, "near", 0.5, {3, 0, 50}, 2);
  add_sphere(client, "wall", 1, {8, 0, 50});
  add_sphere(client, "tower", 1, {5, 0, 51.032});
  ExplainOptions options;
  options.mask = 1;
  options.most = 1;
  const RayQuestion along_x{.origin = {0, 0, 50}, .direction = {1, 0, 0}};
  const Result<ExplainedRay> ray = client.explain_ray(along_x, options);
  ASSERT_TRUE(ray) << ray.error().message;
  EXPECT_EQ(ray->verdict, Verdict::hit);
  EXPECT_EQ(ray->rung, Rung::filter);
  ASSERT_EQ(ray->met.size(), 1u);
  EXPECT_EQ(ray->met[0].object, "wall");
  EXPECT_EQ(ray->met[0].kind, "sphere");
  EXPECT_EQ(ray->met[0].distance_m, 7);
  ASSERT_EQ(ray->left_out.size(), 1u);
  EXPECT_EQ(ray->left_out[0].why_left_out, "its layers 0x2 are not in the mask 0x1");
  ASSERT_EQ(ray->misses.size(), 1u);
  EXPECT_NEAR(ray->misses[0].distance_m, 0.032, ray->misses[0].error_m + 1e-14);
  EXPECT_EQ(ray->misses[0].where, WhereMissed::beside);
  EXPECT_FALSE(client.explain_ray({.origin = {0, 0, 0}, .direction = {0, 0, NAN}}));
  EXPECT_FALSE(client.explain_ray({.origin = {0, 0, 0}, .direction = {0, 0, 1}, .length_m = -1}));

  const Result<ExplainedPair> pair = client.explain_pair("wall", "tower");
  ASSERT_TRUE(pair) << pair.error().message;
  EXPECT_EQ(pair->answer.verdict, Verdict::miss);
  EXPECT_NEAR(pair->answer.distance_m, std::hypot(3, 1.032) - 2, pair->answer.error_m + 1e-14);
  ASSERT_TRUE(pair->nearest);
  EXPECT_EQ(pair->nearest->end, ApproachEnd::found);
  EXPECT_LE(pair->nearest->at_least_m, pair->nearest->distance_m + pair->nearest->error_m);

  const SphereShape region{.radius_m = 2, .center = {8, 0, 50}};
  ASSERT_TRUE(client.add(Standing{.name = "dock", .of = Region{.shape = {region}}}));
  options.why_not = "near";
  const Result<ExplainedStanding> dock = client.explain_standing("dock", options);
  ASSERT_TRUE(dock) << dock.error().message;
  ASSERT_EQ(dock->holds.size(), 1u);
  EXPECT_EQ(dock->holds[0].object, "wall");
  EXPECT_EQ(dock->holds[0].verdict, Verdict::hit);
  EXPECT_TRUE(dock->holds[0].reported);
  ASSERT_TRUE(dock->asked_for);
  EXPECT_NEAR(dock->asked_for->clearance_m, 2.5, dock->asked_for->error_m + 1e-12);
  ASSERT_FALSE(dock->events.empty());
  const Result<ExplainedEvent> event = client.explain_event(dock->events[0].sequence, EventsOf::standing);
  ASSERT_TRUE(event) << event.error().message;
  EXPECT_EQ(event->what, "enter");
  EXPECT_EQ(event->a, "wall");
  EXPECT_EQ(event->bodies.size(), 2u);
  EXPECT_FALSE(client.explain_event(1'000'000));
}

// Of three lamps one is nearer but left out, one is next and one beyond the distance that was asked about.
TEST_F(ServerExplain, TheNearestSaysWhatComesNextAndWhatIsLeftOut) {
  start();
  Client client = connect();
  add_sphere(client, "guest", 0.5, {0, 0, 50});
  add_sphere(client, "lamp_off", 0.5, {2, 0, 50});
  add_sphere(client, "lamp_1", 0.5, {3, 0, 50});
  add_sphere(client, "lamp_2", 0.5, {5, 0, 50});
  add_sphere(client, "lamp_far", 0.5, {40, 0, 50});
  ASSERT_TRUE(client.add(
      Standing{.name = "light", .only = "lamp_*", .skip = "lamp_off", .of = Nearest{.to = "guest", .within_m = 20}}));
  Result<ExplainedStanding> light = client.explain_standing("light");
  const auto is_found = [&] {
    light = client.explain_standing("light");
    return light && !light->holds.empty();
  };
  ASSERT_TRUE(test::eventually(is_found)) << (light ? "nothing is nearest" : light.error().message);
  EXPECT_EQ(light->form, StandingForm::nearest);
  EXPECT_EQ(light->within_m, 20);
  ASSERT_EQ(light->holds.size(), 1u);
  EXPECT_EQ(light->holds[0].object, "lamp_1");
  EXPECT_NEAR(light->holds[0].clearance_m, 2, light->holds[0].error_m);
  EXPECT_EQ(light->looked_at, 3u);
  ASSERT_EQ(light->others.size(), 2u);
  EXPECT_EQ(light->others[0].object, "lamp_2");
  EXPECT_NEAR(light->others[0].clearance_m, 4, light->others[0].error_m);
  EXPECT_EQ(light->others[1].object, "lamp_far");
  ASSERT_EQ(light->left_out.size(), 1u);
  EXPECT_EQ(light->left_out[0].object, "lamp_off");
  EXPECT_EQ(light->left_out[0].why_left_out, "the question leaves 'lamp_off' out");
  EXPECT_EQ(light->cut_short, 0u);
  ASSERT_EQ(light->events.size(), 1u);
  EXPECT_EQ(light->events[0].what, "nearest");
  EXPECT_FALSE(client.explain_standing("dark"));
}

}  // namespace
}  // namespace collided
