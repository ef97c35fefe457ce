#include "server/broad_phase/hierarchy/bvh_build.hpp"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <vector>

#include "server/broad_phase/hierarchy/bvh_collapse.hpp"
#include "server/broad_phase/hierarchy/bvh_node.hpp"
#include "server/broad_phase/hierarchy/bvh_occlusion_order.hpp"
#include "server/broad_phase/hierarchy/bvh_pieces.hpp"
#include "server/broad_phase/hierarchy/bvh_primitive.hpp"
#include "server/broad_phase/hierarchy/bvh_split.hpp"
#include "server/broad_phase/hierarchy/bvh_threads.hpp"

namespace collided::engine::bvh {
namespace {

/// A smaller subtree is not worth handing to another thread.
constexpr std::uint32_t kLeastJob = 4096;
/// Triangles per batch of a thread in passes over all.
constexpr std::size_t kBoxesARun = 65536;

/// Reports the build's progress and checks for cancellation; both on the caller's thread only.
class BuildWatch {
 public:
  BuildWatch(const BvhOptions& options, std::uint64_t total) : options_(options), total_(total) {}

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
  const BvhOptions& options_;
  std::uint64_t total_;
  std::atomic<std::uint64_t> done_{0};
  std::atomic<bool> cancelled_{false};
  std::uint64_t next_report_ = 0;
};

/// Nodes and leaves in the order of a walk, so that each subtree is contiguous.
struct Subtree {
  std::vector<Node> nodes;
  std::vector<Leaf> leaves;
  std::uint32_t depth = 0;
  std::uint64_t references = 0;

  std::uint64_t bytes() const { return nodes.capacity() * sizeof(Node) + leaves.capacity() * sizeof(Leaf); }
};

/// A subtree left to another thread, and its place in its parent.
struct Job {
  Range range;
  std::uint32_t depth = 0;
  std::uint32_t parent = 0;
  int slot = 0;
};

/// Builds subtrees over ranges of primitives, which it reorders; ranges of different calls must not overlap.
class BvhBuilder {
 public:
  /// Reads only how the layout stores triangles.
  BvhBuilder(const TriangleMesh& mesh, const Layout& layout, std::span<Primitive> primitives, BuildWatch& watch)
      : mesh_(mesh), layout_(layout), primitives_(primitives), watch_(watch) {}

  /// Builds the subtree over the range. Ranges of at most job_size are left in `jobs`, unless that is null.
  Ref build(const Range& range, std::uint32_t depth, bool callers_thread, Subtree& piece, std::uint32_t job_size,
            std::vector<Job>* jobs) const {
    piece.depth = std::max(piece.depth, depth + 1);
    if (watch_.cancelled()) return kNothing;
    if (range.size() <= kWidth) {
      watch_.placed(range.size(), callers_thread);
      return add_leaf(range, piece);
    }
    if (range.size() <= Collapse::kMostPrimitives && depth + Collapse::kMostDepth <= kMaxHeuristicDepth) {
      Collapse collapse;
      collapse.cut(primitives_, range);
      watch_.placed(range.size(), callers_thread);
      return add_collapsed(collapse, Collapse::kRoot, depth, piece);
    }
    Range children[kWidth];
    Cut cuts[kWidth];
    const int count = cut_wide(primitives_, range, depth >= kMaxHeuristicDepth, children, cuts);
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
  Ref add_collapsed(const Collapse& collapse, int part, std::uint32_t depth, Subtree& piece) const {
    piece.depth = std::max(piece.depth, depth + 1);
    if (collapse.is_leaf(part)) return add_leaf(collapse.range(part), piece);
    int children[kWidth];
    Cut cuts[kWidth];
    const int count = collapse.children(part, children, cuts);
    const auto index = static_cast<std::uint32_t>(piece.nodes.size());
    piece.nodes.push_back(empty_node());
    set_order(cuts, count, piece.nodes.back());
    for (int i = 0; i < count; ++i) {
      const Ref ref = add_collapsed(collapse, children[i], depth + 1, piece);
      set_child(piece.nodes[index], i, collapse.range(children[i]).bounds, ref);
    }
    return index;
  }

  Ref add_leaf(const Range& range, Subtree& piece) const {
    Leaf leaf{};
    int count = 0;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const std::uint32_t number = primitives_[i].triangle();
      // Two pieces of one triangle in one leaf need only one lane.
      if (std::find(leaf.triangle, leaf.triangle + count, number) != leaf.triangle + count) continue;
      set_lane(mesh_, layout_.frame, layout_.has_corners, number, count++, leaf);
    }
    piece.references += static_cast<std::uint64_t>(count);
    piece.leaves.push_back(leaf);
    return leaf_ref(static_cast<std::uint32_t>(piece.leaves.size() - 1), count);
  }

