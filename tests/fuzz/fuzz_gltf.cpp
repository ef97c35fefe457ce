#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collided::fuzz::load_or_refuse("fuzz.gltf", data, size);
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  // Four points of single precision and six corners of a byte, in base64 and behind the text of a binary file.
  const std::string floats{
      "\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\x80\x3f\0\0\0\0\0\0\x80\x3f\0\0\x80\x3f\0\0\x80\x3f\0\0\x80\x3f\0\0\0\0\0\0\x80"
      "\x3f\0\0\x80\x3f",
      48};
  const std::string corners{"\0\1\2\0\2\3\0\0", 8};
  const std::string body =
      R"("nodes":[{"translation":[1,2,3],"children":[1,2]},{"mesh":0,"rotation":[0,0,0,1],"scale":[2,-1,1]},{"mesh":1,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1]}],)"
      R"("scenes":[{"nodes":[0]}],"scene":0,"meshes":[{"name":"a","primitives":[{"attributes":{"POSITION":0},"indices":1}]},)"
      R"({"primitives":[{"attributes":{"POSITION":0},"mode":5},{"attributes":{"POSITION":2},"mode":6}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":0}}},)"
      R"({"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"},{"bufferView":0,"byteOffset":3,"componentType":5122,"normalized":true,"count":3,"type":"VEC3"}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":48,"byteStride":12},{"buffer":0,"byteOffset":48,"byteLength":6}],"asset":{"version":"2.0"})";
  std::string json = "{" + body + R"(,"buffers":[{"byteLength":54}]})";
  while (json.size() % 4 != 0) json += ' ';
  const auto number = [](std::size_t value) {
    std::string bytes;
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
    return bytes;
  };
  const std::string glb = "glTF" + number(2) + number(12 + 16 + json.size() + 56) + number(json.size()) + "JSON" +
                          json + number(56) + std::string("BIN\0", 4) + floats + corners;
  return {
      "{" + body +
          R"(,"buffers":[{"byteLength":54,"uri":"data:;base64,AAAAAAAAAAAAAIA/AACAPwAAAAAAAIA/AACAPwAAgD8AAIA/AAAAAAAAgD8AAIA/AAECAAIDAAA="}]})",
      glb,
  };
}
