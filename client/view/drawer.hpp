#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "client/view/web_server.hpp"
#include "collided/client.hpp"

namespace collided::view {

/// Draws the world as SVG, as `collide draw` does, for browsers without WebGL. It draws only on request, on a thread of
/// its own, which pauses after each drawing for as long as the drawing took. The client must outlive it.
class Drawer {
 public:
  Drawer(Client& client, bool y_is_up);
  ~Drawer();
  Drawer(const Drawer&) = delete;
  Drawer& operator=(const Drawer&) = delete;

  /// The newest drawing, null before the first is done; requests another one. Any thread; returns at once.
  Bytes newest();

 private:
  void work();
  Bytes draw() const;

  Client& client_;
  const bool y_is_up_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Bytes newest_;
  bool is_wanted_ = false;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace collided::view
