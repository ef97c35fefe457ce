#include "client/view/drawer.hpp"

#include <chrono>

#include "client/draw/drawing/drawing.hpp"

namespace collided::view {

Drawer::Drawer(Client& client, bool y_is_up) : client_(client), y_is_up_(y_is_up), thread_([this] { work(); }) {}

Drawer::~Drawer() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

Bytes Drawer::newest() {
  const std::lock_guard lock(mutex_);
  is_wanted_ = true;
  changed_.notify_all();
  return newest_;
}

void Drawer::work() {
  using Clock = std::chrono::steady_clock;
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return is_stopping_ || is_wanted_; });
    if (is_stopping_) return;
    is_wanted_ = false;
    lock.unlock();
    const Clock::time_point start = Clock::now();
    Bytes drawn = draw();
    const Clock::duration took = Clock::now() - start;
    lock.lock();
    if (drawn) newest_ = std::move(drawn);
    changed_.wait_for(lock, took, [&] { return is_stopping_; });
  }
}

/// A new drawing; null if the server does not answer, and then the last one stays.
Bytes Drawer::draw() const {
  constexpr double kCreaseCosine = 0.866;
  const Result<ShownObjects> shown = client_.shapes({.edges = true, .crease_cosine = kCreaseCosine});
  if (!shown || shown->objects.empty()) return nullptr;
  draw::DrawOptions options;
  options.view.width_px = 900;
  if (y_is_up_) options.view.up = Vec3::UnitY();
  options.crease_cosine = kCreaseCosine;
  options.sight.spacing_px = 2;
  // With a busy server a picture's rays may take longer than the timeout of an ordinary question.
  draw::Rays rays(client_, {.timeout = std::chrono::seconds(10)});
  try {
    return make_bytes(as_svg(draw::draw(*shown, options, rays).picture));
  } catch (const Error&) { return nullptr; } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

}  // namespace collided::view
