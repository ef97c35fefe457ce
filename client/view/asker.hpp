#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "client/view/page_question.hpp"
#include "collided/client.hpp"

namespace collided::view {

/// Asks a server what pages want to know, on threads of its own: an answer may take its time, a web server may not.
class Asker {
 public:
  using Done = std::function<void(std::string text)>;  // the answer as the page reads it; on a thread of the asker's

  explicit Asker(Client& client);
  ~Asker();
  Asker(const Asker&) = delete;
  Asker& operator=(const Asker&) = delete;

  /// False when too many wait already. Any thread; returns at once.
  bool ask(PageQuestion question, Done done);

 private:
  static constexpr std::size_t kMostWaiting = 64;
  static constexpr std::size_t kThreads = 2;
  struct Job {
    PageQuestion question;
    Done done;
  };
  void work();
  std::string answer(const PageQuestion& question);

  Client& client_;
  std::mutex mutex_;
  std::condition_variable came_;
  std::deque<Job> waiting_;
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace collided::view
