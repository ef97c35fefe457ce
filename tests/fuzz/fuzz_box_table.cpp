#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collided::fuzz::load_or_refuse("fuzz.csv", data, size);
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  return {
      "name,type,sx,sy,sz,x,y,z,qw,qx,qy,qz\ntable,box,2,4,6,1,2,3,1,0,0,0\n# "
      "note\n\"wall\",box,1,1e-3,1,0,-0.5,+3,0.5,0.5,0.5,0.5\n",
      "id,min_x,min_y,min_z,max_x,max_y,max_z\nw0,0,0,0,1,2,4\nw0,1,1,1,1,1,1\n",
  };
}
