#pragma once

#include <unistd.h>

#include <string>

#include "idl/dds.hpp"
#include "tests/service/eventually.hpp"
#include "tests/service/own_domain.hpp"

/// Where a test's participants meet: away from those of tests that run at the same time.
namespace collided::test {

using testing_support::own_domain;
inline std::string own_namespace() { return "test_" + std::to_string(getpid()); }

/// The far side of the network inside this process: a second Cyclone domain with the same number on the wire.
inline dds::ParticipantOptions far_side() {
  return {.domain = own_domain(), .role = dds::Role::server, .process_domain = own_domain() + 100'000};
}
inline dds::ParticipantOptions near_side() { return {.domain = own_domain(), .role = dds::Role::client}; }

}  // namespace collided::test
