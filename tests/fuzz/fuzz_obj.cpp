#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collided::fuzz::load_or_refuse("fuzz.obj", data, size);
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  return {
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\no a\nf 1 2 3\ng b\nf 1/1 2/1 3/1 4/1\nusemtl c\nf 1//1 "
      "2//1 "
      "3//1\nf -4/1/1 -3/1/1 -2/1/1\np 1\nl 1 2\n",
      "# an L\r\nv 2 1 0\r\nv 1 1 0\r\nv 1 2 0\r\nv 0 2 0\r\nv 0 0 0\r\nv 2 0 0\r\nf 1 2 3 \\\r\n4 5 6\r\n",
      "v 0 0 0 1 0 0\nv 1e3 +.5 -2.e-3 0.5\nv 3 3 3\nv 0.5 0.5 0.5\nv 4 0 1\nf 1 2 3 4 5\nf 1 3 2 5 4\nf 1 1 1 1\n",
  };
}
