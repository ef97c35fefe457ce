// The service beside what it is made of, in one run: single rays beside ddsperf, batches beside the engine's own answers
// in this process on as many threads, one client's questions beside another's flood.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>

#include "idl/topics.hpp"
#include "server/intake/scene.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/service/child_process.hpp"
#include "tests/studies/bench/rows.hpp"
#include "tests/studies/bench/service_rays.hpp"

namespace {

using namespace collided;
using namespace collided::engine;
using bench::Method;
using bench::Work;
using testing_support::ChildProcess;

constexpr std::size_t kBatch = 10'000;
// A ray's question and the answer with a hit are 180 and 330 bytes.
constexpr std::size_t kRoundTripBytes = 300;
constexpr std::size_t kChunk = wire_contract::kMaxQuestionsPerChunk;

/// service_bench, told what to do line by line.
class Asker {
 public:
  explicit Asker(int domain) {
    int in[2];
    int out[2];
    if (pipe(in) != 0 || pipe(out) != 0) std::abort();
    pid_ = fork();
    if (pid_ == 0) {
      dup2(in[0], 0);
      dup2(out[1], 1);
      for (const int end : {in[0], in[1], out[0], out[1]}) close(end);
      execl(COLLIDED_ASKER, COLLIDED_ASKER, "steps", "--domain", std::to_string(domain).c_str(), nullptr);
      _exit(127);
    }
    close(in[0]);
    close(out[1]);
    to_ = fdopen(in[1], "w");
    from_ = fdopen(out[0], "r");
  }
  ~Asker() {
    std::fclose(to_);
    std::fclose(from_);
    waitpid(pid_, nullptr, 0);
  }
  Asker(const Asker&) = delete;
  Asker& operator=(const Asker&) = delete;

  /// The numbers of its answer.
  std::vector<double> ask(const std::string& line) {
    std::fprintf(to_, "%s\n", line.c_str());
    std::fflush(to_);
    char answer[256];
    if (!std::fgets(answer, sizeof answer, from_)) std::exit(1);  // it has said why
    std::istringstream words(answer);
    std::vector<double> numbers;
    for (double number = 0; words >> number;) numbers.push_back(number);
    return numbers;
  }

 private:
  pid_t pid_ = -1;
  std::FILE* to_ = nullptr;
  std::FILE* from_ = nullptr;
};

struct Service {
  Service(const std::string& scene, unsigned threads, const std::string& folder, int of_domain)
      : domain(of_domain),
        server({COLLIDED_SERVER, "--domain", std::to_string(domain), "--state-dir", folder, "--threads",
                std::to_string(threads), scene},
               folder, "server" + std::to_string(threads)) {
    if (!server.says("ready:", std::chrono::seconds(60))) {
      std::fprintf(stderr, "wire_bench: %s\n", server.errors().c_str());
      std::exit(1);
    }
    asker = std::make_unique<Asker>(domain);
  }
  int domain;
  ChildProcess server;
  std::unique_ptr<Asker> asker;
};

std::string write_terrain(const std::string& folder, std::uint32_t cells) {
  const TriangleMesh mesh = scenes::terrain(cells, 100, 1);
  const std::string path = folder + "/terrain.off";
  std::ofstream file(path);
  file.precision(17);
  file << "OFF\n" << mesh.vertices.size() << ' ' << mesh.triangles.size() << " 0\n";
  for (const Vec3& vertex : mesh.vertices) file << vertex[0] << ' ' << vertex[1] << ' ' << vertex[2] << '\n';
  for (const auto& corners : mesh.triangles)
    file << "3 " << corners[0] << ' ' << corners[1] << ' ' << corners[2] << '\n';
  return path;
}

/// The engine alone: chunks of the same batches, shared out among threads.
class Engine {
 public:
  explicit Engine(std::uint32_t cells) : numbers_(service_rays(kBatch, 1)) {
    Scene scene;
    scene.name = "terrain";
    scene.mesh = scenes::terrain(cells, 100, 1);
    scene.parts = {{.name = "terrain/all",
                    .first_triangle = 0,
                    .triangle_count = static_cast<std::uint32_t>(scene.mesh.triangles.size()),
                    .filter = {}}};
    triangles = scene.mesh.triangles.size();
    const auto indexed = World::index_scene(std::move(scene), {});
    world_.add_scene(indexed);
    world_.step(1, 1, {});
  }
  void answer_batches(int count, unsigned thread_count) {
    std::atomic<std::size_t> next{0};
    const std::size_t chunks = static_cast<std::size_t>(count) * (kBatch / kChunk);
    const auto work = [&] {
      Answers answers;
      QueryScratch scratch;
      const SnapshotRing::Lease state = world_.newest();
      for (std::size_t chunk = next++; chunk < chunks; chunk = next++) {
        const std::size_t first = chunk % (kBatch / kChunk) * kChunk * kRayNumbers;
        const Questions asked{.numbers = std::span(numbers_).subspan(first, kChunk * kRayNumbers)};
        answer(*state, asked, answers, scratch);
      }
    };
    std::vector<std::thread> threads;
    for (unsigned i = 1; i < thread_count; ++i) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
  }
  void answer_singles(std::size_t count) {
    Answers answers;
    QueryScratch scratch;
    const SnapshotRing::Lease state = world_.newest();
    for (std::size_t i = 0; i < count; ++i) {
      answer(*state, {.numbers = std::span(numbers_).subspan(i % kBatch * kRayNumbers, kRayNumbers)}, answers, scratch);
    }
  }
  std::size_t triangles = 0;

