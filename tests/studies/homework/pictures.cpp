// B10: problem A of the homework over the real service: a publisher moves spheres of polygons in a cube, the server says who
// touches whom, both turn round once a contact. Two pictures of it, from the server's own events.
//   homework_pictures --out DIR --server PROGRAM [--seed N] [--spheres N]
#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <map>
#include <stdexcept>

#include "client/cli/publish/bounce.hpp"
#include "client/cli/publish/sphere_mesh.hpp"
#include "tests/service/child_process.hpp"
#include "tests/studies/homework/scene_picture.hpp"

namespace {

using namespace collided;
using namespace std::chrono_literals;

constexpr double kRate = 60;
constexpr double kSide = 1;

struct Arguments {
  std::string out;
  std::string server;
  cli::BounceOptions bounce{.spin_rad_s = 3, .seed = 2000};
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i], value = argv[i + 1];
    if (name == "--out") {
      a.out = value;
    } else if (name == "--server") {
      a.server = value;
    } else if (name == "--seed") {
      a.bounce.seed = std::stoull(value);
    } else if (name == "--spheres") {
      a.bounce.sphere_count = std::stoul(value);
    } else {
      throw std::invalid_argument("unknown argument '" + name + "'");
    }
  }
  if (a.out.empty() || a.server.empty()) throw std::invalid_argument("--out DIR --server PROGRAM are missing");
  return a;
}

template <class T>
T must(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// The spheres as a publisher's objects, and the contacts that the server says hold.
class Simulation {
 public:
  Simulation(Client& client, const cli::BounceOptions& options)
      : bounce_(options),
        watch_(must(client.watch({.persisted = true}))),
        publisher_(must(client.publish("homework"))) {
    (void)must(publisher_.add({.name = "cube", .shape = {cli::cube_walls(kSide / 2)}, .moving = false}));
    const cli::LatitudeLongitude bands = cli::bands_for(256);
    for (std::size_t i = 0; i < bounce_.spheres().size(); ++i) {
      const cli::Sphere& sphere = bounce_.spheres()[i];
      const std::string name = fmt::format("sphere/{}", i);
      number_of_[name] = i;
      meshes_.push_back(cli::sphere_mesh(sphere.radius_m, bands.latitudes, bands.longitudes));
      objects_.push_back(
          must(publisher_.add({.name = name, .shape = {meshes_.back()}, .pose = {sphere.position, sphere.rotation}})));
    }
  }

  /// Everything moves on; then what the server says of it is heard.
  void frame() {
    bounce_.step(1 / kRate);
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      (void)must(publisher_.move(objects_[i], {bounce_.spheres()[i].position, bounce_.spheres()[i].rotation}));
    }
    (void)must(publisher_.flush());
    (void)must(publisher_.wait_applied(5s));
    // Events follow on a topic of their own.
    for (std::optional<Event> event = watch_.next(5ms); event; event = watch_.next(1ms)) hear(*event);
  }

  std::size_t sphere_contacts() const {
    return static_cast<std::size_t>(std::count_if(
        open_.begin(), open_.end(), [](const auto& c) { return c.second.a != "cube" && c.second.b != "cube"; }));
  }
  std::size_t heard() const { return heard_; }
  response::SphereLedger ledger() const { return bounce_.ledger(); }

  std::string picture(const std::string& title) const {
    std::vector<homework::DrawnSphere> spheres;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      spheres.push_back({meshes_[i], {bounce_.spheres()[i].position, bounce_.spheres()[i].rotation}});
    }
    std::vector<homework::DrawnContact> contacts;
    for (const auto& [pair, event] : open_) {
      contacts.push_back({event.point, event.normal});
      for (const std::string& name : {event.a, event.b}) {
        if (const auto at = number_of_.find(name); at != number_of_.end()) spheres[at->second].touches = true;
      }
    }
    return homework::scene_picture(title, kSide, spheres, contacts);
  }

 private:
  void hear(const Event& event) {
    ++heard_;
    const std::pair key{std::min(event.a, event.b), std::max(event.a, event.b)};
    const auto a = number_of_.find(event.a), b = number_of_.find(event.b);
    const bool spheres = a != number_of_.end() && b != number_of_.end();
    const bool begins = event.kind == EventKind::began || event.kind == EventKind::open;
    if (event.kind == EventKind::ended) {
      open_.erase(key);
    } else {
      open_[key] = event;
    }
    if (spheres && begins) bounce_.contact_began(a->second, b->second);
    if (spheres && event.kind == EventKind::ended) bounce_.contact_ended(a->second, b->second);
  }

  cli::Bounce bounce_;
  Watch watch_;
  Publisher publisher_;
  std::vector<MeshShape> meshes_;
  std::vector<Publisher::Object> objects_;
  std::map<std::string, std::size_t> number_of_;
  std::map<std::pair<std::string, std::string>, Event> open_;
  std::size_t heard_ = 0;
};

void draw(Simulation& simulation, const Arguments& a, int number, int& frame, int first_frame) {
  // With some of them in contact, so that there is something to see.
  for (; frame < first_frame || (simulation.sphere_contacts() < 2 && frame < first_frame + 600); ++frame)
    simulation.frame();
  const std::string title =
      fmt::format("{} spheres of 256 polygons after {:.2f} s: {} contacts among them; seed {}", a.bounce.sphere_count,
                  frame / kRate, simulation.sphere_contacts(), a.bounce.seed);
  const std::string file = fmt::format("{}/homework_{}.svg", a.out, number);
  std::ofstream(file) << simulation.picture(title);
  fmt::print("{}: {}\n", file, title);
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments a = parse(argc, argv);
  const testing_support::ScratchFolder folder;
  const int domain = testing_support::own_domain();
  testing_support::ChildProcess server({a.server, "--domain", std::to_string(domain), "--state-dir", folder.path()},
                                       folder.path(), "server");
  if (!server.says("ready:", 20s)) throw std::runtime_error("the server did not start: " + server.errors());
  Client client = must(Client::connect({.domain = domain, .wait = 10s}));
  (void)must(client.command("clear", "{}"));  // the server's own scene is no part of the homework
  Simulation simulation(client, a.bounce);
  int frame = 0;
  draw(simulation, a, 1, frame, 30);
  draw(simulation, a, 2, frame, frame + 120);
  const response::SphereLedger ledger = simulation.ledger();
  fmt::print("{} frames, {} events heard, {} contacts, {} flips, {} sticking, energy drift {:.2g}\n", frame,
             simulation.heard(), ledger.contacts, ledger.flips, ledger.sticking, ledger.energy_drift());
  return ledger.contacts > 0 ? 0 : 1;
} catch (const std::exception& error) {
  fmt::print(stderr, "error: {}\n", error.what());
  return 2;
}
