#include <cstring>

#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collided::fuzz::load_or_refuse("fuzz.stl", data, size);
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  std::string binary(84 + 3 * 50, '\0');
  binary[80] = 3;
  for (std::size_t i = 0; i < 27; ++i) {
    const float value = static_cast<float>(i * i % 7) * 0.5f;
    std::memcpy(binary.data() + 84 + 50 * (i / 9) + 12 + 4 * (i % 9), &value, sizeof(value));
  }
  return {
      binary,
      "solid left\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0.1\n "
      "endloop\nendfacet\n"
      "endsolid left\nsolid right\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0.1\nvertex "
      "0 "
      "0 0\nendloop\nendfacet\nendsolid\n",
  };
}