 private:
  World world_{WorldOptions{}};
  std::vector<double> numbers_;
};

/// ddsperf's median round trip in nanoseconds, samples of so many bytes both ways; 0 where it is not installed. It
/// prints half a round trip: what it prints, times its count of them, is half of the time they took one after the other.
double ddsperf_ns(std::size_t bytes, int domain) {
  const std::string size = std::to_string(bytes);
  const std::string id = std::to_string(domain);
  const std::string command = "ddsperf -i " + id + " -D 5 pong >/dev/null 2>&1 & pong=$!; sleep 0.3; ddsperf -i " + id +
                              " -D 2.2 ping size " + size +
                              " 2>/dev/null; kill $pong 2>/dev/null; wait $pong 2>/dev/null";
  std::FILE* output = popen(command.c_str(), "r");
  if (!output) return 0;
  double median_us = 0;
  char line[512];
  while (std::fgets(line, sizeof line, output)) {
    // "[1234] 2.000  vm:1233 size 300 mean 5.7us min 5.0us 50% 5.6us 90% ..."
    if (const char* at = std::strstr(line, "50% ")) median_us = std::atof(at + 4);
  }
  pclose(output);
  return 2e3 * median_us;
}

/// Poses until the server has applied them, and what they cost the publisher.
void measure_poses(const bench::Options& options, Asker& asker) {
  for (const int each : {1, 1'000}) {
    const int flushes = (options.quick ? 10'000 : 100'000) / (each == 1 ? 1 : 20);
    const std::string line = "poses " + std::to_string(flushes) + ' ' + std::to_string(each);
    const double poses = static_cast<double>(flushes) * each;
    std::vector<Method> methods{
        {.name = "collided over DDS", .own_ns = [&] { return 1e3 * asker.ask(line)[1] / poses; }},
        {.name = "flush alone", .own_ns = [&] { return 1e3 * asker.ask(line)[0] / poses; }}};
    measure(options,
            {.scene = "terrain",
             .size = 1'000,
             .name = "poses, " + std::to_string(each) + " a flush",
             .questions = static_cast<std::size_t>(poses),
             .on_the_wall = true},
            methods);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bench::Options options = bench::read_options(argc, argv);
  const testing_support::ScratchFolder folder;
  const int domain = testing_support::own_domain();
  const std::uint32_t cells = options.quick ? 100 : 700;
  const std::string scene = write_terrain(folder.path(), cells);
  Engine engine(cells);
  const int batches = options.quick ? 5 : 20;
  const int singles = options.quick ? 2'000 : 10'000;
  for (const unsigned threads : {1U, 2U}) {
    Service service(scene, threads, folder.path(), domain);
    Asker& asker = *service.asker;
    const std::string suffix = " " + std::to_string(threads) + "t";
    if (threads == 1 && options.wants("terrain", "single")) {
      std::vector<Method> methods{
          {.name = "collided over DDS",
           .own_ns = [&] { return 1e3 * asker.ask("single " + std::to_string(singles))[0]; }},
          {.name = "ddsperf 300 B", .own_ns = [&] { return ddsperf_ns(kRoundTripBytes, domain + 1); }},
          {.name = "collided in process", .run = [&] { engine.answer_singles(static_cast<std::size_t>(singles)); }}};
      measure(options,
              {.scene = "terrain",
               .size = engine.triangles,
               .name = "single ray p50",
               .questions = static_cast<std::size_t>(singles),
               .on_the_wall = true},
              methods);
    }
    if (options.wants("terrain", "batches")) {
      for (const int askers : {1, 2}) {
        std::vector<Method> methods{
            {.name = "collided over DDS",
             .run =
                 [&] {
                   asker.ask("batches " + std::to_string(kBatch) + ' ' + std::to_string(batches / askers) + ' ' +
                             std::to_string(askers));
                 }},
            {.name = "collided in process", .run = [&] { engine.answer_batches(batches / askers * askers, threads); }}};
        measure(options,
                {.scene = "terrain",
                 .size = engine.triangles,
                 .name = "batches" + suffix + ' ' + std::to_string(askers) + " askers",
                 .questions = kBatch * static_cast<std::size_t>(batches / askers * askers),
                 .on_the_wall = true},
                methods);
      }
    }
    if (threads == 1 && options.wants("terrain", "poses")) measure_poses(options, asker);
    if (options.wants("terrain", "flood")) {
      const std::string count = std::to_string(singles / 5);
      const std::vector<double> alone = asker.ask("single " + count);
      const std::vector<double> flooded = asker.ask("flood 100000 " + count);
      std::printf(
          "single ray%s, us: alone p50 %.1f p90 %.1f p99 %.1f worst %.1f; beside batches of 100,000 p50 %.1f p90 %.1f "
          "p99 %.1f worst %.1f\n",
          suffix.c_str(), alone[0], alone[1], alone[2], alone[3], flooded[0], flooded[1], flooded[2], flooded[3]);
    }
  }
  if (options.wants("terrain", "threads")) {
    std::vector<Method> methods{{.name = "collided, two threads", .run = [&] { engine.answer_batches(batches, 2); }},
                                {.name = "collided, one thread", .run = [&] { engine.answer_batches(batches, 1); }}};
    measure(options,
            {.scene = "terrain",
             .size = engine.triangles,
             .name = "threads",
             .questions = kBatch * static_cast<std::size_t>(batches),
             .on_the_wall = true},
            methods);
  }
  return 0;
}
