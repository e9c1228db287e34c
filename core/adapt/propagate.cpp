#include "core/adapt/propagate.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>

#include "core/adapt/snap.h"
#include "core/base/numbers/statistics.h"
#include "core/base/processes/parallel.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr double lost_confidence = 0.35;  ///< below it a frame is not followed
constexpr double doubtful_frame = 0.7;    ///< share of the median frame's
constexpr double doubtful_edges = 1;      ///< disagreement in mean edges, and not below the next
constexpr double least_doubtful_mm = 3;
constexpr double doubtful_jump = 0.25;  ///< share of all volumes' range, against the mean of both neighbours
constexpr double least_jump = 0.05;     ///< share of that mean
constexpr double rough_change = 0.9;    ///< share of the steps between frames that change less than a cycle's end
constexpr double closed_share = 0.4;    ///< share of what the motion changes: a closed cycle may still differ by it

constexpr double closed_volume = 0.15;  ///< share of the volumes' range: the ends of a closed cycle differ by no more
constexpr double least_beat = 0.1;      ///< share of the largest volume: a smaller range tells nothing about a beat

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

/// From one known frame to the next, or to the end of the cine.
struct Stretch {
  int from = 0, to = 0;  ///< both known; the same where one known frame has the whole cycle
  int steps = 0;         ///< from the one to the other
  bool meets = true;     ///< both ways are gone; else only the one in `direction`
  int direction = 1;     ///< the way of one that does not meet: on from `from`, or back
};

class Propagating {
 public:
  Propagating(const Volume& cine, int frame, const Mesh& mesh, const VertexScalars& stiffness,
              const PropagateOptions& options)
      : cine_(cine), mesh_(mesh), stiffness_(stiffness), options_(options), known_(options.known) {
    known_[frame] = mesh.points;
  }

  Result<Propagation> run() {
    if (auto learned = learn(); !learned) return fail(learned.error());
    for (const auto& [frame, points] : known_) result_.known.push_back(frame);
    result_.cycle = is_cycle(cine_, mesh_);
    std::vector<Stretch> stretches = stretches_between();
    std::vector<Way> ways(2 * stretches.size());
    if (auto walked = walk_all(stretches, ways); !walked) return fail(walked.error());
    if (!result_.cycle && volumes_close_up(ways)) {
      // What lay open at both ends is one stretch, which both ways go on through.
      result_.cycle = true;
      const std::size_t inner = known_.size() - 1;
      std::swap(ways[2 * inner + 1], ways[2 * (inner + 1) + 1]);
      stretches = stretches_between();
      ways.resize(2 * stretches.size());
      if (auto walked = walk_all(stretches, ways); !walked) return fail(walked.error());
    }
    result_.frames.resize(static_cast<std::size_t>(cine_.frames));
    lost_.assign(result_.frames.size(), true);
    for (std::size_t k = 0; k < stretches.size(); ++k) meet(stretches[k], ways[2 * k], ways[2 * k + 1]);
    for (const auto& [frame, points] : known_) {
      result_.frames[frame] = {points, 0, 1, std::nullopt, ""};
      lost_[frame] = false;
    }
    fill_lost();
    judge();
    return std::move(result_);
  }

 private:
  int wrapped(int frame) const { return (frame % cine_.frames + cine_.frames) % cine_.frames; }

  /// Through a stretch from one of its ends.
  using Way = std::vector<Arrival>;

  /// Learns the boundary's look in each known frame.
  Result<void> learn() {
    for (const auto& [frame, points] : known_) {
      auto appearance = std::make_shared<Appearance>();
      if (auto learned = appearance->learn(cine_, frame, {mesh_.topology, points}); !learned) return learned;
      appearances_[frame] = std::move(appearance);
    }
    return {};
  }

  std::vector<Stretch> stretches_between() const {
    std::vector<Stretch> stretches;
    const int first = known_.begin()->first, last = known_.rbegin()->first;
    for (auto here = known_.begin(), next = std::next(here); next != known_.end(); ++here, ++next)
      stretches.push_back({here->first, next->first, next->first - here->first});
    if (result_.cycle) {
      stretches.push_back({last, first, first + cine_.frames - last});
    } else {
      stretches.push_back({last, last, cine_.frames - 1 - last, false, 1});
      stretches.push_back({first, first, first, false, -1});
    }
    return stretches;
  }

