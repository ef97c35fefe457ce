#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "tests/service/child_process.hpp"

namespace collided::testing_support {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// The real server as a process of its own, on a domain of this test's.
class ServerProcess : public ::testing::Test {
 protected:
  /// Starts `collided` and waits until it says that it is ready.
  ChildProcess& start(const std::vector<std::string>& options = {}, const std::string& name = "server") {
    launch(options, name);
    EXPECT_TRUE(servers_.back()->says("ready:", seconds(20))) << servers_.back()->errors();
    return *servers_.back();
  }
  /// Does not wait.
  ChildProcess& launch(const std::vector<std::string>& options, const std::string& name) {
    std::vector<std::string> words{COLLIDED_SERVER, "--domain", std::to_string(domain_), "--state-dir", folder_.path()};
    words.insert(words.end(), options.begin(), options.end());
    servers_.push_back(std::make_unique<ChildProcess>(words, folder_.path(), name));
    return *servers_.back();
  }
  /// Runs the server to its end, for starts that are to fail.
  struct Ended {
    int code = -1;
    std::string output;
    std::string errors;
  };
  Ended run(const std::vector<std::string>& options) {
    std::vector<std::string> words{COLLIDED_SERVER};
    words.insert(words.end(), options.begin(), options.end());
    ChildProcess process(words, folder_.path(), "run");
    const int code = process.wait(seconds(20));
    return {code, process.output(), process.errors()};
  }

  /// What failed only elsewhere is understood by what the servers said there.
  void TearDown() override {
    constexpr std::size_t kMostBytes = 4'000;
    if (!HasFailure()) return;
    for (const std::unique_ptr<ChildProcess>& server : servers_) {
      const std::string said = server->errors();
      std::printf("server %d said:\n%s\n", static_cast<int>(server->pid()),
                  said.substr(said.size() - std::min(said.size(), kMostBytes)).c_str());
    }
  }

  ScratchFolder folder_;
  const int domain_ = own_domain();
  std::vector<std::unique_ptr<ChildProcess>> servers_;
};

}  // namespace collided::testing_support
