// The process that reads foreign files: what it needs it may do, and nothing else.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <thread>
#include <vector>

#include "server/programs/import/sandbox.hpp"

namespace collided::engine {
namespace {

/// How a process ended that entered the sandbox and then did this with its output.
int status_after(const std::function<int(int output)>& work, const std::vector<std::string>& readable = {}) {
  char path[] = "/tmp/sandbox_XXXXXX";
  const int output = ::mkstemp(path);
  const pid_t child = ::fork();
  if (child == 0) {
    if (!enter_sandbox(output, readable).empty()) ::_exit(99);
    ::_exit(work(output));
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ::close(output);
  ::unlink(path);
  return status;
}

bool is_killed(const std::function<int(int output)>& work) {
  const int status = status_after(work);
  return WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS;
}

TEST(IntakeSandbox, ReadingThreadsMemoryAndItsOutputAreAllowed) {
  const int status = status_after(
      [](int output) {
        std::ifstream file("/etc/hostname");
        std::string word;
        file >> word;
        std::vector<double> much(1 << 20, 1.0);
        double sum = 0;
        std::thread([&] {
          for (const double value : much) sum += value;
        }).join();
        return file && sum == 1 << 20 && ::write(output, "abc", 3) == 3 && ::fsync(output) == 0 ? 0 : 1;
      },
      {"/etc/hostname"});
  ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

/// From now on this process cannot change its capabilities, as under a unit with SystemCallFilter=~@privileged.
bool forbid_capset() {
  scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
  const bool is_done = ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && filter != nullptr &&
                       seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(capset), 0) == 0 &&
                       seccomp_load(filter) == 0;
  seccomp_release(filter);
  return is_done;
}

// A service that has no capabilities may not be allowed to give them up either; its imports work all the same. Whoever
// has some and cannot give them up is stopped.
TEST(IntakeSandbox, NobodyGivesUpWhatIsNotThere) {
  if (!kSandboxLimitsCalls) GTEST_SKIP() << "sanitizers make calls of their own, so calls are not limited";
  const auto ends_with = [](bool has_capabilities) {
    const pid_t child = ::fork();
    if (child == 0) {
      constexpr uid_t kNobody = 65534;  // changing to another user takes the capabilities along
      if (!has_capabilities && ::getuid() == 0 && ::setresuid(kNobody, kNobody, kNobody) != 0) ::_exit(98);
      if (!forbid_capset()) ::_exit(97);
      ::_exit(enter_sandbox(1).empty() ? 0 : 99);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  EXPECT_EQ(ends_with(false), 0);
  if (::getuid() == 0) { EXPECT_EQ(ends_with(true), 99); }
}

TEST(IntakeSandbox, EverythingElseEndsIt) {
  if (!kSandboxLimitsCalls) GTEST_SKIP() << "sanitizers make calls of their own, so calls are not limited";
  EXPECT_TRUE(is_killed([](int) { return ::open("/tmp/sandbox_other", O_WRONLY | O_CREAT, 0600); }));
  EXPECT_TRUE(is_killed([](int) { return ::open("/tmp", O_RDWR | O_TMPFILE, 0600); }));
  EXPECT_TRUE(is_killed([](int) { return ::unlink("/tmp/sandbox_other"); }));
  EXPECT_TRUE(is_killed([](int) { return ::rename("/tmp/sandbox_other", "/tmp/sandbox_another"); }));
  EXPECT_TRUE(is_killed([](int) { return ::mkdir("/tmp/sandbox_folder", 0700); }));
  EXPECT_TRUE(is_killed([](int) { return ::chmod("/tmp/sandbox_other", 0777); }));
  EXPECT_TRUE(is_killed([](int) { return ::socket(AF_INET, SOCK_DGRAM, 0); }));
  EXPECT_TRUE(is_killed([](int) { return ::socket(AF_UNIX, SOCK_STREAM, 0); }));
  EXPECT_TRUE(is_killed([](int) { return ::execl("/bin/true", "true", nullptr); }));
  EXPECT_TRUE(is_killed([](int) { return ::fork() < 0 ? 1 : 0; }));
  EXPECT_TRUE(is_killed([](int) { return ::kill(::getppid(), 0); }));
  EXPECT_TRUE(is_killed([](int output) { return ::dup2(output, 0) < 0 ? 1 : 0; }));
  EXPECT_TRUE(is_killed([](int) { return ::setuid(0); }));
}

// What cannot be seen cannot be told: neither secrets nor the memory of the process that started it.
TEST(IntakeSandbox, OnlyTheFilesThatAreNamedCanBeOpened) {
  if (!kSandboxLimitsCalls) GTEST_SKIP() << "sanitizers make calls of their own, so calls are not limited";
  const std::string parent = "/proc/" + std::to_string(::getpid());
  const auto opens = [](const std::string& path) {
    return [path](int) { return ::open(path.c_str(), O_RDONLY) >= 0 ? 0 : 1; };
  };
  for (const std::string& path : {std::string("/etc/passwd"), parent + "/environ", parent + "/maps", parent + "/mem",
                                  std::string("/dev/zero"), std::string("/")}) {
    EXPECT_TRUE(is_killed(opens(path))) << path << ", nothing readable";
    EXPECT_EQ(status_after(opens(path), {"/etc/hostname"}), 1 << 8) << path << ", another file readable";
  }
  EXPECT_EQ(status_after(opens("/etc/hostname"), {"/etc/hostname"}), 0);
  EXPECT_EQ(status_after(opens("/etc/hostname"), {"/etc"}), 0);
  EXPECT_EQ(status_after(opens("/etc/../etc/hostname"), {"/usr"}), 1 << 8);
}

// A descriptor's owner gets signals about it, of a kind that may be chosen: so any process could be ended.
TEST(IntakeSandbox, SignalsCannotBeSentByWayOfADescriptor) {
  if (!kSandboxLimitsCalls) GTEST_SKIP() << "sanitizers make calls of their own, so calls are not limited";
  const auto is_refused = [](const std::function<int(int output)>& call) {
    return status_after([&](int output) { return call(output) == -1 && errno == EPERM ? 0 : 1; }) == 0;
  };
  EXPECT_TRUE(is_refused([parent = ::getpid()](int output) { return ::fcntl(output, F_SETOWN, parent); }));
  EXPECT_TRUE(is_refused([](int output) { return ::fcntl(output, F_SETSIG, SIGKILL); }));
  EXPECT_TRUE(is_refused([](int output) { return ::fcntl(output, F_SETFL, O_ASYNC); }));
  EXPECT_TRUE(is_killed([](int output) { return ::fcntl(output, F_NOTIFY, DN_MODIFY); }));
}

TEST(IntakeSandbox, NoPageIsExecutable) {
  if (!kSandboxLimitsCalls) GTEST_SKIP() << "sanitizers make calls of their own, so calls are not limited";
  EXPECT_TRUE(is_killed([](int) {
    return ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) == MAP_FAILED;
  }));
  EXPECT_TRUE(is_killed([](int) {
    void* page = ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return ::mprotect(page, 4096, PROT_READ | PROT_EXEC);
  }));
}

TEST(IntakeSandbox, ASmallerLimitThatIsSetStays) {
  const int status = status_after([](int) {
    rlimit set{};
    return ::getrlimit(RLIMIT_FSIZE, &set) == 0 && set.rlim_max == 4096 ? 0 : 1;
  });
  EXPECT_EQ(status, 1 << 8);
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit small{4096, 4096};
    if (::setrlimit(RLIMIT_FSIZE, &small) != 0 || !enter_sandbox(2).empty()) ::_exit(99);
    rlimit set{};
    ::_exit(::getrlimit(RLIMIT_FSIZE, &set) == 0 && set.rlim_max == 4096 ? 0 : 1);
  }
  int ended = 0;
  ::waitpid(child, &ended, 0);
  EXPECT_EQ(ended, 0);
}

// A file that would take all the memory there is takes that process's.
TEST(IntakeSandbox, MemoryHasAnEnd) {
  if (!kSandboxLimitsCalls) GTEST_SKIP() << "sanitizers map terabytes";
  const int status = status_after([](int) {
    void* too_much = std::malloc(std::size_t{9} << 30);
    return too_much == nullptr ? 7 : 0;
  });
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

}  // namespace
}  // namespace collided::engine