  /// Goes through each stretch forwards and backwards, on from what the ways hold already.
  Result<void> walk_all(const std::vector<Stretch>& stretches, std::vector<Way>& ways) {
    all_steps_ = 0;
    for (const Stretch& one : stretches) all_steps_ += one.meets ? 2 * (one.steps - 1) : one.steps;
    std::vector<Result<void>> walked(ways.size());
    in_parallel(ways.size(), [&](std::size_t first, std::size_t last) {
      for (std::size_t way = first; way < last; ++way)
        walked[way] = walk(ways[way], stretches[way / 2], way % 2 == 0 ? 1 : -1);
    });
    for (const auto& way : walked)
      if (!way) return fail(way.error());
    return {};
  }

  /// Whether the volumes at both ends are nearly equal, though they change in between: a whole beat, even where the
  /// images at its ends differ by noise or by a breath. The last four of `ways` lie open.
  bool volumes_close_up(const std::vector<Way>& ways) const {
    const auto volume_ml = [&](const Points& points) { return enclosed_volume_ml({mesh_.topology, points}); };
    std::vector<double> volumes;
    for (const auto& [frame, points] : known_) volumes.push_back(volume_ml(points));
    for (const Way& way : ways)
      for (const Arrival& arrival : way)
        if (!arrival.lost) volumes.push_back(volume_ml(arrival.points));
    const Way &on = ways[ways.size() - 4], &back = ways.back();
    if ((!on.empty() && on.back().lost) || (!back.empty() && back.back().lost)) return false;
    const double end_ml = volume_ml(on.empty() ? known_.rbegin()->second : on.back().points);
    const double begin_ml = volume_ml(back.empty() ? known_.begin()->second : back.back().points);
    const auto [smallest, largest] = std::minmax_element(volumes.begin(), volumes.end());
    const double range = *largest - *smallest;
    return range > least_beat * *largest && std::abs(end_ml - begin_ml) <= closed_volume * range;
  }

  Result<void> walk(Way& arrivals, const Stretch& stretch, int direction) {
    if (!stretch.meets && direction != stretch.direction) return {};
    const int from = direction > 0 ? stretch.from : stretch.to;
    SnapOptions snapping;
    snapping.edges.reach_mm = options_.reach_mm;
    snapping.edges.appearance = appearances_.at(from);
    const VertexScalars all = VertexScalars::Ones(mesh_.points.rows());
    Points current = arrivals.empty() ? known_.at(from) : arrivals.back().points;
    const int steps = stretch.meets ? stretch.steps - 1 : stretch.steps;
    for (int k = static_cast<int>(arrivals.size()) + 1; k <= steps; ++k) {
      // A triangle is turned here where it is not as in the frame before.
      const SnapStart start{{mesh_.topology, current}, current, stiffness_, all};
      auto snapped = snap(cine_, wrapped(from + direction * k), start, snapping);
      if (!snapped) return fail(snapped.error());
      Arrival arrival{std::move(snapped->points), snapped->mean_confidence, false};
      arrival.lost = arrival.confidence < lost_confidence;
      if (arrival.lost) arrival.points = current;
      current = arrival.points;
      arrivals.push_back(std::move(arrival));
      if (options_.progress == nullptr) continue;
      options_.progress->report(std::min(1.0, static_cast<double>(++done_) / all_steps_));
      if (options_.progress->cancelled()) return fail("", "the propagation was cancelled");
    }
    return {};
  }

  /// Both ways through a stretch into one mesh a frame.
  void meet(const Stretch& stretch, const std::vector<Arrival>& forwards, const std::vector<Arrival>& backwards) {
    const std::size_t between = std::max(forwards.size(), backwards.size());
    for (std::size_t k = 0; k < between; ++k) {
      const bool on = stretch.meets || stretch.direction > 0;
      const auto f = static_cast<std::size_t>(wrapped(stretch.from + (on ? 1 : -1) * static_cast<int>(k + 1)));
      const Arrival* a = forwards.empty() ? nullptr : &forwards[k];
      const Arrival* b = backwards.empty() ? nullptr : &backwards[stretch.meets ? between - 1 - k : k];
      if (a != nullptr && a->lost) a = nullptr;
      if (b != nullptr && b->lost) b = nullptr;
      if (a == nullptr && b == nullptr) continue;
      lost_[f] = false;
      PropagatedFrame& frame = result_.frames[f];
      if (a == nullptr || b == nullptr) {
        frame.points = (a != nullptr ? a : b)->points;
        frame.confidence = (a != nullptr ? a : b)->confidence;
        continue;
      }
      const double share = static_cast<double>(stretch.steps - 1 - static_cast<int>(k)) / stretch.steps;
      frame.points = (1 - share) * b->points + share * a->points;
      frame.confidence = (1 - share) * b->confidence + share * a->confidence;
      frame.disagreement_mm = mean_vertex_distance(b->points, a->points);
    }
  }

