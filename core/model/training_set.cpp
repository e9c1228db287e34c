#include "core/model/training_set.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/numbers/statistics.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/mesh/construction/mirror.h"
#include "core/mesh/repair/inside_out.h"
#include "core/model/alignment/numbering.h"
#include "core/placement/similarity_fit.h"
#include "core/template/other_side.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// How much better the mirror image has to fit before a shape is said to be mirrored.
constexpr double mirrored_gain = 2;

void find_twins(const TrainingSet& set, std::vector<std::string>& found) {
  std::map<std::string_view, std::size_t> seen;
  for (Eigen::Index i = 0; i < set.shapes.cols(); ++i) {
    const std::string_view bytes(reinterpret_cast<const char*>(set.shapes.col(i).data()),
                                 static_cast<std::size_t>(set.shapes.rows()) * sizeof(double));
    const auto [twin, is_new] = seen.try_emplace(bytes, static_cast<std::size_t>(i));
    if (!is_new)
      found.push_back(set.names[i] + " is the same shape as " + set.names[twin->second] +
                      "; it counts twice, so leave one of them out");
  }
}

void find_sizes(const TrainingSet& set, std::vector<std::string>& found) {
  std::vector<double> sizes;
  for (Eigen::Index i = 0; i < set.shapes.cols(); ++i) sizes.push_back(centroid_size_mm(points_of(set.shapes, i)));
  const double usual = quantile(sizes, 0.5);
  std::map<int, std::vector<std::string>> by_power;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (const int power = power_of_ten(sizes[i] / usual); power != 0) by_power[power].push_back(set.names[i]);
  }
  for (const auto& [power, names] : by_power) {
    found.push_back(some_of(names, 5) + ": about " + std::to_string(std::lround(std::pow(10, std::abs(power)))) +
                    " times as " + (power > 0 ? "large" : "small") +
                    " as the other shapes; its lengths may not be in mm, so convert it first");
  }
}

/// Shapes that are turned against most others as RAS is against LPS: negated x and y are half a turn about z.
void find_half_turns(const TrainingSet& set, std::vector<std::string>& found) {
  constexpr double near_rad = 0.6;
  const Eigen::Quaterniond half_turn(0, 0, 0, 1);
  // The rotation to a mirror image may be any; that it is one is said elsewhere.
  if (!mirrored_shapes(set).empty()) return;
  const Points first = points_of(set.shapes, 0);
  std::vector<std::string> upright, turned;
  for (Eigen::Index i = 0; i < set.shapes.cols(); ++i) {
    const Eigen::Quaterniond rotation = nearest_similarity(first, points_of(set.shapes, i), Similarity{}).rotation;
    if (rotation.angularDistance(Eigen::Quaterniond::Identity()) < near_rad)
      upright.push_back(set.names[i]);
    else if (rotation.angularDistance(half_turn) < near_rad)
      turned.push_back(set.names[i]);
  }
  const auto& fewer = turned.size() > upright.size() ? upright : turned;
  if (fewer.empty() || upright.size() + turned.size() < set.names.size()) return;  // they lie anyhow
  found.push_back(
      some_of(fewer, 5) +
      ": turned by half a turn against the other shapes, as RAS is against LPS; if its coordinates are RAS, "
      "turn it by convert --from-ras");
}

/// All faces of all shapes look inward; those of a mirrored shape alone are said to be mirrored.
void find_inward(const TrainingSet& set, std::vector<std::string>& found) {
  if (!set.topology) return;
  std::optional<std::string> inward;
  for (Eigen::Index i = 0; i < set.shapes.cols(); ++i)
    if (inward = inside_out({set.topology, points_of(set.shapes, i)}); !inward) return;
  if (inward) found.push_back(set.names.front() + ", as all shapes: " + *inward);
}

/// "ends at \"atrium\""
std::string words_of_faced(const FacedNames& faced) {
  return std::string(faced.kept ? "faces" : "ends at") + " \"" + excerpt(faced.labels) + '"';
}

