#include "tests/service/allocation/counting.hpp"

#include <dds/dds.h>
#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <deque>

// The names below take the place of the library's own, in this program and in every library that it loads.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace collided::test {
namespace {

std::atomic<bool> counting{false};
std::atomic<bool> our_listeners{false};
std::atomic<std::uint64_t> allocations{0}, locks{0}, takes{0}, listener_writes{0}, worker_writes{0};

struct Thread {
  int in_listener = 0;
  int in_dds = 0;
  int here = 0;
  bool works = false;  // has written a reply without being called by DDS
  bool asks = false;
};
thread_local constinit Thread thread;

bool counted() {
  if (!counting.load(std::memory_order_relaxed) || thread.in_dds > 0) return false;
  return thread.here > 0 || (!thread.asks && (thread.in_listener > 0 || thread.works));
}

void note_allocation() {
  if (counted()) allocations.fetch_add(1, std::memory_order_relaxed);
}

struct InDds {
  InDds() { ++thread.in_dds; }
  ~InDds() { --thread.in_dds; }
};

template <class Function>
Function* real(Function*, const char* name) {
  const InDds not_ours;
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// What DDS is given in place of a listener of ours.
struct Wrapped {
  Wrapped(dds_on_data_available_fn given, void* with) : callback(given), argument(with) {}
  dds_on_data_available_fn callback;
  void* argument;
};

/// A listener is made with the argument of its callbacks, then told its callbacks.
struct NewestListener {
  dds_listener_t* made;
  void* argument;
};
thread_local constinit NewestListener newest_listener{};

void call_wrapped(dds_entity_t reader, void* raw) {
  const Wrapped& wrapped = *static_cast<Wrapped*>(raw);
  const int in_dds = thread.in_dds;
  thread.in_dds = 0;
  ++thread.in_listener;
  wrapped.callback(reader, wrapped.argument);
  --thread.in_listener;
  thread.in_dds = in_dds;
}

}  // namespace

void count_new_listeners(bool on) { our_listeners.store(on); }
void never_count_this_thread() { thread.asks = true; }
CountHere::CountHere() { ++thread.here; }
CountHere::~CountHere() { --thread.here; }

void start_counting() {
  for (auto* count : {&allocations, &locks, &takes, &listener_writes, &worker_writes}) count->store(0);
  counting.store(true);
}

Counts stop_counting() {
  counting.store(false);
  return counts_so_far();
}

Counts counts_so_far() {
  return {.allocations = allocations,
          .locks = locks,
          .takes = takes,
          .listener_writes = listener_writes,
          .worker_writes = worker_writes};
}

}  // namespace collided::test

using namespace collided::test;

extern "C" {

void* malloc(std::size_t size) {
  note_allocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note_allocation();
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  note_allocation();
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note_allocation();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  note_allocation();
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  static auto* const next = real(&pthread_mutex_lock, "pthread_mutex_lock");
  if (counted()) locks.fetch_add(1, std::memory_order_relaxed);
  return next(mutex);
}

dds_return_t dds_take(dds_entity_t reader, void** samples, dds_sample_info_t* infos, std::size_t size,
                      std::uint32_t most) {
  static auto* const next = real(&dds_take, "dds_take");
  dds_return_t taken = 0;
  {
    const InDds not_ours;
    taken = next(reader, samples, infos, size, most);
  }
  if (taken > 0 && counted()) takes.fetch_add(1, std::memory_order_relaxed);
  return taken;
}

dds_return_t dds_return_loan(dds_entity_t entity, void** samples, std::int32_t count) {
  static auto* const next = real(&dds_return_loan, "dds_return_loan");
  const InDds not_ours;
  return next(entity, samples, count);
}

dds_return_t dds_write(dds_entity_t writer, const void* sample) {
  static auto* const next = real(&dds_write, "dds_write");
  if (thread.in_listener == 0 && !thread.asks) thread.works = true;
  if (counted()) (thread.in_listener > 0 ? listener_writes : worker_writes).fetch_add(1, std::memory_order_relaxed);
  const InDds not_ours;
  return next(writer, sample);
}

dds_listener_t* dds_create_listener(void* argument) {
  static auto* const next = real(&dds_create_listener, "dds_create_listener");
  newest_listener = {next(argument), argument};
  return newest_listener.made;
}

void dds_lset_data_available(dds_listener_t* listener, dds_on_data_available_fn callback) {
  static auto* const next = real(&dds_lset_data_available, "dds_lset_data_available");
  static auto* const next_with_argument = real(&dds_lset_data_available_arg, "dds_lset_data_available_arg");
  if (!our_listeners.load() || newest_listener.made != listener) return next(listener, callback);
  static std::deque<Wrapped> wrapped;
  next_with_argument(listener, call_wrapped, &wrapped.emplace_back(callback, newest_listener.argument), true);
}

}  // extern "C"
