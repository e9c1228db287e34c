#include "core/adapt/propagate.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>

#include "core/adapt/snap.h"
#include "core/base/parallel.h"
#include "core/base/statistics.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr double lost_confidence = 0.35;  ///< below it a frame is not followed
constexpr double doubtful_frame = 0.7;    ///< of the median frame's
constexpr double doubtful_edges = 1;      ///< of disagreement, in mean edges, and not below the next
constexpr double least_doubtful_mm = 3;
constexpr double doubtful_jump = 0.25;  ///< of all volumes' range, against the mean of both neighbours
constexpr double least_jump = 0.05;     ///< of that mean
constexpr double rough_change = 0.9;    ///< share of the steps between frames that change less than a cycle's end
constexpr double closed_share = 0.4;  ///< of what the motion changes: what a closed cycle may still differ at its ends

constexpr double closed_volume = 0.15;  ///< of the volumes' range: what the ends of a closed cycle differ at most
constexpr double least_beat = 0.1;      ///< of the largest volume: a smaller range tells nothing about a beat

/// A frame as one of the two ways came to it.
struct Arrival {
  Points points;
  double confidence = 0;
  bool lost = false;  ///< the points are those of the frame before
};

double mean_vertex_distance(const Points& a, const Points& b) {
  return (a - b).rowwise().norm().mean();
}

/// Whether the last frame leads on to the first. Around the mesh they differ no more than frames that follow each
/// other; or, since scanners leave out the end of the beat, by much less than the first frame differs from the farthest
/// one.
bool is_cycle(const Volume& cine, const Mesh& mesh) {
  const double reach_mm = 10;
  const auto samples = [&](int frame) { return sample_profiles(cine, frame, mesh, reach_mm, 2).values.eval(); };
  const auto change = [](const Eigen::MatrixXf& a, const Eigen::MatrixXf& b) {
    const auto both = ((a - b).array().isFinite()).eval();
    return static_cast<double>(both.select((a - b).array().abs(), 0.0f).sum()) /
           std::max<double>(1, static_cast<double>(both.count()));
  };
  const Eigen::MatrixXf first = samples(0);
  Eigen::MatrixXf before = first;
  std::vector<double> changes;
  double farthest = 0;
  for (int f = 1; f < cine.frames; ++f) {
    Eigen::MatrixXf now = samples(f);
    changes.push_back(change(before, now));
    farthest = std::max(farthest, change(first, now));
    before = std::move(now);
  }
  const double end = change(before, first), noise = quantile(changes, 0);
  return end <= quantile(changes, rough_change) || end - noise <= closed_share * (farthest - noise);
}

class Propagating {
 public:
  Propagating(const Volume& cine, int frame, const Mesh& mesh, const VertexScalars& stiffness,
              const PropagateOptions& options)
      : cine_(cine), given_(frame), mesh_(mesh), stiffness_(stiffness), options_(options) {}

  Result<Propagation> run() {
    auto appearance = std::make_shared<Appearance>();
    if (auto learned = appearance->learn(cine_, given_, mesh_); !learned) return fail(learned.error());
    appearance_ = std::move(appearance);
    result_.given = given_;
    result_.cycle = is_cycle(cine_, mesh_);
    Ways ways;
    if (auto walked = walk_both(ways, {cine_.frames - 1 - given_, given_}); !walked) return fail(walked.error());
    result_.cycle = result_.cycle || volumes_close_up(ways);
    if (result_.cycle)
      if (auto walked = walk_both(ways, {cine_.frames - 1, cine_.frames - 1}); !walked) return fail(walked.error());
    meet(ways[0], ways[1]);
    fill_lost();
    judge();
    return std::move(result_);
  }

 private:
  int frame_at(int steps) const { return ((given_ + steps) % cine_.frames + cine_.frames) % cine_.frames; }

  /// Forwards and backwards.
  using Ways = std::array<std::vector<Arrival>, 2>;

  /// Goes on both ways until each has taken so many steps.
  Result<void> walk_both(Ways& ways, const std::array<int, 2>& steps) {
    std::array<Result<void>, 2> walked;
    in_parallel(std::size_t{2}, [&](std::size_t first, std::size_t last) {
      for (std::size_t way = first; way < last; ++way) walked[way] = walk(ways[way], way == 0 ? 1 : -1, steps[way]);
    });
    for (const auto& way : walked)
      if (!way) return fail(way.error());
    return {};
  }

