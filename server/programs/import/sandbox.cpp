#include "server/programs/import/sandbox.hpp"

#include <fcntl.h>
#include <linux/capability.h>
#include <linux/landlock.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace collided::engine {
namespace {

constexpr rlim_t kMostMemoryBytes = rlim_t{8} << 30;
constexpr rlim_t kOutputBytes = rlim_t{4} << 30;

/// A smaller existing limit stays.
bool limit(int resource, rlim_t amount) {
  rlimit set{};
  if (::getrlimit(static_cast<__rlimit_resource_t>(resource), &set) != 0) return false;
  const rlim_t least = std::min({amount, set.rlim_cur, set.rlim_max});
  const rlimit both{least, least};
  return ::setrlimit(static_cast<__rlimit_resource_t>(resource), &both) == 0;
}

bool limit_ourselves() {
  return limit(RLIMIT_CPU, sandbox_seconds()) && limit(RLIMIT_FSIZE, kOutputBytes) && limit(RLIMIT_CORE, 0) &&
         (!kSandboxLimitsCalls || limit(RLIMIT_AS, sandbox_memory_bytes()));
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
                                     "munmap",
                                     "mremap",
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

  /// Adds a rule for a system call. A call that this kernel lacks needs none.
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

/// Landlock's system calls, for which the C library has no functions; source landlock(7).
int landlock_version() {
  return static_cast<int>(::syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION));
}

bool allow_beneath(int rules, const std::string& path) {
  landlock_path_beneath_attr rule{};
  rule.parent_fd = ::open(path.c_str(), O_PATH | O_CLOEXEC);
  if (rule.parent_fd < 0) return false;
  struct stat about {};
  const bool is_folder = ::fstat(rule.parent_fd, &about) == 0 && S_ISDIR(about.st_mode);
  rule.allowed_access = LANDLOCK_ACCESS_FS_READ_FILE | (is_folder ? LANDLOCK_ACCESS_FS_READ_DIR : 0);
  const bool is_added = ::syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
  ::close(rule.parent_fd);
  return is_added;
}

/// Allows only these files to be opened. Returns why it could not be done, or nothing.
std::string leave_only(const std::vector<std::string>& readable) {
  const int version = landlock_version();
  // A kernel may lack it; if it has it but denies its use, the limits around this process are misconfigured.
  if (version < 1 && (errno == ENOSYS || errno == EOPNOTSUPP)) return {};
  if (version < 1) return std::string("the files that it may read cannot be limited: ") + std::strerror(errno);
  // Every kind of access of the first version, and those added by the second (refer) and third (truncate).
  std::uint64_t handled = (std::uint64_t{LANDLOCK_ACCESS_FS_MAKE_SYM} << 1) - 1;
  if (version >= 2) handled |= std::uint64_t{1} << 13;
  if (version >= 3) handled |= std::uint64_t{1} << 14;
  const landlock_ruleset_attr attributes{.handled_access_fs = handled};
  const int rules = static_cast<int>(
      ::syscall(SYS_landlock_create_ruleset, &attributes, offsetof(landlock_ruleset_attr, handled_access_fs) + 8, 0));
  bool is_done = rules >= 0;
  for (const std::string& path : readable) is_done = is_done && allow_beneath(rules, path);
  is_done = is_done && ::syscall(SYS_landlock_restrict_self, rules, 0) == 0;
  const int fault = errno;
  if (rules >= 0) ::close(rules);
  return is_done ? std::string() : std::string("the files that it may read cannot be limited: ") + std::strerror(fault);
}

/// Drops privileges of a privileged user. If there are none the call is not tried: a service unit without capabilities
/// may forbid it too.
bool drop_capabilities() {
  __user_cap_header_struct header{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> held{}, none{};
  const bool is_known = ::syscall(SYS_capget, &header, held.data()) == 0;
  const auto is_none = [](const __user_cap_data_struct& some) {
    return (some.effective | some.permitted | some.inheritable) == 0;
  };
  if (is_known && std::all_of(held.begin(), held.end(), is_none)) return true;
  return ::syscall(SYS_capset, &header, none.data()) == 0;
}

/// Files may be opened only in ways that cannot change them: not written, created or truncated.
void allow_opening(SyscallFilter& filter) {
  constexpr std::uint64_t kChanging = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND;
  filter.rule(SCMP_ACT_ALLOW, "openat", SCMP_A2_64(SCMP_CMP_MASKED_EQ, kChanging, 0));
  filter.rule(SCMP_ACT_ALLOW, "open", SCMP_A1_64(SCMP_CMP_MASKED_EQ, kChanging, 0));
}

void allow_memory(SyscallFilter& filter) {
  for (const char* name : {"mmap", "mprotect"})
    filter.rule(SCMP_ACT_ALLOW, name, SCMP_A2_64(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
}

/// The C library's operations on descriptors. Setting the receiver of their signals, and which signals these are, is
/// refused.
void allow_descriptors(SyscallFilter& filter) {
  for (const unsigned command : {F_GETFD, F_SETFD, F_GETFL, F_DUPFD_CLOEXEC})
    filter.rule(SCMP_ACT_ALLOW, "fcntl", SCMP_A1_32(SCMP_CMP_EQ, command));
  for (const unsigned command : {F_SETFL, F_SETOWN, F_SETOWN_EX, F_SETSIG})
    filter.rule(SCMP_ACT_ERRNO(EPERM), "fcntl", SCMP_A1_32(SCMP_CMP_EQ, command));
}

}  // namespace

unsigned long long sandbox_memory_bytes() {
  const auto pages = static_cast<unsigned long long>(std::max(0L, ::sysconf(_SC_PHYS_PAGES)));
  const unsigned long long quarter = pages * static_cast<unsigned long long>(::sysconf(_SC_PAGE_SIZE)) / 4;
  return std::min<unsigned long long>(kMostMemoryBytes, quarter);
}

unsigned long long sandbox_seconds() {
  constexpr unsigned kDefault = 30;
  const char* text = std::getenv("COLLIDED_IMPORT_SECONDS");
  unsigned seconds = 0;
  if (text == nullptr || std::from_chars(text, text + std::strlen(text), seconds).ec != std::errc{} || seconds == 0)
    return kDefault;
  return seconds;
}

std::string enter_sandbox(int output, const std::vector<std::string>& readable) {
  if (!limit_ourselves()) return std::string("its limits cannot be set: ") + std::strerror(errno);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (!kSandboxLimitsCalls) return {};
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || ::prctl(PR_SET_DUMPABLE, 0) != 0 || !drop_capabilities())
    return std::string("its rights cannot be given up: ") + std::strerror(errno);
  if (const std::string why = leave_only(readable); !why.empty()) return why;
  SyscallFilter filter(SCMP_ACT_KILL_PROCESS);
  for (const char* name : kHarmless) filter.rule(SCMP_ACT_ALLOW, name);
  for (const int stream : {1, 2, output}) {
    for (const char* name : {"write", "pwrite64", "writev", "fsync", "ftruncate", "fallocate"})
      filter.rule(SCMP_ACT_ALLOW, name, SCMP_A0_32(SCMP_CMP_EQ, static_cast<unsigned>(stream)));
  }
  if (!readable.empty()) allow_opening(filter);
  allow_memory(filter);
  allow_descriptors(filter);
  // Threads may be made, processes not. clone3 has its flags in memory, where a filter cannot read them; refused, the C
  // library falls back to clone.
  filter.rule(SCMP_ACT_ALLOW, "clone",
              SCMP_A0_64(SCMP_CMP_MASKED_EQ, CLONE_THREAD | CLONE_VM, CLONE_THREAD | CLONE_VM));
  filter.rule(SCMP_ACT_ERRNO(ENOSYS), "clone3");
  // The C library tries these and tolerates their failure.
  for (const char* name : {"ioctl", "sched_setaffinity", "prctl"}) filter.rule(SCMP_ACT_ERRNO(EPERM), name);
  filter.rule(SCMP_ACT_ERRNO(EPERM), "prlimit64", SCMP_A2_64(SCMP_CMP_NE, 0));
  filter.rule(SCMP_ACT_ALLOW, "prlimit64", SCMP_A0_32(SCMP_CMP_EQ, 0), SCMP_A2_64(SCMP_CMP_EQ, 0));
  // A signal to itself, sent by abort().
  filter.rule(SCMP_ACT_ALLOW, "tgkill", SCMP_A0_32(SCMP_CMP_EQ, static_cast<unsigned>(::getpid())));
  const int fault = filter.load();
  if (fault != 0) return std::string("its system calls cannot be limited: ") + std::strerror(-fault);
  return {};
}

}  // namespace collided::engine
