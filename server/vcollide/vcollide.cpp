#include <collided/vcollide.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "server/broad_phase/grid/grid.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/indexed_mesh.hpp"

namespace collided::vcollide {

using namespace engine;
namespace {

/// How far products of the matrix's columns may be from a rotation's: as much as for the quaternions of the service.
/// At zero, VCollideAdapter.TakesARotationRoundedToSixDigits fails.
constexpr double kRotationSlack = kUnitNormSlack;

/// A closed object has a mesh; its frame is its last transform.
struct Object {
  ObjectInfo info;
  std::vector<int> triangle_ids;
  Frame frame;
  bool active = true;
};

using Pair = std::pair<int, int>;

Pair ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

/// Collects the triangle pairs of two objects that the walk offers and that overlap.
struct Meeting {
  PlacedTriangles of_a;
  PlacedTriangles of_b;
  const Object& a;
  const Object& b;
  bool all = false;
  std::vector<std::array<int, 2>> pairs{};

  bool operator()(std::uint32_t triangle_a, std::uint32_t triangle_b) {
    if (!overlaps(of_a.at(triangle_a), of_b.at(triangle_b)).yes()) return true;
    pairs.push_back({a.triangle_ids[triangle_a], b.triangle_ids[triangle_b]});
    return all;
  }
};

/// Reads the rotation nearest to the matrix and its translation; returns the error, and then leaves the frame
/// unchanged.
std::string read_frame(const double trans[4][4], Frame& frame) {
  Mat3 rotation;
  Vec3 position;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rotation(row, column) = trans[row][column];
    position[row] = trans[row][3];
  }
  if (!rotation.allFinite() || !position.allFinite()) return "a number of the matrix is not finite";
  for (int column = 0; column < 4; ++column) {
    if (trans[3][column] != (column == 3 ? 1 : 0)) {
      return fmt::format("the matrix's last row has {} in column {}, allowed are 0 0 0 1", trans[3][column], column);
    }
  }
  const double off = (rotation.transpose() * rotation - Mat3::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kRotationSlack))
    return fmt::format("the columns are off a rotation's by {}, allowed {}", off, kRotationSlack);
  if (!(rotation.determinant() > 0)) return "the matrix mirrors (determinant -1), allowed are rotations";
  frame = frame_of(Pose{.position = position, .rotation = Quat(rotation).normalized()});
  return {};
}

}  // namespace

struct VCollide::State {
  std::vector<std::unique_ptr<Object>> objects;  // by id; null once deleted
  TriangleMesh open_mesh;
  bool open = false;  // the newest object still accepts triangles
  std::set<Pair> inactive_pairs;
  std::string error;
  Grid grid{Grid::Use::pairs};
  std::vector<Aabb> bounds;
  std::vector<Pair> candidates;
  WalkCost cost;

  int fail(int code, std::string text) {
    error = std::move(text);
    return code;
  }
  /// VC_OK if the object exists and is closed; else sets the error.
  int check(const char* call, int id) {
    if (id < 0 || static_cast<std::size_t>(id) >= objects.size() || !objects[static_cast<std::size_t>(id)]) {
      return fail(VC_ERR_INVALID_ID, fmt::format("{}: no object {}; {} were made", call, id, objects.size()));
    }
    if (open && static_cast<std::size_t>(id) + 1 == objects.size()) {
      return fail(VC_ERR_CALL_OUT_OF_SEQUENCE, fmt::format("{}: object {} is open; EndObject comes first", call, id));
    }
    return VC_OK;
  }
  Object& object(int id) { return *objects[static_cast<std::size_t>(id)]; }
  int set_pair(const char* call, int a, int b, bool active);
  /// Fills bounds and candidates for the objects' present frames.
  void find_candidates();
  /// The triangle pairs of two objects that overlap, in ascending order; only the first found unless `all`.
  std::vector<std::array<int, 2>> meet(const Pair& pair, bool all);
};

int VCollide::State::set_pair(const char* call, int a, int b, bool active) {
  for (const int id : {a, b}) {
    if (const int code = check(call, id); code != VC_OK) return code;
  }
  if (a == b) return fail(VC_ERR_INVALID_ID, fmt::format("{}: object {} with itself; a pair has two", call, a));
  if (active) {
    inactive_pairs.erase(ordered(a, b));
  } else {
    inactive_pairs.insert(ordered(a, b));
  }
  return VC_OK;
}

void VCollide::State::find_candidates() {
  bounds.assign(objects.size(), Aabb{});
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i] && objects[i]->active) bounds[i] = bounds_of(objects[i]->info, objects[i]->frame);
  }
  grid.rebuild(bounds);
  candidates.clear();
  cost = {};
  const auto found = [&](std::uint32_t first, std::uint32_t second) {
    candidates.emplace_back(static_cast<int>(first), static_cast<int>(second));
    return true;
  };
  WalkCost of_grid;
  grid.pairs(found, of_grid);
  if (!inactive_pairs.empty())
    std::erase_if(candidates, [&](const Pair& pair) { return inactive_pairs.contains(pair); });
  std::sort(candidates.begin(), candidates.end());
}

std::vector<std::array<int, 2>> VCollide::State::meet(const Pair& pair, bool all) {
  const Object& a = object(pair.first);
  const Object& b = object(pair.second);
  Meeting meeting{{*a.info.mesh->mesh, a.frame}, {*b.info.mesh->mesh, b.frame}, a, b, all};
  walk_mesh_pairs({&a.info, a.frame, bounds[static_cast<std::size_t>(pair.first)]},
                  {&b.info, b.frame, bounds[static_cast<std::size_t>(pair.second)]}, meeting, kNeverOver, cost);
  std::sort(meeting.pairs.begin(), meeting.pairs.end());
  meeting.pairs.erase(std::unique(meeting.pairs.begin(), meeting.pairs.end()), meeting.pairs.end());
  return std::move(meeting.pairs);
}

