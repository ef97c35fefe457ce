#include "idl/presence.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <optional>
#include <string>

namespace collided {
namespace {

using wire_contract::is_present_here;
using wire_contract::Presence;

std::string own_name(const std::string& rest) { return "presence_" + std::to_string(getpid()) + rest; }

TEST(Presence, IsSeenWhileItLives) {
  const std::string name = own_name("a");
  EXPECT_FALSE(is_present_here(7, name));
  {
    const Presence mark(7, name, "lo");
    EXPECT_TRUE(is_present_here(7, name));
    EXPECT_TRUE(is_present_here(7, name)) << "looking changes nothing";
    EXPECT_TRUE(is_present_here(7, name, "lo"));
    EXPECT_FALSE(is_present_here(7, name, "eth0"));
    EXPECT_FALSE(is_present_here(8, name));
    EXPECT_FALSE(is_present_here(7, name + "b"));
    EXPECT_FALSE(is_present_here(7, name.substr(0, name.size() - 1)));
  }
  EXPECT_FALSE(is_present_here(7, name));
}

TEST(Presence, WhoCannotBeHeardForSureIsThereAllTheSame) {
  const std::string name = own_name("keys");
  const Presence mark(7, name, "");
  EXPECT_TRUE(is_present_here(7, name));
  EXPECT_FALSE(is_present_here(7, name, "lo"));
}

TEST(Presence, ASecondOneOfTheNameIsNoneAndTakesNoneAway) {
  const std::string name = own_name("twice");
  std::optional<Presence> first(std::in_place, 7, name, "lo");
  { const Presence second(7, name, "lo"); }
  EXPECT_TRUE(is_present_here(7, name));
  first.reset();
  EXPECT_FALSE(is_present_here(7, name));
}

TEST(Presence, NamesLongerThanASocketsAreCut) {
  const std::string name = own_name(std::string(255, 'x'));
  const Presence mark(7, name, "lo");
  EXPECT_TRUE(is_present_here(7, name));
  EXPECT_FALSE(is_present_here(7, own_name("")));
}

TEST(Presence, GoesWithItsProcess) {
  const std::string name = own_name("killed");
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const Presence mark(7, name, "lo");
    static_cast<void>(write(ready[1], "!", 1) + 1);
    pause();
    _exit(0);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_TRUE(is_present_here(7, name));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_FALSE(is_present_here(7, name));
  close(ready[0]);
  close(ready[1]);
}

}  // namespace
}  // namespace collided
