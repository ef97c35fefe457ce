#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/shape_mesh.hpp"
#include "client/cli/input/shape_text.hpp"
#include "client/cli/output/fence_output.hpp"
#include "client/cli/output/readable.hpp"
#include "client/cli/verbs/ask_options.hpp"
#include "client/cli/verbs/standing.hpp"

namespace collided::cli {
namespace {

constexpr const char* kFenceForms =
    "sphere X Y Z R, box X Y Z X Y Z (two opposite corners), prism LOW HIGH X Y X Y X Y ...,\n"
    "plane X Y Z NX NY NZ (what lies behind it), mesh FILE, hull FILE";

Vec3 vector_at(const std::vector<double>& numbers, std::size_t first) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

void need(std::string_view kind, const std::vector<double>& numbers, std::size_t count) {
  if (numbers.size() != count)
    throw bad_use(fmt::format("a {} takes {} numbers; {} given", kind, count, numbers.size()), kFenceForms);
}

Prism prism_of(const std::vector<double>& numbers) {
  if (numbers.size() < 8 || numbers.size() % 2 != 0)
    throw bad_use("a prism takes its low and high end and three corners X Y or more", kFenceForms);
  Prism prism{.corners = {}, .low_m = numbers[0], .high_m = numbers[1]};
  for (std::size_t i = 2; i < numbers.size(); i += 2) prism.corners.push_back({numbers[i], numbers[i + 1]});
  return prism;
}

/// Puts the region of words such as "box 0 0 0 5 5 3" into the fence.
void set_region(const std::vector<std::string>& words, const MeshReading& reading, const Io& io, Fence& fence) {
  const std::string& kind = words.front();
  if (is_mesh_kind(kind)) {
    fence.shape = {read_mesh_shape(words, reading, io)};
    return;
  }
  const std::vector<double> numbers = parse_numbers({words.begin() + 1, words.end()}, Measure::length);
  if (std::any_of(numbers.begin(), numbers.end(), [](double x) { return !std::isfinite(x); }))
    throw bad_use("a fence's numbers must be finite");
  if (kind == "sphere") {
    need(kind, numbers, 4);
    fence.shape = {SphereShape{.radius_m = numbers[3], .center = vector_at(numbers, 0)}};
  } else if (kind == "box") {
    need(kind, numbers, 6);
    const Vec3 a = vector_at(numbers, 0);
    const Vec3 b = vector_at(numbers, 3);
    fence.shape = {BoxShape{.half_m = (b - a).cwiseAbs() / 2, .center = (a + b) / 2}};
  } else if (kind == "plane") {
    need(kind, numbers, 6);
    fence.shape = {HalfSpaceShape{.normal = vector_at(numbers, 3), .point = vector_at(numbers, 0)}};
  } else if (kind == "prism") {
    fence.prism = prism_of(numbers);
  } else {
    throw bad_use(fmt::format("no region '{}'", kind), kFenceForms);
  }
}

/// What "enter,exit" says that a fence tells.
void set_told(const std::vector<std::string>& words, Fence& fence) {
  if (words.empty()) return;
  fence.enter = fence.exit = fence.cross = false;
  for (const std::string& word : words) {
    if (word == "enter") fence.enter = true;
    else if (word == "exit") fence.exit = true;
    else if (word == "cross") fence.cross = true;
    else throw bad_use(fmt::format("--detect {}: nothing that a fence tells", word), "enter, exit, cross");
  }
}

class FenceCommand : public StandingCommand {
 public:
  FenceCommand() : StandingCommand({"fence", "fence", "fences"}) {}

  void declare(CLI::App& app) override {
    option(app, "words add|ls|rm|watch NAME", words_, "add NAME REGION NUMBERS, ls [GLOB], rm GLOB, or watch [GLOB]");
    option(app, "--to OBJECT", fence_.to, "add: object that it moves along with; the numbers are in its frame");
    option(app, "--only GLOB", only_, "add: objects that it looks at; watch: fences or objects (glob)");
    option(app, "--skip GLOB", skip_, "add: objects that it leaves out; watch: fences or objects (glob)");
    option(app, "--mask", mask_, "add: layers that it looks at: bits (all)");
    option(app, "--detect WORDS", detect_, "add: what it tells, of enter, exit and cross (all)")
        ->allow_extra_args(false)
        ->delimiter(',');
    declare_mesh_reading(app, reading_);
    declare_ends(app);
  }

 private:
  Exit add(Session& session, const Globals& globals) override {
    if (words_.size() < 3) throw bad_use("a name and a region are needed", kFenceForms);
    fence_.name = words_[1];
    fence_.only = only_;
    fence_.skip = skip_;
    fence_.mask = mask_;
    fence_.keep = is_kept_;
    set_told(detect_, fence_);
    set_region({words_.begin() + 2, words_.end()}, reading_, session.io, fence_);
    take(session.client(globals).add_fence(fence_));
    return stands(session, globals, fence_.name);
  }

  Exit list(Session& session, const Globals& globals) override {
    return print_list(
        session, globals, take(session.client(globals).fences(word(1))),
        {"FENCE", "REGION", "TO", "LOOKS AT", "TELLS", "KEPT", "INSIDE"},
        [](const ListedFence& fence) { return fence_record(fence); }, fence_row);
  }

  std::size_t remove(Session& session, const Globals& globals, const std::string& glob) override {
    return take(session.client(globals).remove_fences(glob));
  }

  Exit follow(Session& session, const Globals& globals, const std::string& glob) override {
    FenceWatch watch = take(session.client(globals).watch_fences({.only = glob.empty() ? only_ : glob, .skip = skip_}));
    return follow_events(session, globals, std::move(watch), until(), usual_fence_fields(), fence_line,
                         [](const FenceEvent& event) { return fence_record(event); });
  }

  Fence fence_;
  std::vector<std::string> detect_;
  MeshReading reading_;
};

}  // namespace

std::unique_ptr<Command> make_fence() { return std::make_unique<FenceCommand>(); }

}  // namespace collided::cli
