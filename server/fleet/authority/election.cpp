#include "server/fleet/authority/election.hpp"

#include <fmt/format.h>

#include <chrono>
#include <future>
#include <utility>

#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/named_thread.hpp"

namespace collided::engine::service {
namespace {

using State = Leadership::PlaceState;

constexpr std::int64_t kSecondNs = 1'000'000'000;
/// From one try to take the place to the next.
constexpr std::int64_t kTryNs = 20'000'000;
constexpr std::chrono::milliseconds kStartTry{50};
/// A place that is free is left to those that stand by for so long: they hold the world of the one that had it.
constexpr std::int64_t kStandbysFirstNs = 300'000'000;

std::string named(const std::string& holder) { return holder.empty() ? "another server" : holder; }

std::chrono::steady_clock::time_point time_of(std::int64_t steady) {
  return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(steady));
}

}  // namespace

Election::Election(std::unique_ptr<etcd::LeaseStore> store, ElectionOptions options, ServingTerm& term, Notice notice)
    : options_(std::move(options)),
      term_(term),
      notice_(std::move(notice)),
      store_(std::move(store)),
      leadership_(*store_, options_.prefix, options_.life_s, options_.description, [] { return steady_ns(); }) {
  term_.end();
}

Election::~Election() { close(); }

std::uint64_t Election::begin(std::uint64_t least) {
  const std::int64_t until_ns = steady_ns() + patience_ns();
  for (;;) {
    try {
      return leadership_.draw_epoch(least);
    } catch (const etcd::StoreError& failed) {
      note_problem(failed.what());
      if (steady_ns() > until_ns)
        throw CannotServeNow(fmt::format("{}: {}\n       no epoch within {} s; nothing was started", options_.store,
                                         failed.what(), patience_ns() / kSecondNs));
    }
    std::this_thread::sleep_for(kStartTry);
  }
}

void Election::win() {
  const std::int64_t until_ns = steady_ns() + patience_ns();
  std::int64_t free_since_ns = steady_ns();
  for (std::string why; !has_place_.load();) {
    try {
      State now = leadership_.look();
      if (now != State::free) free_since_ns = steady_ns();
      if (steady_ns() - free_since_ns >= kStandbysFirstNs) now = leadership_.take();
      note_problem("");
      if (now == State::held) {
        term_.set(leadership_.confirmed_until_ns());
        has_place_.store(true);
        break;
      }
      if (now == State::free) why = "the place is taken again and again";
      else why = fmt::format("{} is the primary", named(leadership_.holder()));
      // One that was killed leaves its lease for so long.
      if (now != State::free && !std::exchange(is_waiting_told_, true))
        notice_(fmt::format("{}; waiting for its lease to end", why));
    } catch (const etcd::StoreError& failed) {
      free_since_ns = steady_ns();
      note_problem(why = failed.what());
    }
    if (steady_ns() > until_ns)
      throw CannotServeNow(
          fmt::format("{}: {}, also after {} s; nothing was started", options_.store, why, patience_ns() / kSecondNs));
    std::this_thread::sleep_for(kStartTry);
  }
  is_waiting_told_ = false;
  start();
}

void Election::connect(Notice has_successor) {
  if (!thread_.joinable()) start();
  std::string why;
  {
    const std::lock_guard lock(mutex_);
    has_successor_ = has_successor;
    why = why_left_;
  }
  if (!why.empty()) has_successor(why);
}

void Election::start() {
  thread_ = named_thread("election", [this] { run(); });
}

void Election::run() {
  std::unique_lock lock(mutex_);
  while (!is_closing_) {
    changed_.wait_until(lock, time_of(next_ns_), [this] { return is_closing_ || job_ || steady_ns() >= next_ns_; });
    if (is_closing_) break;
    const std::function<void()> job = std::exchange(job_, nullptr);
    const std::uint64_t wanted = steady_ns() < wanted_until_ns_ ? predecessor_ : 0;
    lock.unlock();
    if (job) job();
    else look_after(wanted);
    lock.lock();
    next_ns_ = steady_ns() + period_ns(steady_ns() < wanted_until_ns_);
  }
}

std::int64_t Election::patience_ns() const { return 2 * options_.life_s * kSecondNs; }

std::int64_t Election::period_ns(bool wants) const {
  if (!has_place_.load() && wants) return kTryNs;
  // Four times in the third for which a confirmation counts.
  return options_.life_s * kSecondNs / 12;
}

