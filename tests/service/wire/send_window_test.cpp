// How many chunks of a request are under way, by what the answered ones waited for.

#include "client/library/asking/send_window.hpp"

#include <gtest/gtest.h>

#include <deque>

namespace collided::client {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

/// A request on a clock of its own: each chunk is answered after the time given.
class Asked {
 public:
  /// Sends what the window allows, and has so many chunks answered, each so long after it was sent.
  void answer(int chunks, nanoseconds after, nanoseconds compute) {
    for (int i = 0; i < chunks; ++i) {
      while (under_way_.size() < window_.size()) {
        window_.note_sent(now_);
        under_way_.push_back(now_);
      }
      now_ = std::max(now_, under_way_.front() + after);
      under_way_.pop_front();
      window_.note_answered(now_, compute);
    }
  }
  std::size_t size() const { return window_.size(); }

 private:
  SendWindow window_;
  SendWindow::Clock::time_point now_{};
  std::deque<SendWindow::Clock::time_point> under_way_;
};

TEST(ClientSendWindow, BeginsWithOneAndIsFullSoonWhereTheServerIsFree) {
  Asked asked;
  EXPECT_EQ(asked.size(), 1U);
  asked.answer(3, 3ms, 1ms);
  EXPECT_EQ(asked.size(), wire_contract::kChunksInFlight);
}

TEST(ClientSendWindow, IsOneWhereChunksWaitForThoseOfFiftyOthersAndGrowsAgainWhenTheyAreGone) {
  Asked asked;
  asked.answer(4, 2ms, 1ms);
  ASSERT_EQ(asked.size(), wire_contract::kChunksInFlight);
  asked.answer(4, 100ms, 2ms);
  EXPECT_EQ(asked.size(), 1U);
  asked.answer(100, 100ms, 2ms);
  EXPECT_EQ(asked.size(), 1U) << "never none";
  asked.answer(4, 2ms, 2ms);
  EXPECT_EQ(asked.size(), wire_contract::kChunksInFlight);
}

TEST(ClientSendWindow, StaysFullForChunksThatTakeLongToCompute) {
  Asked asked;
  // Four chunks of a second each, one after the other or two at a time.
  asked.answer(20, 4s, 1s);
  EXPECT_EQ(asked.size(), wire_contract::kChunksInFlight);
  asked.answer(20, 2s, 1s);
  EXPECT_EQ(asked.size(), wire_contract::kChunksInFlight);
}

TEST(ClientSendWindow, AnAnswerTooManyIsNoChunk) {
  SendWindow window;
  window.note_answered(SendWindow::Clock::time_point{}, 1ms);
  EXPECT_EQ(window.size(), 1U);
}

}  // namespace
}  // namespace collided::client
