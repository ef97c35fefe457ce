#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collided::fuzz::load_or_refuse("fuzz.json", data, size);
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  return {
      R"({"type":"CityJSON","version":"2.0","transform":{"scale":[0.001,0.001,0.001],"translate":[84610,447420,-1]},"CityObjects":{)"
      R"("a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2,3],[4,5,6,7]]]}]},)"
      R"("b":{"type":"Building","geometry":[{"type":"Solid","lod":2.2,"boundaries":[[[[0,1,2]],[[0,2,3]]]]},{"type":"MultiPoint","boundaries":[0]}]}},)"
      R"("vertices":[[0,0,0],[4000,0,0],[4000,4000,0],[0,4000,0],[1000,1000,0],[1000,3000,0],[3000,3000,0],[3000,1000,0]]})",
      R"({"type":"CityJSON","version":"1.0","CityObjects":{"x":{"geometry":[{"type":"CompositeSolid","lod":1,"boundaries":[[[[[0,1,2,3,4]]]]]}]}},)"
      R"("vertices":[[0,0,0],[1,0,0],[0.2,0.2,0],[1,1,0],[0,1,0]]})",
  };
}
