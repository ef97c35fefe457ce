#include "tests/drawing/gallery/stage.hpp"

#include <filesystem>

#include <nlohmann/json.hpp>

namespace collided::drawing_test {

using namespace std::chrono_literals;

Stage::Stage(const std::string& program) {
  const int domain = testing_support::own_domain();
  const std::vector<std::string> words{program, "--domain", std::to_string(domain), "--state-dir", folder_.path()};
  server_ = std::make_unique<testing_support::ChildProcess>(words, folder_.path(), "server");
  if (!server_->says("ready:", 20s)) throw std::runtime_error("the server did not start: " + server_->errors());
  client_.emplace(must(Client::connect({.domain = domain, .wait = 10s})));
  (void)must(client_->command("clear", "{}"));
}

void Stage::set(const Shape& shape) {
  // The last one's objects stay until they are cleared.
  publisher_.reset();
  (void)must(client_->command("clear", "{}"));
  publisher_.emplace(must(client_->publish("gallery")));
  (void)must(publisher_->add({.name = "thing", .shape = shape, .moving = false, .lost_policy = LostPolicy::hold}));
  (void)must(publisher_->flush());
  (void)must(publisher_->wait_applied(10s));
}

bool Stage::load(const std::string& path) {
  if (!std::filesystem::exists(path)) return false;
  publisher_.reset();
  (void)must(client_->command("clear", "{}"));
  return static_cast<bool>(client_->command("load", nlohmann::json{{"path", path}}.dump(), {}, 60s));
}

Stage::Shot Stage::shoot(draw::DrawOptions options, bool with_buffers) {
  const ShownObjects shown = must(client_->shapes({.edges = true, .crease_cosine = options.crease_cosine}));
  draw::Rays rays(*client_, AskOptions{.timeout = 30s});
  try {
    draw::Drawing drawing = draw::draw(shown, options, rays);
    Buffers buffers = with_buffers ? cast_buffers(drawing.camera, rays) : Buffers{};
    return {std::move(drawing), polygons_of(shown), std::move(buffers), rays.asked(), rays.undecided()};
  } catch (const Error& error) { throw std::runtime_error(error.message); }
}

}  // namespace collided::drawing_test
