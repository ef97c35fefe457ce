#pragma once

#include <unistd.h>

#include <array>
#include <string>

namespace collided::wire_contract {

/// The name of this machine; "unknown" if it has none.
inline std::string host_name() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) return "unknown";
  return name.data();
}

}  // namespace collided::wire_contract
