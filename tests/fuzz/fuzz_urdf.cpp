#include "server/intake/readers/srdf.hpp"
#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace collided;
  using namespace collided::engine;
  fuzz::load_or_refuse("fuzz.urdf", data, size);
  try {
    const LinkPairs pairs = read_srdf({reinterpret_cast<const char*>(data), size}, "fuzz.srdf");
    Scene robot;
    for (const char* name : {"base", "upper", "hand"}) robot.objects.push_back({.name = name});
    fuzz::require(allow_pairs(pairs, robot) <= pairs.size(), "no more pairs are unknown than there are");
    for (const auto& [low, high] : robot.allowed_pairs->pairs()) fuzz::require(high < 3, "an allowed pair is of links");
  } catch (const LoadError&) {}
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  return {
      R"(<?xml version="1.0"?><robot name="arm"><link name="base"><collision><geometry><box size="2 4 6"/></geometry></collision></link>
<link name="upper"><collision><origin xyz="0 0 1" rpy="0 0.5 0"/><geometry><cylinder radius="0.1" length="2"/></geometry></collision>
<collision><geometry><sphere radius="0.2"/></geometry></collision></link><link name="hand"><collision><geometry><capsule radius="1" length="2"/></geometry></collision></link>
<joint name="shoulder" type="revolute"><origin xyz="1 0 0" rpy="0 0 1.5"/><parent link="base"/><child link="upper"/></joint>
<joint name="wrist" type="fixed"><parent link="upper"/><child link="hand"/></joint></robot>)",
      R"(<robot name="arm"><disable_collisions link1="base" link2="upper" reason="Adjacent"/><disable_collisions link1="hand" link2="hand"/></robot>)",
      R"(<robot name="m"><link name="l"><collision><geometry><mesh filename="package://p/a.stl" scale="1 1 1"/></geometry></collision></link></robot>)",
  };
}
