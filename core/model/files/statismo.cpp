#include "core/model/files/statismo.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "core/base/numbers/limits.h"
#include "core/base/text/text.h"
#include "core/model/files/hdf_tree.h"
#include "core/model/files/statismo_parts.h"
#include "core/model/files/statismo_values.h"

namespace homolog {

namespace fs = std::filesystem;

using statismo::FloatMatrix;
using statismo::floats_of;
using statismo::matrix_at;
using statismo::shrink;
using statismo::text_of;

namespace statismo {

Result<FloatMatrix> matrix_at(const HdfTree& tree, const std::string& path, Eigen::Index rows, Eigen::Index columns) {
  const std::vector<float>* values = tree.floats(path);
  if (values == nullptr)
    return fail(shrink("holds no " + path + ", so it is not a shape model of statismo or scalismo"));
  const auto& dims = tree.datasets.at(path).dims;
  const Eigen::Index r = dims.empty() ? 1 : static_cast<Eigen::Index>(dims[0]);
  const Eigen::Index c = dims.size() < 2 ? 1 : static_cast<Eigen::Index>(dims[1]);
  if (dims.size() > 2 || r * c != std::ssize(*values) || (rows >= 0 && r != rows) || (columns >= 0 && c != columns))
    return fail(shrink(path + " does not fit the other parts of the model"));
  const FloatMatrix matrix = Eigen::Map<const FloatMatrix>(values->data(), r, c);
  if (!matrix.allFinite()) return fail(shrink(path + " holds a number that is not finite"));
  return matrix;
}

}  // namespace statismo

namespace {

constexpr const char* record_path = "/homolog/record";
constexpr const char *alignment_path = "/homolog/alignment", *left_out_path = "/homolog/left_out_distances";
constexpr std::array<std::pair<const char*, bool>, 2> faced_paths{
    {{"/homolog/faces", true}, {"/homolog/ends_at", false}}};  // and whether it is the part that is kept
constexpr const char* names_start = "/modelinfo/modelBuilder-0/dataInfo/URI_";  // before the number of a shape
bool name_ends_with(const fs::path& path, const std::string& ending) {
  const std::string name = lower_case(path.filename().string());
  return name.size() > ending.size() && name.ends_with(ending);
}

HdfTree::Dataset number_of(std::int32_t number) {
  HdfTree::Dataset dataset;
  dataset.values = std::vector<std::int32_t>{number};
  return dataset;
}

/// When the model was made as SOURCE_DATE_EPOCH says; empty without it, so that the same shapes give the same bytes
/// [reproducible-builds.org].
std::string build_time() {
  const char* const epoch = std::getenv("SOURCE_DATE_EPOCH");
  if (epoch == nullptr) return {};
  long long seconds = 0;
  const char* const end = epoch + std::strlen(epoch);
  if (const auto [stop, error] = std::from_chars(epoch, end, seconds); error != std::errc() || stop != end) return {};
  const auto then = static_cast<std::time_t>(seconds);
  std::tm parts{};
  if (::gmtime_r(&then, &parts) == nullptr) return {};
  char text[64];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts)};
}

