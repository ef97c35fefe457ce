// A process joins a domain once; who comes later shares what is there, or is told why it cannot.
#include <gtest/gtest.h>

#include <stdexcept>

#include "client/library/connection/shared_participant.hpp"
#include "tests/service/wire/network.hpp"

namespace collided::client {
namespace {

using dds::Role;

ConnectOptions this_domain() { return {.domain = test::own_domain(), .name_space = test::own_namespace()}; }

std::string refusal(const ConnectOptions& options, Role role) {
  try {
    static_cast<void>(join_domain(options, role));
    return "joined";
  } catch (const std::invalid_argument& wrong) { return wrong.what(); }
}

TEST(SharedParticipant, WhatListensToClientsMustJoinFirst) {
  const std::string domain = "domain " + std::to_string(this_domain().domain);
  {
    const auto client = join_domain(this_domain(), Role::client);
    EXPECT_EQ(join_domain(this_domain(), Role::client), client);
    EXPECT_EQ(
        refusal(this_domain(), Role::server),
        domain +
            ": this process has joined it as a client, which other clients cannot find; what listens to them must be "
            "the first to join");
  }
  const auto listener = join_domain(this_domain(), Role::server);
  EXPECT_EQ(join_domain(this_domain(), Role::server), listener);
  EXPECT_EQ(join_domain(this_domain(), Role::client), listener);
}

TEST(SharedParticipant, OneProcessUsesOneInterfaceAndOneListOfPeers) {
  const auto first = join_domain(this_domain());
  const std::string said = "domain " + std::to_string(this_domain().domain) +
                           ": this process has joined it on interface '" + this_domain().interface +
                           "'; one process uses one interface and one list of peers a domain";
  ConnectOptions elsewhere = this_domain();
  elsewhere.interface = "auto";
  EXPECT_EQ(refusal(elsewhere, Role::client), said);
  ConnectOptions others = this_domain();
  others.peers = {"10.0.0.2"};
  EXPECT_EQ(refusal(others, Role::client), said);
  ConnectOptions another_domain = elsewhere;
  another_domain.domain = this_domain().domain - 100;
  another_domain.interface = this_domain().interface;
  EXPECT_NE(join_domain(another_domain), first);
}

// The last who lets go leaves the domain, and the next may join it otherwise.
TEST(SharedParticipant, WhoComesAfterTheLastHasLeftJoinsAnew) {
  for (const Role role : {Role::client, Role::server, Role::client}) EXPECT_EQ(refusal(this_domain(), role), "joined");
}

}  // namespace
}  // namespace collided::client