/// Which part of a label the shapes are of, `said` of each; none, with a warning, where they do not agree. The names of
/// a mirror image may be those of its own side.
std::optional<FacedNames> faced_by_all(const std::vector<std::string>& names,
                                       const std::vector<std::optional<FacedNames>>& said,
                                       const std::vector<Eigen::Index>& mirrored, std::vector<std::string>& warnings) {
  std::vector<char> is_mirrored(said.size());
  for (const Eigen::Index i : mirrored) is_mirrored[i] = 1;
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < said.size(); ++i)
    if (said[i] && (!first || is_mirrored[i] < is_mirrored[*first])) first = i;
  if (!first) return std::nullopt;
  const FacedNames of_set = is_mirrored[*first] != 0 ? names_of_other_side(*said[*first]) : *said[*first];
  for (std::size_t i = 0; i < said.size(); ++i) {
    if (!said[i] || *said[i] == of_set || (is_mirrored[i] != 0 && names_of_other_side(*said[i]) == of_set)) continue;
    warnings.push_back(names[i] + ": " + words_of_faced(*said[i]) + ", and " + names[*first] + " " +
                       words_of_faced(*said[*first]) +
                       "; a model of both keeps neither, and score takes a label's whole surface; make the shapes from "
                       "one template");
    return std::nullopt;
  }
  return of_set;
}

/// Errors: a shape whose vertices are in another order than most others have them.
Result<void> check_order(const TrainingSet& set) {
  const OtherNumbering other = other_numbering(set.shapes, set.topology);
  if (other.shapes.empty()) return {};
  std::vector<std::string> names;
  for (const Eigen::Index shape : other.shapes) names.push_back(set.names[shape]);
  const std::string first = names.front();
  names.erase(names.begin());
  return fail(first, "has its vertices in another order than " + set.names[other.example] +
                         (names.empty() ? "" : " (so has " + some_of(names, 5) + ")") +
                         ": what lies side by side there lies far apart here; only shapes in correspondence make a "
                         "model, so leave it out or make it from the same template");
}

}  // namespace

std::vector<std::string> oddities(const TrainingSet& set) {
  std::vector<std::string> found;
  if (set.shapes.cols() < 2) return found;
  find_twins(set, found);
  find_sizes(set, found);
  find_half_turns(set, found);
  find_inward(set, found);
  return found;
}

bool looks_mirrored(const Points& shape, const Points& other) {
  return reflection_gain(shape, other) > mirrored_gain;
}

int power_of_ten(double ratio) {
  const double power = std::log10(ratio);
  if (!std::isfinite(power) || std::abs(power) > 6.25 || std::abs(power - std::round(power)) >= 0.25) return 0;
  return static_cast<int>(std::lround(power));
}

std::vector<Eigen::Index> mirrored_shapes(const TrainingSet& set) {
  std::vector<Eigen::Index> like_first, other_hand;
  if (set.shapes.cols() == 0) return other_hand;
  const Points first = points_of(set.shapes, 0);
  for (Eigen::Index i = 0; i < set.shapes.cols(); ++i) {
    const bool mirrored = looks_mirrored(first, points_of(set.shapes, i));
    (mirrored ? other_hand : like_first).push_back(i);
  }
  return other_hand.size() > like_first.size() ? like_first : other_hand;
}

/// The connectivity that most files have; faces turned inside out are the same.
class TrainingSetBuilder::Majority {
 public:
  /// `.particles` have no faces and may join any connectivity of their count.
  void add(const MeshFile& file) {
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
      Kind& kind = kinds_[k];
      if (kind.vertices != file.points.rows()) continue;
      const bool is_turned = kind.triangles.rows() > 0 && turned_faces(kind.triangles, file.triangles);
      if (!is_turned && !same_faces(kind.triangles, file.triangles)) continue;
      ++(is_turned ? kind.turned_files : kind.files);
      of_file_.push_back({k, is_turned});
      return;
    }
    of_file_.push_back({kinds_.size(), false});
    kinds_.push_back({file.points.rows(), file.triangles, 1, 0});
  }

  /// Errors: a file whose connectivity differs from that of most; `names` gives the files as they were added.
  Result<std::shared_ptr<const Topology>> common(const std::vector<std::string>& names) const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < kinds_.size(); ++k)
      if (std::pair(kinds_[k].triangles.rows() > 0, kinds_[k].all_files()) >
          std::pair(kinds_[best].triangles.rows() > 0, kinds_[best].all_files()))
        best = k;
    const Kind& most = kinds_[best];
    const auto of_most =
        std::find_if(of_file_.begin(), of_file_.end(), [&](const OfFile& one) { return one.kind == best; });
    const std::string& example = names[of_most - of_file_.begin()];
    for (std::size_t i = 0; i < names.size(); ++i) {
      const Kind& kind = kinds_[of_file_[i].kind];
      if (kind.vertices != most.vertices) {
        return fail(names[i],
                    "has " + std::to_string(kind.vertices) + " vertices where " + example + " has " +
                        std::to_string(most.vertices) +
                        "; only shapes in correspondence make a model, so leave it out or make it from the same "
                        "template");
      }
      if (kind.triangles.rows() > 0 && &kind != &most) {
        return fail(names[i],
                    "has other faces (or another numbering) than " + example +
                        "; only shapes in correspondence make a model, so leave it out or make it from the same "
                        "template");
      }
    }
    if (most.triangles.rows() == 0) return std::shared_ptr<const Topology>();
    Triangles triangles = most.triangles;
    if (most.mostly_turned()) triangles.col(1).swap(triangles.col(2));
    auto topology = Topology::make(most.vertices, std::move(triangles));
    if (!topology) return fail(example, topology.error().what);
    return *topology;
  }

  /// Those whose faces are turned the other way round than most have them.
  std::vector<std::string> inside_out(const std::vector<std::string>& names) const {
    std::vector<std::string> found;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const Kind& kind = kinds_[of_file_[i].kind];
      if (kind.turned_files > 0 && of_file_[i].turned != kind.mostly_turned()) found.push_back(names[i]);
    }
    return found;
  }

 private:
  struct Kind {
    Eigen::Index vertices = 0;
    Triangles triangles;
    int files = 0, turned_files = 0;
    int all_files() const { return files + turned_files; }
    bool mostly_turned() const { return turned_files > files; }
  };
  struct OfFile {
    std::size_t kind = 0;
    bool turned = false;
  };
  std::vector<Kind> kinds_;
  std::vector<OfFile> of_file_;
};

