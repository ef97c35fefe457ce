#include "server/programs/import/sandbox.hpp"

#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <memory>

namespace collided::engine {
namespace {

constexpr rlim_t kMemoryBytes = rlim_t{8} << 30;
constexpr rlim_t kProcessorSeconds = 600;
constexpr rlim_t kOutputBytes = rlim_t{4} << 30;

bool limit(int resource, rlim_t amount) {
  const rlimit both{amount, amount};
  return ::setrlimit(static_cast<__rlimit_resource_t>(resource), &both) == 0;
}

bool limit_ourselves() {
  return limit(RLIMIT_CPU, kProcessorSeconds) && limit(RLIMIT_FSIZE, kOutputBytes) && limit(RLIMIT_CORE, 0) &&
         (!kSandboxLimitsCalls || limit(RLIMIT_AS, kMemoryBytes));
}

/// System calls that are allowed with any arguments.
constexpr const char* kHarmless[] = {"read",
                                     "pread64",
                                     "readv",
                                     "lseek",
                                     "close",
                                     "fstat",
                                     "newfstatat",
                                     "stat",
                                     "lstat",
                                     "statx",
                                     "access",
                                     "faccessat",
                                     "faccessat2",
                                     "readlink",
                                     "readlinkat",
                                     "getcwd",
                                     "getdents64",
                                     "fcntl",
                                     "mmap",
                                     "munmap",
                                     "mremap",
                                     "mprotect",
                                     "madvise",
                                     "brk",
                                     "futex",
                                     "set_robust_list",
                                     "rseq",
                                     "rt_sigaction",
                                     "rt_sigprocmask",
                                     "rt_sigreturn",
                                     "sigaltstack",
                                     "sched_yield",
                                     "sched_getaffinity",
                                     "clock_gettime",
                                     "clock_nanosleep",
                                     "gettimeofday",
                                     "getrandom",
                                     "getpid",
                                     "gettid",
                                     "getrusage",
                                     "sysinfo",
                                     "uname",
                                     "restart_syscall",
                                     "exit",
                                     "exit_group"};

/// A seccomp filter under construction; the first fault is kept and returned by load().
class SyscallFilter {
 public:
  explicit SyscallFilter(std::uint32_t otherwise) : context_(::seccomp_init(otherwise)) {}
  ~SyscallFilter() {
    if (context_ != nullptr) ::seccomp_release(context_);
  }
  SyscallFilter(const SyscallFilter&) = delete;
  SyscallFilter& operator=(const SyscallFilter&) = delete;

  /// Adds a rule for a system call. One that this kernel does not have needs none.
  template <class... Conditions>
  void rule(std::uint32_t action, const char* name, Conditions... conditions) {
    const int call = ::seccomp_syscall_resolve_name(name);
    if (call == __NR_SCMP_ERROR || fault_ != 0) return;
    fault_ = context_ == nullptr ? -ENOMEM
                                 : ::seccomp_rule_add(context_, action, call, sizeof...(conditions), conditions...);
  }
  int load() const { return fault_ != 0 ? fault_ : ::seccomp_load(context_); }

 private:
  scmp_filter_ctx context_;
  int fault_ = 0;
};

}  // namespace

unsigned long long sandbox_memory_bytes() { return kMemoryBytes; }

std::string enter_sandbox(int output) {
  if (!limit_ourselves()) return std::string("its limits cannot be set: ") + std::strerror(errno);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (!kSandboxLimitsCalls) return {};
  SyscallFilter filter(SCMP_ACT_KILL_PROCESS);
  for (const char* name : kHarmless) filter.rule(SCMP_ACT_ALLOW, name);
  for (const int stream : {1, 2, output}) {
    for (const char* name : {"write", "pwrite64", "writev", "fsync", "ftruncate", "fallocate"})
      filter.rule(SCMP_ACT_ALLOW, name, SCMP_A0_32(SCMP_CMP_EQ, static_cast<unsigned>(stream)));
  }
  // Files may be opened only in ways that cannot change them: not to write, make or cut them.
  constexpr std::uint64_t kChanging = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND;
  filter.rule(SCMP_ACT_ALLOW, "openat", SCMP_A2_64(SCMP_CMP_MASKED_EQ, kChanging, 0));
  filter.rule(SCMP_ACT_ALLOW, "open", SCMP_A1_64(SCMP_CMP_MASKED_EQ, kChanging, 0));
  // Threads may be made, processes not. clone3 has its flags in memory, where a filter cannot see them; refused, the C
  // library falls back to clone.
  filter.rule(SCMP_ACT_ALLOW, "clone",
              SCMP_A0_64(SCMP_CMP_MASKED_EQ, CLONE_THREAD | CLONE_VM, CLONE_THREAD | CLONE_VM));
  filter.rule(SCMP_ACT_ERRNO(ENOSYS), "clone3");
  // The C library tries these in passing and does not mind that they fail.
  for (const char* name : {"ioctl", "prlimit64", "sched_setaffinity", "prctl"})
    filter.rule(SCMP_ACT_ERRNO(EPERM), name);
  // A signal to itself, as abort() sends it.
  filter.rule(SCMP_ACT_ALLOW, "tgkill", SCMP_A0_32(SCMP_CMP_EQ, static_cast<unsigned>(::getpid())));
  const int fault = filter.load();
  if (fault != 0) return std::string("its system calls cannot be limited: ") + std::strerror(-fault);
  return {};
}

}  // namespace collided::engine