HdfTree tree_of(const ShapeModel& model, const std::string& record) {
  HdfTree tree;
  tree.groups["/"];
  tree.groups["/model"];
  tree.groups["/modelinfo"];
  tree.groups["/modelinfo/modelBuilder-0"];
  tree.groups["/modelinfo/modelBuilder-0/dataInfo"];
  tree.groups["/modelinfo/modelBuilder-0/parameters"];
  tree.groups["/version"];
  tree.groups["/representer"] = {{"name", "itkStandardMeshRepresenter"},
                                 {"version", "0.9"},
                                 {"version/majorVersion", "0"},
                                 {"version/minorVersion", "9"},
                                 {"datasetType", model.topology ? "POLYGON_MESH" : "POINT_SET"}};
  auto& datasets = tree.datasets;
  datasets["/version/majorVersion"] = number_of(0);
  datasets["/version/minorVersion"] = number_of(9);
  datasets["/representer/points"] = floats_of(points_of(model.mean).transpose());
  if (model.topology) {
    const Triangles& triangles = model.topology->triangles();
    HdfTree::Dataset cells;
    cells.dims = {3, static_cast<std::size_t>(triangles.rows())};
    std::vector<std::int32_t> corners(static_cast<std::size_t>(triangles.size()));
    Eigen::Map<Eigen::Matrix<std::int32_t, 3, Eigen::Dynamic, Eigen::RowMajor>>(corners.data(), 3, triangles.rows()) =
        triangles.transpose();
    cells.values = std::move(corners);
    datasets["/representer/cells"] = std::move(cells);
  }
  datasets["/model/mean"] = floats_of(model.mean, true);
  datasets["/model/pcaBasis"] = floats_of(model.basis);
  datasets["/model/pcaVariance"] = floats_of(model.variances, true);
  datasets["/model/noiseVariance"] = floats_of(Eigen::VectorXd::Constant(1, model.noise_variance), true);
  // In standard deviations, as statismo counts coefficients.
  if (model.scores.cols() > 0)
    datasets["/modelinfo/scores"] = floats_of(model.variances.cwiseSqrt().cwiseInverse().asDiagonal() * model.scores);
  if (const std::string time = build_time(); !time.empty()) {
    datasets["/modelinfo/build-time"] = text_of(time);
    datasets["/modelinfo/modelBuilder-0/buildTime"] = text_of(time);
  }
  datasets["/modelinfo/modelBuilder-0/builderName"] = text_of("Homolog");
  for (std::size_t i = 0; i < model.names.size(); ++i)
    datasets[names_start + std::to_string(i)] = text_of(model.names[i]);
  if (model.alignment) {
    tree.groups["/homolog"];
    datasets[alignment_path] = text_of(alignment_names[static_cast<std::size_t>(*model.alignment)]);
  }
  if (model.faced) {
    tree.groups["/homolog"];
    for (const auto& [path, kept] : faced_paths)
      if (kept == model.faced->kept) datasets[path] = text_of(model.faced->labels);
  }
  if (model.left_out_distances.size() > 0) {
    tree.groups["/homolog"];
    datasets[left_out_path] = floats_of(model.left_out_distances, true);
  }
  if (!record.empty()) {
    tree.groups["/homolog"];
    datasets[record_path] = text_of(record);
  }
  statismo::add_structures(model, tree);
  return tree;
}

Result<std::shared_ptr<const Topology>> topology_of(const HdfTree& tree, Eigen::Index vertices) {
  const std::string type = tree.attribute("/representer", "datasetType");
  if (type == "POINT_SET") return std::shared_ptr<const Topology>();
  if (type != "POLYGON_MESH")
    return fail("", "is a model of " + (type.empty() ? "unknown data" : excerpt(type)) +
                        "; only models of triangle meshes (POLYGON_MESH) and of points (POINT_SET) can be used");
  const auto* cells = tree.integers("/representer/cells");
  if (cells == nullptr || tree.datasets.at("/representer/cells").dims.size() != 2 ||
      tree.datasets.at("/representer/cells").dims[0] != 3)
    return fail(shrink("/representer/cells is not 3 × the number of triangles"));
  const Eigen::Index count = std::ssize(*cells) / 3;
  const Triangles triangles =
      Eigen::Map<const Eigen::Matrix<std::int32_t, 3, Eigen::Dynamic, Eigen::RowMajor>>(cells->data(), 3, count)
          .transpose();
  return Topology::make(vertices, triangles);
}

/// Refuses versions whose numbers would be misread; true where the basis holds √λ (0.8).
Result<bool> basis_is_scaled(const HdfTree& tree) {
  const auto* major = tree.integers("/version/majorVersion");
  const auto* minor = tree.integers("/version/minorVersion");
  const std::int32_t a = major != nullptr && !major->empty() ? major->front() : 0;
  const std::int32_t b = minor != nullptr && !minor->empty() ? minor->front() : 8;
  if (a == 1 || (a == 0 && b == 9)) return false;
  if (a == 0 && b == 8) return true;
  return fail("", "is of version " + std::to_string(a) + "." + std::to_string(b) +
                      " of the model format; 0.8, 0.9 and 1.x can be read");
}

void read_training(const HdfTree& tree, ShapeModel& model) {
  const auto scores = matrix_at(tree, "/modelinfo/scores", model.modes(), -1);
  if (scores) model.scores = model.variances.cwiseSqrt().asDiagonal() * scores->cast<double>();
  for (int i = 0;; ++i) {
    const std::string path = names_start + std::to_string(i);
    if (!tree.datasets.contains(path)) break;
    model.names.push_back(tree.text(path));
  }
}