void Election::look_after(std::uint64_t wanted) {
  try {
    if (has_place_.load()) hold();
    else if (wanted != 0) try_to_succeed(wanted);
    else leadership_.look();  // so that a store which is away is known before it is needed
    note_problem("");
  } catch (const etcd::StoreError& failed) { note_problem(failed.what()); }
  if (!has_place_.load()) return;
  if (term_.is_over() && !std::exchange(is_silence_told_, true))
    notice_("this server's place as the primary is not confirmed: it publishes and answers nothing until it is");
  if (!term_.is_over() && std::exchange(is_silence_told_, false))
    notice_("this server's place as the primary is confirmed again: it goes on");
}

void Election::hold() {
  const State now = leadership_.confirm();
  if (now == State::held) return term_.set(leadership_.confirmed_until_ns());
  // Its own lease has ended, and nobody has taken the place: the next look takes it again.
  if (now == State::free && leadership_.last_epoch() == leadership_.epoch()) return;
  term_.end();
  has_place_.store(false);
  leave_to(now == State::passed ? fmt::format("{} (epoch {}) has this server's place; this one ends",
                                              named(leadership_.holder()), leadership_.last_epoch())
                                : fmt::format("{} knows nothing of this server any more, which ends", options_.store));
}

void Election::leave_to(const std::string& why) {
  Notice has_successor;
  {
    const std::lock_guard lock(mutex_);
    why_left_ = why;
    has_successor = has_successor_;
  }
  if (has_successor) has_successor(why);
}

void Election::try_to_succeed(std::uint64_t predecessor) {
  switch (leadership_.succeed(predecessor, options_.mode)) {
    case State::held:
      term_.set(leadership_.confirmed_until_ns());
      has_place_.store(true);
      break;
    case State::passed:
      throw etcd::StoreError(fmt::format("the one that took the place last has epoch {}, not {}, which was followed",
                                         leadership_.last_epoch(), predecessor));
    case State::others:
      if (!std::exchange(is_waiting_told_, true))
        notice_(fmt::format("waiting for the lease of {} to end", leadership_.holder()));
      break;
    case State::free: break;  // its lease has just ended; the next try takes it
  }
}

bool Election::succeeds(std::uint64_t predecessor) {
  constexpr std::int64_t kWantedNs = kSecondNs / 4;
  if (has_place_.load()) return true;
  const std::lock_guard lock(mutex_);
  const std::int64_t now_ns = steady_ns();
  if (now_ns >= wanted_until_ns_) {
    next_ns_ = 0;
    changed_.notify_all();
  }
  predecessor_ = predecessor;
  wanted_until_ns_ = now_ns + kWantedNs;
  return false;
}

void Election::done_on_thread(std::function<void()> job) {
  std::promise<void> done;
  {
    const std::lock_guard lock(mutex_);
    job_ = [&] {
      job();
      done.set_value();
    };
    changed_.notify_all();
  }
  done.get_future().wait();
}

std::optional<std::uint64_t> Election::draw_again(std::uint64_t least) {
  std::optional<std::uint64_t> drawn;
  done_on_thread([&] {
    if (has_place_.load()) return;
    try {
      drawn = leadership_.draw_epoch(least);
    } catch (const etcd::StoreError& failed) { note_problem(failed.what()); }
  });
  return drawn;
}

void Election::lend() {
  done_on_thread([this] {
    has_place_.store(false);
    term_.end();
    try {
      leadership_.resign();
    } catch (const etcd::StoreError& failed) { note_problem(failed.what()); }
  });
}

bool Election::take_back() {
  bool is_anothers = false;
  done_on_thread([&] {
    try {
      const State now = leadership_.confirm();
      is_anothers = now == State::passed || now == State::others;
      if (now == State::held) term_.set(leadership_.confirmed_until_ns());
    } catch (const etcd::StoreError& failed) { note_problem(failed.what()); }
    has_place_.store(!is_anothers);
  });
  return !is_anothers;
}

void Election::note_problem(const std::string& problem) {
  {
    const std::lock_guard lock(mutex_);
    if (problem_.empty() == problem.empty()) {
      problem_ = problem;
      return;
    }
    problem_ = problem;
  }
  notice_(problem.empty() ? options_.store + " answers again" : options_.store + ": " + problem);
}

std::string Election::problem() const {
  const std::lock_guard lock(mutex_);
  const bool is_silent = has_place_.load() && term_.is_over();
  const std::string why = problem_.empty() ? "" : fmt::format("{}: {}", options_.store, problem_);
  if (!is_silent) return why;
  return fmt::format("silent, since its place as the primary is not confirmed{}{}", why.empty() ? "" : ": ", why);
}

void Election::close() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      is_closing_ = true;
      changed_.notify_all();
    }
    thread_.join();
  }
  has_place_.store(false);
  term_.end();
  try {
    leadership_.resign();
  } catch (const etcd::StoreError&) {}  // it ends by itself then
}

}  // namespace collided::engine::service