VCollide::VCollide() : state_(std::make_unique<State>()) {}
VCollide::~VCollide() = default;

int VCollide::NewObject(int* id) {
  State& s = *state_;
  if (id == nullptr) return s.fail(VC_ERR, "NewObject: the id has no place to go");
  if (s.open) {
    return s.fail(VC_ERR_CALL_OUT_OF_SEQUENCE,
                  fmt::format("NewObject: object {} is open; EndObject comes first", s.objects.size() - 1));
  }
  *id = static_cast<int>(s.objects.size());
  s.objects.push_back(std::make_unique<Object>());
  s.open_mesh = {};
  s.open = true;
  return VC_OK;
}

int VCollide::AddTri(const double v1[3], const double v2[3], const double v3[3], int id) {
  State& s = *state_;
  if (!s.open) return s.fail(VC_ERR_CALL_OUT_OF_SEQUENCE, "AddTri: no object is open; NewObject comes first");
  const Vec3 corners[3] = {Vec3(v1[0], v1[1], v1[2]), Vec3(v2[0], v2[1], v2[2]), Vec3(v3[0], v3[1], v3[2])};
  for (int corner = 0; corner < 3; ++corner) {
    const Vec3& v = corners[corner];
    if (!v.allFinite()) {
      return s.fail(VC_ERR, fmt::format("AddTri: triangle {}, corner {} is ({}, {}, {}); allowed are finite numbers",
                                        id, corner + 1, v[0], v[1], v[2]));
    }
  }
  const auto first = static_cast<std::uint32_t>(s.open_mesh.vertices.size());
  s.open_mesh.vertices.insert(s.open_mesh.vertices.end(), corners, corners + 3);
  s.open_mesh.triangles.push_back({first, first + 1, first + 2});
  s.objects.back()->triangle_ids.push_back(id);
  return VC_OK;
}

int VCollide::EndObject() {
  State& s = *state_;
  if (!s.open) return s.fail(VC_ERR_CALL_OUT_OF_SEQUENCE, "EndObject: no object is open; NewObject comes first");
  if (s.open_mesh.triangles.empty()) {
    return s.fail(VC_ERR_EMPTY_OBJECT, fmt::format("EndObject: object {} has no triangle", s.objects.size() - 1));
  }
  const OwnFloatEnvironment own;
  auto mesh = std::make_shared<const TriangleMesh>(std::move(s.open_mesh));
  Bvh tree = Bvh::build(*mesh, {.threads = 1, .progress = {}, .cancelled = {}});
  s.objects.back()->info.mesh = indexed_mesh(std::move(mesh), std::move(tree));
  s.open_mesh = {};
  s.open = false;
  return VC_OK;
}

int VCollide::UpdateTrans(int id, const double trans[4][4]) {
  State& s = *state_;
  if (const int code = s.check("UpdateTrans", id); code != VC_OK) return code;
  const OwnFloatEnvironment own;
  if (const std::string wrong = read_frame(trans, s.object(id).frame); !wrong.empty()) {
    return s.fail(VC_ERR, fmt::format("UpdateTrans: object {}: {}; it stays where it was", id, wrong));
  }
  return VC_OK;
}

int VCollide::ActivateObject(int id) {
  if (const int code = state_->check("ActivateObject", id); code != VC_OK) return code;
  state_->object(id).active = true;
  return VC_OK;
}

int VCollide::DeactivateObject(int id) {
  if (const int code = state_->check("DeactivateObject", id); code != VC_OK) return code;
  state_->object(id).active = false;
  return VC_OK;
}

int VCollide::ActivatePair(int id1, int id2) { return state_->set_pair("ActivatePair", id1, id2, true); }
int VCollide::DeactivatePair(int id1, int id2) { return state_->set_pair("DeactivatePair", id1, id2, false); }

int VCollide::DeleteObject(int id) {
  State& s = *state_;
  if (const int code = s.check("DeleteObject", id); code != VC_OK) return code;
  s.objects[static_cast<std::size_t>(id)].reset();
  std::erase_if(s.inactive_pairs, [&](const Pair& pair) { return pair.first == id || pair.second == id; });
  return VC_OK;
}

int VCollide::Collide(VCReport* report, int flag) {
  State& s = *state_;
  if (report == nullptr) return s.fail(VC_ERR, "Collide: the report has no place to go");
  if (flag != VC_ALL_CONTACTS && flag != VC_FIRST_CONTACT) {
    return s.fail(VC_ERR, fmt::format("Collide: flag {}, allowed VC_ALL_CONTACTS (1) and VC_FIRST_CONTACT (2)", flag));
  }
  if (s.open) {
    return s.fail(VC_ERR_CALL_OUT_OF_SEQUENCE,
                  fmt::format("Collide: object {} is open; EndObject comes first", s.objects.size() - 1));
  }
  const OwnFloatEnvironment own;
  s.find_candidates();
  report->pairs_.clear();
  for (const Pair& pair : s.candidates) {
    std::vector<std::array<int, 2>> triangles = s.meet(pair, flag == VC_ALL_CONTACTS);
    if (!triangles.empty()) report->pairs_.push_back({{pair.first, pair.second}, std::move(triangles)});
  }
  return VC_OK;
}

const std::string& VCollide::LastError() const { return state_->error; }
std::size_t VCollide::ObjectCandidates() const { return state_->candidates.size(); }
std::size_t VCollide::TriangleCandidates() const { return state_->cost.candidates; }

}  // namespace collided::vcollide
