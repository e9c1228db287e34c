#include "core/model/training_set.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// How much better the mirror image has to fit before a shape is said to be mirrored.
constexpr double mirrored_gain = 2;

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < 5; ++i) text += (i > 0 ? ", " : "") + names[i];
  if (names.size() > 5) text += " and " + std::to_string(names.size() - 5) + " more";
  return text;
}

void find_twins(const TrainingSet& set, std::vector<std::string>& found) {
  std::map<std::string_view, std::size_t> seen;
  for (Eigen::Index i = 0; i < set.shapes.cols(); ++i) {
    const std::string_view bytes(reinterpret_cast<const char*>(set.shapes.col(i).data()),
                                 static_cast<std::size_t>(set.shapes.rows()) * sizeof(double));
    const auto [twin, is_new] = seen.try_emplace(bytes, static_cast<std::size_t>(i));
    if (!is_new)
      found.push_back(set.names[static_cast<std::size_t>(i)] + " is the same shape as " + set.names[twin->second] +
                      "; it counts twice, so leave one of them out");
  }
}

void find_sizes(const TrainingSet& set, std::vector<std::string>& found) {
  std::vector<double> sizes;
  for (Eigen::Index i = 0; i < set.shapes.cols(); ++i) sizes.push_back(centroid_size_mm(points_of(set.shapes, i)));
  std::vector<double> sorted = sizes;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  std::map<int, std::vector<std::string>> by_power;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double power = std::log10(sizes[i] / *middle);
    const int whole = static_cast<int>(std::lround(power));
    if (std::isfinite(power) && whole != 0 && std::abs(whole) <= 6 && std::abs(power - whole) < 0.25)
      by_power[whole].push_back(set.names[i]);
  }
  for (const auto& [power, names] : by_power) {
    found.push_back(joined(names) + ": about " + std::to_string(std::lround(std::pow(10, std::abs(power)))) +
                    " times as " + (power > 0 ? "large" : "small") +
                    " as the other shapes; its lengths may not be in mm, so convert it first");
  }
}

void find_mirrored(const TrainingSet& set, std::vector<std::string>& found) {
  const Points first = points_of(set.shapes, 0);
  std::vector<std::string> like_first, other_hand;
  for (Eigen::Index i = 0; i < set.shapes.cols(); ++i) {
    const bool mirrored = reflection_gain(first, points_of(set.shapes, i)) > mirrored_gain;
    (mirrored ? other_hand : like_first).push_back(set.names[static_cast<std::size_t>(i)]);
  }
  const auto& fewer = other_hand.size() > like_first.size() ? like_first : other_hand;
  if (!fewer.empty())
    found.push_back(
        joined(fewer) +
        ": a mirror image of the other shapes (left for right, or LPS for RAS); flip it with `homolog mirror`");
}

}  // namespace

std::vector<std::string> oddities(const TrainingSet& set) {
  std::vector<std::string> found;
  if (set.shapes.cols() < 2) return found;
  find_twins(set, found);
  find_sizes(set, found);
  find_mirrored(set, found);
  return found;
}

/// The connectivity that most files have.
class TrainingSetBuilder::Majority {
 public:
  /// `.particles` have no faces and may join any connectivity of their count.
  void add(const MeshFile& file) {
    for (Kind& kind : kinds_) {
      if (kind.vertices == file.points.rows() && kind.triangles.rows() == file.triangles.rows() &&
          kind.triangles == file.triangles) {
        ++kind.files;
        kind_of_file_.push_back(&kind - kinds_.data());
        return;
      }
    }
    kind_of_file_.push_back(std::ssize(kinds_));
    kinds_.push_back({file.points.rows(), file.triangles, 1});
  }

  /// Errors: a file whose connectivity differs from that of most; `names` gives the files as they were added.
  Result<std::shared_ptr<const Topology>> common(const std::vector<std::string>& names) const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < kinds_.size(); ++k)
      if (std::pair(kinds_[k].triangles.rows() > 0, kinds_[k].files) >
          std::pair(kinds_[best].triangles.rows() > 0, kinds_[best].files))
        best = k;
    const Kind& most = kinds_[best];
    const auto of_most = std::find(kind_of_file_.begin(), kind_of_file_.end(), std::ptrdiff_t(best));
    const std::string& example = names[static_cast<std::size_t>(of_most - kind_of_file_.begin())];
    for (std::size_t i = 0; i < names.size(); ++i) {
      const Kind& kind = kinds_[static_cast<std::size_t>(kind_of_file_[i])];
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
    auto topology = Topology::make(most.vertices, most.triangles);
    if (!topology) return fail(example, topology.error().what);
    return *topology;
  }

 private:
  struct Kind {
    Eigen::Index vertices = 0;
    Triangles triangles;
    int files = 0;
  };
  std::vector<Kind> kinds_;
  std::vector<std::ptrdiff_t> kind_of_file_;
};

TrainingSetBuilder::TrainingSetBuilder(std::size_t most_shapes)
    : majority_(std::make_unique<Majority>()), most_shapes_(most_shapes) {}
TrainingSetBuilder::~TrainingSetBuilder() = default;

void TrainingSetBuilder::add(std::string name, const MeshFile& mesh) {
  const auto shape = static_cast<Eigen::Index>(shapes());
  majority_->add(mesh);
  set_.names.push_back(std::move(name));
  if (shape == 0) set_.shapes.resize(mesh.points.size(), static_cast<Eigen::Index>(most_shapes_));
  if (mesh.points.size() == set_.shapes.rows())
    set_.shapes.col(shape) = Eigen::Map<const Eigen::VectorXd>(mesh.points.data(), mesh.points.size());
}

Result<TrainingSetRead> TrainingSetBuilder::finish() {
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
  if (((set_.shapes.rightCols(count - 1).colwise() - set_.shapes.col(0)).array() == 0).all())
    return fail(set_.names.front(),
                "is the same shape as all others, so there is nothing to model; give different shapes");
  TrainingSetRead read;
  read.set = std::move(set_);
  read.warnings = oddities(read.set);
  return read;
}

Result<TrainingSetRead> read_training_set(const std::vector<fs::path>& files, Progress* progress) {
  TrainingSetBuilder builder(files.size());
  std::vector<std::string> warnings;
  Error unreadable{"", "no shape was given; a model needs at least two"};
  for (const fs::path& file : files) {
    if (progress != nullptr) {
      progress->report(static_cast<double>(builder.shapes()) / static_cast<double>(files.size()));
      if (progress->cancelled()) return fail("", "was stopped while the shapes were read");
    }
    if (file.extension() == ".stl" || file.extension() == ".STL")
      return fail(file.string(),
                  "is an STL file, which does not keep vertices and so no correspondence; use PLY or VTK");
    const auto mesh = read_mesh_file(file);
    if (!mesh) {
      if (warnings.empty() && builder.shapes() == 0) unreadable = mesh.error();
      warnings.push_back(mesh.error().sentence() + " (left out)");
      continue;
    }
    for (const std::string& warning : mesh->warnings) warnings.push_back(file.string() + ": " + warning);
    builder.add(file.string(), *mesh);
  }
  if (builder.shapes() == 0) return fail(std::move(unreadable));
  auto read = builder.finish();
  if (read) read->warnings.insert(read->warnings.begin(), warnings.begin(), warnings.end());
  return read;
}

}  // namespace homolog
