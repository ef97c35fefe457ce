#pragma once

#include <cstdint>

/// Counts what this program's own code allocates and locks on the threads that serve, and nothing of what the DDS library does
/// for itself. The seam is DDS's C interface, whose functions counting.cpp stands in for: a thread is at work for us
/// from where DDS calls a listener of ours until that returns, or for good once it has written a reply, and is not
/// while a call into DDS lasts.
namespace collided::test {

struct Counts {
  std::uint64_t allocations = 0;
  std::uint64_t locks = 0;
  std::uint64_t takes = 0;            // of DDS, with a sample
  std::uint64_t listener_writes = 0;  // of DDS, on a thread that DDS had called us on
  std::uint64_t worker_writes = 0;
};

/// Listeners made while this is set are ours to count; those of the asking side are not.
void count_new_listeners(bool on);
/// The calling thread asks; it is never counted but inside a CountHere.
void never_count_this_thread();

/// Counts on this thread, as the world's thread.
class CountHere {
 public:
  CountHere();
  ~CountHere();
};

/// From zero.
void start_counting();
Counts stop_counting();
Counts counts_so_far();

}  // namespace collided::test
