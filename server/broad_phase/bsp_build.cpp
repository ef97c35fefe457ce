#include "server/broad_phase/bsp_build.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <thread>
#include <vector>

#include "server/broad_phase/bsp_split.hpp"

namespace collided::bsp {
namespace {

/// A subtree smaller than this is not worth handing to another thread.
constexpr std::uint32_t kLeastJob = 4096;

/// Calls work(i) for i in [0, count) from several threads, the caller's among them; the first exception is rethrown.
template <typename Work>
void in_parallel(unsigned threads, std::size_t count, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::atomic<bool> failed{false};
  const auto run = [&](bool callers_thread) {
    try {
      for (std::size_t i = next++; i < count && !failed; i = next++) work(i, callers_thread);
    } catch (...) {
      if (!failed.exchange(true)) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (unsigned i = 1; i < threads && i < count; ++i) helpers.emplace_back(run, false);
    run(true);
  }
  if (failure) std::rethrow_exception(failure);
}

/// Tells how far the build is and hears whether to go on; both from the caller's thread only.
class Watch {
 public:
  Watch(const BspOptions& options, std::uint64_t total) : options_(options), total_(total) {}

  void placed(std::uint32_t count, bool callers_thread) {
    const std::uint64_t done = done_ += count;
    if (!callers_thread || done < next_report_) return;
    next_report_ = done + total_ / 128 + 1;
    if (options_.progress) options_.progress(static_cast<double>(done) / static_cast<double>(total_));
    ask();
  }
  void ask() {
    if (options_.cancelled && options_.cancelled()) cancelled_ = true;
  }
  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 private:
  const BspOptions& options_;
  std::uint64_t total_;
  std::atomic<std::uint64_t> done_{0};
  std::atomic<bool> cancelled_{false};
  std::uint64_t next_report_ = 0;
};

/// Nodes and leaves in the order of a walk, so that a subtree lies together.
struct Piece {
  std::vector<Node> nodes;
  std::vector<Leaf> leaves;
  std::uint32_t depth = 0;
};

/// A subtree left to another thread, and where its parent waits for it.
struct Job {
  Range range;
  std::uint32_t depth = 0;
  std::uint32_t parent = 0;
  int slot = 0;
};

void set_child(Node& node, int slot, const FloatBox& box, Ref ref) {
  for (int axis = 0; axis < 3; ++axis) {
    node.plane[axis][0][slot] = box.low[axis];
    node.plane[axis][1][slot] = box.high[axis];
  }
  node.child[slot] = ref;
}

Node empty_node() {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Node node{};
  const FloatBox nothing{Float4::Constant(kInfinity), Float4::Constant(-kInfinity)};
  for (int slot = 0; slot < kWidth; ++slot) set_child(node, slot, nothing, kNothing);
  return node;
}

/// The cuts that made a node's children, in order: child `left` was cut along an axis, its upper part became `right`.
struct Cut {
  int left;
  int right;
  int axis;
};

/// Near to far for each octant of directions. A child's list starts with itself; undoing the cuts from the last to the
/// first joins the lists of their two sides, nearer side first.
void set_order(const Cut (&cuts)[kWidth], int child_count, Node& node) {
  for (unsigned octant = 0; octant < 8; ++octant) {
    std::uint32_t list[kWidth];
    int length[kWidth];
    for (int i = 0; i < kWidth; ++i) {
      list[i] = static_cast<std::uint32_t>(i);
      length[i] = 1;
    }
    for (int c = child_count - 2; c >= 0; --c) {
      const auto [left, right, axis] = cuts[c];
      const bool left_first = (octant >> axis & 1u) == 0;
      const int first = left_first ? left : right;
      const int second = left_first ? right : left;
      list[left] = list[first] | list[second] << (3 * length[first]);
      length[left] += length[right];
    }
    // Missing children go last, so that every lane is somewhere.
    for (int i = child_count; i < kWidth; ++i) list[0] |= static_cast<std::uint32_t>(i) << (3 * i);
    node.order[octant] = list[0];
  }
}

class Builder {
 public:
  /// Reads of the layout only how triangles are stored.
  Builder(const TriangleMesh& mesh, const Layout& layout, std::span<Primitive> primitives, Watch& watch)
      : mesh_(mesh), layout_(layout), primitives_(primitives), watch_(watch) {}

  /// The subtree over the range. Ranges of at most job_size are left in jobs, if given.
  Ref build(const Range& range, std::uint32_t depth, bool callers_thread, Piece& piece, std::uint32_t job_size,
            std::vector<Job>* jobs) const {
    piece.depth = std::max(piece.depth, depth + 1);
    if (watch_.cancelled()) return kNothing;
    if (range.size() <= kWidth) {
      watch_.placed(range.size(), callers_thread);
      return add_leaf(range, piece);
    }
    Range children[kWidth];
    Cut cuts[kWidth];
    const int count = cut(range, depth, children, cuts);
    const auto index = static_cast<std::uint32_t>(piece.nodes.size());
    piece.nodes.push_back(empty_node());
    set_order(cuts, count, piece.nodes.back());
    for (int i = 0; i < count; ++i) {
      const bool later = jobs != nullptr && children[i].size() <= job_size;
      if (later) jobs->push_back({children[i], depth + 1, index, i});
      const Ref ref = later ? kNothing : build(children[i], depth + 1, callers_thread, piece, job_size, jobs);
      set_child(piece.nodes[index], i, children[i].bounds, ref);
    }
    return index;
  }

 private:
  /// Which child to cut next: the one of largest surface, or of most triangles where only the count still divides;
  /// -1 when each fits a leaf.
  static int next_cut(const Range (&children)[kWidth], int count, bool by_count) {
    int next = -1;
    for (int i = 0; i < count; ++i) {
      if (children[i].size() <= kWidth) continue;
      if (next < 0) {
        next = i;
        continue;
      }
      const float area = by_count ? 0.0f : children[i].bounds.half_area();
      const float best = by_count ? 0.0f : children[next].bounds.half_area();
      if (area > best || (area == best && children[i].size() > children[next].size())) next = i;
    }
    return next;
  }

  /// Cuts until there are eight children or none is larger than a leaf.
  int cut(const Range& range, std::uint32_t depth, Range (&children)[kWidth], Cut (&cuts)[kWidth]) const {
    const bool by_count = depth >= kMaxHeuristicDepth;
    int count = 1;
    children[0] = range;
    while (count < kWidth) {
      const int next = next_cut(children, count, by_count);
      if (next < 0) break;
      const Range whole = children[next];
      const int axis = split(primitives_, whole, by_count, children[next], children[count]);
      cuts[count - 1] = {next, count, axis};
      ++count;
    }
    return count;
  }

  Ref add_leaf(const Range& range, Piece& piece) const {
    Leaf leaf{};
    for (std::uint32_t lane = 0; lane < range.size(); ++lane) {
      const std::uint32_t number = primitives_[range.begin + lane].triangle();
      const Triangle world = mesh_.triangle(number);
      const Vec3 first = layout_.frame.to_local(world.a);
      const Vec3 base = layout_.has_corners ? Vec3::Zero() : first;
      const Vec3 second = layout_.frame.to_local(world.b) - base;
      const Vec3 third = layout_.frame.to_local(world.c) - base;
      for (int axis = 0; axis < 3; ++axis) {
        leaf.a[axis][lane] = static_cast<float>(first[axis]);
        leaf.b[axis][lane] = static_cast<float>(second[axis]);
        leaf.c[axis][lane] = static_cast<float>(third[axis]);
      }
      leaf.triangle[lane] = number;
    }
    piece.leaves.push_back(leaf);
    return leaf_ref(static_cast<std::uint32_t>(piece.leaves.size() - 1), static_cast<int>(range.size()));
  }

  const TriangleMesh& mesh_;
  const Layout& layout_;
  std::span<Primitive> primitives_;
  Watch& watch_;
};

Primitive local_primitive(const TriangleMesh& mesh, const LocalFrame& frame, std::uint32_t number) {
  const Triangle world = mesh.triangle(number);
  const Vec3 low = frame.to_local(world.a.cwiseMin(world.b).cwiseMin(world.c));
  const Vec3 high = frame.to_local(world.a.cwiseMax(world.b).cwiseMax(world.c));
  Primitive primitive;
  for (int axis = 0; axis < 3; ++axis) {
    primitive.low[axis] = round_down(low[axis]);
    primitive.high[axis] = round_up(high[axis]);
  }
  primitive.low[3] = std::bit_cast<float>(number);
  primitive.high[3] = 0;
  return primitive;
}

Aabb triangle_bounds(const TriangleMesh& mesh) {
  Aabb bounds;
  for (const TriangleCorners& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) bounds.extend(mesh.vertices[corner]);
  }
  return bounds;
}

/// Primitives of all triangles and the range over them.
Range make_primitives(const TriangleMesh& mesh, const LocalFrame& frame, unsigned threads,
                      std::span<Primitive> primitives) {
  constexpr std::size_t kChunk = 65536;
  const std::size_t chunk_count = (primitives.size() + kChunk - 1) / kChunk;
  std::vector<Range> chunks(chunk_count);
  in_parallel(threads, chunk_count, [&](std::size_t chunk, bool) {
    const std::size_t end = std::min((chunk + 1) * kChunk, primitives.size());
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      primitives[i] = local_primitive(mesh, frame, static_cast<std::uint32_t>(i));
      chunks[chunk].add(primitives[i]);
    }
  });
  Range all{0, static_cast<std::uint32_t>(primitives.size()), {}, {}};
  for (const Range& chunk : chunks) {
    all.bounds.extend(chunk.bounds);
    all.centers.extend(chunk.centers);
  }
  return all;
}

Ref moved(Ref ref, std::size_t node_offset, std::size_t leaf_offset) {
  if (ref == kNothing) return ref;
  return static_cast<Ref>(ref + (is_leaf(ref) ? leaf_offset : node_offset));
}

/// Puts the pieces one after the other, the top first, and joins each job's root to its parent.
void join(const std::vector<Piece>& pieces, const std::vector<Job>& jobs, const std::vector<Ref>& roots,
          Layout& layout, BspReport& report) {
  std::size_t node_count = 0;
  std::size_t leaf_count = 0;
  for (const Piece& piece : pieces) {
    node_count += piece.nodes.size();
    leaf_count += piece.leaves.size();
    report.depth = std::max(report.depth, piece.depth);
  }
  if (node_count > kIndexMask || leaf_count > kIndexMask) {
    throw std::length_error("BSP tree of " + std::to_string(leaf_count) + " leaves; at most " +
                            std::to_string(kIndexMask) + " are addressable. Nothing was built.");
  }
  layout.nodes = PlainArray<Node>(node_count);
  layout.leaves = PlainArray<Leaf>(leaf_count);
  std::size_t node_offset = 0;
  std::size_t leaf_offset = 0;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const Piece& piece = pieces[p];
    std::copy(piece.leaves.begin(), piece.leaves.end(), layout.leaves.data() + leaf_offset);
    for (std::size_t i = 0; i < piece.nodes.size(); ++i) {
      Node& node = layout.nodes[node_offset + i];
      node = piece.nodes[i];
      for (Ref& ref : node.child) ref = moved(ref, node_offset, leaf_offset);
    }
    // Piece 0 is the top, which starts at offset 0, so a parent's number is its place.
    if (p > 0) layout.nodes[jobs[p - 1].parent].child[jobs[p - 1].slot] = moved(roots[p], node_offset, leaf_offset);
    node_offset += piece.nodes.size();
    leaf_offset += piece.leaves.size();
  }
  layout.root = roots[0];
  report.nodes = static_cast<std::uint32_t>(node_count);
  report.leaves = static_cast<std::uint32_t>(leaf_count);
  report.bytes = layout.nodes.bytes() + layout.leaves.bytes();
}

}  // namespace

