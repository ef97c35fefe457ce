#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "idl/topics.hpp"

namespace collided::wire_contract {
namespace {

bool is_taken(const std::string& name_space) {
  try {
    return topic_name(name_space, kPoseTopic) == name_space + "/pose_v2";
  } catch (const std::invalid_argument&) { return false; }
}

TEST(TopicName, ANamespaceIsOfLettersDigitsLinesAndStrokesWithoutADigitFirst) {
  const std::string first = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_/";
  const std::string later = first + "0123456789";
  for (int byte = 0; byte < 256; ++byte) {
    const char c = static_cast<char>(byte);
    EXPECT_EQ(is_taken(std::string(1, c)), first.find(c) != std::string::npos) << byte;
    EXPECT_EQ(is_taken(std::string("a") + c), later.find(c) != std::string::npos) << byte;
  }
  EXPECT_FALSE(is_taken(""));
  EXPECT_THROW(topic_name(std::string_view("abc").substr(0, 0), kPoseTopic), std::invalid_argument)
      << "whatever stands behind it";
}

}  // namespace
}  // namespace collided::wire_contract