  /// Whether the volumes at both ends are nearly equal, though they change in between: a whole beat, even where the
  /// images at its ends differ by noise or by a breath.
  bool volumes_close_up(const Ways& ways) const {
    std::vector<double> volumes;
    const auto add = [&](const std::vector<Arrival>& way) {
      for (const Arrival& arrival : way)
        if (!arrival.lost) volumes.push_back(enclosed_volume_ml({mesh_.topology, arrival.points}));
    };
    const double given_ml = enclosed_volume_ml(mesh_);
    const auto end_ml = [&](const std::vector<Arrival>& way) {
      return way.empty() ? given_ml : enclosed_volume_ml({mesh_.topology, way.back().points});
    };
    for (const auto& way : ways) {
      if (!way.empty() && way.back().lost) return false;
      add(way);
    }
    volumes.push_back(given_ml);
    const auto [smallest, largest] = std::minmax_element(volumes.begin(), volumes.end());
    const double range = *largest - *smallest;
    return range > least_beat * *largest && std::abs(end_ml(ways[0]) - end_ml(ways[1])) <= closed_volume * range;
  }

  Result<void> walk(std::vector<Arrival>& arrivals, int direction, int steps) {
    SnapOptions snapping;
    snapping.edges.reach_mm = options_.reach_mm;
    snapping.edges.appearance = appearance_;
    const VertexScalars all = VertexScalars::Ones(mesh_.points.rows());
    Points current = arrivals.empty() ? mesh_.points : arrivals.back().points;
    for (int k = static_cast<int>(arrivals.size()) + 1; k <= steps; ++k) {
      const SnapStart start{{mesh_.topology, current}, current, stiffness_, all};
      auto snapped = snap(cine_, frame_at(direction * k), start, snapping);
      if (!snapped) return fail(snapped.error());
      Arrival arrival{std::move(snapped->points), snapped->mean_confidence, false};
      arrival.lost = arrival.confidence < lost_confidence;
      if (arrival.lost) arrival.points = current;
      current = arrival.points;
      arrivals.push_back(std::move(arrival));
      if (options_.progress == nullptr) continue;
      options_.progress->report(static_cast<double>(++done_) / (2 * (cine_.frames - 1)));
      if (options_.progress->cancelled()) return fail("", "the propagation was cancelled");
    }
    return {};
  }

  /// Both ways into one mesh a frame.
  void meet(const std::vector<Arrival>& forwards, const std::vector<Arrival>& backwards) {
    result_.frames.resize(static_cast<std::size_t>(cine_.frames));
    lost_.assign(result_.frames.size(), true);
    const auto take = [&](const std::vector<Arrival>& way, int direction, const std::vector<Arrival>& other) {
      for (std::size_t k = 0; k < way.size(); ++k) {
        const auto f = static_cast<std::size_t>(frame_at(direction * static_cast<int>(k + 1)));
        PropagatedFrame& frame = result_.frames[f];
        // The other way came here in the rest of the cycle.
        const Arrival* against = result_.cycle ? &other[other.size() - 1 - k] : nullptr;
        if (way[k].lost) continue;
        lost_[f] = false;
        if (against == nullptr || against->lost) {
          frame.points = way[k].points;
          frame.confidence = way[k].confidence;
          continue;
        }
        const double share = static_cast<double>(k + 1) / cine_.frames;
        frame.points = (1 - share) * way[k].points + share * against->points;
        frame.confidence = (1 - share) * way[k].confidence + share * against->confidence;
        frame.disagreement_mm = mean_vertex_distance(way[k].points, against->points);
      }
    };
    take(forwards, 1, backwards);
    take(backwards, -1, forwards);
    auto& given = result_.frames[static_cast<std::size_t>(given_)];
    given = {mesh_.points, 0, 1, std::nullopt, ""};
    lost_[static_cast<std::size_t>(given_)] = false;
  }