Layout build_layout(const TriangleMesh& mesh, const BspOptions& options, BspReport& report) {
  Layout layout;
  const std::size_t count = mesh.triangles.size();
  Watch watch(options, count);
  watch.ask();
  if (count == 0 || watch.cancelled()) return layout;
  const unsigned threads = options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());

  layout.frame = local_frame(triangle_bounds(mesh));
  PlainArray<Primitive> storage(count);
  const std::span<Primitive> primitives(storage.data(), count);
  const Range all = make_primitives(mesh, layout.frame, threads, primitives);
  layout.has_corners = std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const TriangleCorners& corners) {
    return layout.frame.is_float(mesh.vertices[corners[0]]) && layout.frame.is_float(mesh.vertices[corners[1]]) &&
           layout.frame.is_float(mesh.vertices[corners[2]]);
  });
  const Builder builder(mesh, layout, primitives, watch);

  const std::uint32_t job_size = threads == 1 ? 0 : std::max(kLeastJob, all.size() / (threads * 8));
  std::vector<Job> jobs;
  std::vector<Piece> pieces(1);
  std::vector<Ref> roots(1);
  roots[0] = builder.build(all, 0, true, pieces[0], job_size, &jobs);
  pieces.resize(jobs.size() + 1);
  roots.resize(jobs.size() + 1);
  in_parallel(threads, jobs.size(), [&](std::size_t i, bool callers_thread) {
    roots[i + 1] = builder.build(jobs[i].range, jobs[i].depth, callers_thread, pieces[i + 1], 0, nullptr);
  });
  if (watch.cancelled()) {
    report = {};
    return {};
  }
  join(pieces, jobs, roots, layout, report);
  for (int axis = 0; axis < 3; ++axis) {
    layout.root_low[axis] = all.bounds.low[axis];
    layout.root_high[axis] = all.bounds.high[axis];
  }
  report.references = count;
  if (options.progress) options.progress(1);
  return layout;
}

}  // namespace collided::bsp