  const TriangleMesh& mesh_;
  const Layout& layout_;
  std::span<Primitive> primitives_;
  BuildWatch& watch_;
};

/// One box per triangle.
PlainArray<Primitive> whole_triangles(const TriangleMesh& mesh, const LocalFrame& frame, unsigned threads) {
  PlainArray<Primitive> boxes(mesh.triangles.size());
  in_runs(threads, boxes.size(), kBoxesARun, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) boxes[i] = local_primitive(mesh, frame, static_cast<std::uint32_t>(i));
  });
  return boxes;
}

/// The boxes with those of split triangles replaced by their pieces.
PlainArray<Primitive> with_pieces(const TriangleMesh& mesh, const LocalFrame& frame, PlainArray<Primitive> whole,
                                  const std::vector<Split>& splits) {
  if (splits.empty()) return whole;
  std::size_t count = whole.size();
  for (const Split& split : splits) count += split.piece_count - 1;
  PlainArray<Primitive> boxes(count);
  std::copy_n(whole.data(), whole.size(), boxes.data());
  std::size_t end = whole.size();
  for (const Split& split : splits) {
    Primitive pieces[kMaxPieces];
    const std::uint32_t written = cover(mesh, frame, split.triangle, split.piece_count, pieces);
    boxes[split.triangle] = pieces[0];
    // Pieces that were not needed repeat the first one.
    for (std::uint32_t i = 1; i < split.piece_count; ++i) boxes[end++] = pieces[i < written ? i : 0];
  }
  return boxes;
}

/// The bounds of all primitives, computed on several threads.
Range range_over(std::span<const Primitive> primitives, unsigned threads) {
  std::vector<Range> runs((primitives.size() + kBoxesARun - 1) / kBoxesARun);
  in_runs(threads, primitives.size(), kBoxesARun, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) runs[begin / kBoxesARun].add(primitives[i]);
  });
  Range all{0, static_cast<std::uint32_t>(primitives.size()), {}, {}};
  for (const Range& run : runs) {
    all.bounds.extend(run.bounds);
    all.centers.extend(run.centers);
  }
  return all;
}

/// A reference within a piece, after the piece has moved to its place in the tree.
Ref moved(Ref ref, std::size_t node_offset, std::size_t leaf_offset) {
  if (ref == kNothing) return ref;
  return static_cast<Ref>(ref + (is_leaf(ref) ? leaf_offset : node_offset));
}

/// The place of each piece in the finished tree; the top comes first.
struct Places {
  std::vector<std::size_t> first_node{0};
  std::vector<std::size_t> first_leaf{0};

  Places(const std::vector<Subtree>& pieces) {
    for (const Subtree& piece : pieces) {
      first_node.push_back(first_node.back() + piece.nodes.size());
      first_leaf.push_back(first_leaf.back() + piece.leaves.size());
    }
    if (first_node.back() > kIndexMask || first_leaf.back() > kIndexMask) {
      throw std::length_error("a hierarchy of " + std::to_string(first_leaf.back()) + " leaves; at most " +
                              std::to_string(kIndexMask) + " are addressable. Nothing was built.");
    }
  }
};