Result<ShapeModel> model_of(const HdfTree& tree) {
  const auto mean = matrix_at(tree, "/model/mean", -1, 1);
  if (!mean) return fail(mean.error());
  if (mean->size() == 0 || mean->size() % 3 != 0) return fail(shrink("/model/mean is not made of points in space"));
  const auto variances = matrix_at(tree, "/model/pcaVariance", -1, 1);
  if (!variances) return fail(variances.error());
  const auto basis = matrix_at(tree, "/model/pcaBasis", mean->rows(), variances->rows());
  if (!basis) return fail(basis.error());
  const auto scaled = basis_is_scaled(tree);
  if (!scaled) return fail(scaled.error());
  if (variances->size() > 0 && variances->minCoeff() < 0)
    return fail(shrink("/model/pcaVariance holds a negative number"));
  auto topology = topology_of(tree, mean->rows() / 3);
  if (!topology) return fail(topology.error());
  ShapeModel model;
  model.topology = std::move(*topology);
  model.mean = mean->cast<double>();
  model.basis = basis->cast<double>();
  model.variances = variances->cast<double>();
  if (*scaled) {
    for (Eigen::Index k = 0; k < model.modes(); ++k)
      if (model.variances[k] > 0) model.basis.col(k) /= std::sqrt(model.variances[k]);
  }
  if (!all_in_reach(model.mean)) return fail(shrink(std::string("/model/mean ") + beyond_farthest));
  for (Eigen::Index k = 0; k < model.modes(); ++k)
    if (!all_in_reach(model.basis.col(k)) || !all_in_reach(std::sqrt(model.variances[k]) * model.basis.col(k)))
      return fail(
          shrink("mode " + std::to_string(k + 1) + " (/model/pcaBasis) moves a point to where it " + beyond_farthest));
  const auto noise = matrix_at(tree, "/model/noiseVariance", 1, 1);
  if (noise) model.noise_variance = static_cast<double>((*noise)(0, 0));
  read_training(tree, model);
  if (tree.datasets.contains(alignment_path))
    for (std::size_t k = 0; k < alignment_names.size(); ++k)
      if (tree.text(alignment_path) == alignment_names[k]) model.alignment = static_cast<Alignment>(k);
  for (const auto& [path, kept] : faced_paths)
    if (const std::string labels = tree.text(path); !labels.empty()) model.faced = FacedNames{labels, kept};
  const auto distances = matrix_at(tree, left_out_path, model.scores.cols(), 1);
  if (distances && model.scores.cols() > 0) model.left_out_distances = distances->cast<double>();
  statismo::read_structures(tree, model);
  return model;
}

Result<HdfTree> tree_in(const fs::path& path, const HdfParts& parts) {
  return name_ends_with(path, ".h5.json") ? read_hdf5_json(path, parts) : read_hdf5(path, parts);
}

}  // namespace

HdfParts model_parts() {
  HdfParts parts{.attributes = {{"/representer", "datasetType"}},
                 .datasets = {"/version/majorVersion", "/version/minorVersion", "/representer/cells", "/model/mean",
                              "/model/pcaBasis", "/model/pcaVariance", "/model/noiseVariance", "/modelinfo/scores",
                              alignment_path, left_out_path},
                 .numbered = {names_start}};
  for (const auto& [path, kept] : faced_paths) parts.datasets.emplace_back(path);
  statismo::add_structure_parts(parts);
  return parts;
}

bool is_model_name(const fs::path& path) {
  return name_ends_with(path, ".h5") || name_ends_with(path, ".h5.json");
}

Result<void> write_model(const ShapeModel& model, const fs::path& path, const std::string& record) {
  if (name_ends_with(path, ".h5.json")) return write_hdf5_json(tree_of(model, record), path);
  if (name_ends_with(path, ".h5")) return write_hdf5(tree_of(model, record), path);
  return fail(path.string(), "is not the name of a model; use .h5.json or .h5");
}

Result<std::optional<std::string>> read_model_record(const fs::path& path) {
  const auto tree = tree_in(path, {.attributes = {}, .datasets = {record_path}, .numbered = {}});
  if (!tree) return fail(tree.error());
  if (!tree->datasets.contains(record_path)) return std::nullopt;
  return tree->text(record_path);
}

Result<ShapeModel> read_model(const fs::path& path) {
  if (!is_model_name(path)) return fail(path.string(), "is not the name of a model; use .h5.json or .h5");
  const auto tree = tree_in(path, model_parts());
  if (!tree) return fail(tree.error());
  auto model = model_of(*tree);
  if (!model) return fail(path.string(), model.error().what);
  return model;
}

}  // namespace homolog
