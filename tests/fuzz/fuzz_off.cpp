#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collided::fuzz::load_or_refuse("fuzz.off", data, size);
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  return {
      "OFF\n# a comment\n4 3 0\n0 0 0\n1 0 0\n1 1 0.1\n0 1 0.1\n3 0 1 2\n4 0 1 2 3\n2 0 1\n",
      "STCNOFF 5 1 0\n0 0 0 0 0 1 255 0 0 255 0 0\n1 0 0\n1 1 0\n.5 .2 0\n0 1 0\n5 0 1 2 3 4 0.5 0.5 0.5\n",
  };
}
