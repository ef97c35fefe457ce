#include "client/view/follower.hpp"

#include <gtest/gtest.h>

namespace collided::view {
namespace {

using namespace std::chrono_literals;

// Of a server whose steps take long: its status was always old when it was looked at, while it answered all the time.
TEST(LastHeard, AServerIsHeardOfByAnswersAndByWhatItPublishes) {
  const LastHeard::Time start{};
  LastHeard heard(start);
  EXPECT_FALSE(heard.silence_s(start + 500ms));
  EXPECT_EQ(heard.silence_s(start + 2s), 2.);
  for (std::chrono::milliseconds t = 2s; t < 83s; t += 500ms) {
    heard.note(start + t - 33ms);   // an answer
    heard.note(start + t - 900ms);  // the newest status
    EXPECT_FALSE(heard.silence_s(start + t)) << t.count();
  }
  // Without answers, the time since its newest status counts, not since one that was found fresh.
  heard.note(start + 90s);
  EXPECT_NEAR(*heard.silence_s(start + 90s + 600ms), 0.6, 1e-9);
}

}  // namespace
}  // namespace collided::view
