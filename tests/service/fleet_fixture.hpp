#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "collided/fleet.hpp"
#include "tests/service/etcd_process.hpp"
#include "tests/service/server_fixture.hpp"

namespace collided::testing_support {

/// Servers of one namespace beside an etcd that says which of them is the primary.
class FleetTest : public ServerTest {
 protected:
  void SetUp() override {
    if (!has_etcd()) GTEST_SKIP() << "etcd-server is not installed";
    start_etcd(1);
  }
  void start_etcd(int members) {
    etcd_ = std::make_unique<EtcdCluster>(members, folder_.path());
    ASSERT_TRUE(etcd_->is_ready(seconds(20))) << etcd_->member(0).output();
    options_of_all_ = {"--authority", etcd_->address()};
  }
  /// Starts a server with a state folder of its own, and does not wait for it.
  ChildProcess& begin(const std::string& name, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{COLLIDED_SERVER,
                                   "--domain",
                                   std::to_string(domain_),
                                   "--member",
                                   name,
                                   "--state-dir",
                                   folder_.path() + "/" + name};
    words.insert(words.end(), options_of_all_.begin(), options_of_all_.end());
    words.insert(words.end(), more.begin(), more.end());
    servers_.push_back(std::make_unique<ChildProcess>(words, folder_.path(), name + std::to_string(servers_.size())));
    return *servers_.back();
  }
  ChildProcess& join(const std::string& name, const std::vector<std::string>& more = {}) {
    ChildProcess& server = begin(name, more);
    EXPECT_TRUE(server.says("ready:", seconds(20))) << server.errors();
    return server;
  }
  /// A member as it describes itself; an empty one where it is not heard.
  FleetMember member(const std::string& name) {
    const Result<Fleet> all = fleet({.domain = domain_});
    if (!all) return {};
    const auto found = std::ranges::find(all->members, name, &FleetMember::name);
    return found == all->members.end() ? FleetMember{} : *found;
  }
  /// Whether it comes to hold what the primary holds, and says so.
  bool becomes_ready(const std::string& name, Publisher& publisher) {
    return test::eventually(
        [&] {
          static_cast<void>(publisher.keep_alive());
          const FleetMember one = member(name);
          return one.state == "ready" && one.hash_time != seconds(0);
        },
        seconds(40));
  }
  bool becomes_primary(const std::string& name) {
    return test::eventually([&] { return member(name).role == FleetRole::primary && member(name).name == name; },
                            seconds(30));
  }
  static bool logs(const ChildProcess& server, const std::string& text, milliseconds wait = seconds(20)) {
    return test::eventually([&] { return server.errors().find(text) != std::string::npos; }, wait);
  }

  std::unique_ptr<EtcdCluster> etcd_;
};

}  // namespace collided::testing_support
