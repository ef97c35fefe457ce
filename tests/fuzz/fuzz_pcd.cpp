#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collided::fuzz::load_or_refuse("fuzz.pcd", data, size);
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  const std::string head =
      "VERSION 0.7\nFIELDS x y z i\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 "
      "0 0\nPOINTS 2\nDATA ";
  const std::string points(26, '\x3f');
  // One literal and a run of it: 26 bytes in six.
  const std::string lzf{"\x01\x3f\x3f\xe0\x0f\x00", 6};
  return {
      head + "ascii\n1 2 3 7\nnan nan nan 0\n",
      head + "binary\n" + points,
      head + "binary_compressed\n" + std::string("\x06\0\0\0\x1a\0\0\0", 8) + lzf,
  };
}
