#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "client/view/page_feed.hpp"
#include "client/view/page_question.hpp"
#include "client/view/server_memory.hpp"
#include "collided/client.hpp"

namespace collided::view {

/// Asks the server the questions of pages. It has threads of its own, since answers may take long and the web server's
/// thread must not wait. The destructor ends them. All arguments must outlive it.
class Asker {
 public:
  /// Called with the answer in the page's format, on one of the asker's threads.
  using Done = std::function<void(std::string text)>;

  Asker(Client& client, ServerMemory& memory, const PageFeed& feed);
  ~Asker();
  Asker(const Asker&) = delete;
  Asker& operator=(const Asker&) = delete;

  /// Queues a question; false if kMostWaiting already wait. Any thread; returns at once.
  bool ask(PageQuestion question, Done done);

 private:
  static constexpr std::size_t kMostWaiting = 64;
  static constexpr std::size_t kThreads = 2;  // so that one slow answer does not delay the next
  struct Job {
    PageQuestion question;
    Done done;
  };
  void work();
  // Asks the server and writes the answer as text.
  std::string answer(const PageQuestion& question);

  Client& client_;
  ServerMemory& memory_;
  const PageFeed& feed_;  // the static objects, in addition to the server's memory
  std::mutex mutex_;
  std::condition_variable came_;
  std::deque<Job> waiting_;
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace collided::view
