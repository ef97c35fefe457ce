#pragma once

#include <chrono>
#include <csignal>
#include <string>
#include <vector>

#include "tests/service/own_domain.hpp"

namespace collided::testing_support {

/// A program run beside the test, its output in a file. Ends with the object: SIGTERM, then SIGKILL.
class ChildProcess {
 public:
  /// words[0] is the program; output and errors go to "<folder>/<name>.out" and ".err".
  ChildProcess(const std::vector<std::string>& words, const std::string& folder, const std::string& name);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  int pid() const { return pid_; }
  void signal(int number) const;
  /// The exit code, 128 + signal for a killed one, -1 where it is still running after `wait`.
  int wait(std::chrono::milliseconds wait);
  std::string output() const;
  std::string errors() const;
  /// Whether the text stands in the output within `wait`; false at once when the program has ended without it.
  bool says(const std::string& text, std::chrono::milliseconds wait);

 private:
  int pid_ = -1;
  int exit_code_ = -1;
  std::string path_;
};

/// A fresh folder for a test's files, removed with the object.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  std::string path() const { return path_; }
  std::string write(const std::string& name, const std::string& text) const;

 private:
  std::string path_;
};

}  // namespace collided::testing_support
