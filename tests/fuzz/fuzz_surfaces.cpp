#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collided::fuzz::load_or_refuse("fuzz.surfaces", data, size);
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  return {
      "ball implicit x^2+y^2+z^2-1 in 0 -1 -1 1 1 1\nglobe sphere 1 count 6 4\nring implicit \\\n (x^2+y^2+z^2+3)^2 - "
      "16*(x^2+y^2)\n",
      "# a comment\nball sphere 1 count 6 4\negg ellipsoid 1 2 3 at 4 5 6 error 0.5\n",
      "can cylinder 1 2 count 7\nhat cone 1 2 error 0.1\nring torus 2 0.5 count 9 5\nsea waves 4 4 0.1 2 3 error 0.1\n",
      "p patch 1 2 2 3  0 0 0  1 0 0 \\\n 0 1 1  1 1 1  0 2 0  1 2 0  count 3 2\n",
  };
}
