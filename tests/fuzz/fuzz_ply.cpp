#include <algorithm>
#include <cstring>

#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collided::fuzz::load_or_refuse("fuzz.ply", data, size);
  return 0;
}

namespace {

template <class Number>
void put(std::string& bytes, Number value, bool big) {
  char raw[sizeof(Number)];
  std::memcpy(raw, &value, sizeof(Number));
  if (big) { std::reverse(raw, raw + sizeof(Number)); }
  bytes.append(raw, sizeof(Number));
}

std::string binary(bool big) {
  std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                      "_endian 1.0\nelement vertex 4\nproperty double x\nproperty float y\nproperty short z\nproperty "
                      "list uchar char extra\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < 4; ++i) {
    put(bytes, 0.5 * (i & 1), big);
    put(bytes, static_cast<float>(i / 2), big);
    put(bytes, static_cast<std::int16_t>(i), big);
    put(bytes, static_cast<std::uint8_t>(1), big);
    put(bytes, static_cast<std::int8_t>(-1), big);
  }
  for (int face = 0; face < 2; ++face) {
    put(bytes, static_cast<std::uint8_t>(3), big);
    for (int i = 0; i < 3; ++i) { put(bytes, static_cast<std::int32_t>(i + face), big); }
  }
  return bytes;
}

}  // namespace

std::vector<std::string> fuzz_seeds() {
  return {
      binary(false),
      binary(true),
      "ply\nformat ascii 1.0\ncomment c\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
      "z\nelement "
      "face 2\nproperty list uchar int vertex_indices\nelement tristrips 1\nproperty list int int vertex_indices\n"
      "end_header\n0 0 0\n1 0 0\n1 1 0.1\n0 1 0.1\n.5 .5 0\n3 0 1 2\n5 0 1 4 2 3\n7 0 1 2 3 -1 0 1\n",
      "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\nelement vertex 3\nproperty double "
      "z\nproperty double y\nproperty double x\nelement edge 1\nproperty int a\nend_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 "
      "0\n7\n",
  };
}
