#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collided::fuzz::load_or_refuse("fuzz.bt", data, size);
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  using namespace std::string_literals;
  const std::string head = "# Octomap OcTree binary file\n# comment\n#\nid OcTree\nsize 3\nres 0.05\ndata\n";
  return {head + "\x02\xc0\x08\x00"s, head + "\xff\xff\x0a\x00\x02\x02\x10\x20\x03\x00\x02\x00"s};
}