  /// Frames that no way could follow lie between the nearest ones that were.
  void fill_lost() {
    const int n = cine_.frames;
    const auto nearest = [&](int from, int direction) {
      for (int k = 1; k < n; ++k) {
        const int f = from + direction * k;
        if (!result_.cycle && (f < 0 || f >= n)) return std::pair(-1, 0);
        if (const int there = (f % n + n) % n; !lost_[there]) return std::pair(there, k);
      }
      return std::pair(-1, 0);
    };
    const auto points = [&](int f) -> const Points& { return result_.frames[f].points; };
    for (int f = 0; f < n; ++f) {
      if (!lost_[f]) continue;
      const auto [before, back] = nearest(f, -1);
      const auto [after, on] = nearest(f, 1);
      auto& frame = result_.frames[f];
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
      if (options_.missing_share > 0 && frame.doubt.empty()) frame.doubt = missing_doubt(options_.missing_share);
      if (!frame.doubt.empty() || known_.contains(static_cast<int>(f))) continue;
      if (frame.confidence < doubtful_frame * usual)
        frame.doubt = "shows less of the boundary than other frames";
      else if (frame.disagreement_mm && *frame.disagreement_mm > most_mm)
        frame.doubt = "came out differently forwards and backwards";
      else if (jumps(f, largest - smallest))
        frame.doubt = "has a volume that does not fit its neighbours'";
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
    std::map<int, double> all, trusted;
    for (std::size_t f = 0; f < result_.frames.size(); ++f) {
      all[static_cast<int>(f)] = result_.frames[f].volume_ml;
      if (result_.frames[f].doubt.empty()) trusted[static_cast<int>(f)] = result_.frames[f].volume_ml;
    }
    result_.ejection = *ejection_of(trusted.empty() ? all : trusted);
  }

  const Volume& cine_;
  const Mesh& mesh_;
  const VertexScalars& stiffness_;
  const PropagateOptions& options_;
  std::map<int, Points> known_;
  std::map<int, std::shared_ptr<const Appearance>> appearances_;
  std::atomic<int> done_ = 0;
  int all_steps_ = 0;
  Propagation result_;
  std::vector<bool> lost_;
};

}  // namespace

std::string missing_doubt(double missing_share) {
  return "comes from a template that lacks " + std::to_string(std::lround(100 * missing_share)) +
         " % of the label that it was made of";
}

std::optional<Ejection> ejection_of(const std::map<int, double>& volumes_ml) {
  if (volumes_ml.empty()) return std::nullopt;
  const auto smaller = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto largest = std::max_element(volumes_ml.begin(), volumes_ml.end(), smaller);
  const auto smallest = std::min_element(volumes_ml.begin(), volumes_ml.end(), smaller);
  return Ejection{largest->first, smallest->first,
                  largest->second > 0 ? (largest->second - smallest->second) / largest->second : 0};
}

Result<Propagation> propagate(const Volume& cine, int frame, const Mesh& mesh, const VertexScalars& stiffness,
                              const PropagateOptions& options) {
  if (cine.frames < 2) return fail("", "has one frame only; give a cine");
  if (frame < 0 || frame >= cine.frames)
    return fail("", "has " + std::to_string(cine.frames) + " frames, counted from 0; choose one of them");
  for (const auto& [known, points] : options.known) {
    if (known < 0 || known >= cine.frames) return fail("", "has no frame " + std::to_string(known));
    if (points.rows() != mesh.points.rows())
      return fail("", "has a mesh of another template in frame " + std::to_string(known));
  }
  return Propagating(cine, frame, mesh, stiffness, options).run();
}

}  // namespace homolog
