#include <cmath>
#include <string>
#include <string_view>
#include <variant>

#include "client/view/figures.hpp"
#include "idl/described_json.hpp"
#include "client/view/foxglove.hpp"
#include "client/view/page_question.hpp"
#include "client/view/request_rules.hpp"
#include "tests/fuzz/fuzz_target.hpp"

using namespace collided;

namespace {

bool is_name(const std::string& name) { return !name.empty() && name.size() <= 255; }

/// Whether a question of each kind can be asked as it is.
struct CanBeAsked {
  bool operator()(const RayQuestion& ray) const {
    return ray.origin.allFinite() && ray.direction.allFinite() && !ray.direction.isZero(0);
  }
  bool operator()(const SphereQuestion& ball) const {
    return ball.center.allFinite() && std::isfinite(ball.radius_m) && ball.radius_m >= 0;
  }
  bool operator()(const BoxQuestion& box) const {
    return box.center.allFinite() && box.half_m.allFinite() && (box.half_m.array() >= 0).all();
  }
  bool operator()(const view::NearestToPoint& nearest) const {
    return nearest.near.point.allFinite() && nearest.count >= 1 && nearest.count <= view::kMostNearest;
  }
  bool operator()(const view::SweptBall& sweep) const {
    return std::isfinite(sweep.radius_m) && sweep.radius_m > 0 && sweep.motion.from.position.allFinite() &&
           sweep.motion.to.position.allFinite();
  }
  bool operator()(const view::PairOfNames& pair) const { return is_name(pair.a) && is_name(pair.b); }
  bool operator()(const view::ObjectOfName& object) const { return is_name(object.name); }
  bool operator()(const view::NearestToObject& object) const { return is_name(object.name); }
  bool operator()(const view::Remembered& wanted) const {
    return wanted.last_s > 0 && wanted.last_s <= view::kMostRemembered_s;
  }
  bool operator()(const view::SampledSince& known) const { return known.since >= 0 && std::isfinite(known.since); }
  bool operator()(const view::Owners&) const { return true; }
};

}  // namespace

/// What clients of the viewer say, and what a server's figures might be.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto question = view::parse_page_question(text))
    fuzz::require(std::visit(CanBeAsked(), question->what), "a question that can be asked");
  std::size_t answers = 0;
  view::Foxglove foxglove([&](view::Foxglove::Connection, const view::WebMessage& message) {
    ++answers;
    fuzz::require(message.bytes && !message.bytes->empty(), "an answer that says something");
  });
  foxglove.opened(1);
  foxglove.said(1, text, true);
  fuzz::require(answers <= 3 + size, "no more answers than were asked for");
  const view::RequestRules rules{.hosts = {"a.example"}, .origins = {"https://b.example"}};
  if (view::may_be_called(text, "127.0.0.1", true, rules)) {
    fuzz::require(text.find("127.0.0.1") != text.npos || text.size() >= 9, "a host that is known");
  }
  if (const auto figures = view::parse_figures(text)) view::between(*figures, *figures);
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  return {R"({"ask":"ray","id":3,"origin":[0,0,5],"direction":[0,0,-1]})",
          R"({"ask":"pair","id":4,"a":"x","b":"y"})",
          R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2},{"id":2,"channelId":1}]})",
          R"({"op":"unsubscribe","subscriptionIds":[1,2]})",
          "localhost:8765",
          "[::1]:8765",
          json_of(Figures{.up_ns = 1,
                          .steps = 3,
                          .step_durations = {{100, 2}, {200, 1}},
                          .stages = {{"take", 5}},
                          .pairs = {.moved = 1},
                          .questions = {{"ray", 1, {{7, 1}}}},
                          .not_built = {"FCL"}})
              .dump()};
}