/// Concatenates the pieces, freeing each, and attaches each job's root to its parent.
void join(std::vector<Subtree>& pieces, const std::vector<Job>& jobs, const std::vector<Ref>& roots, unsigned threads,
          Layout& layout) {
  const Places places(pieces);
  layout.nodes = PlainArray<Node>(places.first_node.back());
  layout.leaves = PlainArray<Leaf>(places.first_leaf.back());
  in_parallel(threads, pieces.size(), [&](std::size_t p, bool) {
    const Subtree piece = std::move(pieces[p]);
    std::copy(piece.leaves.begin(), piece.leaves.end(), layout.leaves.data() + places.first_leaf[p]);
    Node* nodes = layout.nodes.data() + places.first_node[p];
    for (std::size_t i = 0; i < piece.nodes.size(); ++i) {
      nodes[i] = piece.nodes[i];
      for (Ref& ref : nodes[i].child) ref = moved(ref, places.first_node[p], places.first_leaf[p]);
    }
  });
  // Piece 0 is the top and starts at 0, so a parent's number is also its place.
  for (std::size_t p = 1; p < pieces.size(); ++p) {
    const Job& job = jobs[p - 1];
    layout.nodes[job.parent].child[job.slot] = moved(roots[p], places.first_node[p], places.first_leaf[p]);
  }
  layout.root = roots[0];
}

void set_root_box(const Range& all, Layout& layout) {
  for (int axis = 0; axis < 3; ++axis) {
    layout.root_low[axis] = all.bounds.low[axis];
    layout.root_high[axis] = all.bounds.high[axis];
  }
}

/// Fills the report from pieces that are not joined yet.
void count_up(const std::vector<Subtree>& pieces, std::uint64_t primitive_bytes, BvhReport& report) {
  std::uint64_t nodes = 0;
  std::uint64_t leaves = 0;
  report.peak_bytes = primitive_bytes;
  for (const Subtree& piece : pieces) {
    nodes += piece.nodes.size();
    leaves += piece.leaves.size();
    report.depth = std::max(report.depth, piece.depth);
    report.references += piece.references;
    report.peak_bytes += piece.bytes();
  }
  report.nodes = static_cast<std::uint32_t>(nodes);
  report.leaves = static_cast<std::uint32_t>(leaves);
  report.bytes = nodes * sizeof(Node) + leaves * sizeof(Leaf);
}

/// Builds each piece on one thread, so that no thread waits for another.
void build_pieces(const BvhBuilder& builder, const Range& all, unsigned threads, std::vector<Subtree>& pieces,
                  std::vector<Job>& jobs, std::vector<Ref>& roots) {
  const std::uint32_t job_size = threads == 1 ? 0 : std::max(kLeastJob, all.size() / (threads * 8));
  pieces.resize(1);
  roots.resize(1);
  roots[0] = builder.build(all, 0, true, pieces[0], job_size, &jobs);
  pieces.resize(jobs.size() + 1);
  roots.resize(jobs.size() + 1);
  in_parallel(threads, jobs.size(), [&](std::size_t i, bool callers_thread) {
    roots[i + 1] = builder.build(jobs[i].range, jobs[i].depth, callers_thread, pieces[i + 1], 0, nullptr);
  });
}

}  // namespace

Layout build_layout(const TriangleMesh& mesh, const BvhOptions& options, BvhReport& report) {
  Layout layout;
  const unsigned threads = thread_count(options.threads);
  if (mesh.triangles.empty() || (options.cancelled && options.cancelled())) return layout;
  const MeshFrame found = mesh_frame(mesh, threads);
  layout.frame = found.frame;
  layout.has_corners = found.has_corners;
  PlainArray<Primitive> primitives = whole_triangles(mesh, layout.frame, threads);
  if (options.form == BvhForm::best) {
    layout.splits = worth_splitting(mesh, layout.frame, {primitives.data(), primitives.size()}, threads);
    primitives = with_pieces(mesh, layout.frame, std::move(primitives), layout.splits);
  }
  const std::span<Primitive> all_primitives(primitives.data(), primitives.size());
  const Range all = range_over(all_primitives, threads);
  BuildWatch watch(options, primitives.size());
  watch.ask();
  std::vector<Subtree> pieces;
  std::vector<Job> jobs;
  std::vector<Ref> roots;
  build_pieces(BvhBuilder(mesh, layout, all_primitives, watch), all, threads, pieces, jobs, roots);
  if (watch.cancelled()) return {};
  count_up(pieces, primitives.bytes(), report);
  report.split_triangles = static_cast<std::uint32_t>(layout.splits.size());
  primitives = {};
  join(pieces, jobs, roots, threads, layout);
  set_root_box(all, layout);
  set_occlusion_orders(layout, threads);
  if (options.progress) options.progress(1);
  return layout;
}

}  // namespace collided::engine::bvh
