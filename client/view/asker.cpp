#include "client/view/asker.hpp"

#include <utility>

#include "client/view/page_messages.hpp"

namespace collided::view {

Asker::Asker(Client& client) : client_(client) {
  for (std::size_t i = 0; i < kThreads; ++i) threads_.emplace_back([this] { work(); });
}

Asker::~Asker() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
    waiting_.clear();
  }
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

std::string Asker::answer(const PageQuestion& question) {
  if (const auto* ray = std::get_if<RayQuestion>(&question.what)) {
    // As a batch of one ray, as the command line asks.
    const Result<Answers> answers = client_.ask(std::span<const RayQuestion>(ray, 1));
    if (!answers) return refused_text(question.id, answers.error().message);
    return ray_answer_text(question.id, *ray, answers->answers.front());
  }
  if (const auto* object = std::get_if<ObjectOfName>(&question.what))
    return object_answer_text(question.id, client_.get(object->name));
  if (std::holds_alternative<Owners>(question.what)) {
    constexpr std::uint64_t kMostListed = 100'000;
    return owners_answer_text(question.id, client_.list({.moving = true, .limit = kMostListed}));
  }
  const auto& pair = std::get<PairOfNames>(question.what);
  return pair_answer_text(question.id, pair.a, pair.b, client_.pair(pair.a, pair.b));
}

}  // namespace collided::view
