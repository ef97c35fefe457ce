#include "server/service/questions/overload.hpp"

namespace collided::engine::service {

void Overload::note(bool poses, bool questions) {
  const Stage before = stage();
  Stage stage = before;
  // One stage up with each call under pressure, one stage down after kCalmTicks calls without.
  if (poses || questions) {
    calm_ticks_ = 0;
    if (stage != Stage::low_questions) stage = static_cast<Stage>(static_cast<int>(stage) + 1);
  } else if (++calm_ticks_ >= kCalmTicks && stage != Stage::none) {
    calm_ticks_ = 0;
    stage = static_cast<Stage>(static_cast<int>(stage) - 1);
  }
  if (stage == before) return;
  stage_.store(stage, std::memory_order_relaxed);
  if (stage == Stage::none) return notice_("no longer overloaded; everything is told and answered again");
  if (stage < before) return;
  const std::string why =
      std::string("overloaded: more ") + (poses ? "poses" : "questions") + " come than can be dealt with; ";
  notice_(why + (stage == Stage::details ? "contacts that go on are not told anew, answers not audited"
                                         : "questions of the low class are refused as well"));
}

}  // namespace collided::engine::service