  /// Frames that no way could follow lie between the nearest ones that were.
  void fill_lost() {
    const int n = cine_.frames;
    const auto nearest = [&](int from, int direction) {
      for (int k = 1; k < n; ++k) {
        const int f = from + direction * k;
        if (!result_.cycle && (f < 0 || f >= n)) return std::pair(-1, 0);
        if (const int there = (f % n + n) % n; !lost_[static_cast<std::size_t>(there)]) return std::pair(there, k);
      }
      return std::pair(-1, 0);
    };
    const auto points = [&](int f) -> const Points& { return result_.frames[static_cast<std::size_t>(f)].points; };
    for (int f = 0; f < n; ++f) {
      if (!lost_[static_cast<std::size_t>(f)]) continue;
      const auto [before, back] = nearest(f, -1);
      const auto [after, on] = nearest(f, 1);
      auto& frame = result_.frames[static_cast<std::size_t>(f)];
      if (before < 0 || after < 0)
        frame.points = points(before < 0 ? after : before);
      else
        frame.points = (on * points(before) + back * points(after)) / static_cast<double>(on + back);
      frame.confidence = 0;
      frame.doubt = "does not show the boundary; its mesh is taken from the frames around it";
    }
  }

  void judge() {
    std::vector<double> confidences;
    double smallest = std::numeric_limits<double>::infinity(), largest = 0;
    for (auto& frame : result_.frames) {
      frame.volume_ml = enclosed_volume_ml({mesh_.topology, frame.points});
      smallest = std::min(smallest, frame.volume_ml);
      largest = std::max(largest, frame.volume_ml);
      confidences.push_back(frame.confidence);
    }
    const double usual = quantile(confidences, 0.5);
    const double most_mm = std::max(least_doubtful_mm, doubtful_edges * mean_edge_mm(*mesh_.topology, mesh_.points));
    for (std::size_t f = 0; f < result_.frames.size(); ++f) {
      auto& frame = result_.frames[f];
      if (!frame.doubt.empty() || static_cast<int>(f) == given_) continue;
      if (frame.confidence < doubtful_frame * usual)
        frame.doubt = "shows less of the boundary than other frames";
      else if (frame.disagreement_mm && *frame.disagreement_mm > most_mm)
        frame.doubt = "was reached differently forwards and backwards";
      else if (jumps(f, largest - smallest))
        frame.doubt = "has another volume than its neighbours";
    }
    measure();
  }

  bool jumps(std::size_t f, double range) const {
    const std::size_t n = result_.frames.size();
    if (!result_.cycle && (f == 0 || f + 1 == n)) return false;
    const double around = (result_.frames[(f + n - 1) % n].volume_ml + result_.frames[(f + 1) % n].volume_ml) / 2;
    const double off = std::abs(result_.frames[f].volume_ml - around);
    return off > doubtful_jump * range && off > least_jump * around;
  }

  void measure() {
    result_.end_diastole = result_.end_systole = given_;
    const auto volume = [&](int f) { return result_.frames[static_cast<std::size_t>(f)].volume_ml; };
    for (int f = 0; f < cine_.frames; ++f) {
      if (!result_.frames[static_cast<std::size_t>(f)].doubt.empty()) continue;
      if (volume(f) > volume(result_.end_diastole)) result_.end_diastole = f;
      if (volume(f) < volume(result_.end_systole)) result_.end_systole = f;
    }
    const double largest = volume(result_.end_diastole);
    result_.ejection_fraction = largest > 0 ? (largest - volume(result_.end_systole)) / largest : 0;
  }

  const Volume& cine_;
  int given_;
  const Mesh& mesh_;
  const VertexScalars& stiffness_;
  const PropagateOptions& options_;
  std::shared_ptr<const Appearance> appearance_;
  std::atomic<int> done_ = 0;
  Propagation result_;
  std::vector<bool> lost_;
};

}  // namespace

Result<Propagation> propagate(const Volume& cine, int frame, const Mesh& mesh, const VertexScalars& stiffness,
                              const PropagateOptions& options) {
  if (cine.frames < 2) return fail("", "has one frame only; give a cine");
  if (frame < 0 || frame >= cine.frames)
    return fail("", "has " + std::to_string(cine.frames) + " frames, counted from 0; choose one of them");
  return Propagating(cine, frame, mesh, stiffness, options).run();
}

}  // namespace homolog
