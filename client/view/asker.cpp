#include "client/view/asker.hpp"

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

#include "client/view/page_answers.hpp"
#include "idl/commands.hpp"

namespace collided::view {

Asker::Asker(Client& client, ServerMemory& memory, const PageFeed& feed)
    : client_(client), memory_(memory), feed_(feed) {
  for (std::size_t i = 0; i < kThreads; ++i) threads_.emplace_back([this] { work(); });
}

Asker::~Asker() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
    waiting_.clear();
  }
  memory_.stop();
  came_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool Asker::ask(PageQuestion question, Done done) {
  {
    const std::lock_guard lock(mutex_);
    if (is_stopping_ || waiting_.size() >= kMostWaiting) return false;
    waiting_.push_back({std::move(question), std::move(done)});
  }
  came_.notify_one();
  return true;
}

void Asker::work() {
  for (;;) {
    std::unique_lock lock(mutex_);
    came_.wait(lock, [&] { return is_stopping_ || !waiting_.empty(); });
    if (is_stopping_) return;
    const Job job = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    job.done(answer(job.question));
  }
}

namespace {

/// Asks each kind of question, like the command line: a batch of one.
struct AskServer {
  Client& client;
  ServerMemory& memory;
  const PageFeed& feed;
  double id;

  std::string operator()(const RayQuestion& ray) const {
    return ray_answer_text(id, ray, client.ask(std::span<const RayQuestion>(&ray, 1)));
  }
  std::string operator()(const SphereQuestion& sphere) const {
    return hits_answer_text(id, "sphere", client.ask(std::span<const SphereQuestion>(&sphere, 1)));
  }
  std::string operator()(const BoxQuestion& box) const {
    return hits_answer_text(id, "box", client.ask(std::span<const BoxQuestion>(&box, 1)));
  }
  std::string operator()(const NearestToPoint& nearest) const {
    AskOptions options;
    options.max_hits = nearest.count;
    return hits_answer_text(id, "near", client.ask(std::span<const NearQuestion>(&nearest.near, 1), options));
  }
  std::string operator()(const SweptBall& sweep) const {
    const Shape ball{SphereShape{.radius_m = sweep.radius_m}};
    return hits_answer_text(id, "sweep", client.sweep(ball, std::span<const SweepQuestion>(&sweep.motion, 1)));
  }
  std::string operator()(const PairOfNames& pair) const {
    return pair_answer_text(id, pair.a, pair.b, client.pair(pair.a, pair.b));
  }
  std::string operator()(const ObjectOfName& object) const { return object_answer_text(id, client.get(object.name)); }
  /// It is asked repeatedly while an object is chosen, so it may not keep the server busy for long.
  std::string operator()(const NearestToObject& object) const {
    ClearanceOptions options;
    options.deadline = std::chrono::milliseconds(50);
    return nearest_answer_text(id, object.name, client.clearance(object.name, options));
  }
  std::string operator()(const Remembered& wanted) const {
    const auto last =
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(wanted.last_s));
    return memory_answer_text(id, memory.fetch(client, last, feed.shown()));
  }
  std::string operator()(const SampledSince& sampled) const {
    const std::string arguments = "{\"since\":" + std::to_string(static_cast<std::uint64_t>(sampled.since)) + "}";
    return sampled_answer_text(
        id, client.command(wire_contract::command::kSampled, arguments, {}, std::chrono::seconds(1)));
  }
  std::string operator()(const Owners&) const {
    constexpr std::uint64_t kMostListed = 100'000;
    return owners_answer_text(id, client.list({.moving = true, .limit = kMostListed}));
  }
};

}  // namespace

std::string Asker::answer(const PageQuestion& question) {
  return std::visit(AskServer{client_, memory_, feed_, question.id}, question.what);
}

}  // namespace collided::view