TrainingSetBuilder::TrainingSetBuilder(std::size_t most_shapes)
    : majority_(std::make_unique<Majority>()), most_shapes_(most_shapes) {}
TrainingSetBuilder::~TrainingSetBuilder() = default;

void TrainingSetBuilder::add(std::string name, const MeshFile& mesh) {
  const auto shape = static_cast<Eigen::Index>(shapes());
  majority_->add(mesh);
  set_.names.push_back(std::move(name));
  faced_.push_back(faced_in(mesh.comments));
  if (shape == 0) set_.shapes.resize(mesh.points.size(), static_cast<Eigen::Index>(most_shapes_));
  if (shape == set_.shapes.cols()) set_.shapes.conservativeResize(Eigen::NoChange, 2 * shape);
  if (mesh.points.size() == set_.shapes.rows())
    set_.shapes.col(shape) = Eigen::Map<const Eigen::VectorXd>(mesh.points.data(), mesh.points.size());
}

Result<TrainingSetRead> TrainingSetBuilder::finish(bool flip_mirrored) {
  if (set_.names.empty()) return fail("", "no shape was given; a model needs at least two");
  auto topology = majority_->common(set_.names);
  if (!topology) return fail(topology.error());
  const auto count = static_cast<Eigen::Index>(shapes());
  if (count < 2) {
    return fail(set_.names.front(), most_shapes_ < 2
                                        ? "is one shape only; a model needs at least two"
                                        : "is the only shape that could be read; a model needs at least two");
  }
  set_.topology = *topology;
  set_.shapes.conservativeResize(Eigen::NoChange, count);
  if (auto ordered = check_order(set_); !ordered) return fail(ordered.error());
  if (((set_.shapes.rightCols(count - 1).colwise() - set_.shapes.col(0)).array() == 0).all())
    return fail(set_.names.front(),
                "is the same shape as all others, so there is nothing to model; give different shapes");
  TrainingSetRead read;
  read.set = std::move(set_);
  read.warnings = oddities(read.set);
  std::vector<std::string> inside_out = majority_->inside_out(read.set.names);
  const std::vector<Eigen::Index> mirrored = mirrored_shapes(read.set);
  for (const Eigen::Index i : mirrored) {
    read.mirrored.push_back(read.set.names[i]);
    std::erase(inside_out, read.mirrored.back());  // as the mirror image of a template is
    if (flip_mirrored)
      for (Eigen::Index x = 0; x < read.set.shapes.rows(); x += 3) read.set.shapes(x, i) *= -1;
  }
  if (!inside_out.empty())
    read.warnings.push_back(some_of(inside_out, 5) +
                            ": its faces look inward, unlike those of the other shapes; they were turned outward");
  read.set.faced = faced_by_all(read.set.names, faced_, mirrored, read.warnings);
  return read;
}

}  // namespace homolog
